"""Colours of values: the usual colour maps for logs, scales between two values, and grey for missing values.

    share = (value - low) / (high - low), of logarithms on a log scale       colour = map[share]       missing: grey

``color_maps.json`` is the only definition of the maps: meshes, pictures and the viewer's page read it. No map holds a
colour close to this grey.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Bytes, Floats, column
from helibore.base.errors import InputError, check_choice, needs
from helibore.base.units import MILLIMETRE

if TYPE_CHECKING:
    from matplotlib.colors import Colormap, Normalize

Colors = Bytes

_DEFINITION: dict[str, Any] = json.loads(Path(__file__).with_name("color_maps.json").read_text(encoding="utf-8"))


def _rgb(text: str) -> tuple[int, int, int]:
    return int(text[0:2], 16), int(text[2:4], 16), int(text[4:6], 16)


MISSING: tuple[int, int, int] = _rgb(_DEFINITION["missing"])
"""Red, green and blue, 0 to 255, of a missing value: a grey that is not close to any colour of a map."""


ZONE_COLORS: dict[str, str] = {kind: f"#{light}" for kind, (light, _) in _DEFINITION["zones"].items()}
"""Colours of the kinds of zones on a light ground; the page has others in dark mode."""


def ink_on(color: str) -> str:
    """Return "black" or "white": the one with more contrast, as WCAG 2 defines it, on a colour (#rrggbb)."""
    parts = [int(color[at : at + 2], 16) / 255 for at in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    return "black" if luminance > 0.179 else "white"


FILL_COLORS: dict[str, str] = {kind: f"#{light}" for kind, (light, _) in _DEFINITION["fills"].items()}
"""Colours of the fills in the caliper track and the cross-section, on a light ground. "over" fills from the bit size to
C2. "partly over" fills from C2, or from the bit size if C2 is smaller, to C1. "under" fills from the least diameter to
the bit size."""

PICK_COLORS: dict[str, str] = {kind: f"#{light}" for kind, (light, _) in _DEFINITION["picks"].items()}
"""Colours of the classes of picks, on a light ground."""

DIP_TITLES: dict[str, str] = {kind: _DEFINITION["dips"][kind] for kind in ("true", "apparent")}
"""Titles of true dips, and of apparent dips, which are relative to the hole; the page and prints show them."""

DIP_LINES: tuple[int, ...] = tuple(_DEFINITION["dips"]["lines"])
"""The dips, degrees, at which a track of dips has lines, from its left edge to its right edge."""

PERCENTILES = (2.0, 98.0)
"""The usual percentiles at the ends of a static scale."""
NEARLY_ALL = 99.8
"""The colours of a wall end at this percentile of the distances of its radii from half the bit size."""


@dataclass(frozen=True)
class ColorMap:
    """A colour map: evenly spaced colours (stops), and linear interpolation between them."""

    label: str  # what the map is for; menus show this text
    stops: tuple[tuple[int, int, int], ...]  # (red, green, blue) from the least value to the greatest, 0 to 255
    safe: bool  # whether people with red-green colour blindness can read the map: lightness alone shows the order


COLOR_MAPS: dict[str, ColorMap] = {
    name: ColorMap(of["label"], tuple(map(_rgb, of["stops"].split())), of.get("safe", False))
    for name, of in _DEFINITION["maps"].items()
}
"""All maps by name: image, viridis, cividis, gamma, resistivity, caliper, difference, over-bit, over-bit-dark."""


def check_map(color_map: str) -> None:
    """Raise InputError unless ``color_map`` is a known map; the error lists the maps."""
    check_choice("color_map", color_map, COLOR_MAPS)


def color_table(color_map: str, count: int = 256) -> Colors:
    """Return a map as ``count`` colours, (count, 3) uint8, from the least value to the greatest."""
    check_map(color_map)
    stops = np.array(COLOR_MAPS[color_map].stops, dtype=np.float64)
    at = np.linspace(0, len(stops) - 1, count)
    channels = [np.interp(at, np.arange(len(stops)), stops[:, channel]) for channel in range(3)]
    return np.floor(np.column_stack(channels) + 0.5).astype(np.uint8)


def customary_map(name: str, unit: str = "") -> str:
    """Return the usual map for a quantity, by its name and unit.

    >>> customary_map("GRAS"), customary_map("APRA", "ohm.m"), customary_map("ABDC", "g/cm3")
    ('gamma', 'resistivity', 'image')
    """
    if name.lower().startswith(("gr", "gamma")) or "api" in unit.lower():
        return "gamma"
    if unit.lower().startswith("ohm") or name.lower().startswith("res"):
        return "resistivity"
    if name.lower().startswith("difference"):
        return "difference"
    return "caliper" if name.lower().startswith(("radius", "diameter", "caliper")) else "image"


@dataclass(frozen=True)
class ColorScale:
    """A colour map between two values; values beyond them get the colours of the ends."""

    low: float
    high: float
    color_map: str = "viridis"  # one of `COLOR_MAPS`
    log: bool = False  # whether colours follow the logarithm; both ends must then be above 0
    reverse: bool = False  # whether to reverse the order of the colours

    def __post_init__(self) -> None:
        check_map(self.color_map)
        ends = (self.low, self.high)
        if not (all(map(math.isfinite, ends)) and ends[0] < ends[1]):
            raise InputError("limits", "must be two finite numbers, the first below the second", str(ends))
        if self.log and ends[0] <= 0:
            raise InputError("limits", "must be above 0 on a log scale", str(ends))

    def share(self, values: Floats) -> Floats:
        """Return how far along the scale each value lies, 0 to 1, as a new array of the same shape; NaN where missing.

        On a log scale, raises InputError if a value is not above 0.
        """
        low, high = self.low, self.high
        if self.log:
            check_positive(values)
            values, low, high = np.log(values), math.log(low), math.log(high)
        share: Floats = np.where(np.isfinite(values), np.clip((values - low) / (high - low), 0, 1), np.nan)
        return 1 - share if self.reverse else share

    def colors(self, values: Floats) -> Colors:
        """Return the colour of each value, (..., 4) uint8: red, green, blue and 255; missing values are `MISSING`."""
        if self.log:
            check_positive(values)  # before they are cut into blocks, so that an error names the place in ``values``
        table, flat = _table_with_missing(self.color_map), np.ravel(values)
        colors = np.empty((flat.size, 4), dtype=np.uint8)
        for first in range(0, flat.size, _BLOCK):
            share = self.share(flat[first : first + _BLOCK])
            there = np.isfinite(share)
            place = np.where(there, np.rint(np.where(there, share, 0) * (_FINE - 1)), _FINE)
            colors[first : first + _BLOCK] = table[place.astype(np.intp)]
        return colors.reshape(*np.shape(values), 4)

    def matplotlib(self) -> tuple[Colormap, Normalize]:
        """Return the scale for matplotlib, missing values in grey: ``cmap, norm = scale.matplotlib()``."""
        with needs("matplotlib", "plot"):
            from matplotlib.colors import ListedColormap, LogNorm, Normalize
        table = color_table(self.color_map, 256) / 255.0
        drawn = ListedColormap(table[::-1] if self.reverse else table, name=self.color_map)
        red, green, blue = (part / 255.0 for part in MISSING)
        norm = (LogNorm if self.log else Normalize)(self.low, self.high, clip=False)
        return drawn.with_extremes(bad=(red, green, blue)), norm


_FINE = 1024
_BLOCK = 1 << 16  # values coloured at a time, so few that intermediate arrays stay in the processor's cache


@cache
def _table_with_missing(color_map: str) -> Colors:
    """Return (1025, 4) uint8: the colours of the map in `_FINE` steps, then the grey of missing values."""
    table = np.full((_FINE + 1, 4), 255, dtype=np.uint8)
    table[:_FINE, :3] = color_table(color_map, _FINE)
    table[_FINE, :3] = MISSING
    return table


def check_positive(values: Floats) -> None:
    """Raise InputError if a value is not above 0, as a log scale needs; the error names the first. NaN is allowed."""
    wrong = np.flatnonzero(np.ravel(values) <= 0)
    if wrong.size:
        place = ", ".join(str(index) for index in np.unravel_index(wrong[0], np.shape(values)))
        counts = f"({wrong.size} of {np.size(values)} are not)"
        rule = f"must be above 0 on a log scale {counts}; make them NaN to show them as missing"
        raise InputError(f"values[{place}]", rule, f"{np.ravel(values)[wrong[0]]:g}")


def colors_of(
    values: Floats, limits: tuple[float, float] | None = None, color_map: str = "viridis", log: bool = False
) -> Colors:
    """Return the colours of values of any shape, as `ColorScale.colors` does.

    Without ``limits``, the scale reaches from the least value to the greatest; if all values are equal, they get the
    first colour.
    """
    if limits is not None:
        return ColorScale(*limits, color_map=color_map, log=log).colors(values)
    if log:
        check_positive(values)
    there = values[np.isfinite(values)]
    low, high = (float(there.min()), float(there.max())) if there.size else (1.0, 2.0)
    return ColorScale(low, high if high > low else low + max(abs(low), 1.0), color_map, log).colors(values)


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
    color_map: str | None = None,
    limits: tuple[float, float] | None = None,
    unit: float = MILLIMETRE,
) -> tuple[Floats, ColorScale]:
    """Return radii less half the bit size, in a unit of ``unit`` metres, and a scale of colours for them.

    Without ``limits``, the scale is centred on 0.
    """
    over = (radius - 0.5 * bit_diameter) / unit
    limit = symmetric_limit(over, MILLIMETRE / unit)
    return over, ColorScale(*(limits or (-limit, limit)), color_map or "over-bit")
