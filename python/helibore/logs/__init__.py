"""Measure each turn of a wall (logs), and say what the measures mean (zones, summary); keep the picks of a wall."""
