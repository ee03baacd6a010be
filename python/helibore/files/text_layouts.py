"""Rules for the layout of texts, from ``text_layouts.toml`` and a file of the user: comments, footers, names, units.

The file of a user has the same keys; its entries come before those of helibore.
"""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path
from typing import Any

from helibore.base.cached import cached_property
from helibore.base.errors import InputError

RULES_FILE = Path(__file__).with_name("text_layouts.toml")
LINES_OF_A_LAYOUT = 40
"""A line among so many first ones decides whether a file has a layout."""

BETWEEN = {",": ",", ";": ";", "|": "|", "\t": "\t", "blanks": None}


@dataclass(frozen=True)
class StatedUnit:
    """A comment that states the unit of columns."""

    comment: re.Pattern[str]
    columns: tuple[str, ...]


@dataclass(frozen=True)
class StatedLayout:
    """A layout whose names do not stand in a line above the rows."""

    name: str
    line: re.Pattern[str]
    names: tuple[str, ...] = ()
    names_from: re.Pattern[str] | None = None
    names_to: re.Pattern[str] | None = None
    units: tuple[str, ...] = ()
    rows_after: re.Pattern[str] | None = None
    delimiter: str = ","

    @property
    def mark(self) -> str | None:
        """The delimiter; None for blanks."""
        return BETWEEN[self.delimiter]


@dataclass(frozen=True)
class TextRules:
    """All rules: those of the user, then those of helibore."""

    comments: tuple[str, ...] = ()
    footers: tuple[str, ...] = ()
    never_rows: tuple[re.Pattern[str], ...] = ()
    name_words: tuple[str, ...] = ()
    units: tuple[StatedUnit, ...] = ()
    layouts: tuple[StatedLayout, ...] = ()

    def is_comment(self, line: str) -> bool:
        """Return whether a line starts as a comment does."""
        return line.lstrip().startswith(self.comments)

    def bare(self, line: str) -> str:
        """Return a line without the mark of a comment at its start."""
        text = line.strip()
        mark = max((each for each in self.comments if text.startswith(each)), key=len, default="")
        return text.lstrip(mark) if mark else text

    @cached_property
    def _footer(self) -> re.Pattern[str]:
        return re.compile(rf"\W*(?:{'|'.join(map(re.escape, self.footers))})\b", re.IGNORECASE)

    def is_footer(self, cell: str) -> bool:
        """Return whether a cell begins with a word of a footer."""
        return bool(self.footers) and self._footer.match(cell) is not None

    def is_never_row(self, line: str) -> bool:
        """Return whether a line is no row wherever it stands."""
        return any(pattern.search(line) for pattern in self.never_rows)

    def layout_of(self, lines: list[str]) -> StatedLayout | None:
        """Return the first layout that one of the first lines fits, or None."""
        first = lines[:LINES_OF_A_LAYOUT]
        return next((each for each in self.layouts if any(map(each.line.search, first))), None)


def _pattern(place: str, text: Any) -> re.Pattern[str]:
    try:
        return re.compile(str(text), re.IGNORECASE)
    except re.error as error:
        raise InputError(place, f"must be a regular expression ({error})", repr(text)) from None


def _entry(place: str, kind: type, table: Any, patterns: tuple[str, ...], texts: tuple[str, ...]) -> Any:
    """Return one table of the file as an object of ``kind``; an error names the key that breaks a rule."""
    if not isinstance(table, dict):
        raise InputError(place, "must be a table", repr(table))
    known = [each.name for each in fields(kind)]
    if unknown := next((key for key in table if key not in known), None):
        raise InputError(f"{place}: {unknown}", f"is not known; known are {', '.join(known)}")
    needed = [key for key in known if key in ("name", "line", "comment", "columns")]
    if missing := next((key for key in needed if key not in table), None):
        raise InputError(f"{place}: {missing}", "is missing")
    values = dict(table)
    for key, value in table.items():
        if key in texts:
            values[key] = _texts(f"{place}: {key}", value)
        elif not isinstance(value, str):
            raise InputError(f"{place}: {key}", "must be a text", repr(value))
        elif key in patterns:
            values[key] = _pattern(f"{place}: {key}", value)
    return kind(**values)


def _texts(place: str, value: Any) -> tuple[str, ...]:
    if not isinstance(value, list) or not all(isinstance(each, str) for each in value):
        raise InputError(place, "must be a list of texts", repr(value))
    if "" in value and not place.endswith("units"):
        raise InputError(place, "must not have an empty text")
    return tuple(value)


@cache
def rules_of(path: Path) -> TextRules:
    """Return the rules of one file; an InputError names the key that breaks a rule."""
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(path.name, f"must be TOML ({error})") from None
    known = [each.name for each in fields(TextRules)]
    if unknown := next((key for key in table if key not in known), None):
        raise InputError(f"{path.name}: {unknown}", f"is not known; known are {', '.join(known)}")
    found: dict[str, Any] = {key: _texts(f"{path.name}: {key}", value) for key, value in table.items()
                             if key not in ("units", "layouts")}  # fmt: skip
    found["never_rows"] = tuple(_pattern(f"{path.name}: never_rows", each) for each in found.get("never_rows", ()))
    for key in ("units", "layouts"):
        if not isinstance(table.get(key, []), list):
            raise InputError(f"{path.name}: {key}", "must be tables: [[...]]")
    found["units"] = tuple(
        _entry(f"{path.name}: units[{at}]", StatedUnit, each, ("comment",), ("columns",))
        for at, each in enumerate(table.get("units", []))
    )
    found["layouts"] = tuple(
        _entry(f"{path.name}: layouts[{at}]", StatedLayout, each, ("line", "names_from", "names_to", "rows_after"),
               ("names", "units"))
        for at, each in enumerate(table.get("layouts", []))
    )  # fmt: skip
    for at, each in enumerate(found["layouts"]):
        place = f"{path.name}: layouts[{at}]"
        if each.delimiter not in BETWEEN:
            raise InputError(f"{place}: delimiter", "must be , ; | a tab or blanks", repr(each.delimiter))
        if bool(each.names) == bool(each.names_from and each.names_to):
            raise InputError(place, "must have names, or names_from and names_to")
        if each.names and each.units and len(each.names) != len(each.units):
            raise InputError(f"{place}: units", f"must be {len(each.names)}, one for each name", str(len(each.units)))
    if any("unit" not in each.comment.groupindex for each in found["units"]):
        raise InputError(f"{path.name}: units", "each comment must have a group (?P<unit>...)")
    return TextRules(**found)


def text_rules(own: Path | None = None) -> TextRules:
    """Return the rules of helibore, after those of the file ``own``."""
    base = rules_of(RULES_FILE)
    if own is None:
        return base
    first = rules_of(own)
    return TextRules(**{each.name: getattr(first, each.name) + getattr(base, each.name) for each in fields(TextRules)})
