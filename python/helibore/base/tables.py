"""A table of logs: named columns on one depth, with units, descriptions, and the facts they were made with.

    table = wall.logs().table()          table["DEQ"].values, table["DEQ"].unit, table.facts["bit diameter"]

What files are written from. Missing values are NaN.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from helibore.base.arrays import Floats, column


@dataclass(frozen=True, eq=False)
class LogColumn:
    """One log.

    Attributes
    ----------
    mnemonic
        Its short name in files: capital letters, digits and underscores.
    unit
        ``"m"``, ``"m3"``, ``"deg"``, ``"s"``, or ``""`` for a fraction or a code.
    description
        What it is, in one line of ASCII.
    values
        (n,) float64; NaN where missing.
    decimals
        That text files write; None: as fine as the unit deserves.
    """

    mnemonic: str
    unit: str
    description: str
    values: Floats
    decimals: int | None = None

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[A-Z][A-Z0-9_]*", self.mnemonic):
            raise ValueError(f"mnemonic = {self.mnemonic!r}: must be capital letters, digits and underscores")
        if not (self.description.isascii() and self.unit.isascii()):
            raise ValueError(f"{self.mnemonic}: unit and description must be ASCII")


class LogTable:
    """Columns on one depth, the depth first.

    Parameters
    ----------
    columns
        The first is the depth, metres, strictly rising or falling. All of one length, mnemonics all different.
    facts
        What they were made with, as texts: ``{"bit diameter": "0.2159 m"}``. Every file states them.

    Raises
    ------
    ValueError
        ``C1: 99 values, DEPT has 100: must be equal``; on a mnemonic that comes twice; on an empty table.
    """

    def __init__(self, columns: Sequence[LogColumn], facts: Mapping[str, str]) -> None:
        if not columns or not columns[0].values.size:
            raise ValueError("a table of logs must have a depth and at least one row")
        self.facts = dict(facts)
        self._columns: dict[str, LogColumn] = {}
        for one in columns:
            if one.mnemonic in self._columns:
                raise ValueError(f"{one.mnemonic}: comes twice; mnemonics must differ")
            size, rows = one.values.size, columns[0].values.size
            if size != rows:
                raise ValueError(f"{one.mnemonic}: {size} values, {columns[0].mnemonic} has {rows}: must be equal")
            column(one.mnemonic, one.values)
            self._columns[one.mnemonic] = one

    @property
    def rows(self) -> int:
        """How many rows."""
        return int(self.depth.values.size)

    @property
    def depth(self) -> LogColumn:
        """The first column."""
        return next(iter(self._columns.values()))

    def __getitem__(self, mnemonic: str) -> LogColumn:
        try:
            return self._columns[mnemonic]
        except KeyError:
            raise KeyError(f"no log {mnemonic!r}; there are {', '.join(self._columns)}") from None

    def __iter__(self) -> Iterator[LogColumn]:
        return iter(self._columns.values())

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        return f"LogTable({', '.join(self._columns)}: {self.rows} rows)"
