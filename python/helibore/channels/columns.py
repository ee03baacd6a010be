"""Turn channels with roles into a survey, a sector image, or a column in metres, degrees or seconds.

A survey or an image leaves out rows that lack a value, and counts them. ``channel_readings`` makes the readings that a
wall is built from.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from helibore.base import units
from helibore.base.angles import wrapped
from helibore.base.arrays import Floats, Reals
from helibore.base.errors import InputError
from helibore.channels import plausibility
from helibore.channels.roles import ROLES, Role, RoleMap, guess, north_stated
from helibore.files.delimited import NO_HEADER
from helibore.files.raw_set import RawSet
from helibore.images.sector_image import Direction, Origin, SectorImage
from helibore.trajectory.references import Reference
from helibore.trajectory.survey import Survey

AZIMUTHS_AGREE = 0.05
"""Degrees by which azimuths of a survey may differ without a remark: they are rounded."""

EXAMPLES = {units.LENGTH: "in", units.ANGLE: "deg", units.TIME: "us"}
"""A unit of each kind, for errors."""


@dataclass(frozen=True)
class RawSectorImage:
    """A sector image as the file holds it; `sector_image` turns it into an image for walls.

    Attributes
    ----------
    name, unit
        As in the file.
    depth, values
        (n,) float64 metres, strictly growing or strictly falling, and (n, K) values, NaN where missing.
    first, step
        Angle of the first sector, and angle from one sector to the next, degrees; None if neither the file nor a map
        states them. ``step`` is NaN if the file states uneven angles.
    members
        Names of the columns that form the image; ``()`` if the file stores it as one array.
    dropped
        Number of rows left out because they have no depth.
    """

    name: str
    unit: str
    depth: Floats
    values: Reals
    first: float | None
    step: float | None
    members: tuple[str, ...]
    dropped: int

    def __repr__(self) -> str:
        rows, sectors = self.values.shape
        ends = f"{self.depth[0]:g} to {self.depth[-1]:g} m"
        return f"RawSectorImage({self.name!r}, {self.unit!r}, {rows} rows x {sectors} sectors, {ends})"

    def sector_image(
        self,
        origin: Origin,
        reference: Reference,
        direction: Direction | None = None,
        offset: float | None = None,
        reach: float | None = None,
        name: str | None = None,
    ) -> SectorImage:
        """Return an image for a wall: ``wall.images["GR"] = file.image("GRAS").sector_image(...)``.

        The arguments are those of `SectorImage`. Log files do not state whether sector 1 is centred on its angle or
        starts there (``origin``), nor what the angles count from (``reference``). If ``direction`` is None, the sign of
        ``step`` decides, or it is clockwise without a step. If ``offset`` is None, it is ``first``, or 0 degrees
        without a first angle. If ``name`` is None, it is the name of the channel.

        Raises
        ------
        InputError
            If the sectors do not fit around the hole (``GRAS: 8 sectors, 22.5 deg apart: must be 45 around the hole``).
            Also if `SectorImage` refuses an argument; the error then begins with the channel's name.
        """
        even, step = 360.0 / self.values.shape[1], self.step
        if step is not None and not abs(abs(step) - even) <= 0.005 * even:  # NaN: not evenly spaced
            apart = f"{step:g} deg apart" if np.isfinite(step) else "unevenly spaced"
            rule = f"{self.values.shape[1]} sectors, {apart}: must be {even:g} around the hole"
            raise InputError(self.name, rule)
        if direction is None:
            direction = "counterclockwise" if step is not None and step < 0 else "clockwise"
        offset = (self.first or 0.0) if offset is None else offset
        try:
            return SectorImage(
                self.depth, self.values, name or self.name, self.unit,
                origin=origin, reference=reference, direction=direction, offset=offset, reach=reach,
            )  # fmt: skip
        except ValueError as error:
            raise InputError(self.name, str(error)) from error


def column(log_set: RawSet, role: Role, option: str = "") -> Floats:
    """Return a channel in metres, degrees or seconds. A unit that is missing or does not fit its role is an error.

    Two units may be missing: angles are degrees if one of them is beyond 2 pi, and a ``time`` is in seconds. If the
    role needs no unit, the values are returned unchanged. The error names ``option``, a setting, as a place to state
    the unit; "": there is none.
    """
    kind = ROLES[role.role]
    values = log_set.numbers(role.channel)
    if kind and not role.unit and role.role != "time":
        found = plausibility.present(values)
        if kind != units.ANGLE or not found.size or float(np.abs(found).max()) <= 2.0 * np.pi + 1e-6:
            example = "ft" if role.role == "depth" else EXAMPLES[kind]
            how = f"the name of the column ({role.channel} [{example}]), in a map"
            how += f' ([channels."{role.channel}"] unit = ...)'
            how += f", or by {option}={role.channel}:{example}" if option else ""
            raise log_set.input_error(f"unit missing: state it in {how}; {role.role} is {kind}", column=role.channel)
    if not kind or not role.unit:
        return values
    try:
        factor = units.factor(role.unit, kind)
    except ValueError as error:
        raise log_set.input_error(str(error), column=role.channel) from error
    return values if factor == 1.0 else values * factor


def depths(log_set: RawSet, roles: RoleMap, option: str = "") -> tuple[Role, Floats]:
    """Return the depth channel and its values in metres; raise InputError if the values cannot be depths."""
    role = needed(log_set, roles, "depth")
    values = column(log_set, role, option)
    plausibility.depths(log_set, role, values)
    return role, values


def needed(log_set: RawSet, roles: RoleMap, role: str) -> Role:
    """Return the entry of the channel that has ``role``.

    Raise InputError if no channel has this role; the error says how to name a channel.
    """
    found = roles.one(role)
    if found is None:
        near = [f"; {each.channel} is {each.reason}" for each in roles if f"like {role}, but" in each.reason]
        how = f'name one by an option or in a map ([channels."..."] role = "{role}")'
        rule = f"no channel has the role {role}: {how}{''.join(near)}; the channels are {', '.join(log_set.names)}"
        raise log_set.input_error(rule + about_names(log_set))
    return found


def about_names(log_set: RawSet) -> str:
    """Return, as text, the remarks that explain why no name fits: the table has no header, or names repeat."""
    return "".join(f"; {remark}" for remark in log_set.remarks if NO_HEADER in remark or "columns are named" in remark)


def north_of(log_set: RawSet, roles: RoleMap) -> str:
    """Return the north from which a survey's azimuths count: true, grid or magnetic.

    It is searched in the name and description of the azimuth channel. Return "" if they name no north, or several.
    """
    role = roles.one("azimuth")
    return "" if role is None else role.north or north_stated(log_set[role.channel])


def survey(log_set: RawSet, roles: RoleMap | None = None) -> Survey:
    """Return the directional survey of a set as a `helibore.Survey`; ``roles`` say which channels it has.

    Stations are sorted by depth. Those without depth, inclination or azimuth are left out, and so are repeats of a
    station; the set's remarks say how many.

    Raises
    ------
    InputError
        If a column or its unit is missing, a unit is wrong, degrees look like radians, or two stations at one
        depth differ.
    """
    roles = roles or guess(log_set)
    at_depth, depth = depths(log_set, roles, "columns.survey_depth")
    try:
        inclined, turned = (needed(log_set, roles, role) for role in ("inclination", "azimuth"))
    except InputError as error:
        known = roles.one("inclination")
        if known is not None:
            rule = (
                f"a survey needs the azimuth beside the inclination {known.channel}: the path and true dips follow "
                "from both. Name the azimuth by columns.azimuth=NAME or in a map; without a survey, dips count "
                "from the hole, "
                "and toolfaces count from the high side"
            )
            raise InputError(error.place, rule) from error
        rule = "a survey is depth, inclination and azimuth at each station; positions alone do not state the directions"
        raise InputError(error.place, f"{error.rule}; {rule}") from error
    inclination, azimuth = (
        column(log_set, inclined, "columns.inclination"),
        column(log_set, turned, "columns.azimuth"),
    )
    plausibility.survey_angles(log_set, inclined, turned, inclination, azimuth)
    _compare_azimuths(log_set, roles, turned, azimuth)
    rows = np.flatnonzero(np.isfinite(depth) & np.isfinite(inclination) & np.isfinite(azimuth))
    if rows.size < depth.size:
        _remark(log_set, f"survey: {depth.size - rows.size} of {log_set.rows} stations left out: a value is missing")
    if np.any(np.diff(depth[rows]) < 0):
        rows = rows[np.argsort(depth[rows], kind="stable")]
        _remark(log_set, "survey: the stations are sorted by depth")
    stations = np.stack([depth, inclination, azimuth], axis=1)[rows]
    repeats = np.flatnonzero(np.diff(depth[rows]) == 0) + 1
    for at in repeats:
        if not np.array_equal(stations[at], stations[at - 1]):
            rule = f"two stations at {depth[rows[at]]:g} m with different angles"
            raise log_set.input_error(rule, int(rows[at]), at_depth.channel)
    if repeats.size:
        rows = np.delete(rows, repeats)
        _remark(log_set, f"survey: {repeats.size} repeated stations left out")
    try:
        return Survey(depth[rows], inclination[rows], azimuth[rows], north=north_of(log_set, roles))
    except ValueError as error:
        raise log_set.input_error(str(error)) from error


def _compare_azimuths(log_set: RawSet, roles: RoleMap, used: Role, azimuth: Floats) -> None:
    """Remark on each other azimuth of a survey that differs, such as one from another north."""
    for role in roles:
        if role.role != "none" or f"like azimuth; {used.channel} has this role" not in role.reason:
            continue
        other = column(log_set, replace(role, role="azimuth", unit=log_set[role.channel].unit or used.unit))
        off = wrapped(other - azimuth + 180.0) - 180.0
        off = off[np.isfinite(off)]
        if off.size and np.abs(off).max() > AZIMUTHS_AGREE:
            _remark(
                log_set,
                f"survey: {role.channel} differs from {used.channel} by {np.median(off):+.2f} deg (median), maybe by "
                f"another north: {used.channel} is used, and columns.azimuth={role.channel} uses the other",
            )


def _remark(log_set: RawSet, remark: str) -> None:
    if remark not in log_set.remarks:
        log_set.remarks.append(remark)


def image(log_set: RawSet, name: str, roles: RoleMap | None = None) -> RawSectorImage:
    """Return the sector image ``name`` with its depth, which ``roles`` names.

    Rows without a depth are left out and counted.

    Raises
    ------
    InputError
        If there is no such channel, it has no sectors, no row has a depth, or depth neither strictly grows nor strictly
        falls.
    """
    roles = roles or guess(log_set)
    channel = log_set.channel(name)
    if len(channel.shape) != 2:
        images = [each.channel for each in roles.all("image", "radius-image")]
        raise log_set.input_error(f"has no sectors; the images are {', '.join(images) or 'none'}", column=name)
    named, depth = depths(log_set, roles)
    rows = np.flatnonzero(np.isfinite(depth))
    if not rows.size:
        raise log_set.input_error("has no value", column=named.channel)
    steps = np.diff(depth[rows])
    wrong = np.flatnonzero(steps <= 0 if steps.sum() >= 0 else steps >= 0)
    if wrong.size:
        before, after = rows[wrong[0]], rows[wrong[0] + 1]
        rule = (
            f"depth {depth[after]:g} m after {depth[before]:g} m: an image's depth must strictly grow or strictly fall"
        )
        raise log_set.input_error(rule, int(after), named.channel)
    role, members = roles.roles.get(name) or Role(name, "image", ""), channel.member_names
    return RawSectorImage(
        name, channel.unit, depth[rows], channel.values[rows], role.first, role.step, members, log_set.rows - rows.size
    )
