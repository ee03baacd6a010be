"""A table of logs: named columns at the same depths, with units, descriptions, and facts on how they were made.

    table = wall.logs().table()          table["DEQ"].values, table["DEQ"].unit, table.facts["bit diameter"]

Writers of log files take this table. Missing values are NaN. Polars, DuckDB, pandas and pyarrow read a table as an
Arrow stream, by the Arrow PyCapsule interface (https://arrow.apache.org/docs/format/CDataInterface/). nanoarrow makes
the stream: it takes 1 MB, pyarrow 100 MB.
"""

from __future__ import annotations

import os
import re
import sys
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from helibore.base.arrays import Floats, column
from helibore.base.decimals import DECIMALS, USUAL_DECIMALS
from helibore.base.errors import InputError, needs

if TYPE_CHECKING:
    from pandas import DataFrame


@dataclass(frozen=True, eq=False)
class LogColumn:
    """One log: a column of a table of logs, or a log to save with others by ``logs.save("well.las", more=[column])``.

    Parameters
    ----------
    mnemonic
        Short name in files: capital letters, digits and underscores, of which the first is a letter.
    unit
        ``"m"``, ``"m3"``, ``"deg"``, ``"s"``, ``"gAPI"``; "" for a fraction or a code. ASCII.
    description
        The meaning of the log, in one line of ASCII.
    values
        (n,) numbers, one for each row of the table, as many as its depths; NaN where missing.
    decimals
        Number of decimals in text files; None: chosen by the unit.

    Raises
    ------
    InputError
        ``mnemonic = 'gamma ray': must be capital letters, digits and underscores, the first a letter``.
    """

    mnemonic: str
    unit: str
    description: str
    values: Floats
    decimals: int | None = None

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[A-Z][A-Z0-9_]*(\[\d+\])?", self.mnemonic):
            rule = "must be capital letters, digits and underscores, the first a letter"
            raise InputError("mnemonic", rule, repr(self.mnemonic))
        if not (self.description.isascii() and self.unit.isascii()):
            raise InputError(self.mnemonic, "unit and description must be ASCII")
        self.__dict__["values"] = column(self.mnemonic, self.values)

    def texts(self, missing: str) -> list[str]:
        """Return the values as text, with ``decimals`` or, if it is None, the decimals of the unit.

        Parameters
        ----------
        missing
            The text of a missing value.
        """
        decimals = DECIMALS.get(self.unit, USUAL_DECIMALS) if self.decimals is None else self.decimals
        return [f"{value:.{decimals}f}" if value == value else missing for value in self.values.tolist()]


@dataclass(frozen=True, eq=False)
class LogImage:
    """An image of the wall: a row for each row of a table of logs, a column for each sector around the hole.

    Files hold it as one channel of K values a row (DLIS), or as K columns ``NAME[1]`` ... ``NAME[K]``.

    Parameters
    ----------
    mnemonic, unit, description
        As in `LogColumn`.
    values
        (n, K) float64; NaN where missing.
    first
        Toolface of the centre of sector 1, degrees. The next sectors follow clockwise, looking downhole.
    """

    mnemonic: str
    unit: str
    description: str
    values: Floats
    first: float

    @property
    def toolface(self) -> Floats:
        """(K,) toolfaces of the centres of the sectors, degrees in [0, 360)."""
        sectors = self.values.shape[1]
        centres: Floats = (self.first + np.arange(sectors) * (360.0 / sectors)) % 360.0
        return centres

    def columns(self) -> list[LogColumn]:
        """Return a column for each sector; its description ends in its angle, as LAS 3.0 states it: {AF;5.625deg}."""
        step = 360.0 / self.values.shape[1]
        return [
            LogColumn(
                f"{self.mnemonic}[{sector + 1}]",
                self.unit,
                f"{self.description} {{AF;{self.first + sector * step:.10g}deg}}",
                self.values[:, sector],
            )
            for sector in range(self.values.shape[1])
        ]


