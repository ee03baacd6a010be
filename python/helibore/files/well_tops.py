"""Read formation tops and intervals: any table that `hb.open` reads, and the well tops of Petrel.

    Well,Surface,MD (m)                 # Petrel well tops
    A-1,Draupne,3105.2                  # Unit in depth: m
    A-1,Hugin,3190.0                    VERSION 2
                                        BEGIN HEADER
    Formation,Top_m,Base_m              MD
    Draupne,3105.2,3190.0               Surface
                                        Well
                                        END HEADER
                                        3105.2 "Draupne" "A-1"

A table with a column of bottoms holds intervals, any other holds tops, each of which reaches to the next. Depths are
measured depths: a table of true depths alone is refused. Of several wells, the well's own rows count.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import numpy as np

from helibore.base import units
from helibore.base.arrays import Floats, Mask
from helibore.base.errors import InputError
from helibore.files.headings import to_float, unit_in_name
from helibore.files.input_file import InputFile, ReadOptions, decode
from helibore.files.number_rows import column_of
from helibore.files.raw_set import Channel
from helibore.files.reading import read_file
from helibore.logs.intervals import Interval, checked_intervals, intervals_of_tops

NAMES = (
    "formation", "surface", "interval", "zone", "horizon", "marker", "unit", "lithostratigraphic unit", "member",
    "group", "top", "pick", "section", "name",
)  # fmt: skip
"""Columns that name an interval, in order of trust; ``name`` may follow any of them."""
TOPS = ("md", "measured depth", "top", "from", "start", "depth", "dept")
BOTTOMS = ("bottom", "base", "to", "stop", "end")
WELLS = ("well", "wellbore", "borehole", "hole", "uwi", "well identifier")
TYPES = ("type", "pick type", "surface type")
HORIZON = "horizon"
"""Type of the tops of Petrel that bound formations; contacts and points have others."""
TEXT_LIMIT = 1 << 24
"""Most bytes of Petrel's text."""
PETREL = re.compile(rb"^\s*BEGIN HEADER\s*$", re.MULTILINE)
STATED_UNIT = re.compile(r"#\s*Unit in depth:\s*(?P<unit>\S+)", re.IGNORECASE)
TYPED = re.compile(r"(?:STRING|FLOAT|INT|BOOL|DOUBLE)\s+(?=\S)", re.IGNORECASE)
"""What stands before the name of a column in Petrel's version 1."""
ABSENT = -999.0
CELL = re.compile(r'"([^"]*)"|(\S+)')


@dataclass(frozen=True)
class WellTops:
    """What `read_tops` found: the intervals, and sentences on how the file was read."""

    intervals: tuple[Interval, ...]
    remarks: tuple[str, ...]


def read_intervals(
    filename: str | PathLike[str], *, well: str | None = None, unit: str | None = None
) -> tuple[Interval, ...]:
    """Read formation tops or intervals: a table with a name and a measured depth, or well tops of Petrel.

    Parameters
    ----------
    filename
        CSV, XLSX, Parquet or another table of `helibore.open`, or Petrel's text of well tops. Columns are found by
        their names: formation, surface or zone; MD, top or depth; bottom or base; well.
    well
        Well whose rows are read. None: the only well of the file.
    unit
        Unit of the depths. None: that which the file states.

    Returns
    -------
    tuple of Interval
        By depth. Without a column of bottoms, each reaches to the next top, the last one to infinity.

    Raises
    ------
    InputError
        If a column is missing or has no unit, a depth is no number, or the file has several wells.
    """
    return read_tops(Path(filename), well, unit).intervals


def read_tops(path: Path, well: str | None = None, unit: str | None = None, likely: str = "") -> WellTops:
    """Return the intervals of a file, with remarks; of several wells, ``likely`` counts if ``well`` is None."""
    channels, stated = _channels(path)
    try:
        return _tops(channels, stated, well, unit, likely)
    except InputError as error:
        raise error.within(path.name) from error


def _channels(path: Path) -> tuple[Sequence[Channel], str]:
    """Return the columns of a file, and the unit of depths that a comment states; "" if none does."""
    source = InputFile(path, ReadOptions())
    if path.is_file():
        with source.stream() as stream:
            head = stream.read(TEXT_LIMIT)
        if PETREL.search(head):
            return _petrel(source, decode(path, head)[0])
    found = read_file(path, ReadOptions())
    if len(found.sets) != 1:
        raise InputError(path.name, f"holds {len(found.sets)} sets: a table of tops has one")
    return found.sets[0].channels, ""


def _petrel(source: InputFile, text: str) -> tuple[list[Channel], str]:
    """Return the columns of Petrel's well tops, and the unit that a comment states."""
    lines = text.splitlines()
    upper = [line.strip().upper() for line in lines]
    first = upper.index("BEGIN HEADER")
    if "END HEADER" not in upper[first:]:
        raise source.error("Petrel's well tops: END HEADER is missing", len(lines))
    last = upper.index("END HEADER", first)
    names = [TYPED.sub("", line.strip(), count=1) for line in lines[first + 1 : last] if line.strip()]
    rows: list[list[str]] = []
    for number, line in enumerate(lines[last + 1 :], last + 2):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        cells = [quoted or plain for quoted, plain in CELL.findall(line)]
        if len(cells) != len(names):
            raise source.error(f"{len(cells)} values, but the header names {len(names)} columns", number)
        rows.append(cells)
    if not rows:
        raise source.error("Petrel's well tops: no row below END HEADER", len(lines))
    columns = [column_of(list(cells)) for cells in zip(*rows, strict=True)]
    nulls = (*source.nulls, ABSENT)
    unit = next((match["unit"] for line in lines[:first] if (match := STATED_UNIT.match(line))), "")
    return [Channel(name, unit_in_name(name), "", of, nulls) for name, of in zip(names, columns, strict=True)], unit


