"""Values of a mesh's cells by name: any number of them, switched without touching geometry.

surface.attributes["GR"] = image.on(wall)      # one value a quad, or one for every quad the whole wall has room for
"""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping

import numpy.typing as npt

from helibore.arrays import Floats, Integers, column


class Attributes(MutableMapping[str, Floats]):
    """Named values, one a cell (quad or hexahedron): each (cells,) float64, copied and read-only.

    A value for every cell the whole wall has room for is taken, too, and those of missing cells dropped.
    """

    def __init__(self, cell: str, index: Integers | range, whole: int) -> None:
        self._cell, self._index, self._whole = cell, index, whole
        self._values: dict[str, Floats] = {}

    def __getitem__(self, name: str) -> Floats:
        return self._values[name]

    def __setitem__(self, name: str, values: npt.ArrayLike) -> None:
        array = column(f"attributes[{name!r}]", values)
        if array.size == self._whole != len(self._index):
            array = array[self._index]
        elif array.size != len(self._index):
            whole = f" (or {self._whole}, one for each of the whole wall)" if self._whole != len(self._index) else ""
            raise ValueError(
                f"attributes[{name!r}] has {array.size} values: must be {len(self._index)}, one a {self._cell}{whole}"
            )
        else:
            array = array.copy()
        array.flags.writeable = False
        self._values[name] = array

    def __delitem__(self, name: str) -> None:
        del self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __repr__(self) -> str:
        return f"Attributes({', '.join(self._values) or 'none'})"