class Tabular(ABC):
    """Base of the classes that have a `table`. `to_pandas` makes a pandas data frame of an object. Polars, DuckDB and
    other readers of Arrow streams read the object directly: ``polars.DataFrame(logs)``.
    """

    __slots__ = ()

    @abstractmethod
    def table(self) -> LogTable:
        """Return the object's numbers as columns with mnemonics and units, and the facts about them."""

    def to_pandas(self) -> DataFrame:
        """Return `table` as a ``pandas.DataFrame``; its columns have the mnemonics as names.

        ``attrs`` of the data frame holds the ``units`` by mnemonic, and the ``facts``.

        Raises
        ------
        MissingExtraError
            If pandas is not installed.
        """
        with needs("pandas", "tables"):
            from pandas import DataFrame
        table = self.table()
        frame = DataFrame({of.mnemonic: of.values for of in table})
        frame.attrs = {"units": {of.mnemonic: of.unit for of in table}, "facts": table.facts}
        return frame

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """Return the Arrow stream of `table`: float64 columns with their units as metadata, null where missing."""
        import nanoarrow as arrow
        from nanoarrow.c_array_stream import CArrayStream

        table, fields, arrays = self.table(), {}, []
        for of in table:
            fields[of.mnemonic] = arrow.Schema(arrow.float64(), metadata={"unit": of.unit} if of.unit else None)
            there = ~np.isnan(of.values)  # a missing value is null, so that a mean leaves it out
            validity = None if there.all() else np.packbits(there, bitorder="little")
            arrays.append(arrow.c_array_from_buffers(fields[of.mnemonic], table.rows, [validity, of.values.copy()]))
        batch = arrow.c_array_from_buffers(arrow.struct(fields), table.rows, [None], children=arrays)
        return CArrayStream.from_c_arrays([batch], batch.schema).__arrow_c_stream__(requested_schema)

    def __iter__(self) -> Iterator[Any]:
        """Refuse ``pandas.DataFrame(logs)`` by the error of `__array__`, which says what makes a data frame."""
        self.__array__()

    def __array__(self, *_: Any, **__: Any) -> NoReturn:
        """Refuse ``pandas.DataFrame(table)``, which would make rows of the names and units."""
        raise InputError(type(self).__name__, "is not an array: to_pandas() or polars.DataFrame() make a data frame")


class LogTable(Tabular):
    """Columns of equal length and different mnemonics. The first is the depth, metres; in logs, depths rise or fall.

    ``facts`` say how the columns were made: ``{"bit diameter": "0.2159 m"}``. Every file states them. ``images`` have
    as many rows as the columns; they are written to files, and are no columns of the table.
    """

    def __init__(self, columns: Sequence[LogColumn], facts: Mapping[str, str], images: Sequence[LogImage] = ()) -> None:
        if not columns:
            raise InputError("columns", "a table of logs must have a depth")
        self.facts, self.images = dict(facts), tuple(images)
        self._columns: dict[str, LogColumn] = {}
        for one in columns:
            if one.mnemonic in self._columns:
                raise InputError(one.mnemonic, "comes twice; mnemonics must differ")
            size, rows = one.values.size, columns[0].values.size
            if size != rows:
                raise InputError(f"{one.mnemonic}: {size} values, {columns[0].mnemonic} has {rows}", "must be equal")
            self._columns[one.mnemonic] = one

    def table(self) -> LogTable:
        return self

    def save(self, filename: str | os.PathLike[str]) -> None:
        """Write the table to ``filename``: .las, .csv, .parquet or .dlis."""
        package: Any = sys.modules["helibore"]  # the package knows the formats, whose folder lies above this one
        package._save_table(self, filename)

    @property
    def rows(self) -> int:
        """Number of rows."""
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


def columns_of(*rows: Any) -> list[LogColumn]:
    """Return a `LogColumn` for each of ``rows``: (mnemonic, unit, description, numbers[, decimals])."""
    return [
        LogColumn(mnemonic, unit, description, np.array([*values], dtype=np.float64), *decimals)
        for mnemonic, unit, description, values, *decimals in rows
    ]


def refuse_table(value: object, place: str) -> None:
    """If ``value`` is a data frame in place of samples, raise an InputError that says how to make samples of it."""
    if isinstance(value, dict) or hasattr(value, "columns"):
        rule = "is a data frame: hb.open(frame).caliper() makes a caliper of it, hb.Caliper.from_table of named columns"
        raise InputError(place, rule, type(value).__name__)
