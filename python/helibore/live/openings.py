"""What a journal says it was begun with: the configuration, and its meaning, in the OPENED record of each session."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path as FilePath

import numpy as np

from helibore.live import journal as journals
from helibore.live.configuration import Configuration, parse
from helibore.live.journal import Segment, segments


def _openings(folder: FilePath) -> Iterator[dict[str, str]]:
    for segment in segments(folder):
        opened: Segment = segment
        for row in np.flatnonzero(opened.records["kind"] == journals.OPENED).tolist():
            yield json.loads(opened.payload(row))


def recorded_configuration(folder: FilePath) -> Configuration:
    """Return the configuration a journal was begun with.

    Raises
    ------
    ValueError
        If it holds none.
    """
    for opening in _openings(folder):
        if opening.get("configuration"):
            return parse(opening["configuration"])
    raise ValueError(f"{folder}: holds no configuration; give one")


def check_meaning(folder: FilePath, configuration: Configuration) -> None:
    """Refuse to continue a journal that was begun with a configuration of another meaning.

    Raises
    ------
    ValueError
        If it was.
    """
    for opening in _openings(folder):
        if opening.get("meaning") != configuration.meaning():
            raise ValueError(
                f"{folder}: was begun with another configuration of walls, units or items: give the old one, or begin "
                "another journal"
            )
        return
