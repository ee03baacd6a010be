"""Checked radius samples of a hole, from which a wall is rebuilt.

A sample is (toolface, depth, radius), with a time if the tool recorded one. Units are metres and degrees, toolface is
clockwise looking downhole, and radius is measured from the axis of the hole. For a well without an azimuthal caliper,
samples can be made from an average caliper or from the bit size. `Caliper.basis` states the source, and so does every
wall, mesh and log made from the samples.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Real
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from helibore import _core
from helibore.base.arrays import (
    Floats,
    Integers,
    column,
    require,
    sample_columns,
    whole_column,
)
from helibore.base.cached import cached_property
from helibore.base.errors import InputError, check_choice
from helibore.base.frames import frame_rows
from helibore.base.notebook import card, usual_picture
from helibore.base.tables import LogColumn, LogTable, Tabular
from helibore.base.thread_count import thread_count
from helibore.base.units import ANGLE, LENGTH, TIME
from helibore.samples.bit_sizes import FEW, looks_like_diameter

Basis = Literal["azimuthal", "average", "gauge"]
"""What a wall is made from."""

BASIS_TEXT: dict[Basis, str] = {
    "azimuthal": "radius measured by an azimuthal caliper",
    "average": "average caliper: size measured, shape assumed round",
    "gauge": "gauge hole at bit size: not measured",
}
"""Each basis in words."""

LARGEST_RADIUS = 2.0
"""Largest radius of a sample, metres."""
ROUND = 16
"""Number of samples around the hole that are made from one diameter without a direction."""


def basis_text(basis: Basis, arms: bool = False) -> str:
    """Return what files, pictures and summaries say of a basis; ``arms`` is whether the arm of each sample is known."""
    return "radius measured by the arms of a caliper" if arms else BASIS_TEXT[basis]


def check_basis(basis: str) -> None:
    """Raise InputError unless ``basis`` is an allowed word; the error lists these words."""
    check_choice("basis", basis, BASIS_TEXT)


COLUMNS = {"depth": LENGTH, "toolface": ANGLE, "radius": LENGTH, "time": TIME, "arm": None}
"""The columns of samples, and what the unit of each column measures; None: the column has no unit."""


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Caliper(Tabular):
    """Samples of the radius of a hole, in any order, checked and frozen.

    Parameters
    ----------
    depth
        (n,) measured depth, metres, finite.
    toolface
        (n,) degrees clockwise looking downhole, finite; 370 and -350 mean 10.
    radius
        (n,) metres from the axis of the hole, above 0 and at most 2; not a diameter and not in inches.
    time
        (n,) seconds or any other clock, finite; or None. If there are times, the order in which samples arrive does not
        matter, and rows that are equal in all four columns count once.
    arm
        (n,) number of the arm that measured each sample, integers; None: not known, or a tool that measures all around.
        The two ends of a measured diameter may have one number or two. For a tool with few arms, logs take their
        diameters from the arms.
    basis
        What the radii are: ``"azimuthal"``, measured around the hole; ``"average"`` or ``"gauge"``, as
        `from_average` and `gauge` make them.

    Raises
    ------
    InputError
        The error names column, row, value and rule: ``toolface[17] = nan: must be finite``.

    Notes
    -----
    The attributes are named as the parameters; the arrays are read-only. Input that already is contiguous float64 is
    not copied: do not change it afterwards. `from_table` takes a data frame with missing values.

    Examples
    --------
    >>> caliper = Caliper(depth=[100.0, 100.1], toolface=[0.0, 90.0], radius=[0.108, 0.109])
    >>> len(caliper)
    2
    """

    depth: Floats
    toolface: Floats
    radius: Floats
    time: Floats | None
    arm: Integers | None
    basis: Basis
    left_out: int  # rows of a table with a missing value, which `from_table` left out

    def __init__(
        self,
        depth: npt.ArrayLike,
        toolface: npt.ArrayLike,
        radius: npt.ArrayLike,
        time: npt.ArrayLike | None = None,
        *,
        arm: npt.ArrayLike | None = None,
        basis: Basis = "azimuthal",
    ) -> None:
        check_basis(basis)
        arms = None if arm is None else whole_column("arm", arm, np.size(depth), "depth")
        columns = sample_columns(depth, toolface, radius, time)
        _core.check_samples(*columns, thread_count(None))
        columns_and_arms = zip(COLUMNS, (*columns, arms), strict=True)
        frozen = {name: None if values is None else _frozen(values) for name, values in columns_and_arms}
        self.__dict__.update(frozen, basis=basis, left_out=0)

    @classmethod
    def from_table(
        cls,
        table: Any,
        *,
        depth: str = "DEPTH",
        toolface: str = "TOOLFACE",
        radius: str = "RADIUS",
        time: str | None = None,
        arm: str | None = None,
        diameters: Mapping[str, float] | None = None,
        units: Mapping[str, str] | None = None,
    ) -> Caliper:
        """Return samples from the columns of a data frame: pandas, Polars, Arrow, xarray, or a dict of columns.

        ``hb.open(frame)`` finds the columns and their roles by itself, as in a file.

        Parameters
        ----------
        table
            ``table[name]`` is a column of numbers. A time column may hold dates, which become seconds since 1970; dates
            without a time zone are UTC. A row with a missing value (NaN, null, masked, or -999.25, -9999 or -9999.25,
            which mean a missing value in log files) is left out; ``left_out`` of the caliper counts such rows. Equal
            rows count once if there is a ``time``. Without a time each of them counts, which changes radii; `repeated`
            counts the repeated rows, and ``frame.drop_duplicates()`` of pandas drops them.
        depth, toolface, radius, time, arm
            Names of the columns; radius, not diameter.
        diameters
            For a tool with few arms (X-Y, four arms), in place of ``radius``: the column of each diameter, and the
            angle of its arms from the toolface, degrees, such as ``{"CAL1": 0, "CAL2": 90}``. Half of a diameter is the
            radius on both sides. If one diameter is missing, the other diameters of its row stay, and ``left_out``
            counts the row once.
        units
            Units: ``{"depth": "ft", "radius": "in"}``, or ``{"diameter": "in"}`` for all diameters. Without, a column
            has the unit at the end of its name, as in a file (``MD_ft``, ``CAL [in]``), or else metres, degrees or
            seconds.

        Raises
        ------
        InputError
            On a column that the table does not have, that does not hold numbers or has another length than the others,
            an unknown unit, a table without a complete row, and as `Caliper`, with the table's column, row and value:
            ``CAL1[5] = -999 in: must be above 0 and at most 4 m``. On a median above 2 m (diameters: 4 m) without a
            unit. On 5 radii or more whose median is 0.5 % below to 3 % above the diameter of a bit of 7.875, 8.375,
            8.5, 8.75, 9.5, 9.875, 10.625 or 12.25 in, unless twice the median is as near to a bit of 16 or 17.5 in.

        Examples
        --------
        >>> frame = {"MD": [328.0, 328.1, 328.2], "TF": [0, 90, 180], "R": [4.3, math.nan, 4.4]}
        >>> caliper = Caliper.from_table(
        ...     frame, depth="MD", toolface="TF", radius="R", units={"depth": "ft", "radius": "in"}
        ... )
        >>> len(caliper), caliper.left_out
        (2, 1)
        >>> frame = {"MD": [100.0, 100.1], "RB": [0, 9], "X": [8.5, 8.6], "Y": [8.5, math.nan]}
        >>> diameters = {"X": 0, "Y": 90}
        >>> units = {"diameter": "in"}
        >>> caliper = Caliper.from_table(frame, depth="MD", toolface="RB", diameters=diameters, units=units)
        >>> len(caliper), caliper.left_out
        (6, 1)
        """
        if diameters is not None:
            if arm is not None or radius != "RADIUS":
                raise InputError("diameters", "must not be given together with radius or arm")
            return cls._of_diameters(table, depth, toolface, diameters, time, units)
        names = {"depth": depth, "toolface": toolface, "radius": radius, "time": time, "arm": arm}
        rows = frame_rows(table, {role: (names[role], COLUMNS[role]) for role in COLUMNS}, units)
        sizes = rows.columns["radius"]
        median = float(np.median(sizes))
        if median > LARGEST_RADIUS and "radius" not in (units or {}):
            rule = f'must be at most {LARGEST_RADIUS:g} m: units={{"radius": "in"}} states another unit'
            raise InputError(f"column {radius!r}: median", rule, f"{median:.3g} m")
        if sizes.size >= FEW and looks_like_diameter(median):
            rule = "looks like a diameter, where a radius is expected; halve it, or use hb.Caliper, which accepts it"
            raise InputError(f"column {radius!r}: median", rule, f"{median:.3g} m")
        with rows.named():
            made = cls(**rows.columns)  # type: ignore[arg-type]
        made.__dict__["left_out"] = int((~rows.complete).sum())
        return made

    @classmethod
    def _of_diameters(
        cls, table: Any, depth: str, toolface: str, diameters: Mapping[str, float], time: str | None,
        units: Mapping[str, str] | None,
    ) -> Caliper:  # fmt: skip
        """Return the samples at both ends of each diameter of a table."""
        if not (diameters and isinstance(diameters, Mapping)):
            rule = 'must be the angle of the arms by column, degrees: {"CAL1": 0, "CAL2": 90}'
            raise InputError("diameters", rule, repr(diameters))
        common = {"depth": (depth, LENGTH), "toolface": (toolface, ANGLE), "time": (time, TIME)}
        parts: list[dict[str, Any]] = []
        complete = np.True_
        for number, (name, angle) in enumerate(diameters.items()):
            if not (isinstance(angle, Real) and math.isfinite(angle)):
                raise InputError(f"diameters[{name!r}]", "must be finite degrees", repr(angle))
            rows = frame_rows(table, {**common, "diameter": (name, LENGTH)}, units)
            columns = dict(rows.columns)
            size, complete = columns.pop("diameter"), complete & rows.complete
            median = float(np.median(size))
            if median > 2 * LARGEST_RADIUS and "diameter" not in (units or {}):
                rule = f'must be at most {2 * LARGEST_RADIUS:g} m: units={{"diameter": "in"}} states another unit'
                raise InputError(f"column {name!r}: median", rule, f"{median:.3g} m")
            with rows.named():
                valid = (size > 0) & (size <= 2 * LARGEST_RADIUS)
                require("diameter", size, valid, f"must be above 0 and at most {2 * LARGEST_RADIUS:g} m")
                cls(**columns, radius=size / 2)  # checked here, where an error can name the row
            arm = np.full(size.size, number)
            for turned in (angle, angle + 180.0):
                end = {"toolface": columns["toolface"] + turned, "radius": size / 2, "arm": arm}
                parts.append(columns | end)
        whole: dict[str, Any] = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
        made = cls(**whole)
        made.__dict__["left_out"] = int((~complete).sum())
        return made

    @classmethod
    def from_average(cls, depth: npt.ArrayLike, diameter: npt.ArrayLike) -> Caliper:
        """Return 16 samples at each depth from the mean diameter of a hole, whose shape is assumed round.

        Parameters
        ----------
        depth
            (n,) measured depth, metres, in any order; finite where there is a diameter.
        diameter
            (n,) mean diameter, metres, above 0 and at most 4; NaN where missing. Rows with NaN are left out, so a gap
            longer than the wall's ``max_distance`` stays a gap.

        Raises
        ------
        InputError
            On a value that breaks its rule (``diameter[3] = 8.5: must be above 0 and at most 4 metres``), or if all
            rows are missing.

        Examples
        --------
        >>> Caliper.from_average([100.0, 100.1], [0.22, 0.23])
        Caliper(32 samples, 100 to 100.1 m, average caliper: size measured, shape assumed round)
        """
        depths = column("depth", depth)
        diameters = column("diameter", diameter, depths.size, "depth")
        there = ~np.isnan(diameters)
        require("depth", depths, ~there | np.isfinite(depths), "must be finite")
        valid = ~there | ((diameters > 0) & (diameters <= 2 * LARGEST_RADIUS))
        require("diameter", diameters, valid, f"must be above 0 and at most {2 * LARGEST_RADIUS:g} metres")
        if not there.any():
            raise InputError("diameter", f"all {diameters.size} are missing")
        return cls._round(depths[there], diameters[there] / 2, "average")

    @classmethod
    def gauge(cls, start: float, stop: float, bit_diameter: float, step: float = 0.1) -> Caliper:
        """Return samples of an unmeasured hole at bit size: 16 around the hole every ``step`` from start to stop.

        Parameters
        ----------
        start, stop
            Measured depths, metres; both ends are sampled.
        bit_diameter
            Metres.
        step
            The largest distance between two depths, metres.

        Raises
        ------
        InputError
            On a value that breaks its rule: ``stop = 10: must be deeper than start = 20``.

        Examples
        --------
        >>> Caliper.gauge(1000.0, 1000.1, bit_diameter=0.2159)
        Caliper(32 samples, 1000 to 1000.1 m, gauge hole at bit size: not measured)
        """
        for name, value in (("start", start), ("stop", stop)):
            if not math.isfinite(value):
                raise InputError(name, "must be finite", str(value))
        if not stop > start:
            raise InputError("stop", f"must be deeper than start = {start:g}", f"{stop:g}")
        if not (math.isfinite(step) and step > 0):
            raise InputError("step", "must be finite and above 0", f"{step:g}")
        if not 0 < bit_diameter <= 2 * LARGEST_RADIUS:
            rule = f"must be above 0 and at most {2 * LARGEST_RADIUS:g} metres"
            raise InputError("bit_diameter", rule, f"{bit_diameter:g}")
        depth = np.linspace(start, stop, math.ceil((stop - start) / step - 1e-9) + 1)
        return cls._round(depth, np.full(depth.size, bit_diameter / 2), "gauge")

    @classmethod
    def _round(cls, depth: Floats, radius: Floats, basis: Basis) -> Caliper:
        toolface = np.tile(np.arange(ROUND) * (360.0 / ROUND), depth.size)
        return cls(np.repeat(depth, ROUND), toolface, np.repeat(radius, ROUND), basis=basis)

    @cached_property
    def repeated(self) -> int:
        """Number of samples that equal an earlier sample in depth, toolface, radius and time.

        A wall counts equal samples once if they have times, and counts each of them if they have no times.
        """
        columns = [of for of in (self.depth, self.toolface, self.radius, self.time) if of is not None]
        order = np.lexsort(columns)
        same = np.logical_and.reduce([of[order[1:]] == of[order[:-1]] for of in columns])
        return int(np.count_nonzero(same))

    @property
    def basis_text(self) -> str:
        """The basis in words."""
        return basis_text(self.basis, self.arm is not None)

    def table(self) -> LogTable:
        """Return the samples as columns DEPTH, TOOLFACE, RADIUS and, where they have them, TIME and ARM."""
        units = {"depth": "m", "toolface": "deg", "radius": "m", "time": "s"}
        columns = [(name, getattr(self, name)) for name in COLUMNS]
        return LogTable(
            [LogColumn(of.upper(), units.get(of, ""), of, values) for of, values in columns if values is not None],
            {"basis": self.basis_text},
        )

    def __len__(self) -> int:
        return self.depth.size

    def _repr_html_(self) -> str:
        if not len(self):
            return card(repr(self), {}, "")
        place = (np.linspace(self.depth.min(), self.depth.max(), 121)[:-1], np.arange(0, 360, 5))
        row = np.searchsorted(place[0], self.depth, "right") - 1
        cell = row * 72 + (np.mod(self.toolface, 360) / 5).astype(int) % 72
        with np.errstate(invalid="ignore"):
            mean = np.bincount(cell, self.radius, 120 * 72) / np.bincount(cell, minlength=120 * 72)
        numbers = {
            "samples": f"{len(self)}",
            "depth": f"{self.depth.min():.2f} to {self.depth.max():.2f} m",
            "radius": f"{1000 * self.radius.min():.1f} to {1000 * self.radius.max():.1f} mm",
            "basis": self.basis_text,
        }
        if self.left_out:
            numbers["missing"] = f"a value in {self.left_out} of the table's rows"
        if self.repeated:
            counted = "counted again, since there is no time" if self.time is None else "counted once"
            numbers["repeated"] = f"{self.repeated} equal to an earlier sample, {counted}"
        picture = usual_picture(mean.reshape(120, 72), "radius", "m", "radius by depth and toolface")
        return card("Caliper", numbers, picture)

    def __repr__(self) -> str:
        if not len(self):
            return "Caliper(no samples)"
        basis = "" if self.basis == "azimuthal" else f", {self.basis_text}"
        return f"Caliper({len(self)} samples, {self.depth.min():g} to {self.depth.max():g} m{basis})"


def _frozen(values: Floats | Integers) -> Floats | Integers:
    view = values.view()
    view.setflags(write=False)
    return view
