"""The configuration, a TOML file: which sources are connected, what their items mean, and which wall grows from them.

    [wall]
    bit_diameter = 0.216            # metres, like all lengths in [wall] and [passes]
    start_depth = 2500.0

    [source.mwd]
    address = "tcp://127.0.0.1:9872"
    units = "metric"                # must be set: WITS does not transmit units
    items = { bit_depth = "0108", hole_depth = "0110", rotation = "0120" }
    caliper = { first = "5010", groups = 30, order = ["toolface", "depth", "radius"] }

``docs/live.md`` lists every setting. This file checks all tables and converts them to core units; ``sources.py`` does
so for the tables of sources.
"""

from __future__ import annotations

import dataclasses
import json
import os
import re
import tomllib
from dataclasses import asdict, dataclass, field
from pathlib import Path as FilePath
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, ConfigDict, Field

from helibore.base.errors import InputError
from helibore.base.settings import Settings
from helibore.live.checks import Table, check, within
from helibore.live.depth_limits import DepthLimits
from helibore.live.layout import PathReference
from helibore.live.pass_rules import PassRules, read_layers
from helibore.live.sources import Source, read_store, read_wits
from helibore.wall.wall import Wall

OF_WALL = {*(f.name for f in dataclasses.fields(Settings)), "threads", "instruction_set", "basis"}


@dataclass(frozen=True)
class Configuration:
    """Everything a live wall needs to know before the first byte."""

    wall: dict[str, Any]
    layers: dict[str, tuple[str, ...]]
    passes: PassRules
    path: dict[str, Any]
    depth: DepthLimits
    sources: dict[str, Source]
    journal: str | None = None
    sync_interval: float = 0.1
    segment_bytes: int = 64 << 20
    snapshot: dict[str, Any] = field(default_factory=dict)
    text: str = ""

    def meaning(self) -> str:
        """Return as JSON the settings that affect the wall, so without those of the transport."""
        sources = {name: asdict(source) for name, source in self.sources.items()}
        for name, source in sources.items():
            for transport in ("address", "allow", "mode", "every", "silence", "replace_after", "store"):
                del source[transport]
            if source["pass_number"] is None:  # older journals have no such settings
                del source["pass_number"], source["pass_numbers"]
            if store := self.sources[name].store:
                source["store"] = store.meaning()
        return json.dumps(
            {"wall": self.wall, "layers": self.layers, "passes": self.passes.model_dump(), "path": self.path,
             "depth": self.depth.model_dump(),              "sources": sources}, sort_keys=True,
        )  # fmt: skip


class WallTable(Table):
    """The table ``wall``; `Wall` checks its other settings."""

    model_config = ConfigDict(extra="allow")

    bit_diameter: Annotated[float, within(1e-3, 10)] = Field(description="metres")
    start_depth: float = Field(description="metres, the depth of the first vertex")


def _three(rule: str) -> AfterValidator:
    def check_three(values: list[float]) -> list[float]:
        if len(values) != 3:
            raise ValueError(rule)
        return values

    return AfterValidator(check_three)


class PathTable(Table):
    """The table ``path``."""

    method: Literal["minimum-curvature", "radius-of-curvature"] = "minimum-curvature"
    reference: PathReference = "high-side"
    head: Annotated[list[float], _three("must be three numbers: north, east, down in metres")] = [0.0, 0.0, 0.0]
    extend: Annotated[float, within(0)] = 100.0
    stations: list[Annotated[list[float], _three("must be [depth m, inclination deg, azimuth deg]")]] = []


class JournalTable(Table):
    """The table ``journal``."""

    folder: Annotated[str, Field(min_length=1)] | None = None
    sync_ms: Annotated[float, within(0, 60_000)] = 100.0
    segment_mb: Annotated[int, within(1, 1024)] = 64


class SnapshotTable(Table):
    """The table ``snapshot``."""

    folder: str = ""
    every: Annotated[float, within(1)] = 60.0
    logs: Literal["las", "csv", "none"] = "las"


