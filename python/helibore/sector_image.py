"""A sector image: rows of values around the hole, and the value each quad of a wall takes from it.

    origin "edge":    sector 1 starts at ``offset``        |  1  |  2  |  3  | ...
    origin "centre":  sector 1 is centred on ``offset``  1 |  2  |  3  | ...
                                                       offset

    image = hb.SectorImage(depth, values, name="GR", unit="gAPI", origin="edge", reference="high-side")
    surface.attributes["GR"] = image.on(wall)

A row covers half the way to its neighbours, but at most ``reach``: beyond it the image has a gap, and gaps stay NaN.
It maps rows of evenly spaced sectors. Scattered values and colours are not its business.
"""

from __future__ import annotations

import math
from typing import Literal, get_args

import numpy as np
import numpy.typing as npt

from helibore.arrays import Floats, Integers, column
from helibore.helix import WallLike

Origin = Literal["centre", "edge"]
Direction = Literal["clockwise", "counterclockwise"]
Reference = Literal["high-side", "north"]
Method = Literal["cell", "linear"]

REACH = 0.75
"""Default reach of a row in median spacings: uneven rows meet, one absent row leaves a gap."""


class SectorImage:
    """Rows of evenly spaced sectors around the hole.

    Parameters
    ----------
    depth
        (n,) metres, in any order, no two alike. Copied.
    values
        (n, S) one row a depth, one column a sector, S at least 2; NaN where missing. Copied.
    name, unit
        What the values are.
    origin
        What of sector 1 lies at ``offset``: its ``"centre"``, or the ``"edge"`` where it starts. Tools differ, and a
        wrong choice turns the image by half a sector, so there is no default.
    reference
        What toolface 0 is, ``"high-side"`` or ``"north"``. It must be what the wall's toolfaces count from; a wall
        does not know, so this is not checked.
    direction
        The way sectors count, looking downhole.
    offset
        Toolface of sector 1's origin, degrees.
    reach
        How far above and below its depth a row may speak, metres; None: 0.75 of the median spacing.

    Attributes
    ----------
    depth, values
        Sorted by depth, float64, read-only.
    missing
        Number of values that are NaN.

    Raises
    ------
    ValueError
        ``depth[4] = 1000: already the depth of row 3``; on shapes that do not fit, infinite or only missing values, an
        unknown word, and one row without a reach.
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
        _one_of("origin", origin, get_args(Origin))
        _one_of("reference", reference, get_args(Reference))
        _one_of("direction", direction, get_args(Direction))
        if not math.isfinite(offset):
            raise ValueError(f"offset = {offset}: must be finite")
        self.name, self.unit = name, unit
        self.origin, self.reference, self.direction, self.offset = origin, reference, direction, float(offset)
        depths = column("depth", depth)
        order = _order(depths)
        self.depth = depths[order]
        self.values = _rows(values, depths.size)[order]
        self.depth.flags.writeable = self.values.flags.writeable = False
        self.missing = int(np.isnan(self.values).sum())
        self.reach = _reach(reach, self.depth)

    @property
    def sectors(self) -> int:
        """S, sectors a row."""
        return int(self.values.shape[1])

    def on(self, wall: WallLike, method: Method = "cell") -> Floats:
        """Return one value for every quad the whole wall has room for.

        Parameters
        ----------
        wall
            Whose helix the quads lie on; its radii play no part.
        method
            ``"cell"``: the cell that holds the quad's centre; a centre on a border takes the cell beyond it, deeper or
            next in number. ``"linear"``: linear in depth between rows and, periodically, in toolface between sector
            centres; NaN where a cell with a say is missing, above the first row and below the last.

        Returns
        -------
        (vertices - sectors - 1,) float64, owned; row k is the quad of vertex k. NaN where the image has a gap.
        `Surface.attributes` drops the rows of quads that a surface does not have.

        Raises
        ------
        ValueError
            If no quad's centre lies within the image's depths, or the method is not known.
        """
        _one_of("method", method, get_args(Method))
        depth, toolface = _centres(wall)
        if not depth.size:
            return depth
        upwards = wall.settings.pitch < 0
        rising = depth[::-1] if upwards else depth
        top, bottom = self.depth[0] - self.reach, self.depth[-1] + self.reach
        if np.searchsorted(rising, top) == np.searchsorted(rising, bottom, side="right"):
            raise ValueError(
                f"image '{self.name}' reaches from {top:g} to {bottom:g} m: no quad of the wall, "
                f"{rising[0]:g} to {rising[-1]:g} m, has its centre there"
            )
        # Sectors from the start of sector 1, for one turn: toolfaces repeat from turn to turn.
        turned = (toolface - self.offset) * (1 if self.direction == "clockwise" else -1) * self.sectors / 360
        sector = turned + 0.5 if self.origin == "centre" else turned
        if method == "cell":
            rows = _in_order(self._cell_rows(rising), upwards)
            columns = np.floor(sector).astype(np.int64) % self.sectors
            return self._padded().take(rows * self.sectors + np.resize(columns, rows.size))
        return self._linear(depth, _in_order(self._rows_above(rising), upwards), sector - 0.5)

    def _padded(self) -> Floats:
        """The values, and one more row of NaN for depths in no row."""
        return np.vstack([self.values, np.full((1, self.sectors), np.nan)])

    def _cell_rows(self, rising: Floats) -> Integers:
        """The row that covers each of the rising depths, or the number of rows."""
        count = self.depth.size
        low, high = self.depth - self.reach, self.depth + self.reach
        near = np.diff(self.depth) <= 2 * self.reach
        middle = self.depth[:-1] + np.diff(self.depth) / 2
        low[1:][near] = high[:-1][near] = middle[near]
        bounds = np.searchsorted(rising, np.column_stack([low, high]).ravel())
        label = np.full(2 * count + 1, count)
        label[1::2] = np.arange(count)
        return np.repeat(label, np.diff(bounds, prepend=0, append=rising.size))

    def _rows_above(self, rising: Floats) -> Integers:
        """The last row at or above each of the rising depths, -1 above the first."""
        bounds = np.searchsorted(rising, self.depth)
        return np.repeat(np.arange(-1, self.depth.size), np.diff(bounds, prepend=0, append=rising.size))

    def _linear(self, depth: Floats, above: Integers, sector: Floats) -> Floats:
        count = self.depth.size
        spacing = np.append(np.diff(self.depth), np.inf)
        spacing[spacing > 2 * self.reach] = np.nan  # nothing is known between rows so far apart
        down = (depth - self.depth[above]) / spacing[above]
        down[depth == self.depth[above]] = 0.0
        left = np.floor(sector)
        across = np.resize(sector - left, above.size)
        first = left.astype(np.int64) % self.sectors
        left_column = np.resize(first, above.size)
        right_column = np.resize((first + 1) % self.sectors, above.size)
        flat = self._padded()
        # Row -1 is the padding, so what lies above the first row is NaN.
        upper = np.where(above < 0, count, above) * self.sectors
        top = _between(flat.take(upper + left_column), flat.take(upper + right_column), across)
        lower = np.minimum(above + 1, count) * self.sectors
        bottom = _between(flat.take(lower + left_column), flat.take(lower + right_column), across)
        return _between(top, bottom, down)

    def __repr__(self) -> str:
        return (
            f"SectorImage({self.name!r}, {self.unit!r}, {self.depth.size} rows x {self.sectors} sectors, "
            f"{self.depth[0]:g} to {self.depth[-1]:g} m, {self.missing} missing, {self.origin} of sector 1 at "
            f"{self.offset:g} deg from {self.reference}, {self.direction})"
        )


def _between(start: Floats, stop: Floats, part: Floats) -> Floats:
    """Linear; at part 0 the start alone has a say, so a gap at the stop does not reach it."""
    between: Floats = np.where(part == 0, start, start + part * (stop - start))
    return between


def _centres(wall: WallLike) -> tuple[Floats, Floats]:
    """Depth of every quad's centre, the mean of its corners, and toolface of those of the first turn."""
    K, pitch = wall.settings.sectors, wall.settings.pitch
    count = max(wall.radius.size - K - 1, 0)
    depth: Floats = wall.start_depth + (np.arange(count, dtype=np.float64) + (K + 1) / 2) * (pitch / K)
    toolface: Floats = wall.settings.start_toolface + (np.arange(K, dtype=np.float64) + 0.5) * (360 / K)
    return depth, toolface


