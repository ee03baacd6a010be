"""The stations of a survey, and the path of the hole through them.

    survey = hb.Survey(depth, inclination, azimuth)       # metres, degrees, degrees
    path = survey.path(extend=20.0)
    path.position(depths)                                 # (n, 3): north, east, down

Positions and frames between stations follow the curve of the method. A survey can state its north; `Norths` turns
azimuths into another. Not supported: other corrections of a survey (sag, tool errors) and its uncertainty.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import InitVar, dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from helibore import _core
from helibore.base.arrays import Floats, column
from helibore.base.errors import InputError, check_choice
from helibore.base.frames import frame_rows
from helibore.base.notebook import card, curve_picture
from helibore.base.units import ANGLE, LENGTH
from helibore.settings.path_settings import Method
from helibore.trajectory.references import NORTHS, Reference

UPRIGHT = math.sin(math.radians(1.0))
"""Level part of a direction, up to which it has no azimuth."""

__all__ = ["CorePath", "Method", "Path", "Survey"]

CorePath = _core.Path


@dataclass(frozen=True, eq=False, repr=False)
class Survey:
    """Survey stations, shallowest first. The attributes have the parameters' names and are read-only float64 copies.

    Parameters
    ----------
    depth
        Depth along the hole of each station, metres, growing. Two stations or more.
    inclination
        Degrees from straight down, 0 to 180.
    azimuth
        Degrees from north, clockwise seen from above, -360 to 360. It has no meaning at inclination 0, except that the
        radius-of-curvature method turns evenly from the azimuth given there, as published software does.
    north
        The north that the azimuths count from: "true", "magnetic" or "grid"; "" if it is not stated.

    Raises
    ------
    InputError
        The error names the first value that breaks a rule: ``depth[3] = 120: must be greater than depth[2] = 130``.
    """

    depth: Floats
    inclination: Floats
    azimuth: Floats
    left_out: int  # rows of a table that `from_table` left out
    north: str  # true, magnetic or grid; "": not stated
    _core: _core.Survey = field(init=False)

    def __init__(
        self, depth: npt.ArrayLike, inclination: npt.ArrayLike, azimuth: npt.ArrayLike, *, north: str = ""
    ) -> None:
        check_choice("north", north, ("", *NORTHS))
        columns = {"depth": column("depth", depth).copy()}
        for name, values in (("inclination", inclination), ("azimuth", azimuth)):
            columns[name] = column(name, values, columns["depth"].size, "depth").copy()
        for of in columns.values():
            of.flags.writeable = False
        self.__dict__.update(columns, left_out=0, north=north, _core=_core.Survey(**columns))

    def __len__(self) -> int:
        return self.depth.size

    def __reduce__(self) -> tuple[Callable[..., Survey], tuple[Floats | str, ...]]:
        return _survey, (self.depth, self.inclination, self.azimuth, self.north)

    def _repr_html_(self) -> str:
        numbers = {
            "stations": f"{len(self)}",
            "depth": f"{self.depth[0]:.1f} to {self.depth[-1]:.1f} m",
            "inclination": f"{self.inclination.min():.2f} to {self.inclination.max():.2f} deg",
            "greatest dogleg": f"{self.dogleg().max():.2f} deg between stations",
        }
        if self.left_out:
            numbers["left out"] = f"{self.left_out} of the table's rows: a value is missing"
        position = self.path().position(np.linspace(self.depth[0], self.depth[-1], 200))
        away = np.hypot(position[:, 0], position[:, 1])
        return card(
            "Survey", numbers, curve_picture(away, position[:, 2], "depth by distance from the head", equal=True)
        )

    def __repr__(self) -> str:
        return f"Survey({len(self)} stations, {self.depth[0]:g} to {self.depth[-1]:g} m)"

    @classmethod
    def from_table(
        cls,
        table: Any,
        *,
        depth: str = "DEPTH",
        inclination: str = "INCLINATION",
        azimuth: str = "AZIMUTH",
        units: Mapping[str, str] | None = None,
    ) -> Survey:
        """Return the survey in the columns of a data frame: pandas, Polars, Arrow, xarray, or a dict of columns.

        Parameters
        ----------
        table
            ``table[name]`` is a column of numbers. A row with a missing value (NaN, null, or -999.25, -9999 or
            -9999.25, which mean a missing value in log files) is left out; ``left_out`` of the survey counts such rows.
        depth, inclination, azimuth
            Names of the columns.
        units
            Units: ``{"depth": "ft"}``. Without, a column has the unit at the end of its name (``MD_ft``), or else
            metres and degrees.

        Raises
        ------
        InputError
            On a column that the table does not have or that does not hold numbers, an unknown unit, a table without a
            complete row, and as `Survey`, with the table's column, row and value.

        Examples
        --------
        >>> Survey.from_table(
        ...     {"MD": [0, 1000], "INC": [0, 20], "AZI": [0, 45]},
        ...     depth="MD", inclination="INC", azimuth="AZI", units={"depth": "ft"},
        ... )
        Survey(2 stations, 0 to 304.8 m)
        """
        wanted = {"depth": (depth, LENGTH), "inclination": (inclination, ANGLE), "azimuth": (azimuth, ANGLE)}
        rows = frame_rows(table, wanted, units)
        with rows.named():
            made = cls(*(rows.columns[name] for name in wanted))
        made.__dict__["left_out"] = int((~rows.complete).sum())
        return made

    def dogleg(self) -> Floats:
        """Return the angle between the directions of each two neighbouring stations, degrees, (n - 1,) float64."""
        return self._core.dogleg()

    def path(
        self,
        method: Method = "minimum-curvature",
        reference: Reference = "high-side",
        head: tuple[float, float, float] = (0.0, 0.0, 0.0),
        extend: float = 0.0,
    ) -> Path:
        """Return the path through the stations.

        If a longer survey has all these stations, its path equals this path in every bit down to the last of them.

        Parameters
        ----------
        method
            ``"minimum-curvature"``: circular arcs between stations. ``"radius-of-curvature"``: curves on upright
            cylinders, inclination linear in depth and azimuth linear in the horizontal distance covered.
        reference
            What toolface 0 points to: ``"high-side"`` (undefined where the hole is vertical), ``"north"`` (undefined
            where the hole is horizontal and points north or south) or ``"parallel-transport"``. A parallel-transport
            reference starts as north at the first station (as the high side, if the hole there points within 45 degrees
            of horizontal north or south), and down the hole it turns with the tangent but never about it. It is defined
            everywhere.
        head
            North, east and down of the first station, metres. A map position (UTM) goes here.
        extend
            Metres by which the path continues straight below the last station; this part is provisional.

        Raises
        ------
        InputError
            On an unknown method or reference, a head that is not within 1e9 m, an extend that is not within 0 to 1e7 m,
            or two neighbouring stations that point opposite ways (minimum curvature).

        Notes
        -----
        Minimum curvature: Sawaryn and Thorogood, SPE 84246. Radius of curvature: the classic quotients, written without
        their divisions by differences of angles.
        """
        return Path(self, method, reference, head, extend)


def _survey(depth: Floats, inclination: Floats, azimuth: Floats, north: str) -> Survey:
    """Return a survey that was pickled."""
    return Survey(depth, inclination, azimuth, north=north)


@dataclass(frozen=True, eq=False, repr=False)
class Path:
    """A path through the stations of a survey; `Survey.path` makes it. A path never changes.

    Attributes
    ----------
    survey, method, reference, head, extend
        As given to `Survey.path`.
    start_depth, survey_depth, stop_depth
        Depths where the path starts (the first station), where it becomes provisional (the last station), and where it
        ends (``extend`` below that), metres.
    """

    survey: Survey
    method: Method
    reference: Reference
    head: tuple[float, float, float]
    extend: float
    start_depth: float = field(init=False)
    survey_depth: float = field(init=False)
    stop_depth: float = field(init=False)
    _core: CorePath = field(init=False)
    core: InitVar[CorePath | None] = None

    def __post_init__(self, core: CorePath | None) -> None:
        try:
            north, east, down = map(float, self.head)
        except (TypeError, ValueError):
            raise InputError("head", "must be three numbers: north, east and down", repr(self.head)) from None
        head, extend = (north, east, down), float(self.extend)
        core = core or _core.Path(self.survey._core, self.method, self.reference, head, extend)
        ends = {"start_depth": core.start_depth, "survey_depth": core.survey_depth, "stop_depth": core.stop_depth}
        self.__dict__.update(ends, head=head, extend=extend, _core=core)

    def __reduce__(self) -> tuple[type[Path], tuple[Any, ...]]:
        return Path, (self.survey, self.method, self.reference, self.head, self.extend)

    def __repr__(self) -> str:
        return f"Path({self.method}, {self.reference}, {self.start_depth:g} to {self.stop_depth:g} m)"

    def position(self, depth: npt.ArrayLike) -> Floats:
        """Return north, east and down of the path at each depth, metres.

        Parameters
        ----------
        depth
            Depths in metres, in any order, from the first station to the last plus ``extend``: an array, or one number.

        Returns
        -------
        (n, 3) float64, owned; (3,) for one number.

        Raises
        ------
        InputError
            The error names the first depth that the path does not reach, and where the path ends.
        """
        return _shaped(self._core.position(_depths(depth)), depth)

    def tangent(self, depth: npt.ArrayLike) -> Floats:
        """Return the unit vector (north, east, down) that points downhole at each depth, (n, 3) float64.

        For one number the result is (3,). Raises the errors of `position`.
        """
        return _shaped(self._core.tangent(_depths(depth)), depth)

    def frame(self, depth: npt.ArrayLike) -> Floats:
        """Return the directions of toolface 0, toolface 90 and downhole at each depth.

        Returns
        -------
        (n, 3, 3) float64, or (3, 3) for one number. Rows: the reference turned square to the hole (high side, north, or
        parallel transport), right (clockwise of it looking downhole), tangent; orthonormal, right-handed. A point of
        the wall is ``position + radius * (cos(toolface) * row 0 + sin(toolface) * row 1)``.

        Raises
        ------
        InputError
            As `position`, and where the reference is undefined: the high side if the hole is within 0.00006 degrees of
            vertical, north if it points within the same angle of horizontal north or south.
        """
        return _shaped(self._core.frame(_depths(depth)), depth)

    def azimuth(self, depth: float, toolface: float) -> float:
        """Return the azimuth of the direction at a depth and a toolface: of its level part, degrees in [0, 360).

        NaN beyond the ends of the path, where toolface 0 is undefined (`frame`), and where the direction is less than a
        degree from the vertical.
        """
        if math.isnan(toolface) or not self.start_depth <= depth <= self.stop_depth:
            return math.nan
        try:
            zero, right, _ = self.frame(depth)
        except InputError:  # toolface 0 is undefined
            return math.nan
        angle = math.radians(toolface)
        north, east, _ = math.cos(angle) * zero + math.sin(angle) * right
        return math.degrees(math.atan2(east, north)) % 360 if math.hypot(north, east) > UPRIGHT else math.nan

    def north_to_high_side(self, depth: npt.ArrayLike) -> Floats:
        """Return the angle to add to a toolface from north, so that it counts from the high side, at each depth.

        It is ``atan2(-sin A, cos I cos A)`` at inclination I and azimuth A, which is exact; the usual "subtract the
        azimuth" is 6.9 degrees off at I = 48, A = 248.

        Returns
        -------
        (n,) float64, degrees in [0, 360); shape () for one number.

        Raises
        ------
        InputError
            As `position`, and where the hole is vertical, or level and points north or south.
        """
        return _shaped(self._core.north_to_high_side(_depths(depth)), depth)


def _depths(depth: npt.ArrayLike) -> Floats:
    return column("depth", [depth] if np.ndim(depth) == 0 else depth)  # type: ignore[arg-type]


def _shaped(rows: Floats, depth: npt.ArrayLike) -> Floats:
    return rows.reshape(rows.shape[1:]) if np.ndim(depth) == 0 else rows


def checked_path(path: Path | None) -> Path | None:
    """Return ``path`` if it is a `Path` or None; else raise an InputError, which says how a survey gives a path."""
    if path is None or isinstance(path, Path):
        return path
    how = ": survey.path() makes one" if isinstance(path, Survey) else ""
    raise InputError("path", f"must be a Path or None, not {type(path).__name__}{how}")


def core_path(path: Path | None) -> _core.Path:
    """Return the core's object of a path; if ``path`` is None, of a path straight down from (0, 0, 0) with toolface 0
    to the north.
    """
    path = checked_path(path)
    return _core.Path() if path is None else path._core
