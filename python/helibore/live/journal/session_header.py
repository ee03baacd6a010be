"""Session headers of a journal: an OPENED record holds the configuration of a session and its meaning.

    session 1   configuration A            the walls begin with A
    session 2   configuration A            read in the same way, also by a later version that has other defaults
    session 3   configuration B            the records from here on are read with B; the walls stay
                configuration C            another change, without a restart (`Live.reconfigure`)

The meaning has the value of each setting that affects the wall, even if the value is a default. So a later version with
other defaults reads the records in the same way. If the first segments were removed, the checkpoints have the
configurations of their records.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from helibore.base.errors import InputError
from helibore.live.journal import checkpoint
from helibore.live.journal import journal as journals
from helibore.live.journal.journal import Segment, all_paths, number_of, segments
from helibore.live.rules.configuration import Configuration, parse
from helibore.live.rules.recorded_values import joined_place
from helibore.live.rules.sources import Source

Header = dict[str, Any]
IMAGE_STAYS = ("name", "unit", "sectors", "layout")


def read_header(payload: bytes) -> Header:
    """Return the session header in the payload of an OPENED record; {} if the payload is empty.

    Raises
    ------
    ValueError
        If the payload is not a JSON object, or has a configuration or a meaning that is not a text.
    """
    header = json.loads(payload or b"{}")
    if not isinstance(header, dict):
        raise InputError("session header", "must be a JSON object", _short(header))
    for name in ("configuration", "meaning"):
        if not isinstance(header.get(name, ""), str):
            raise InputError(f"session header.{name}", "must be a text", _short(header[name]))
    return header


def headers(segment: Segment) -> list[tuple[int, Header]]:
    """Return (row, header) of each session header of a segment; headers that cannot be read are left out."""
    found = []
    for row in np.flatnonzero(segment.records["kind"] == journals.OPENED).tolist():
        with suppress(ValueError):
            found.append((row, read_header(segment.payload(row))))
    return found


def _headers(segment: Segment) -> list[Header]:
    return [header for _, header in headers(segment) if header.get("meaning")]


def _first(found: Iterable[Segment], place: int) -> Header | None:
    return next((found_here[place] for segment in found if (found_here := _headers(segment))), None)


def _from_the_end(folder: FilePath) -> Iterator[Segment]:
    for path in reversed(all_paths(folder)):
        yield next(segments(folder, number_of(path)))


def configuration_of(header: Header) -> Configuration:
    """Return the configuration of a session header, with the defaults of the version that wrote it.

    Raises
    ------
    InputError
        If the header holds no configuration, or if this version cannot read its configuration.
    """
    if not header.get("configuration"):
        raise InputError("session header", "holds no configuration; give one")
    return parse(header["configuration"]).with_meaning(header["meaning"])


def recorded_configuration(folder: FilePath) -> Configuration:
    """Return the configuration with which a journal was begun.

    Raises
    ------
    InputError
        If the first session of the journal holds no configuration, or one that this version cannot read.
    """
    header = _first(segments(folder), 0)
    if header is None or not header.get("configuration"):
        raise InputError(str(folder), "holds no configuration; give one")
    return configuration_of(header)


def sources_of(folder: FilePath, last: Configuration | None, name: str | None = None) -> dict[int, Source]:
    """Return the sources of all sessions by their number in the journal; if ``name`` is given, only this source.

    A source has the settings of ``last`` or, if ``last`` lacks it, of the last session that has it.

    Raises
    ------
    InputError
        If the journal has no source ``name``, or if there is neither ``last`` nor a configuration in the journal.
    """
    texts = _texts(folder, last)
    if not (last or any(texts.values())):
        raise InputError(str(folder), "holds no configuration; give one")
    if name is not None and name not in texts:
        raise InputError("source", f"must be one of {', '.join(texts)}", repr(name))
    given = last.sources if last else {}
    return {number: given[key] if key in given else parse(texts[key]).sources[key]
            for number, key in enumerate(texts, 1) if name in (None, key)}  # fmt: skip


def numbers_of(folder: FilePath, last: Configuration) -> dict[str, int]:
    """Return the numbers that the sources of all sessions and of ``last`` have in the journal."""
    return {name: number for number, name in enumerate(_texts(folder, last), 1)}


def _texts(folder: FilePath, last: Configuration | None) -> dict[str, str]:
    """Return for each source the text of the latest configuration that has it, in the order of the sources' numbers."""
    texts = dict[str, str]()
    for header in (*_of_checkpoint(folder), *(one for segment in segments(folder) for one in _headers(segment))):
        names = sorted(json.loads(header["meaning"])["sources"])
        texts |= dict.fromkeys(names, header.get("configuration", ""))
    return texts | (dict.fromkeys(sorted(last.sources), last.text) if last else {})


