"""A sector image: rows of values around the hole, and how quads of a wall take values from it.

    origin "edge":    sector 1 starts at ``offset``        |  1  |  2  |  3  | ...
    origin "centre":  sector 1 is centred on ``offset``  1 |  2  |  3  | ...
                                                       offset

    image = hb.SectorImage(depth, values, name="GR", unit="gAPI", origin="edge", reference="high-side")
    surface.attributes["GR"] = image.on(wall)

A row covers half the distance to its neighbours, but at most ``reach``; beyond that the image has a gap, which is NaN.
Sectors must be evenly spaced. Scattered values are not supported. ``base.colors`` turns values into colours.
"""

from __future__ import annotations

import math
from collections import UserDict
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np
import numpy.typing as npt

from helibore import _core
from helibore.base.angles import wrapped
from helibore.base.arrays import Floats, Integers, column
from helibore.base.errors import InputError, check_choice
from helibore.base.notebook import card, usual_picture
from helibore.base.thread_count import thread_count
from helibore.samples.helix import WallLike, quad_room
from helibore.trajectory.references import REFERENCES, Reference, defined, onto_path
from helibore.trajectory.survey import Path

if TYPE_CHECKING:
    from helibore.images.image_breakouts import ImageBreakouts
    from helibore.settings.zone_settings import ImageCriteria

Origin = Literal["centre", "edge"]
Direction = Literal["clockwise", "counterclockwise"]
Method = Literal["cell", "linear"]

FINE = 360
"""Least number of sectors of an image that was turned, so that no border moves by more than half a degree."""

REACH = 0.75
"""Default reach of a row, in median spacings: unevenly spaced rows still meet, and an absent row leaves a gap."""


