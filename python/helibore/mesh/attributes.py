"""Named values on cells, such as gamma, resistivity or the difference of two passes, separate from the geometry.

    surface.attributes["GR"] = image.on(wall)       # one value for each quad
    surface.attributes.units["GR"] = "gAPI"         # and its unit, if it is known
    wall.attributes["GR"] = values                  # for the whole wall; every surface made from it has the values

Missing values are NaN.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, MutableMapping

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, Integers, column
from helibore.base.errors import InputError


class _NamedValues(MutableMapping[str, Floats]):
    """Read-only float64 arrays by name, and units by name."""

    def __init__(self) -> None:
        self._values: dict[str, tuple[Floats, float]] = {}  # with the depth of vertex 0 when a wall's values were set
        self.units: dict[str, str] = {}

    def _keep(self, name: str, values: Floats, start_depth: float = math.nan) -> None:
        values.flags.writeable = False
        self._values[name] = values, start_depth

    def __getitem__(self, name: str) -> Floats:
        return self._values[name][0]

    def __delitem__(self, name: str) -> None:
        del self._values[name]
        self.units.pop(name, None)

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(self._values) or 'none'})"


class Attributes(_NamedValues):
    """Named values, one for each cell (quad or hexahedron) of a mesh; (cells,) float64, copied and read-only.

    An assignment may also give one value for each cell that the whole wall has room for; the values of cells that are
    not in the mesh are dropped. Raises InputError on another number of values.

    Attributes
    ----------
    units
        Unit by name, if it is known; files state it.
    index
        For each cell, its number among the cells that the whole wall has room for.
    """

    def __init__(self, cell: str, index: Integers | range, whole: int) -> None:
        super().__init__()
        self._cell, self.index, self._whole = cell, index, whole

    def __setitem__(self, name: str, values: npt.ArrayLike) -> None:
        array, cells = column(f"attributes[{name!r}]", values), len(self.index)
        if array.size not in (cells, self._whole):
            whole = f", or {self._whole}, one for each {self._cell} that the whole wall has room for"
            rule = f"must be {cells}, one for each {self._cell}{whole if self._whole != cells else ''}"
            raise InputError(f"attributes[{name!r}] has {array.size} values", rule)
        self._keep(name, array.copy() if array.size == cells else array[self.index])


class WallAttributes(_NamedValues):
    """Named values of a wall; value k is that of the quad at vertex k. They are float64, copied and read-only.

    A wall that grows keeps the values; later quads have NaN. Values belong to the helix on which they were set: if a
    later sample moves the start of the helix, `Wall.surface` refuses the values until they are set again. An assignment
    of another number of values raises InputError.

    Attributes
    ----------
    units
        Unit by name, if it is known.
    """

    def __init__(self, helix: Callable[[], tuple[float, int]] | None = None) -> None:
        super().__init__()
        self._helix = helix  # returns the depth of vertex 0, and how many quads the wall has room for; None: frozen

    def __setitem__(self, name: str, values: npt.ArrayLike) -> None:
        if self._helix is None:
            raise InputError(f"attributes[{name!r}]", "cannot be set on a frozen copy: set it on the wall")
        start, quads = self._helix()
        array = column(f"attributes[{name!r}]", values)
        if array.size != quads:
            rule = f"must be {quads}, one for each quad of the wall"
            raise InputError(f"attributes[{name!r}] has {array.size} values", rule)
        self.restore(name, start, array.copy())

    def __delitem__(self, name: str) -> None:
        if self._helix is None:
            raise InputError(f"attributes[{name!r}]", "cannot be removed from a frozen copy: remove it from the wall")
        super().__delitem__(name)

    def frozen(self) -> WallAttributes:
        """Return a copy that does not change. Each step copies a whole dict, so other threads may assign meanwhile."""
        copy = WallAttributes()
        copy._values, copy.units = dict(self._values), dict(self.units)
        return copy

    def start_depth(self, name: str) -> float:
        """Return the depth of vertex 0 at the time the values were set, metres."""
        return self._values[name][1]

    def restore(self, name: str, start_depth: float, values: Floats) -> None:
        """Set values that belong to a helix with this depth of vertex 0, for example those of an archive."""
        self._keep(name, values, start_depth)

    def whole(self, name: str, start_depth: float, quads: int) -> Floats:
        """Return values for a wall with this start and number of quads: the values that were set, then NaN.

        Raises
        ------
        InputError
            If the start of the helix has moved since the values were set, or the wall has fewer quads than values.
        """
        values, start = self._values[name]
        if start != start_depth and not (math.isnan(start) and math.isnan(start_depth)):
            moved = f"when the wall began at {start:g} m; it begins at {start_depth:g} m now"
            raise InputError(f"attributes[{name!r}] was set {moved}", "set it again")
        if values.size > quads:
            raise InputError(f"attributes[{name!r}] has {values.size} values", f"the wall has {quads} quads")
        return np.concatenate([values, np.full(quads - values.size, np.nan)])
