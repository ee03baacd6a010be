"""Read a TOML file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from helibore.base.errors import InputError


def read_toml(path: Path, place: str) -> dict[str, Any]:
    """Return the tables of a TOML file in UTF-8, with or without a byte order mark, which Windows editors may write.

    Raises an InputError with this ``place`` if the file is not valid TOML.
    """
    import tomllib

    try:
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(place, f"not TOML: {error}") from error
