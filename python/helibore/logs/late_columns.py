"""Columns of logs that are measured when one of them is first read.

The unworn circles and lobes of turns, and the sections that kinds are compared with, take most of the time of all logs;
a diameter, a volume or a table of few columns needs none of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from helibore.base.arrays import Floats
from helibore.base.cached import cached_property


class LateColumns(Mapping[str, Floats]):
    """The columns by name, each float64 with one entry or line for each row.

    Parameters
    ----------
    names
        Of all columns.
    measure
        Returns them. What it reads must not change.
    """

    def __init__(self, names: tuple[str, ...], measure: Callable[[], Mapping[str, Floats]]) -> None:
        self._names, self._measure = names, measure

    @cached_property
    def _columns(self) -> Mapping[str, Floats]:
        columns = self._measure()
        for of in columns.values():
            of.flags.writeable = False
        return columns

    def __getitem__(self, name: str) -> Floats:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def between(self, rows: slice) -> LateColumns:
        """Return the columns of some of the rows."""
        return LateColumns(self._names, lambda: {name: of[rows] for name, of in self.items()})

    def __reduce__(self) -> tuple[type[_Known], tuple[dict[str, Floats]]]:
        return _Known, (dict(self),)


class _Known(LateColumns):
    """Columns that are measured already."""

    def __init__(self, columns: Mapping[str, Floats]) -> None:
        super().__init__(tuple(columns), lambda: columns)
