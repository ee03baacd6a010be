"""Read a TOML file."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from helibore.base.errors import InputError
from helibore.base.regular_file import check_regular


def read_toml(path: Path, place: str) -> dict[str, Any]:
    """Return the tables of a TOML file in UTF-8, with or without a byte order mark, which Windows editors may write.

    Raises an InputError with this ``place`` if the file is not valid TOML.
    """
    return parse_toml(read_text(path, place), place)


def read_text(path: Path, place: str) -> str:
    """Return the text of a file in UTF-8 without a byte order mark; raise InputError if it is in another encoding."""
    check_regular(path)
    try:
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(place, f"not TOML: {error}") from error


def parse_toml(text: str, place: str) -> dict[str, Any]:
    """Return the tables of a text; raise InputError with this ``place`` if the text is not valid TOML."""
    import tomllib

    check_parts(text, place)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(place, f"not TOML: {error}") from error
    except (RecursionError, ValueError) as error:  # nested too deep, or an integer of thousands of digits
        raise InputError(place, f"not sensible TOML ({type(error).__name__})") from error


MOST_PARTS = 50
PARTS = re.compile(rf"(?<![\w\"'-])(?:[\w\"'-]++[ \t]*+\.[ \t]*+){{{MOST_PARTS}}}")


def check_parts(text: str, place: str) -> None:
    """Refuse a key of very many parts (a.b.c ...): the memory that `tomllib` takes for it grows with their square."""
    if found := PARTS.search(text):
        line = text.count("\n", 0, found.start()) + 1
        raise InputError(f"{place}, line {line}", f"not sensible TOML: a key has {MOST_PARTS} parts or more")
