"""Colours and patterns of the common rocks: what a track of rocks looks like in print and on the viewer's page.

    rock_of("Lithology", "Claystone, dk gry, blky")      claystone: its colour, and strokes that fill a tile

``rocks.json`` is the only definition; more rocks, and their names in other languages, are added there.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

_DEFINITION: dict[str, Any] = json.loads(Path(__file__).with_name("rocks.json").read_text(encoding="utf-8"))
PATTERN: tuple[int, int] = tuple(_DEFINITION["size"])
"""Width and height of the tile that repeats."""


@dataclass(frozen=True)
class Rock:
    """A rock: its colour on a light ground, and its strokes (x0, y0, x1, y1) in the tile, y down."""

    name: str
    color: str
    marks: tuple[tuple[float, float, float, float], ...]


_ROCKS = {
    word: Rock(one["words"][0], f"#{one['colours'][0]}", tuple(tuple(mark) for mark in one["marks"]))
    for one in _DEFINITION["rocks"]
    for word in one["words"]
}


def _words(text: str) -> list[str]:
    return re.findall("[a-z]+", text.lower())


def rock_of(track: str, text: str) -> Rock | None:
    """Return the rock that a text names first; None if it names none, or if the track is not one of rocks."""
    if not set(_words(track)) & set(_DEFINITION["tracks"]):
        return None
    found = (_ROCKS.get(word) or _ROCKS.get(word.removesuffix("s")) for word in _words(text))
    return next((rock for rock in found if rock), None)