def _of_checkpoint(folder: FilePath) -> list[Header]:
    """Return the session headers in the newest readable checkpoint, because their segments may have been removed."""
    for path in reversed(checkpoint.paths(folder)):
        with suppress(InputError, FileNotFoundError):
            facts, _ = checkpoint.read(path, journals.salt_of(all_paths(folder)), only_facts=True)
            return [facts, *facts["stretches"]]
    return []


def continued_with(folder: FilePath, given: Configuration) -> tuple[Configuration, Configuration]:
    """Return the configuration with which a journal was begun, and the configuration with which it continues.

    If ``given`` changes no setting of the last session, the meaning of that session stays, even if the defaults have
    changed. Otherwise ``given`` applies from now on.

    Raises
    ------
    InputError
        If ``given`` lacks a source, or changes what a journal cannot change; the message names the first such setting.
    """
    last = _first(_from_the_end(folder), -1)
    if last is None:
        return given, given
    if not last.get("configuration"):  # the program made a Configuration without a text
        given = _estimated_as(json.loads(last["meaning"]), given)
        _check(folder, json.loads(last["meaning"]), given)
        return given, given
    if parse(last["configuration"]).meaning() == given.meaning():
        going_on = given.with_meaning(last["meaning"])
    else:
        going_on = _changed(folder, configuration_of(last), given)
    return recorded_configuration(folder), going_on


def changed_to(given: Configuration, last: Configuration, folder: FilePath | None = None) -> Configuration:
    """Return the configuration with which a running journal continues if it changes from ``last`` to ``given``.

    Raises
    ------
    InputError
        If ``given`` changes what a journal cannot change, or adds or lacks a source.
    """
    if names := sorted(given.sources.keys() ^ last.sources.keys()):
        raise InputError(f"source.{names[0]}", "a source can be added or removed only by a restart")
    return _changed(folder or FilePath("the journal"), last, given)


def _changed(folder: FilePath, last: Configuration, given: Configuration) -> Configuration:
    begun = json.loads(last.meaning())
    _check(folder, begun, _estimated_as(begun, given))
    return replace(given, wall=last.wall | {"bit_diameter": given.wall["bit_diameter"]})


def _estimated_as(begun: dict[str, Any], given: Configuration) -> Configuration:
    """Return ``given`` with the estimator that a journal was begun with, if ``given`` states none."""
    recorded = {"estimator": begun["wall"]["estimator"]} if "estimator" in begun["wall"] else {}
    return replace(given, wall=recorded | given.wall)


def _check(folder: FilePath, begun: dict[str, Any], given: Configuration) -> None:
    """Raise InputError if ``given`` lacks a source or an image, or changes a setting that `_lasting` returns."""
    now = json.loads(given.meaning())
    before, after = _lasting(begun), _lasting(now)
    after["sources"] = {name: of for name, of in after["sources"].items() if name in before["sources"]}
    after["images"] = {name: of for name, of in after["images"].items() if name in before["images"]}
    if before != after:
        rule = "give the old configuration, or begin another journal"
        raise InputError(str(folder), f"was begun with another configuration ({_difference(before, after)}); {rule}")


def _lasting(meaning: dict[str, Any]) -> dict[str, Any]:
    """Return the part of a meaning that a journal cannot change; for a source, this is only whether it is a store."""
    images = {image["name"]: {key: image[key] if key != "sectors" else len(image[key]) for key in IMAGE_STAYS}
              for source in meaning["sources"].values() for image in source["images"]}  # fmt: skip
    wall = {key: value for key, value in meaning["wall"].items() if key not in ("bit_diameter", "threads")}
    return {"wall": wall, "path": meaning["path"], "layers": meaning["layers"], "images": images,
            "sources": {name: {"store": bool(of.get("store"))} for name, of in meaning["sources"].items()}}  # fmt: skip


def _difference(begun: Any, now: Any, place: str = "") -> str:
    """Return the first setting that differs between two meanings, as "PLACE = NOW, was BEGUN"."""
    if isinstance(begun, dict) and isinstance(now, dict):
        for name in sorted(begun.keys() | now.keys(), key=lambda name: (name != "wall", name)):
            if begun.get(name) != now.get(name):
                return _difference(begun.get(name), now.get(name), joined_place(place, name))
    return f"{place} = {_short(now)}, was {_short(begun)}"


def _short(value: Any) -> str:
    text = "not set" if value is None else json.dumps(value)
    return text if len(text) <= 100 else f"{text[:97]}..."