class SectorImage:
    """Values by depth, in rows of evenly spaced sectors around the hole.

    Parameters
    ----------
    depth
        (n,) metres, in any order, no two equal. The image copies them.
    values
        (n, S), one row for each depth and one column for each of S sectors, S at least 1; NaN where missing. The image
        copies them.
    name, unit
        Name and unit of the values.
    origin
        The part of sector 1 that lies at ``offset``: its ``"centre"``, or the ``"edge"`` where it starts. Tools differ,
        and a wrong choice turns the image by half a sector, so there is no default.
    reference
        What toolface 0 is: ``"high-side"``, ``"north"``, or ``"parallel-transport"``, as a path defines it. If the path
        of a wall has another reference, `on` turns the image (as `onto`). For a wall without a path, give the reference
        from which the wall's toolfaces count.
    direction
        Direction in which the numbers of the sectors rise, looking downhole.
    offset
        Toolface of the centre or edge of sector 1 (see ``origin``), degrees.
    reach
        Greatest distance that a row covers above and below its depth, metres; None: 0.75 of the median spacing of rows.

    Attributes
    ----------
    depth, values
        Sorted by depth, float64, read-only.
    missing
        Number of values that are NaN.

    Raises
    ------
    InputError
        If two rows have the same depth (``depth[4] = 1000: already the depth of row 3``), there is no row, a depth, the
        offset or the reach is not finite, the reach is not above 0, shapes do not fit, a value is infinite, all values
        are missing, the origin, reference or direction is an unknown word, or a single row has no reach.
    """

    def __init__(
        self,
        depth: npt.ArrayLike,
        values: npt.ArrayLike,
        name: str,
        unit: str = "",
        *,
        origin: Origin,
        reference: Reference,
        direction: Direction = "clockwise",
        offset: float = 0.0,
        reach: float | None = None,
    ) -> None:
        check_choice("origin", origin, get_args(Origin))
        check_choice("reference", reference, REFERENCES)
        check_choice("direction", direction, get_args(Direction))
        if not math.isfinite(offset):
            raise InputError("offset", "must be finite", str(offset))
        self.name, self.unit = name, unit
        self.origin, self.reference, self.direction, self.offset = origin, reference, direction, float(offset)
        depths = column("depth", depth)
        order = _order(depths)
        self.depth = depths[order]
        self.values = _rows(values, depths.size)[order]
        self.depth.flags.writeable = self.values.flags.writeable = False
        self.missing = int(np.isnan(self.values).sum())
        if reach is None:
            if self.depth.size < 2:
                raise InputError("reach", "must be given for an image of one row")
            reach = REACH * float(np.median(np.diff(self.depth)))
        if not (math.isfinite(reach) and reach > 0):
            raise InputError("reach", "must be finite and above 0", str(reach))
        self.reach = float(reach)

    def _repr_html_(self) -> str:
        numbers = {
            "depth": f"{self.depth[0]:.2f} to {self.depth[-1]:.2f} m",
            "rows, sectors": f"{self.depth.size}, {self.sectors}",
            "values": f"{np.nanmin(self.values):g} to {np.nanmax(self.values):g} {self.unit}",
            "missing": f"{100 * self.missing / self.values.size:.1f} %",
            "toolface 0": self.reference,
        }
        picture = usual_picture(self.values, self.name, self.unit, f"{self.name} by depth and sector")
        return card(f"SectorImage {self.name}", numbers, picture)

    @property
    def sectors(self) -> int:
        """S, the number of sectors in a row."""
        return int(self.values.shape[1])

    @property
    def toolface(self) -> Floats:
        """The toolface of each sector's centre, (S,) degrees in [0, 360), a new array."""
        number = np.arange(self.sectors, dtype=np.float64) + (0.0 if self.origin == "centre" else 0.5)
        way = 1 if self.direction == "clockwise" else -1
        return wrapped(self.offset + way * number * (360 / self.sectors))

    def breakouts(self, criteria: ImageCriteria | None = None) -> ImageBreakouts:
        """Find where the image is dark on opposite sides of the hole, relative to the median of each row.

        ``criteria`` say how dark, how long and how opposite; None: the defaults of `ImageCriteria`.

        Raises
        ------
        InputError
            If a value is negative, since "dark" is a share of the row's median; if the image is one of gamma rays.

        Examples
        --------
        >>> row = np.where(np.isin(np.arange(36), [8, 9, 10, 26, 27, 28]), 20.0, 100.0)  # dark at 90 and 270
        >>> image = SectorImage([10.0, 10.1], [row, row], "AMP", origin="centre", reference="north")
        >>> image.breakouts().zones[0].toolface
        90.0
        """
        from helibore.images.image_breakouts import find_breakouts

        return find_breakouts(self, criteria)

    def onto(self, path: Path, method: Method = "cell") -> SectorImage:
        """Turn the image into the reference of a path, which is what the toolfaces of its wall count from.

        Every row is turned by the angle between the two references at its depth, and cut into at least `FINE` sectors.
        A sector gets the value of the cell that holds its centre (``method="cell"``), or a value interpolated linearly
        between the centres of cells (``"linear"``).

        Returns
        -------
        SectorImage
            A new image. Rows beyond the path, and rows where one of the references is undefined, are missing.

        Raises
        ------
        InputError
            If no row with a value lies where the path has both references, if the image's reference is
            "parallel-transport" (it follows another path, which is not known), or if the method is unknown.
        """
        check_choice("method", method, get_args(Method))
        if self.reference == "parallel-transport":
            rule = "its toolface 0 follows another path, which is not known, so the image cannot be turned"
            raise InputError(f"image {self.name!r}", rule)
        high_side = self.reference == "high-side"
        there = np.flatnonzero((self.depth >= path.start_depth) & (self.depth <= path.stop_depth))
        there = there[defined(path, self.depth[there], high_side)]
        if not there.size:
            rule = f"from {self.reference} to {path.reference}: no row lies where the path has both references"
            raise InputError(f"image {self.name!r}", rule)
        turn = onto_path(np.zeros(there.size), self.depth[there], path, high_side)
        sectors = self.sectors * math.ceil(FINE / self.sectors)
        fine = (np.arange(sectors, dtype=np.float64) + 0.5) * (360 / sectors)
        way = 1 if self.direction == "clockwise" else -1
        place = (fine - turn[:, None] - self.offset) * way * self.sectors / 360  # in sectors from the first centre
        place -= 0.5 if self.origin == "edge" else 0.0
        values = np.full((self.depth.size, sectors), np.nan)
        values[there] = _around(self.values[there], place, method)
        new: dict[str, Any] = {"origin": "edge", "reference": path.reference, "reach": self.reach}
        return SectorImage(self.depth, values, self.name, self.unit, **new)

    def on(self, wall: WallLike, method: Method = "cell") -> Floats:
        """Return one value for every quad that the wall's helix has room for, whether a surface has the quad or not.

        Parameters
        ----------
        wall
            The wall on whose helix the quads lie; its radii play no part. If the wall's path has another reference, the
            values are those of ``image.onto(wall.path)``.
        method
            ``"cell"``: the value of the cell that holds the quad's centre; a centre on a border belongs to the deeper
            cell, or to the cell with the next number. ``"linear"``: interpolated linearly in depth between two rows,
            and in toolface between two sector centres; NaN if one of these four cells is missing, above the first row
            and below the last.

        Returns
        -------
        (vertices - sectors - 1,) float64, owned; row k is the quad of vertex k. NaN where the image has a gap.
        `Surface.attributes` drops the rows of quads that a surface does not have.

        Raises
        ------
        InputError
            If no quad's centre lies within reach of the image's rows, the method is unknown, or the image cannot be
            turned (`onto`).
        """
        check_choice("method", method, get_args(Method))
        path: Path | None = getattr(wall, "path", None)
        if path is not None and path.reference != self.reference:
            return self.onto(path, method).on(wall, method)
        K, pitch = wall.settings.sectors, wall.settings.pitch
        count = quad_room(wall.radius.size, K)
        if not count:
            return np.empty(0)
        self._check_meets(wall, count)
        # Places of the quads of one turn, in sectors from the start of sector 1; toolfaces repeat from turn to turn.
        toolface = wall.settings.start_toolface + (np.arange(K, dtype=np.float64) + 0.5) * (360 / K)
        turned = (toolface - self.offset) * (1 if self.direction == "clockwise" else -1) * self.sectors / 360
        sector = turned + 0.5 if self.origin == "centre" else turned
        quads, values, threads = (
            (wall.start_depth, pitch, count),
            self.values.ravel(),
            thread_count(getattr(wall, "threads", None)),
        )
        if method == "cell":
            low, high = self.cover()
            return _core.cell_values(self.depth, values, low, high, quads, sector, threads)
        return _core.linear_values(self.depth, values, self.reach, quads, sector - 0.5, threads)

    def _check_meets(self, wall: WallLike, count: int) -> None:
        """Raise an InputError if no centre of the wall's ``count`` quads lies within reach of the image."""
        K, step = wall.settings.sectors, wall.settings.pitch / wall.settings.sectors
        top, bottom = self.depth[0] - self.reach, self.depth[-1] + self.reach
        near = [(end - wall.start_depth) / step - (K + 1) / 2 for end in (top, bottom)]
        candidates = np.clip(np.rint(np.add.outer(near, [-1, 0, 1])), 0, count - 1)
        depths = wall.start_depth + (candidates + (K + 1) / 2) * step
        if not ((depths >= top) & (depths <= bottom)).any():
            ends = sorted(wall.start_depth + (k + (K + 1) / 2) * step for k in (0, count - 1))
            rule = f"no quad of the wall, {ends[0]:g} to {ends[1]:g} m, has its centre there"
            raise InputError(f"image '{self.name}' reaches from {top:g} to {bottom:g} m", rule)

    def cover(self) -> tuple[Floats, Floats]:
        """Return the ends [low, high) of each row: halfway to its neighbours, but at most `reach` from its depth."""
        low, high = self.depth - self.reach, self.depth + self.reach
        near = np.diff(self.depth) <= 2 * self.reach
        middle = self.depth[:-1] + np.diff(self.depth) / 2
        low[1:][near] = high[:-1][near] = middle[near]
        return low, high

    def __repr__(self) -> str:
        size = f"{self.depth.size} rows x {self.sectors} sectors, {self.depth[0]:g} to {self.depth[-1]:g} m"
        place = f"{self.origin} of sector 1 at {self.offset:g} deg from {self.reference}, {self.direction}"
        return f"SectorImage({self.name!r}, {self.unit!r}, {size}, {self.missing} missing, {place})"


