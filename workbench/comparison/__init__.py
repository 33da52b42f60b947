"""Comparisons of policies: what is asked for, flown by processes of their own, kept, and put together for the page."""
