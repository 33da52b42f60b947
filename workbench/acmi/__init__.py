"""Tacview recordings: ACMI 2.2 written, checked and read."""