def _around(rows: Floats, place: Floats, method: Method) -> Floats:
    """Return the values of each row at places around the hole, counted in sectors from the centre of sector 1."""
    low = np.floor(place + 0.5 if method == "cell" else place)
    first = low.astype(np.int64) % rows.shape[1]
    values: Floats = np.take_along_axis(rows, first, axis=1)
    if method == "linear":
        share = place - low
        values = (1 - share) * values + share * np.take_along_axis(rows, (first + 1) % rows.shape[1], axis=1)
    return values


def _order(depths: Floats) -> Integers:
    """Return the indices of the rows from the shallowest to the deepest.

    Raises an InputError if there is no row, if two depths are equal, or if a depth is not finite.
    """
    if not depths.size:
        raise InputError("depth", "must have at least one row")
    wrong = np.flatnonzero(~np.isfinite(depths))
    if wrong.size:
        raise InputError(f"depth[{wrong[0]}]", "must be finite", str(depths[wrong[0]]))
    order: Integers = np.argsort(depths, kind="stable")
    twice = np.flatnonzero(np.diff(depths[order]) == 0)
    if twice.size:
        row, again = order[twice[0]], order[twice[0] + 1]
        raise InputError(f"depth[{again}]", f"already the depth of row {row}", f"{depths[again]:g}")
    return order


def _rows(values: npt.ArrayLike, count: int) -> Floats:
    shape = np.shape(values)
    if len(shape) != 2 or shape[0] != count or shape[1] < 1:
        rule = f"must be of shape ({count}, sectors), one row a depth and 1 sector or more: {shape}"
        raise InputError("values", rule)
    rows = column("values", np.ravel(values)).reshape(shape)
    if np.isinf(rows).any():
        row, sector = np.argwhere(np.isinf(rows))[0]
        raise InputError(f"values[{row}, {sector}]", "must be finite, or NaN where missing", str(rows[row, sector]))
    if np.isnan(rows).all():
        raise InputError("values", f"all {rows.size} are missing")
    return rows


class SectorImages(UserDict[str, SectorImage]):
    """Images of a wall by name. Setting a plain array is refused, because an array states neither depths nor layout."""

    def __setitem__(self, name: str, image: SectorImage) -> None:
        if not isinstance(image, SectorImage):
            rule = "must be a SectorImage, which states its depths and where sector 1 lies"
            raise InputError(f"images[{name!r}]", f"{rule}, not {type(image).__name__}")
        super().__setitem__(name, image)