def _in_order(rows: Integers, upwards: bool) -> Integers:
    return rows[::-1] if upwards else rows


def _one_of(name: str, word: str, known: tuple[str, ...]) -> None:
    if word not in known:
        raise ValueError(f"{name} = {word!r}: must be {' or '.join(repr(each) for each in known)}")


def _order(depths: Floats) -> Integers:
    """The rows from the shallowest to the deepest."""
    if not depths.size:
        raise ValueError("depth: must have at least one row")
    wrong = np.flatnonzero(~np.isfinite(depths))
    if wrong.size:
        raise ValueError(f"depth[{wrong[0]}] = {depths[wrong[0]]}: must be finite")
    order: Integers = np.argsort(depths, kind="stable")
    twice = np.flatnonzero(np.diff(depths[order]) == 0)
    if twice.size:
        row, again = order[twice[0]], order[twice[0] + 1]
        raise ValueError(f"depth[{again}] = {depths[again]:g}: already the depth of row {row}")
    return order


def _rows(values: npt.ArrayLike, count: int) -> Floats:
    shape = np.shape(values)
    if len(shape) != 2 or shape[0] != count or shape[1] < 2:
        raise ValueError(f"values: must be of shape ({count}, sectors), one row a depth and 2 sectors or more: {shape}")
    rows = column("values", np.ravel(values)).reshape(shape)
    if np.isinf(rows).any():
        row, sector = np.argwhere(np.isinf(rows))[0]
        raise ValueError(f"values[{row}, {sector}] = {rows[row, sector]}: must be finite, or NaN where missing")
    if np.isnan(rows).all():
        raise ValueError(f"values: all {rows.size} are missing")
    return rows


def _reach(reach: float | None, depth: Floats) -> float:
    if reach is None:
        if depth.size < 2:
            raise ValueError("reach: must be given for an image of one row")
        return REACH * float(np.median(np.diff(depth)))
    if not (math.isfinite(reach) and reach > 0):
        raise ValueError(f"reach = {reach}: must be finite and above 0")
    return float(reach)
