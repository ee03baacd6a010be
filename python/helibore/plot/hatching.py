"""How a picture on paper shows what is not measured: the lines, greys and faded colours of the viewer's page.

    no data: grey under dense lines that rise        interpolated: a faded colour under sparse lines that fall

The numbers are those of the page's shader (``viewer/web/src/shaders.js``), whose pixels are 1/96 inch.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.units import INCH

if TYPE_CHECKING:
    from helibore.plot.paper import Sheet

PIXEL = 1000.0 * INCH / 96
"""Size of a pixel of the page, millimetres."""
DENSE = 7.0 * PIXEL
"""Distance between the lines over what has no data, along a row of pixels, millimetres."""
HATCH = 10.0 * PIXEL
"""Distance between the lines over interpolated values, along a row of pixels, millimetres."""
LINE = 1.5 * PIXEL
"""Width of a line along a row of pixels, millimetres."""
NO_DATA = (204, 204, 204)
"""Red, green and blue of what has no data, between the lines."""
NO_DATA_LINE = (158, 158, 158)
HATCH_BYTES = (140, 140, 140)
"""Red, green and blue of the lines over interpolated values."""
PALE, PALENESS = 245, 0.55
"""Grey that colours of interpolated values fade to, and how far they fade to it."""


def rgb(color: tuple[int, int, int]) -> tuple[float, float, float]:
    """Return a colour of bytes as matplotlib takes it, each part in [0, 1]."""
    red, green, blue = (part / 255.0 for part in color)
    return red, green, blue


def faded(colors: Any, whole: float = 255.0) -> Any:
    """Return colours, (..., 3) from 0 to ``whole``, as those of interpolated values."""
    return (1.0 - PALENESS) * colors + PALENESS * PALE * (whole / 255.0)


def hatch(sheet: Sheet, colors: Any, between: Any, gone: Any) -> Any:
    """Return the pixels of a picture, (rows, columns, 3) uint8, with what is not measured hatched.

    ``between`` and ``gone``, (rows, columns): where values are interpolated, and where there are none.
    """
    down, right = np.ogrid[: colors.shape[0], : colors.shape[1]]
    wide = max(sheet.pixels(LINE), 1)
    shown = np.where(between[..., None], faded(colors.astype(float)).round().astype(np.uint8), colors)
    shown[between & ((right - down) % sheet.pixels(HATCH) < wide)] = HATCH_BYTES
    shown[gone] = NO_DATA
    shown[gone & ((right + down) % sheet.pixels(DENSE) < wide)] = NO_DATA_LINE
    return shown


def mostly_interpolated(interpolated: Floats, sectors: int) -> Floats:
    """Return for each turn of a wall, whole or not, 1 where most of it is interpolated, as on the page, else 0."""
    starts = np.arange(0, interpolated.size, sectors)
    sizes = np.diff(np.append(starts, interpolated.size))
    return (2 * np.add.reduceat(interpolated, starts) > sizes).astype(float)
