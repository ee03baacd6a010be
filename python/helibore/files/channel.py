"""What a file holds: channels on a common index (a LogSet), one or more of them in a file (a LogFile).

    LogFile  --sets-->  LogSet  --channels-->  Channel: name, unit as written, shape (n,) or (n, K), values

A channel loads its values when first asked. Declared and customary nulls, empty cells and infinities become NaN and
are counted. Units and meanings are not judged here: see ``helibore.channels.roles``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from helibore.files.headings import not_a_number, to_float
from helibore.files.source import complaint

if TYPE_CHECKING:
    from helibore.channels.columns import SectorColumns
    from helibore.channels.readings import WallSamples
    from helibore.channels.roles import RoleMap
    from helibore.preparation.conditioning import Echo
    from helibore.preparation.readings import Readings
    from helibore.samples.caliper import Caliper
    from helibore.trajectory.survey import Survey

Array = npt.NDArray[Any]

CUSTOMARY_NULLS = (-999.25, -9999.0, -9999.25)
"""Values that stand for "no measurement" in files that declare none."""

EXACT = 2**53
"""Integers beyond this are not exact in float64 (time in nanoseconds) and stay integers."""


@dataclass(frozen=True)
class SectorAxis:
    """The angles of an image's sectors as the file states them: sector i is at ``first + i * step``.

    Attributes
    ----------
    first, step
        Angle of the first sector and from one to the next, in ``unit``. ``step`` is NaN where the file states no
        even step.
    unit
        As written in the file.
    """

    first: float
    step: float
    unit: str


class Channel:
    """One column of a file, or one image of K sectors.

    Attributes
    ----------
    name
        As in the file; a repeated name carries ``:1``, ``:2`` ...
    unit
        As written, ``""`` where the file states none.
    description
        As written.
    shape
        (n,) or (n, K).
    members
        Names of the K columns an image was joined from, ``()`` for a channel that is stored as one.
    axis
        The sector angles where the file states them, else None.
    is_text
        Whether the values are text.

    Notes
    -----
    ``load`` returns the values as stored; a masked array says which cells are empty. In a format that has its own way
    to leave a cell empty, ``nan_is_missing`` is False: a NaN is then what somebody computed (see ``odd_row``).
    """

    def __init__(
        self,
        name: str,
        unit: str,
        description: str,
        shape: tuple[int, ...],
        load: Callable[[], Array],
        nulls: Iterable[float] = CUSTOMARY_NULLS,
        axis: SectorAxis | None = None,
        is_text: bool = False,
        nan_is_missing: bool = True,
    ) -> None:
        self.name = name
        self.unit = unit.strip()
        self.description = description.strip()
        self.shape = shape
        self.axis = axis
        self.is_text = is_text
        self.members: tuple[str, ...] = ()
        self._load = load
        self._nulls = tuple(nulls)
        self._nan_is_missing = nan_is_missing
        self._values: Array | None = None
        self._missing = 0
        self._odd: int | None = None

    @property
    def values(self) -> Array:
        """The values, loaded at the first call and kept (read-only): float64, float32 as stored, or text.

        Whole numbers become float64 unless one is too large to be exact. Nulls are NaN in numbers, "" in text.
        """
        if self._values is None:
            self._values, self._missing, self._odd = clean(self._load(), self._nulls, self._nan_is_missing)
            self._values.flags.writeable = False
        return self._values

    @property
    def missing(self) -> int:
        """How many values are missing (NaN, or empty text)."""
        _ = self.values
        return self._missing

    @property
    def odd_row(self) -> int | None:
        """The first row in which the file holds an infinity, or a NaN where NaN is not its word for an empty cell."""
        _ = self.values
        return self._odd

    def __repr__(self) -> str:
        return f"<Channel {self.name} [{self.unit or 'no unit'}] {'x'.join(map(str, self.shape))}>"


def clean(values: Array, nulls: tuple[float, ...], nan_is_missing: bool = True) -> tuple[Array, int, int | None]:
    """Return numbers with nulls and infinities as NaN, how many cells are missing, and the first odd row (see Channel).

    A copy is made only where something is replaced or converted.
    """
    kind = values.dtype.kind
    if kind in "OSUMm":
        text = np.array(["" if cell is None else str(cell) for cell in values.ravel()], dtype=np.str_)
        return text.reshape(values.shape), int(np.count_nonzero(text == "")), None
    if kind in "iu" and values.size and max(abs(int(values.max())), abs(int(values.min()))) > EXACT:
        return np.array(values), 0, None
    width = np.float32 if values.dtype == np.float32 else np.float64
    empty = np.ma.getmaskarray(values) if isinstance(values, np.ma.MaskedArray) else None
    numbers = np.ma.getdata(values).astype(width, order="C", copy=False)
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


NO_HEADER = "numbers, so there is no header"
"""Said in the remarks of a table without one."""


def unique(names: list[str]) -> list[str]:
    """Return ``names`` with every repeated one numbered ``NAME:1``, ``NAME:2`` ... in file order."""
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


class LogSet:
    """Channels that share one index: a LAS data section, a DLIS frame, a WITSML log or trajectory, a table.

    Attributes
    ----------
    name
        The set's name in the file.
    channels
        In file order, images in the place of their first member.
    index
        Name of the index channel, None where the format states none.
    rows
        How many rows.
    header
        What the file says beside the channels (well name, null value, azimuth reference ...), as text.
    remarks
        Every assumption made and every flaw met while reading, as sentences.
    """

    def __init__(
        self,
        path: Path,
        name: str,
        channels: list[Channel],
        rows: int,
        index: str | None = None,
        header: dict[str, str] | None = None,
        remarks: list[str] | None = None,
        line_of: Callable[[int], int] | None = None,
    ) -> None:
        from helibore.files.sectors import join_sectors

        self.path = path
        self.name = name
        self.rows = rows
        self.index = index
        self.header = header or {}
        self.remarks = remarks if remarks is not None else []
        self._line_of = line_of
        self._columns = {channel.name: channel for channel in channels}
        joined, gaps = join_sectors(channels, index)
        self.remarks.extend(gaps)
        self.channels: tuple[Channel, ...] = tuple(joined)
        self._columns.update({channel.name: channel for channel in joined})

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

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    def __iter__(self) -> Iterator[Channel]:
        return iter(self.channels)

    def __len__(self) -> int:
        return len(self.channels)

    def place(self, row: int) -> str:
        """Return where a row stands in the file: its line in a text file, else its row counted from 0."""
        return f"line {self._line_of(row)}" if self._line_of else f"row {row}"

    def numbers(self, name: str) -> npt.NDArray[np.float64]:
        """Return a channel as float64 (read-only), or raise ValueError that names the first cell that is no number."""
        channel = self[name]
        if channel.is_text:
            for row, cell in enumerate(channel.values.ravel()):
                try:
                    to_float(cell or "nan")
                except ValueError:
                    place = self.place(row // max(1, channel.values[:1].size))
                    raise complaint(self.path, not_a_number(str(cell)), place, name) from None
        return channel.values.astype(np.float64, copy=False)

    def readings(
        self, roles: RoleMap | None = None, bit_diameter: float | None = None, echo: Echo | None = None
    ) -> Readings:
        """Return what each sensor read in each row, for :func:`helibore.prepare`. See :func:`readings.readings`."""
        from helibore.channels.readings import readings

        return readings(self, roles, bit_diameter, echo)

    def samples(self, roles: RoleMap | None = None, bit_diameter: float | None = None) -> WallSamples:
        """Return the wall samples as they stand in the file. See :func:`readings.samples`."""
        from helibore.channels.readings import samples

        return samples(self, roles, bit_diameter)

    def caliper(self, roles: RoleMap | None = None, bit_diameter: float | None = None) -> Caliper:
        """Return the wall samples as a :class:`helibore.Caliper`; a radius that none holds is an error with its line.

        ``helibore.prepare(file.readings(), ...)`` conditions, corrects and merges them first.
        """
        from helibore.preparation.prepare import prepare

        return prepare(self.readings(roles, bit_diameter)).caliper

    def survey(self, roles: RoleMap | None = None) -> Survey:
        """Return the directional survey of the set as a :class:`helibore.Survey`. See :func:`columns.survey`."""
        from helibore.channels import columns

        return columns.survey(self, roles)

    def image(self, name: str, roles: RoleMap | None = None) -> SectorColumns:
        """Return a sector image and its depth. See :func:`columns.image`."""
        from helibore.channels import columns

        return columns.image(self, name, roles)

    def __repr__(self) -> str:
        return f"<LogSet {self.name!r}: {len(self.channels)} channels x {self.rows} rows>"


class LogFile:
    """An opened file: its format and the sets it holds.

    A file with one set can be used as that set (``file["GR"]``, ``file.caliper()``). With several, choose:
    ``file.set("name").survey()``.
    """

    def __init__(
        self, path: Path, format_name: str, sets: list[LogSet], close: Callable[[], object] | None = None
    ) -> None:
        if not sets:
            raise complaint(path, f"{format_name}: holds no channels")
        self.path = path
        self.format = format_name
        self.sets = tuple(sets)
        self._close = close

    def set(self, name: str | None = None) -> LogSet:
        """Return the set of that name; without a name the only one, or ValueError that lists them."""
        if name is None:
            if len(self.sets) == 1:
                return self.sets[0]
            raise ValueError(f"{self.path.name}: holds {len(self.sets)} sets: name one of {self._names()}")
        for candidate in self.sets:
            if candidate.name == name:
                return candidate
        raise ValueError(f"{self.path.name}: no set {name!r}; it holds {self._names()}")

    def _names(self) -> str:
        return ", ".join(repr(one.name) for one in self.sets)

    def __getitem__(self, name: str) -> Channel:
        return self.set()[name]

    def __contains__(self, name: object) -> bool:
        return name in self.set()

    def __iter__(self) -> Iterator[Channel]:
        return iter(self.set())

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Channels of the only set."""
        return self.set().channels

    def caliper(self, roles: RoleMap | None = None, bit_diameter: float | None = None) -> Caliper:
        """Return the wall samples of the only set (or of the one the map names)."""
        return self.set(roles.set_name if roles else None).caliper(roles, bit_diameter)

    def readings(
        self, roles: RoleMap | None = None, bit_diameter: float | None = None, echo: Echo | None = None
    ) -> Readings:
        """Return the readings of the only set (or of the one the map names)."""
        return self.set(roles.set_name if roles else None).readings(roles, bit_diameter, echo)

    def samples(self, roles: RoleMap | None = None, bit_diameter: float | None = None) -> WallSamples:
        """Return the wall samples of the only set (or of the one the map names), and what was left out."""
        return self.set(roles.set_name if roles else None).samples(roles, bit_diameter)

    def survey(self, roles: RoleMap | None = None) -> Survey:
        """Return the survey of the only set (or of the one the map names)."""
        return self.set(roles.set_name if roles else None).survey(roles)

    def image(self, name: str, roles: RoleMap | None = None) -> SectorColumns:
        """Return a sector image of the only set (or of the one the map names)."""
        return self.set(roles.set_name if roles else None).image(name, roles)

    def close(self) -> None:
        """Let go of the file. Values already loaded stay."""
        if self._close is not None:
            with suppress(OSError):
                self._close()
            self._close = None

    def __enter__(self) -> LogFile:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<LogFile {self.path.name}: {self.format}, {len(self.sets)} set(s)>"
