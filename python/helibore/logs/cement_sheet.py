"""A cement sheet: what a casing in the measured hole takes, section by section, from the shoe upwards.

        |  |      |  |
        |  | lap  |  |       previous casing: pi/4 (its inner diameter^2 - casing^2), no excess
        |  |______|  |  <- previous shoe
        (  |      |  )       open hole: pi/4 (measured area - casing), with the excess
        (  | shoe |  )
        (  | track|  )       shoe track: inside the casing, from the float collar to the shoe; none if stabbed in
        (  |______|  )  <- shoe
        (            )       rat hole: the hole below the shoe, with the excess

Where the hole was not measured, a section takes the mean area of its measured part, and the sheet states the share that
was measured. A section without a measured row is an error. The uncertainty is the sum of those of the rows, as if their
errors never cancelled: it is an upper limit, and NaN without the sigma of the logs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.errors import InputError
from helibore.settings.cement_settings import CementJob

OPEN_HOLE, RAT_HOLE, SHOE_TRACK, LAP = "open hole", "rat hole", "shoe track", "lap"
COLUMNS = ("section", "slurry", "top [m]", "bottom [m]", "volume [m3]", "sigma [m3]", "by bit size [m3]", "measured")


class MeasuredHole(NamedTuple):
    """Columns of the logs with one row a turn or step, and the height of a row and the bit size, metres."""

    depth: Floats
    coverage: Floats
    equivalent_diameter: Floats
    volume_sigma: Floats
    height: float
    bit_diameter: float


class CementSection(NamedTuple):
    """A section of a cement sheet, with one slurry.

    Attributes
    ----------
    name
        "rat hole", "shoe track", "open hole" or "lap".
    slurry
        "lead" or "tail"; "" if the job has one slurry.
    top, bottom
        Measured depths, metres.
    volume
        With the excess, cubic metres.
    sigma
        Upper limit of its standard uncertainty, cubic metres; 0 inside casings, NaN if the logs have none.
    by_bit_size
        Volume in a gauge hole, with the same excess, cubic metres.
    measured
        Share of the wall of the section that was measured, as `Logs.coverage` counts it, 0 to 1; 1 inside casings.
    """

    name: str
    slurry: str
    top: float
    bottom: float
    volume: float
    sigma: float
    by_bit_size: float
    measured: float


@dataclass(frozen=True)
class CementSheet:
    """The cement of a job; made by `Logs.cement_sheet`.

    Attributes
    ----------
    job
        The casing and how it is cemented.
    sections
        From the bottom upwards.
    displacement
        What is pumped behind the cement, cubic metres: the casing above the float collar, or the drill pipe of a
        stab-in job; NaN without an inner diameter.
    """

    job: CementJob
    sections: tuple[CementSection, ...]
    displacement: float = field(default=math.nan)

    @property
    def total(self) -> float:
        """All slurry, cubic metres."""
        return sum(each.volume for each in self.sections)

    @property
    def sigma(self) -> float:
        """Upper limit of the standard uncertainty of `total`, cubic metres."""
        return sum(each.sigma for each in self.sections)

    def slurry(self, name: str) -> float:
        """Return the volume of a slurry, cubic metres; 0 if there is no such slurry.

        Parameters
        ----------
        name
            "lead" or "tail".
        """
        return sum(each.volume for each in self.sections if each.slurry == name)

    def rows(self) -> list[list[str]]:
        """Return the sheet as rows of text: the names of the columns, the sections, total and displacement."""
        rows = [list(COLUMNS)]
        for each in self.sections:
            numbers = (each.volume, each.sigma, each.by_bit_size, each.measured)
            rows.append([each.name, each.slurry, f"{each.top:.2f}", f"{each.bottom:.2f}", *map(_number, numbers)])
        by_bit = sum(each.by_bit_size for each in self.sections)
        rows.append(["total", "", "", "", *map(_number, (self.total, self.sigma, by_bit)), ""])
        rows += [[name, "", "", "", _number(of), "", "", ""] for name in ("lead", "tail") if (of := self.slurry(name))]
        if not math.isnan(self.displacement):
            rows.append(["displacement", "", "", "", _number(self.displacement), "", "", ""])
        return rows


def _number(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.3f}"


def cement_sheet(logs: MeasuredHole, job: CementJob) -> CementSheet:
    """Return the cement of a job in the hole of ``logs``, as `Logs.cement_sheet` describes."""
    if not logs.depth.size:
        raise InputError("cement", "the logs have no row")
    half = 0.5 * logs.height
    start, stop = float(logs.depth.min()) - half, float(logs.depth.max()) + half
    previous = job.previous_shoe
    top = (start if previous is None else previous) if job.top is None else job.top
    open_top = top if previous is None else max(top, previous)
    if not start - 1e-9 <= job.shoe <= stop + 1e-9:
        rule = f"must lie in the logs, which reach from {start:.2f} to {stop:.2f} m"
        raise InputError("shoe", rule, f"{job.shoe:g}", "cement.shoe")
    if open_top < start - 1e-9:
        name = "top" if open_top == top else "previous_shoe"
        rule = f"the logs reach from {start:.2f} to {stop:.2f} m only"
        raise InputError(name, rule, f"{open_top:g}", f"cement.{name}")
    casing = _area(job.casing)
    parts: list[tuple[str, float, float]] = [
        (RAT_HOLE, job.shoe, stop),
        (SHOE_TRACK, job.shoe - (0.0 if job.stab_in else job.shoe_track), job.shoe),
        (OPEN_HOLE, open_top, job.shoe),
        (LAP, top, open_top),
    ]
    sections = []
    for name, upper, lower in parts:
        for slurry, high, low in _slurries(upper, lower, job.tail_top, name):
            if low - high <= 1e-9:
                continue
            if name in (RAT_HOLE, OPEN_HOLE):
                outer = _of_hole(logs, high, low, casing if name == OPEN_HOLE else 0.0, job.excess)
            else:
                bore = job.inner_diameter if name == SHOE_TRACK else job.previous_inner
                size = (_area(bore or 0.0) - (casing if name == LAP else 0.0)) * (low - high)
                outer = (size, 0.0, size, 1.0)
            sections.append(CementSection(name, slurry, high, low, *outer))
    if job.stab_in is not None:
        displaced = _area(job.stab_in) * job.shoe
    elif job.inner_diameter is not None:
        displaced = _area(job.inner_diameter) * (job.shoe - job.shoe_track)
    else:
        displaced = math.nan
    return CementSheet(job, tuple(sections), displaced)


def _area(diameter: float) -> float:
    return 0.25 * math.pi * diameter**2


def _slurries(top: float, bottom: float, tail_top: float | None, name: str) -> list[tuple[str, float, float]]:
    """Return the parts of a section by slurry, from the bottom; the tail is the last to be pumped."""
    if tail_top is None:
        return [("", top, bottom)]
    if name in (RAT_HOLE, SHOE_TRACK):
        return [("tail", top, bottom)]
    between = min(max(tail_top, top), bottom)
    return [("tail", between, bottom), ("lead", top, between)]


def _of_hole(
    logs: MeasuredHole, top: float, bottom: float, casing: float, excess: float
) -> tuple[float, float, float, float]:
    """Return volume, sigma, volume by bit size and measured share of an interval of hole around an area of casing."""
    half = 0.5 * logs.height
    inside = np.clip(np.minimum(logs.depth + half, bottom) - np.maximum(logs.depth - half, top), 0.0, None)
    hole = 0.25 * np.pi * logs.equivalent_diameter**2
    known = np.isfinite(hole) & (inside > 0)
    length = float(inside[known].sum())
    if length == 0:
        raise InputError("cement", f"no row between {top:.2f} and {bottom:.2f} m was measured")
    narrow = known & (hole < casing)
    if narrow.any():
        at = float(logs.depth[narrow][0])
        rule = f"the hole at {at:.2f} m has less area than the casing"
        raise InputError("casing", rule, setting="cement.casing")
    whole = (bottom - top) / length * (1 + excess)
    sigma = float((logs.volume_sigma[known] * inside[known]).sum() / logs.height)
    gauge = max(_area(logs.bit_diameter) - casing, 0.0) * (bottom - top) * (1 + excess)
    volume = float(((hole - casing)[known] * inside[known]).sum())
    measured = float((logs.coverage[known] * inside[known]).sum()) / (bottom - top)
    return volume * whole, sigma * whole, gauge, min(1.0, measured)
