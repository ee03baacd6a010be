"""Session headers of a journal: the OPENED record of each session holds the configuration and its meaning."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from helibore.base.errors import InputError
from helibore.live import journal as journals
from helibore.live.checks import joined_place
from helibore.live.configuration import Configuration, parse
from helibore.live.journal import segments


def _session_headers(folder: FilePath) -> Iterator[dict[str, str]]:
    for segment in segments(folder):
        for row in np.flatnonzero(segment.records["kind"] == journals.OPENED).tolist():
            yield json.loads(segment.payload(row))


def recorded_configuration(folder: FilePath) -> Configuration:
    """Return the configuration with which a journal was begun.

    Raises
    ------
    InputError
        If the journal holds no configuration.
    """
    for header in _session_headers(folder):
        if header.get("configuration"):
            return parse(header["configuration"])
    raise InputError(str(folder), "holds no configuration; give one")


def check_meaning(folder: FilePath, configuration: Configuration) -> None:
    """Refuse to continue a journal that was begun with a configuration of another meaning.

    Raises
    ------
    InputError
        If the meanings differ; the text names the first setting that differs.
    """
    header = next(_session_headers(folder), None)
    if header is None:
        return
    begun, now = json.loads(header.get("meaning") or "null"), json.loads(configuration.meaning())
    if begun != now:
        rule = "was begun with another configuration: give the old one, or begin another journal"
        raise InputError(str(folder), f"{rule}: {_difference(begun, now)}")


def _difference(begun: Any, now: Any, place: str = "") -> str:
    """Return the first setting that differs, with both values."""
    if isinstance(begun, dict) and isinstance(now, dict):
        for name in sorted(begun.keys() | now.keys(), key=lambda name: (name != "wall", name)):
            if begun.get(name) != now.get(name):
                return _difference(begun.get(name), now.get(name), joined_place(place, name))
    if isinstance(begun, list) and isinstance(now, list) and len(begun) == len(now):
        at = next(index for index, pair in enumerate(zip(begun, now, strict=True)) if pair[0] != pair[1])
        return _difference(begun[at], now[at], joined_place(place, at))
    return f"{place} = {_short(now)}, was {_short(begun)}"


def _short(value: Any) -> str:
    text = "not set" if value is None else json.dumps(value)
    return text if len(text) <= 100 else f"{text[:97]}..."
