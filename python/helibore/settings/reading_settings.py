"""How log files are read, where a file does not say it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from helibore.settings.declared import Declared, Option, Rule


def _is_encoding(name: str) -> bool:
    try:
        "".encode(name)
    except LookupError:
        return False
    return True


ENCODING = Rule("is not one that Python knows", _is_encoding)


@dataclass(frozen=True, kw_only=True)
class ReadingSettings(Declared, group="reading"):
    """How files are read; a setting counts for the files of a run to whose format it applies."""

    encoding: Annotated[str | None, ENCODING, Option("UTF-8, or else Windows-1252"),
        "Encoding of texts, such as cp1251. None: UTF-8, or UTF-16 with its mark, or else Windows-1252.",
    ] = None  # fmt: skip
    decimal: Annotated[Literal[".", ","] | None, Option("the cells decide"),
        "Decimal mark of the numbers of tables and LAS files. None: the cells decide.",
    ] = None  # fmt: skip
    salvage: Annotated[bool, Option(),
        "Read what lies before the damage of a cut file, and state what is lost.",
    ] = False  # fmt: skip
    strict: Annotated[bool, Option(),
        "Refuse a file of which only a part can be read. Without it, the part is read and the rest is named.",
    ] = False  # fmt: skip
    layouts: Annotated[Path | None, Option("the rules of helibore", "FILE"),
        "File of rules for the layout of texts: comments, footers, names and units; they come before helibore's.",
    ] = None  # fmt: skip
