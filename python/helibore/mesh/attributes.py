"""Named values on cells: gamma, resistivity, the difference of two passes, any number of them, apart from geometry.

    surface.attributes["GR"] = image.on(wall)       # one value a quad, with a unit:
    surface.attributes.units["GR"] = "gAPI"
    wall.attributes["GR"] = values                  # for the whole wall; every surface made of it has them

A value that is missing is NaN. Colours are not made here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, MutableMapping

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, Integers, column


class Attributes(MutableMapping[str, Floats]):
    """Named values, one a cell (quad or hexahedron): each (cells,) float64, copied and read-only.

    A value for every cell the whole wall has room for is taken, too, and those of missing cells dropped.

    Attributes
    ----------
    units
        Name to unit, where one is known; files say it.
    index
        The cell of the whole wall that each cell is.
    """

    def __init__(self, cell: str, index: Integers | range, whole: int) -> None:
        self._cell, self.index, self._whole = cell, index, whole
        self._values: dict[str, Floats] = {}
        self.units: dict[str, str] = {}

    def __getitem__(self, name: str) -> Floats:
        return self._values[name]

    def __setitem__(self, name: str, values: npt.ArrayLike) -> None:
        array = column(f"attributes[{name!r}]", values)
        if array.size == self._whole != len(self.index):
            array = array[self.index]
        elif array.size != len(self.index):
            whole = f" (or {self._whole}, one for each of the whole wall)" if self._whole != len(self.index) else ""
            raise ValueError(
                f"attributes[{name!r}] has {array.size} values: must be {len(self.index)}, one a {self._cell}{whole}"
            )
        else:
            array = array.copy()
        array.flags.writeable = False
        self._values[name] = array

    def __delitem__(self, name: str) -> None:
        del self._values[name]
        self.units.pop(name, None)

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __repr__(self) -> str:
        return f"Attributes({', '.join(self._values) or 'none'})"


class WallAttributes(MutableMapping[str, Floats]):
    """Named values of a wall, one for each quad it has room for, by vertex k: each float64, copied and read-only.

    A wall that grows keeps them, and quads that came later have none (NaN). They belong to the helix they were set on:
    where a shallower sample moves its start, they must be set anew.

    Attributes
    ----------
    units
        Name to unit, where one is known.
    """

    def __init__(self, helix: Callable[[], tuple[float, int]]) -> None:
        self._helix = helix  # depth of vertex 0, and the quads there is room for
        self._values: dict[str, tuple[float, Floats]] = {}
        self.units: dict[str, str] = {}

    def __getitem__(self, name: str) -> Floats:
        return self._values[name][1]

    def __setitem__(self, name: str, values: npt.ArrayLike) -> None:
        start, quads = self._helix()
        array = column(f"attributes[{name!r}]", values)
        if array.size != quads:
            raise ValueError(f"attributes[{name!r}] has {array.size} values: must be {quads}, one a quad of the wall")
        self._keep(name, start, array.copy())

    def __delitem__(self, name: str) -> None:
        del self._values[name]
        self.units.pop(name, None)

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __repr__(self) -> str:
        return f"WallAttributes({', '.join(self._values) or 'none'})"

    def start_depth(self, name: str) -> float:
        """Depth of vertex 0 when the values were set, metres."""
        return self._values[name][0]

    def restore(self, name: str, start_depth: float, values: Floats) -> None:
        """Set values that were set on a helix with this start, as an archive keeps them."""
        self._keep(name, start_depth, values)

    def _keep(self, name: str, start: float, values: Floats) -> None:
        values.flags.writeable = False
        self._values[name] = (start, values)

    def whole(self, name: str, start_depth: float, quads: int) -> Floats:
        """Values for a wall of so many quads that starts at this depth: those set, then NaN.

        Raises
        ------
        ValueError
            If the helix has moved since they were set, or the wall has fewer quads than values.
        """
        start, values = self._values[name]
        if start != start_depth and not (math.isnan(start) and math.isnan(start_depth)):
            raise ValueError(
                f"attributes[{name!r}] was set when the wall began at {start:g} m; it begins at {start_depth:g} m now: "
                "set it anew"
            )
        if values.size > quads:
            raise ValueError(f"attributes[{name!r}] has {values.size} values: the wall has {quads} quads")
        return np.concatenate([values, np.full(quads - values.size, np.nan)])
