"""The application: command line, server, pages, runs, launcher, recordings."""
