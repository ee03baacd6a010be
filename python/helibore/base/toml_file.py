"""Read a TOML file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from helibore.base.errors import InputError


def read_toml(path: Path, place: str) -> dict[str, Any]:
    """Return the tables of a TOML file in UTF-8; raise an InputError with this ``place`` if it is not valid TOML."""
    import tomllib

    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(place, f"not TOML: {error}") from error
