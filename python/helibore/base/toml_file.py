"""Read a TOML file."""

from __future__ import annotations

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

    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(place, f"not TOML: {error}") from error
