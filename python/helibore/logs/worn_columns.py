"""The unworn circle of each turn and the lobes over it.

They take three quarters of the time of all logs, and a diameter, a volume or a table of few columns needs none of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property

from helibore.base.arrays import Floats
from helibore.logs.log_columns import WORN


class WornColumns(Mapping[str, Floats]):
    """The columns by name, each (rows,) float64; they are measured when one of them is first read.

    Parameters
    ----------
    measure
        Returns all columns of `WORN`. What it reads must not change.
    """

    def __init__(self, measure: Callable[[], Mapping[str, Floats]]) -> None:
        self._measure = measure

    @cached_property
    def _columns(self) -> Mapping[str, Floats]:
        columns = self._measure()
        for of in columns.values():
            of.flags.writeable = False
        return columns

    def __getitem__(self, name: str) -> Floats:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(WORN)

    def __len__(self) -> int:
        return len(WORN)

    def between(self, rows: slice) -> WornColumns:
        """Return the columns of some of the rows."""
        return WornColumns(lambda: {name: of[rows] for name, of in self.items()})

    def __reduce__(self) -> tuple[type[_Known], tuple[dict[str, Floats]]]:
        return _Known, (dict(self),)


class _Known(WornColumns):
    """Columns that are measured already."""

    def __init__(self, columns: Mapping[str, Floats]) -> None:
        super().__init__(lambda: columns)
