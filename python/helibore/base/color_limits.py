"""The two values at the ends of a scale of colours, for images, attributes and the wall's radius."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, column
from helibore.base.colors import ColorScale, check_positive, customary_map
from helibore.base.errors import InputError
from helibore.base.units import MILLIMETRE

PERCENTILES = (2.0, 98.0)
"""The usual percentiles at the ends of a static scale."""
NEARLY_ALL = 99.8
"""The usual percentile at the ends of a scale around 0."""
LASTING = 0.5
"""Metres of hole. What fills less than half of it along the hole, as an open fracture does, widens no scale."""


def percentile_limits(
    values: npt.ArrayLike, percentiles: tuple[float, float] = PERCENTILES, log: bool = False
) -> tuple[float, float]:
    """Return the two ends of a static scale: percentiles of the values that are not missing.

    Parameters
    ----------
    values
        Numbers of any shape; NaN and infinite values count as missing.
    percentiles
        Two numbers in [0, 100], the first below the second; (0, 100) gives the least and the greatest value.
    log
        Whether the scale is logarithmic; all values must then be above 0.

    Raises
    ------
    InputError
        ``values: all 96 are missing``; ``values: constant, 60 at both the 2 and the 98 percentile ...``; on a log scale
        as `ColorScale`.
    """
    low, high = percentiles
    if not 0 <= low < high <= 100:
        rule = "must be two numbers in [0, 100], the first below the second"
        raise InputError("percentiles", rule, str(percentiles))
    flat = column("values", np.ravel(values))
    there = flat[np.isfinite(flat)]
    if not there.size:
        raise InputError("values", f"all {flat.size} are missing")
    if log:
        check_positive(flat.reshape(np.shape(values)))
    ends = np.percentile(there, [low, high])
    if not ends[0] < ends[1]:
        rule = f"constant, {ends[0]:g} at both the {low:g} and the {high:g} percentile: give limits=(low, high)"
        raise InputError("values", rule)
    return float(ends[0]), float(ends[1])


def symmetric_limit(values: Floats, unit: float) -> float:
    """Return the limit L of a scale from -L to L: ``unit`` times 1, 2, 3 or 5 times a power of ten, not below ``unit``.

    L is the least such number for which 99.8 % of the values lie from -L to L; missing values do not count.
    """
    there = np.abs(values[np.isfinite(values)])
    reach = max(float(np.percentile(there, NEARLY_ALL)) / unit, 1.0) if there.size else 1.0
    power = 10.0 ** math.floor(math.log10(reach) + 1e-9)
    return unit * power * next(step for step in (1, 2, 3, 5, 10) if step * power >= reach * (1 - 1e-9))


def wall_limit(over: Floats, sectors: int, pitch: float, unit: float) -> float:
    """Return the limit L of the scale of a wall, from -L to L, rounded as `symmetric_limit` does.

    From -L to L lie 98 % of ``over``, the radii less half the bit size, turn after turn, and 99.8 % of what lasts, the
    medians of each sector in each half metre.
    """
    distances = lasting = np.abs(over)
    rows = max(round(LASTING / abs(pitch)), 1)
    if parts := over.size // (rows * sectors):
        blocks = distances[: parts * rows * sectors].reshape(parts, rows, sectors)
        lasting = np.sort(blocks, axis=1)[:, rows // 2].ravel()  # NaN count as the greatest
    there = distances[np.isfinite(distances)]
    most = np.percentile(there, [PERCENTILES[1]]) if there.size else there
    return max(symmetric_limit(lasting, unit), symmetric_limit(most, unit))


def usual_scale(
    values: npt.ArrayLike,
    name: str,
    unit: str = "",
    color_map: str | None = None,
    log: bool | None = None,
    limits: tuple[float, float] | None = None,
) -> ColorScale:
    """Return the usual scale of colours for a quantity.

    By default the name and the unit decide the map (`customary_map`), the scale is logarithmic if that map is
    "resistivity", and the values decide the limits (`percentile_limits`).
    """
    color_map = color_map or customary_map(name, unit)
    log = color_map == "resistivity" if log is None else log
    return ColorScale(*(limits or percentile_limits(values, log=log)), color_map, log)


def over_bit(
    radius: Floats,
    bit_diameter: float,
    sectors: int,
    pitch: float,
    color_map: str | None = None,
    limits: tuple[float, float] | None = None,
    unit: float = MILLIMETRE,
) -> tuple[Floats, ColorScale]:
    """Return the radii of a wall less half the bit size, in a unit of ``unit`` metres, and a scale of colours for them.

    Without ``limits``, the scale is centred on 0.
    """
    over = (radius - 0.5 * bit_diameter) / unit
    limit = wall_limit(over, sectors, pitch, MILLIMETRE / unit)
    return over, ColorScale(*(limits or (-limit, limit)), color_map or "over-bit")
