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

from helibore.base.arrays import Bytes, Floats
from helibore.base.errors import InputError, check_choice, needs

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

TOP_COLOR: str = f"#{_DEFINITION['tops'][0]}"
"""Colour of the tops of named intervals, on a light ground."""

DIP_TITLES: dict[str, str] = {kind: _DEFINITION["dips"][kind] for kind in ("true", "apparent")}
"""Titles of true dips, and of apparent dips, which are relative to the hole; the page and prints show them."""

DIP_LINES: tuple[int, ...] = tuple(_DEFINITION["dips"]["lines"])
"""The dips, degrees, at which a track of dips has lines, from its left edge to its right edge."""


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