class TopTable(Table):
    """The whole file. Each table of a source is checked separately, because WITS and WITSML sources differ."""

    wall: WallTable = Field(default_factory=dict, validate_default=True)
    path: PathTable = PathTable()
    source: dict[str, dict[str, Any]] = {}
    layers: dict[str, list[str]] = {}
    passes: PassRules = PassRules()
    depth: DepthLimits = DepthLimits()
    journal: JournalTable = JournalTable()
    snapshot: SnapshotTable = SnapshotTable()


def load(file: str | os.PathLike[str]) -> Configuration:
    """Read and check a configuration file.

    Raises
    ------
    InputError
        For the first setting that breaks a rule (``FILE: PLACE = VALUE: RULE``), or if the file is not TOML.
    """
    text = FilePath(file).read_text(encoding="utf-8")
    entries = _toml(text, str(file))
    try:
        return _read(entries, text)
    except InputError as error:
        raise error.within(str(file)) from None


def parse(text: str) -> Configuration:
    """Check the text of a configuration; see :func:`load`."""
    return _read(_toml(text, "configuration"), text)


def _toml(text: str, name: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        if item := re.search(r"^[^#\n]*[=\[,]\s*(0\d{3})\b", text, re.MULTILINE):
            line = text.count("\n", 0, item.start(1)) + 1
            raise InputError(f"{name}, line {line}", f'an item must be in quotes: "{item[1]}"', item[1]) from None
        raise InputError(name, f"is not TOML: {error}") from None


def _read(entries: dict[str, Any], text: str) -> Configuration:
    top = check(TopTable, entries)
    wall = _wall(top.wall.model_dump())
    if top.depth.outside(np.array(wall["start_depth"])):
        raise InputError("wall.start_depth", top.depth.rule(), f"{wall['start_depth']:g}")
    path = top.path.model_dump(include={"method", "reference", "head", "extend"}) | {"stations": top.path.stations}
    sources = {}
    for name, table in top.source.items():
        read = read_store if str(table.get("address", "")).lower().startswith("https:") else read_wits
        sources[name] = read(name, table, wall["bit_diameter"], path["reference"])
    _check_sources(sources)
    return Configuration(
        wall=wall,
        layers=read_layers(top.layers, numbered=any(source.pass_number for source in sources.values())),
        passes=top.passes,
        path=path,
        depth=top.depth,
        sources=sources,
        journal=top.journal.folder,
        sync_interval=top.journal.sync_ms / 1000.0,
        segment_bytes=top.journal.segment_mb << 20,
        snapshot=top.snapshot.model_dump(),
        text=text,
    )


def _wall(settings: dict[str, Any]) -> dict[str, Any]:
    for name in settings.keys() - OF_WALL:
        raise InputError(f"wall.{name}", "is not a setting")
    try:
        Wall(**settings)
    except (ValueError, TypeError) as error:
        place, _, rule = str(error).partition(": ")
        raise InputError(f"wall.{place}", rule) from None
    return settings


def _check_sources(sources: dict[str, Source]) -> None:
    """Refuse a rig quantity or image that two sources map; each source has pass numbers of its own."""
    if not sources:
        raise InputError("source", "must be set: at least one table [source.NAME]")
    seen: dict[str, str] = {}
    for name, source in sources.items():
        place = f"source.{name}"
        for key in [*(f"items.{k}" for k in source.items), *(f"image.{image.name}" for image in source.images)]:
            if key in seen:
                raise InputError(f"{place}.{key}", f"is mapped by source.{seen[key]} too; one source only")
            seen[key] = name
        if source.pass_number and not source.caliper:
            rule = "numbers the caliper's samples, and there is no caliper"
            raise InputError(f"{place}.items.pass_number", rule)
        if source.pass_numbers.listed and not source.pass_number:
            raise InputError(f"{place}.pass_numbers", "items.pass_number must be set: it has the number")
    if "items.bit_depth" not in seen:
        for name, source in sources.items():
            if source.caliper and not source.caliper.depth:
                raise InputError(f"source.{name}.caliper", "has no depth items, and no source maps bit_depth")
            for image in source.images:
                if image.depth is None:
                    raise InputError(f"source.{name}.image.{image.name}", "has no depth item, no source maps bit_depth")
