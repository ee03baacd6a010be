"""Find breakouts in an image: dark sectors on opposite sides of the hole. Radii may not show them clearly.

    relative = value / median of its row         dark: relative < ``dark``

    toolface  0        90       180       270       360
              |         ####               ####      |       two dark arcs, half a turn apart: a row of a breakout
              |          ##                          |       one dark arc: a spall, a joint, a tool mark; no breakout

Broken rock scatters the pulse of an acoustic televiewer, and mud fills the gap between broken rock and the buttons of a
pad. Both tools therefore read low in a breakout, long before its lobes are an inch deep. `ImageCriteria` sets how dark,
wide, opposite and long the arcs must be; every output states these criteria. An image shows where a breakout is and how
wide it opens. Only radii show how deep it is (``zones``).

The search does not find joints and beds, which are sinusoids. A decentred tool can cause narrow dark bands that the
search takes for breakouts.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from helibore.base.arrays import Floats, Integers, Mask
from helibore.base.axial import Axes, axial_mean, lobe_of
from helibore.base.colors import customary_map
from helibore.base.errors import InputError
from helibore.base.tables import LogTable, columns_of

if TYPE_CHECKING:
    from helibore.settings.zone_settings import ImageCriteria


class SearchedImage(Protocol):
    """The part of a `SectorImage` that the search reads."""

    name: str
    unit: str
    depth: Floats
    values: Floats
    reference: Any
    direction: Any

    @property
    def sectors(self) -> int: ...
    @property
    def toolface(self) -> Floats: ...
    def cover(self) -> tuple[Floats, Floats]: ...


@dataclass(frozen=True)
class DarkLobe:
    """One side of a breakout, found in the mean of all rows of the breakout (the mean row)."""

    toolface: float  # of the lobe's middle, weighted by darkness, [0, 360), degrees from the image's reference
    opening: float  # the angle over which the mean row is dark, degrees
    relative: float  # the least value of the mean row within the lobe, as a share of the median


@dataclass(frozen=True)
class ImageBreakout:
    """A stretch of hole with dark sectors on opposite sides."""

    start: float  # measured depths, metres, start above stop
    stop: float
    toolface: float  # of the breakout's axis, [0, 180), degrees from the image's reference
    deviation: float  # standard deviation of the rows' axes about ``toolface``, degrees (axial, Mardia); NaN if one row
    lobes: tuple[DarkLobe, DarkLobe]  # the lobe at ``toolface`` first

    @property
    def length(self) -> float:
        """Metres of hole."""
        return self.stop - self.start


@dataclass(frozen=True)
class ImageBreakouts:
    """All breakouts of an ``image``, its ``zones`` in order of depth, and their ``criteria``.

    `SectorImage.breakouts` makes it.
    """

    image: SearchedImage
    zones: tuple[ImageBreakout, ...]
    criteria: ImageCriteria

    def axis(self) -> Axes:
        """Return the mean axis of the breakouts and its spread, weighted by length; NaN if there are no breakouts."""
        return axial_mean(np.array([of.toolface for of in self.zones]), np.array([of.length for of in self.zones]))

    def facts(self) -> dict[str, str]:
        """Return the image and the criteria of the search as texts."""
        image = self.image
        return {
            "image": f"{image.name}, {image.sectors} sectors",
            "toolface 0": image.reference,
            "breakout": "sectors of an image that are dark on opposite sides",
            **self.criteria.facts(),
        }

    def table(self) -> LogTable:
        """Return a table with one breakout per row and the criteria as facts; without breakouts it has no row."""
        zones = self.zones
        rows: list[Any] = [
            ("DEPT", "m", "Middle of the breakout", [(of.start + of.stop) / 2 for of in zones]),
            ("TOP", "m", "Top of the breakout", [of.start for of in zones]),
            ("BOTTOM", "m", "Bottom of the breakout", [of.stop for of in zones]),
            ("AXIS", "deg", "Toolface of its axis, 0 to 180", [of.toolface for of in zones]),
            ("AXISDEV", "deg", "Axial standard deviation of its rows", [of.deviation for of in zones]),
        ]
        for number in (1, 2):
            lobes = [of.lobes[number - 1] for of in zones]
            rows += [
                (f"LOBE{number}", "deg", "Toolface of the lobe", [of.toolface for of in lobes]),
                (f"OPEN{number}", "deg", "Opening of the lobe", [of.opening for of in lobes]),
                (f"REL{number}", "", "Least value over the row's median", [of.relative for of in lobes]),
            ]
        return LogTable(columns_of(*rows), self.facts())

    def __repr__(self) -> str:
        return f"ImageBreakouts({len(self.zones)} in image {self.image.name!r})"


def find_breakouts(image: SearchedImage, criteria: ImageCriteria | None = None) -> ImageBreakouts:
    """Find where an image is dark on opposite sides of the hole; see `SectorImage.breakouts`."""
    if customary_map(image.name, image.unit) == "gamma":
        raise InputError(f"image {image.name!r}", "gamma is dark in beds, not in breakouts; use an image of the wall")
    if criteria is None:
        from helibore.settings.zone_settings import ImageCriteria

        criteria = ImageCriteria()
    relative, toolface = _relative(image)
    dark = relative < criteria.dark
    row, first, count = _arcs(dark)
    step = 360 / image.sectors
    lobes = (count * step >= criteria.least_opening - 1e-9) & (count * step <= criteria.most_opening + 1e-9)
    row, middle = row[lobes], first[lobes] + (count[lobes] - 1) / 2
    broken = _paired(row, middle * step, image.depth.size, criteria.opposite)
    # The axis of each row, degrees: half the direction of the doubled angles, weighted by darkness.
    weight = np.maximum(
        criteria.dark - np.nan_to_num(np.where(broken[:, None], relative, np.nan), nan=criteria.dark), 0
    )
    axes: Floats = np.degrees(np.angle(weight @ np.exp(2j * np.radians(toolface)))) / 2
    low, high = image.cover()
    zones = []
    for top, stop in _stretches(broken, axes, low, high, criteria):
        rows = top + np.flatnonzero(broken[top:stop])
        if rows.size < criteria.least_rows:
            continue
        ends = (float(low[top]), float(high[stop - 1]))
        zones.append(_zone(relative[rows], axes[rows], toolface, criteria.dark, ends))
    return ImageBreakouts(image, tuple(zones), criteria)


def _relative(image: SearchedImage) -> tuple[Floats, Floats]:
    """Return the values divided by the median of their row, and the toolfaces of the sectors, in clockwise order.

    Values are NaN where they are missing, and in rows whose median is 0. Raises an InputError if a value is negative.
    """
    values, toolface = image.values, image.toolface
    wrong = np.argwhere(values < 0)
    if wrong.size:
        row, sector = wrong[0]
        place = f"image '{image.name}', values[{row}, {sector}]"
        rule = "must not be negative where dark is a share of the row's median"
        raise InputError(place, rule, f"{values[row, sector]:g}")
    median = np.full(len(values), np.nan)
    there = np.isfinite(values).any(axis=1)
    median[there] = np.nanmedian(values[there], axis=1)
    median[median == 0] = np.nan
    relative = values / median[:, None]
    return (relative, toolface) if image.direction == "clockwise" else (relative[:, ::-1], toolface[::-1])


def _arcs(dark: Mask) -> tuple[Integers, Integers, Integers]:
    """Return runs of dark sectors as row, first sector and number of sectors; a row that is all dark has no run."""
    row, first = np.nonzero(dark & ~np.roll(dark, 1, axis=1))
    end_row, last = np.nonzero(dark & ~np.roll(dark, -1, axis=1))
    # In a row whose last run continues at sector 0, the end of this run comes first; it is moved behind the other ends.
    over = np.flatnonzero(np.diff(end_row, prepend=-1))
    wraps = last[over] < first[over]
    ends = np.append(over, last.size)
    for begin, stop in zip(ends[:-1][wraps], ends[1:][wraps], strict=True):
        last[begin:stop] = np.roll(last[begin:stop], -1)
    return row, first, (last - first) % dark.shape[1] + 1


def _paired(row: Integers, middle: Floats, rows: int, opposite: float) -> Mask:
    """Return which rows have two arcs whose middles are 180 degrees apart, plus or minus ``opposite`` degrees.

    ``row`` and ``middle`` are the row and the middle, degrees, of each arc.
    """
    found = np.zeros(rows, dtype=np.bool_)
    most = int(np.bincount(row).max()) if row.size else 0
    for apart in range(1, most):
        same = row[apart:] == row[:-apart]
        off = np.abs((middle[apart:] - middle[:-apart]) % 360 - 180)
        found[row[apart:][same & (off <= opposite + 1e-9)]] = True
    return found


def _stretches(
    broken: Mask, axes: Floats, low: Floats, high: Floats, criteria: ImageCriteria
) -> Iterator[tuple[int, int]]:
    """Yield the rows [top, stop) of each breakout, joined over short gaps and split where the axis changes."""
    joined: list[list[int]] = []
    for row in np.flatnonzero(broken).tolist():
        if joined:
            last = joined[-1][1] - 1
            turned = abs((axes[row] - axes[last] + 90) % 180 - 90)
            if low[row] - high[last] <= criteria.join + 1e-9 and turned <= criteria.opposite:
                joined[-1][1] = row + 1
                continue
        joined.append([row, row + 1])
    for top, stop in joined:
        if high[stop - 1] - low[top] >= criteria.least_length - 1e-9:
            yield top, stop


def _zone(relative: Floats, axes: Floats, toolface: Floats, dark: float, ends: tuple[float, float]) -> ImageBreakout:
    there = np.isfinite(relative)
    count = there.sum(axis=0)
    mean = np.where(there, relative, 0.0).sum(axis=0) / np.maximum(count, 1)
    darkness = np.where(count > 0, 1 - mean, 0.0)
    spread = axial_mean(axes % 180)
    sides = []
    for side in (spread.mean, spread.mean + 180):
        lobe = lobe_of(darkness, side, float(toolface[0]), 1 - dark)
        sides.append(DarkLobe(lobe.toolface, lobe.opening, 1 - lobe.height))
    return ImageBreakout(*ends, spread.mean, spread.deviation, (sides[0], sides[1]))
