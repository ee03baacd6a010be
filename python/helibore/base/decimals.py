"""Decimals of numbers in text files of logs: LAS and CSV."""

from __future__ import annotations

DECIMALS = {"m": 6, "m3": 7, "deg": 2, "s": 2, "": 5, "in": 4, "mm": 3, "ft": 5}
"""Decimals of a number by its unit; "" is a fraction or a code."""

USUAL_DECIMALS = 6
"""Decimals of a number whose unit is not in `DECIMALS`."""
