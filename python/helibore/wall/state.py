"""A wall at one moment: it is saved, measured and meshed like the wall, which may grow meanwhile."""

from __future__ import annotations

from dataclasses import dataclass

from helibore.wall.reads import WallReads
from helibore.wall.wall_columns import WallColumns


@dataclass(frozen=True, eq=False, repr=False)
class WallState(WallColumns, WallReads):  # the columns come first: the readings of the same name copy a wall
    """The arrays of a wall at one moment and the methods that read them, as in `Wall`. It never changes."""

    def _state(self, samples: bool | None = True) -> WallState:  # noqa: ARG002
        return self
