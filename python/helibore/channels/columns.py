"""Turn channels with roles into a column in metres, degrees or seconds, a survey or a sector image.

Rows without a value are left out and counted. ``readings`` makes the columns that a wall is built from.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from helibore.base import units
from helibore.base.errors import InputError
from helibore.channels import plausibility
from helibore.channels.roles import ROLES, Role, RoleMap, guess
from helibore.files.delimited import NO_HEADER
from helibore.files.raw_set import RawSet
from helibore.images.sector_image import Direction, Origin, SectorImage
from helibore.trajectory.references import Reference
from helibore.trajectory.survey import Survey

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class RawSectorImage:
    """A sector image as it stands in the file; `sector_image` turns it into an image for walls.

    Attributes
    ----------
    name, unit
        As in the file.
    depth
        (n,) float64, metres, strictly growing or strictly falling.
    values
        (n, K), NaN where missing.
    first, step
        Angle of the first sector, and angle from one sector to the next, degrees; None if neither the file nor a map
        states them. Log files do not state whether a sector is centred on its angle or starts there.
    members
        The columns that form the image.
    dropped
        Rows left out because they have no depth.
    """

    name: str
    unit: str
    depth: Floats
    values: npt.NDArray[np.floating]
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

        Parameters
        ----------
        origin, reference
            As in `SectorImage`. Log files do not state whether sector 1 is centred on its angle or starts there, nor
            what the angles count from.
        direction
            None: by the sign of ``step``, clockwise if it is not stated.
        offset
            Degrees; None: ``first``, or 0 if it is not stated.
        reach, name
            As in `SectorImage`; ``name`` None: the name of the channel.

        Raises
        ------
        ValueError
            ``GRAS: 8 sectors, 22.5 deg apart: must be 45``; as `SectorImage`, with the channel's name.
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


def column(log_set: RawSet, role: Role) -> Floats:
    """Return a channel in metres, degrees or seconds, read-only. A unit that is missing or does not fit is an error."""
    kind = ROLES[role.role]
    values = log_set.numbers(role.channel)
    if not kind:
        return values
    if not role.unit and role.role != "time":
        inferred = plausibility.unstated_angle(values) if kind == units.ANGLE else ""
        if not inferred:
            stated = (
                f'state it in a map ([channels."{role.channel}"] unit = ...), or as {role.channel}:UNIT in its option'
            )
            rule = f"unit missing: {stated}; {role.role} is {kind}"
            raise log_set.input_error(rule, column=role.channel)
        return values
    try:
        factor = units.factor(role.unit, kind) if role.unit else 1.0
        return values if factor == 1.0 else values * factor
    except ValueError as error:
        raise log_set.input_error(str(error), column=role.channel) from error


def needed(log_set: RawSet, roles: RoleMap, role: str) -> Role:
    """Return the channel that has a role, or raise an InputError that says how to name one."""
    found = roles.one(role)
    if found is None:
        near = [f"; {each.channel} is {each.reason}" for each in roles if f"like {role}, but" in each.reason]
        how = f'name one by an option or in a map ([channels."..."] role = "{role}")'
        rule = f"no channel has the role {role}: {how}{''.join(near)}; the channels are {', '.join(log_set.names)}"
        raise log_set.input_error(rule + about_names(log_set))
    return found


def about_names(log_set: RawSet) -> str:
    """Return the remarks that explain why no name fits: the table has no header, or names repeat."""
    return "".join(f"; {remark}" for remark in log_set.remarks if NO_HEADER in remark or "columns are named" in remark)


def survey(log_set: RawSet, roles: RoleMap | None = None) -> Survey:
    """Return the directional survey of a set.

    Stations without depth, inclination or azimuth are left out; the set's remarks say how many.

    Raises
    ------
    ValueError
        If a column or its unit is missing, a unit is wrong, degrees look like radians, or depth does not grow.
    """
    roles = roles or guess(log_set)
    named = {role: needed(log_set, roles, role) for role in ("depth", "inclination", "azimuth")}
    columns = {role: column(log_set, found) for role, found in named.items()}
    plausibility.depths(log_set, named["depth"], columns["depth"])
    plausibility.survey_angles(
        log_set, named["inclination"], named["azimuth"], columns["inclination"], columns["azimuth"]
    )
    keep = np.isfinite(columns["depth"]) & np.isfinite(columns["inclination"]) & np.isfinite(columns["azimuth"])
    if not keep.all():
        remark = f"survey: {int(np.count_nonzero(~keep))} of {log_set.rows} stations left out: a value is missing"
        if remark not in log_set.remarks:
            log_set.remarks.append(remark)
    rows = np.flatnonzero(keep)
    depth = columns["depth"][rows]
    falls = np.flatnonzero(np.diff(depth) <= 0)
    if falls.size:
        first = int(falls[0])
        kind = "repeats" if depth[first] == depth[first + 1] else "falls from"
        rule = f"depth {depth[first + 1]:g} m {kind} {depth[first]:g} m: must grow"
        raise log_set.input_error(rule, int(rows[first + 1]), named["depth"].channel)
    try:
        return Survey(depth, columns["inclination"][rows], columns["azimuth"][rows])
    except ValueError as error:
        raise log_set.input_error(str(error)) from error


def image(log_set: RawSet, name: str, roles: RoleMap | None = None) -> RawSectorImage:
    """Return a sector image with its depth; rows without a depth are left out and counted.

    Raises
    ------
    ValueError
        If the channel has no sectors, or depth does not strictly grow or strictly fall.
    """
    roles = roles or guess(log_set)
    channel = log_set[name]
    if len(channel.shape) != 2:
        images = [each.channel for each in roles.all("image", "radius-image")]
        raise log_set.input_error(f"has no sectors; the images are {', '.join(images) or 'none'}", column=name)
    named = needed(log_set, roles, "depth")
    depth = column(log_set, named)
    rows = np.flatnonzero(np.isfinite(depth))
    if not rows.size:
        raise log_set.input_error("has no value", column=named.channel)
    steps = np.diff(depth[rows])
    wrong = np.flatnonzero(steps <= 0 if steps.sum() >= 0 else steps >= 0)
    if wrong.size:
        at = int(wrong[0])
        before, after = depth[rows[at]], depth[rows[at + 1]]
        rule = f"depth {after:g} m after {before:g} m: an image's depth must strictly grow or strictly fall"
        raise log_set.input_error(rule, int(rows[at + 1]), named.channel)
    role = roles.roles.get(name) or Role(name, "image", "")
    dropped = log_set.rows - rows.size
    return RawSectorImage(
        name,
        channel.unit,
        depth[rows],
        channel.values[rows],
        role.first,
        role.step,
        channel.member_names,
        dropped,
    )
