"""Read formation tops, casings, mud logs and other intervals: any table that `hb.open` reads, and Petrel's well tops.

    Well,Surface,MD (m)                 # Petrel well tops
    A-1,Draupne,3105.2                  # Unit in depth: m
    A-1,Hugin,3190.0                    VERSION 2
                                        BEGIN HEADER
    Formation,Top_m,Base_m              MD
    Draupne,3105.2,3190.0               Surface
                                        Well
    Casing,Shoe (m),OD (in)             END HEADER
    Surface,412.0,13 3/8                3105.2 "Draupne" "A-1"

    From (m),To (m),Lithology,Shows
    3100,3105,Claystone,

A table with a column of bottoms holds intervals, any other holds tops, each of which reaches to the next. Names of
formations cross all tracks; casings, and each column of a mud log, are a track of their own. Depths are measured ones:
a table of true depths alone is refused. Of several wells, the well's own rows count.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import numpy as np

from helibore.base import units
from helibore.base.arrays import Array, Floats, Mask
from helibore.base.errors import InputError
from helibore.files.headings import to_float, unit_in_name
from helibore.files.input_file import InputFile, ReadOptions, decode
from helibore.files.number_rows import NULL_TEXTS, column_of
from helibore.files.raw_set import Channel
from helibore.files.reading import read_file
from helibore.logs.intervals import CASING, WIDEST, Interval, checked_intervals

NAMES = (
    "formation", "surface", "interval", "zone", "horizon", "marker", "unit", "lithostratigraphic unit", "member",
    "group", "top", "pick", "section", "name",
)  # fmt: skip
"""Columns that name an interval, in order of trust; ``name`` may follow any of them."""
TOPS = ("md", "measured depth", "top", "from", "start", "depth", "dept")
BOTTOMS = ("bottom", "base", "to", "stop", "end", "shoe", "setting", "set")
PIPES = ("casing", "liner", "tubing", "string", "pipe")
"""Columns that name a pipe."""
SIZES = ("od", "outer diameter", "outside diameter", "nominal od")
"""Columns of the outer diameter of a pipe; where pipes are named, ``diameter`` and ``size`` are it, too."""
TEXTS = frozenset(
    (
        "lithology", "litho", "rock", "cuttings", "description", "descriptions", "remark", "remarks", "comment",
        "comments", "note", "notes", "event", "events", "show", "shows", "fluorescence", "stain", "facies", "fossils",
        "texture", "colour", "color", "interpretation",
    )
)  # fmt: skip
"""Words in the names of a mud log's columns of text."""
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
    """Read formation tops, casings, a mud log or other intervals: a table with names and measured depths.

    Parameters
    ----------
    filename
        CSV, XLSX, Parquet or another table of `helibore.open`, or Petrel's text of well tops. Columns are found by
        their names: formation, surface or zone; casing with OD; lithology, description, shows ...; MD, top or depth;
        bottom, base or shoe; well.
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
    size = _named(channels, SIZES)
    pipe = _named(channels, PIPES, "name", "string", "type")
    if pipe is not None and size is None:
        size = _named(channels, (*PIPES, "diameter", "size"), *SIZES, "size", "diameter")
        size = None if size is pipe else size
    named = _named(channels, NAMES, "name", text=True) or _named(channels, ("name", *NAMES[:3]), "name")
    texts = [one for one in channels if one is not named and one.is_text and TEXTS & set(_plain(one).split())]
    pipe = pipe or (named if size is not None else None)
    columns = [(CASING, pipe)] if pipe is not None else [("", named)] if named is not None else []
    columns += [(_title(one), one) for one in texts]
    bottom = _named(channels, BOTTOMS, "md", "depth", text=False)
    order = (*TOPS[2:5], *TOPS[:2], *TOPS[5:]) if bottom else TOPS
    top = _named(channels, order, "md", "depth", text=False)
    from_surface = pipe is not None and top is None and bottom is not None
    top = bottom if from_surface else top
    for role, found, words in (("a name", columns, NAMES), ("a measured depth", top, TOPS)):
        if not found:
            raise InputError("columns", f"none is {role} ({', '.join(words[:4])} ...); the table has {listed}")
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
    source = f"names {', '.join(of.name for _, of in columns)}, depths {top.name}"
    at = np.flatnonzero(rows)
    start = np.zeros(at.size) if from_surface else depth[at]
    stop = np.full(at.size, np.inf)
    if bottom is None:
        at, start = at[(by_depth := np.argsort(start, kind="stable"))], start[by_depth]
        stop[:-1] = start[1:]
    else:
        source = source if from_surface else f"{source} to {bottom.name}"
        stop = _depths(bottom, units.factor(unit or bottom.unit or known, units.LENGTH))[at]
        stop = np.where(np.isnan(stop), np.inf, stop)
    sizes: list[float | None] = [None] * len(at)
    if size is not None:
        source += f", diameters {size.name}"
        sizes, said = _sizes(size, at)
        remarks += said
    intervals = [
        Interval(name, *ends, track, sizes[number] if of is pipe else None)
        for track, of in columns
        for number, (row, ends) in enumerate(zip(at, zip(start.tolist(), stop.tolist(), strict=True), strict=True))
        if (name := _name(of.values[row])) not in NULL_TEXTS
    ]
    return WellTops(checked_intervals(intervals), (f"{source}, in {units.canonical(known)}", *remarks))


def _title(channel: Channel) -> str:
    """Return the name of a column as the title of a track: ``oil_shows`` is ``Oil shows``."""
    text = re.sub(r"[\s_]+", " ", channel.name).strip()
    return text[:1].upper() + text[1:]


def _sizes(channel: Channel, rows: Array) -> tuple[list[float | None], list[str]]:
    """Return outer diameters in metres, None where none can be read, and remarks on these."""
    found: list[float | None] = []
    remarks = []
    for row in rows:
        value = channel.values[row]
        text = str(value).strip()
        if not text or text in NULL_TEXTS or text == "nan":
            found.append(None)
            continue
        found.append(None)
        if text[-1:].isdigit() and not channel.unit:
            remarks.append(f"{channel.name} {text} has no unit, drawn without it")
            continue
        try:
            size = units.quantity(f"{text}{channel.unit}" if text[-1:].isdigit() else text, units.LENGTH)
        except InputError as error:
            remarks.append(f"{channel.name} {text}: {error.rule}, drawn without it")
            continue
        if not 0 < size <= WIDEST:
            remarks.append(f"{channel.name} {text} is {size:g} m, must be at most {WIDEST:g} m: drawn without it")
            continue
        found[-1] = size
    return found, list(dict.fromkeys(remarks))


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
