"""The index of runs: one database beside the folders, made anew from them whenever it is missing or damaged."""
