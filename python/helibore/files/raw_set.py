"""The results of the readers of files: channels with one index (a RawSet), and the sets of one file (a RawFile).

    RawFile  --sets-->  RawSet  --channels-->  Channel: name, unit as written, shape (n,) or (n, K), values

A channel cleans its values at their first use; if the format allows, the values are loaded only then. Null values
(declared by the file or in common use), empty cells and infinities become NaN and are counted. ``helibore.channels``
decides what a channel means.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from helibore.base.arrays import Array, Floats, Reals, data_and_mask
from helibore.base.cached import cached_property
from helibore.base.errors import InputError
from helibore.base.limits import check_limit
from helibore.base.nulls import NULLS
from helibore.files.headings import to_float
from helibore.files.input_file import file_error

TEXT_KINDS = "OSUMm"
"""Kinds of NumPy arrays whose values become text: texts, dates, durations and objects."""

EXACT = 2**53
"""A column that has an integer beyond this keeps its integers; float64 would round them (time in nanoseconds)."""


@dataclass(frozen=True)
class SectorAxis:
    """The angles of an image's sectors as the file states them: sector i is at ``first + i * step``.

    ``unit`` is the unit as written. ``first`` is NaN if the file does not state it; ``step`` is None if the file does
    not state it, and NaN if the angles are uneven.
    """

    first: float
    step: float | None
    unit: str

    @classmethod
    def of_angles(cls, angles: Sequence[float], unit: str) -> SectorAxis:
        """Return the axis of two or more sectors, from the angle of each sector.

        Files round their angles (2.8125 deg is written 2.81), so each angle may be off by half a percent of a sector.
        """
        step = (angles[-1] - angles[0]) / (len(angles) - 1)
        even = all(abs(angle - angles[0] - sector * step) <= 0.005 * abs(step) for sector, angle in enumerate(angles))
        return cls(angles[0], step if even else float("nan"), unit)


@dataclass(eq=False, repr=False)
class Channel:
    """One column of a file, or one image of K sectors.

    Attributes
    ----------
    name
        As in the file; ``:1``, ``:2`` ... is added to a repeated name.
    unit
        As written, ``""`` if the file states no unit.
    description
        As written.
    shape
        (n,) or (n, K).
    members
        The K columns that form an image; ``()`` if the file stores the channel as one column or array.
    axis
        The sector angles if the file states them, else None.
    is_text
        Whether the values are text.

    Notes
    -----
    ``stored`` is the array, or a function that loads the array. ``shape`` and ``is_text`` follow from an array; with a
    function, the caller states them. A mask of the array marks empty cells. ``nulls`` are numbers that mean no value.
    ``nan_is_missing`` is False for a format that has its own mark for empty cells; in such a format a NaN is a computed
    value (see ``odd_row``).
    """

    name: str
    unit: str
    description: str
    stored: Array | Callable[[], Array]
    nulls: tuple[float, ...] = NULLS
    axis: SectorAxis | None = None
    shape: tuple[int, ...] = ()
    is_text: bool = False
    nan_is_missing: bool = True
    members: Sequence[Channel] = ()

    def __post_init__(self) -> None:
        self.unit, self.description = self.unit.strip(), self.description.strip()
        if isinstance(self.stored, np.ndarray):
            self.shape, self.is_text = self.stored.shape, self.stored.dtype.kind in TEXT_KINDS

    @property
    def member_names(self) -> tuple[str, ...]:
        """Names of the columns that form an image; ``()`` for any other channel."""
        return tuple(member.name for member in self.members)

    @cached_property
    def _cleaned(self) -> tuple[Array, int, int | None]:
        cleaned = clean(self.stored() if callable(self.stored) else self.stored, self.nulls, self.nan_is_missing)
        cleaned[0].flags.writeable = False
        return cleaned

    @property
    def values(self) -> Array:
        """The values, read-only: float64, float32 if the file stores float32, or text.

        They are loaded and cleaned at the first call, and kept. Integers become float64, but a column with an integer
        beyond 2**53 keeps its integers. A missing number is NaN; a missing text is "".
        """
        return self._cleaned[0]

    @property
    def missing(self) -> int:
        """The number of missing values (NaN, or empty text)."""
        return self._cleaned[1]

    @property
    def odd_row(self) -> int | None:
        """The first row with an infinity, or with a NaN if ``nan_is_missing`` is False; None without such a row."""
        return self._cleaned[2]

    def __repr__(self) -> str:
        return f"<Channel {self.name} [{self.unit or 'no unit'}] {'x'.join(map(str, self.shape))}>"


def clean(values: Array, nulls: tuple[float, ...], nan_is_missing: bool = True) -> tuple[Array, int, int | None]:
    """Return the cleaned values, the number of missing cells, and the `Channel.odd_row`.

    Nulls, masked cells and infinities become NaN. Dates, durations and objects become text. Integers become float64; if
    one is beyond 2**53, all stay integers. Float64 and float32 values are copied only if a value is replaced.
    """
    kind = values.dtype.kind
    if kind in TEXT_KINDS:
        text = np.array([_text(cell) for cell in values.ravel()], dtype=np.str_)
        return text.reshape(values.shape), int(np.count_nonzero(text == "")), None
    if kind in "iu" and values.size and max(abs(int(values.max())), abs(int(values.min()))) > EXACT:
        return np.array(values), 0, None
    width = np.float32 if values.dtype == np.float32 else np.float64
    data, empty = data_and_mask(values)
    numbers: Reals = data.astype(width, order="C", copy=False)
    if empty is None and numbers.size and numbers.min() > max(nulls, default=-np.inf) and numbers.max() < np.inf:
        return numbers.view(), 0, None
    infinite = ~np.isfinite(numbers)
    odd = infinite if empty is None else infinite & ~empty
    if nan_is_missing:
        odd = odd & ~np.isnan(numbers)
    gone = infinite.copy() if empty is None else infinite | empty
    for null in nulls:
        gone |= numbers == width(null)
    missing = int(np.count_nonzero(gone))
    if missing:
        numbers = np.where(gone, width(np.nan), numbers)
    first = int(np.argmax(odd)) // max(1, numbers[:1].size) if odd.any() else None
    return numbers.view(), missing, first


def _text(cell: Any) -> str:
    """Return a cell as text: "" for None and for a missing date (NaT); bytes are UTF-8, or else Windows-1252."""
    if isinstance(cell, bytes):
        try:
            return cell.decode()
        except UnicodeDecodeError:
            return cell.decode("cp1252", "replace")
    return "" if cell is None or cell != cell else str(cell)


def unique(names: list[str]) -> list[str]:
    """Return ``names`` in their order, with each repeated name numbered: ``NAME:1``, ``NAME:2`` ...

    A number is skipped if the name with this number exists already.
    """
    repeated = {name for name, count in Counter(names).items() if count > 1}
    taken = set(names) - repeated
    seen = dict.fromkeys(repeated, 0)
    result = []
    for name in names:
        new = name
        while name in repeated and (new == name or new in taken):
            seen[name] += 1
            new = f"{name}:{seen[name]}"
        taken.add(new)
        result.append(new)
    return result


class Loss(str):
    """A remark on a part of a file that cannot be read; with ``strict``, it is an error."""

    __slots__ = ()


@dataclass(eq=False, repr=False)
class RawSet:
    """Channels with one index: a LAS data section, a DLIS frame, a WITSML log or trajectory, a table.

    Attributes
    ----------
    path
        The file.
    name
        The set's name in the file.
    channels
        In file order.
    index
        Name of the index channel; None if the file states no index.
    rows
        The number of rows.
    header
        What else the file states (well name, null value, azimuth reference ...): text by name.
    remarks
        Every assumption made and every flaw met while reading, as sentences.
    line_of
        A function that returns the line of a row in a text file or sheet, counted from 1; None for other formats.
    """

    path: Path
    name: str
    channels: Sequence[Channel]
    rows: int
    index: str | None = None
    header: dict[str, str] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)
    line_of: Callable[[int], int] | None = None

    def __post_init__(self) -> None:
        check_limit(f"{self.path.name}: {self.name}", "columns", len(self.channels))
        every = [each for channel in self.channels for each in (*channel.members, channel)]
        self._columns = {channel.name: channel for channel in every}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the channels, in file order."""
        return tuple(channel.name for channel in self.channels)

    def __getitem__(self, name: str) -> Channel:
        """Return a channel, or a member column of an image, by its name."""
        try:
            return self._columns[name]
        except KeyError:
            raise KeyError(f"{self.path.name}: no channel {name!r}; it holds {', '.join(self.names)}") from None

    def channel(self, name: str) -> Channel:
        """Return a channel as ``log_set[name]`` does, but raise an InputError, not a KeyError, for an unknown name."""
        if name not in self:
            raise InputError(self.path.name, f"no channel {name!r}; it holds {', '.join(self.names)}")
        return self[name]

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    def __iter__(self) -> Iterator[Channel]:
        return iter(self.channels)

    def __len__(self) -> int:
        return len(self.channels)

    def place(self, row: int) -> str:
        """Return where a row stands in the file: "line 8" in a text file or sheet, else "row 7", counted from 0."""
        return f"line {self.line_of(row)}" if self.line_of else f"row {row}"

    def input_error(
        self, rule: str, row: int | None = None, column: str | None = None, value: str | None = None
    ) -> InputError:
        """Return an InputError that names the file, the rule, and the row, column and value if they are given."""
        return file_error(self.path, rule, None if row is None else self.place(row), column, value)

    def numbers(self, name: str) -> Floats:
        """Return a channel as float64 (read-only); an empty cell of a text column is NaN.

        Raises
        ------
        InputError
            If a cell of a text column is not a number: ``w.csv, line 3, column GR = 'x': is not a number``.
        """
        channel = self[name]
        values = channel.values
        if channel.is_text:
            values = np.where(values == "", "nan", values)
            for row, cell in enumerate(values.ravel()):
                try:
                    to_float(cell)
                except ValueError:
                    text, rule = cell.strip(), "is not a number"
                    if text.replace(",", "").lstrip("-").isdigit():
                        rule += ": a decimal comma? The option decimal states the mark"
                    row //= max(1, values[:1].size)
                    raise self.input_error(rule, row, name, repr(text[:40])) from None
        return values.astype(np.float64, copy=False)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name!r}: {len(self.channels)} channels x {self.rows} rows>"


@dataclass
class RawFile:
    """An opened file: the name of its format, its sets, and the function that closes the file."""

    format: str
    sets: list[RawSet]
    close: Callable[[], object] = lambda: None


def readable_sets(readers: Iterable[Callable[[], RawSet]]) -> list[RawSet]:
    """Read the sets of a file. A set that raises an InputError is left out, and each other set gets a remark about it.

    Raises
    ------
    InputError
        If no set can be read: the error of the first set.
    """
    sets: list[RawSet] = []
    errors: list[InputError] = []
    for read in readers:
        try:
            sets.append(read())
        except InputError as error:
            errors.append(error)
    if errors and not sets:
        raise errors[0]
    for each in sets:
        each.remarks.extend(Loss(f"another set is left out: {error}") for error in errors)
    return sets
