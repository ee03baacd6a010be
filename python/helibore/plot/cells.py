"""Numbers of the tables of prints and reports as text."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from helibore.plot.tracks import LENGTHS

if TYPE_CHECKING:
    from helibore.plot.content import Content


def number(value: float, decimals: int = 3) -> str:
    """Return a number as text; "" if it is missing."""
    return f"{round(value, decimals) + 0.0:,.{decimals}f}" if math.isfinite(value) else ""  # + 0.0: never "-0.0"


def in_unit(length: float, content: Content, inch_decimals: int = 3) -> str:
    """Return a length as text, in the drawing's unit of diameters: one decimal in mm, ``inch_decimals`` in inches."""
    unit = content.drawing.size_unit
    return number(length / LENGTHS[unit], inch_decimals if unit == "in" else 1)


def in_depth_unit(depth: float, content: Content, decimals: int = 2) -> str:
    """Return a depth or a length along the hole in the unit that the picture has for depths."""
    return number(depth / content.drawing.depth_unit.metres, decimals)