def _plain(channel: Channel) -> str:
    """Return the name of a column in small letters, without its unit: ``Top_MD (m)`` is ``top md``."""
    name = channel.name
    if found := unit_in_name(name):
        name = re.sub(rf"[\s_]*[\[(]?\s*{re.escape(found)}\s*[\])]?\s*$", "", name)
    return " ".join(re.findall(r"[a-z0-9]+", re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).lower()))


def _named(channels: Sequence[Channel], words: Iterable[str], *more: str, text: bool | None = None) -> Channel | None:
    """Return the first column with one of the names, alone or with one of ``more`` before or behind it."""
    for word in words:
        known = {word, *(f"{word} {each}" for each in more), *(f"{each} {word}" for each in more)}
        for channel in channels:
            if _plain(channel) in known and text in (None, channel.is_text):
                return channel
    return None


def _tops(channels: Sequence[Channel], stated: str, well: str | None, unit: str | None, likely: str) -> WellTops:
    listed = ", ".join(channel.name for channel in channels)
    named = _named(channels, NAMES, "name", text=True) or _named(channels, ("name", *NAMES[:3]), "name")
    bottom = _named(channels, BOTTOMS, "md", "depth", text=False)
    order = (*TOPS[2:5], *TOPS[:2], *TOPS[5:]) if bottom else TOPS
    top = _named(channels, order, "md", "depth", text=False)
    for role, found, words in (("a name", named, NAMES), ("a measured depth", top, TOPS)):
        if found is None:
            raise InputError("columns", f"none is {role} ({', '.join(words[:4])} ...); the table has {listed}")
    assert named is not None
    assert top is not None
    rows = np.ones(len(top.values), dtype=bool)
    remarks = []
    if (wells := _named(channels, WELLS, "name")) is not None:
        rows, remark = _of_well(wells, well, likely)
        remarks += [remark] if remark else []
    kinds = _named(channels, TYPES, text=True)
    if kinds is not None and (horizon := np.char.lower(kinds.values) == HORIZON)[rows].any():
        others = int((rows & ~horizon).sum())
        remarks += [f"{others} of another {kinds.name} than {HORIZON} left out"] if others else []
        rows &= horizon
    known = unit or top.unit or stated
    if not known:
        raise InputError(f"column {top.name}", "has no unit: state that of the depths", setting="intervals.unit")
    length = units.factor(known, units.LENGTH)
    depth = _depths(top, length)
    missing = rows & np.isnan(depth)
    remarks += [f"{int(missing.sum())} without a depth left out"] if missing.any() else []
    rows &= ~missing
    if not rows.any():
        raise InputError(f"column {top.name}", "no row has a depth")
    at = np.flatnonzero(rows)
    names = [_name(named.values[row]) for row in at]
    source = f"names {named.name}, depths {top.name}"
    if bottom is None:
        intervals = intervals_of_tops(zip(names, depth[at].tolist(), strict=True))
    else:
        source += f" to {bottom.name}"
        stop = _depths(bottom, units.factor(unit or bottom.unit or known, units.LENGTH))[at]
        stop = np.where(np.isnan(stop), np.inf, stop)
        intervals = checked_intervals(map(Interval, names, depth[at].tolist(), stop.tolist()))
    return WellTops(intervals, (f"{source}, in {units.canonical(known)}", *remarks))


def _depths(channel: Channel, length: float) -> Floats:
    depth: Floats = channel.values.astype(np.float64) * length
    return depth


def _name(value: object) -> str:
    """Return a name as text: a formation may be called 7."""
    return value.strip() if isinstance(value, str) else f"{to_float(str(value)):g}"


def _of_well(channel: Channel, well: str | None, likely: str) -> tuple[Mask, str]:
    """Return which rows are those of the well, and a remark if the file has others."""
    texts = [_name(value) for value in channel.values]
    every = list(dict.fromkeys(texts))
    wanted = well if well is not None else likely
    same = [name for name in every if _letters(name) == _letters(wanted)]
    if well is None and len(every) == 1:
        return np.ones(len(texts), dtype=bool), ""
    if not same:
        listed = ", ".join(every[:6]) + (" ..." if len(every) > 6 else "")
        value = None if well is None else repr(well)
        rule = f"must be one of the wells of the file: {listed}"
        raise InputError("well", rule, value, "intervals.well")
    rows = np.fromiter((text in same for text in texts), dtype=bool)
    return rows, f"of {same[0]}, one of {len(every)} wells" if len(every) > 1 else ""


def _letters(name: str) -> str:
    """Return a well's name for comparison: ``15/9-F-12`` and ``15_9-F-12`` are one."""
    return re.sub(r"[^0-9a-z]+", "", name.lower())
