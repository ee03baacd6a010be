"""Decide the role of each channel of a file, and turn channels into readings."""
