"""Session headers of a journal: the OPENED record of each session holds the configuration and its meaning."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path as FilePath

import numpy as np

from helibore.live import journal as journals
from helibore.live.configuration import Configuration, parse
from helibore.live.journal import segments


def _session_headers(folder: FilePath) -> Iterator[dict[str, str]]:
    for segment in segments(folder):
        for row in np.flatnonzero(segment.records["kind"] == journals.OPENED).tolist():
            yield json.loads(segment.payload(row))


def recorded_configuration(folder: FilePath) -> Configuration:
    """Return the configuration a journal was begun with.

    Raises
    ------
    ValueError
        If it holds none.
    """
    for header in _session_headers(folder):
        if header.get("configuration"):
            return parse(header["configuration"])
    raise ValueError(f"{folder}: holds no configuration; give one")


def check_meaning(folder: FilePath, configuration: Configuration) -> None:
    """Refuse to continue a journal that was begun with a configuration of another meaning.

    Raises
    ------
    ValueError
        If it was.
    """
    for header in _session_headers(folder):
        if header.get("meaning") != configuration.meaning():
            raise ValueError(
                f"{folder}: was begun with another configuration of walls, units or items: give the old one, or begin "
                "another journal"
            )
        return
