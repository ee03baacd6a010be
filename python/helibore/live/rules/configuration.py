"""The configuration, a TOML file: which sources are connected, what their items mean, and which wall grows from them.

    [wall]
    bit_diameter = 0.216            # metres, like all lengths in [wall] and [passes]
    start_depth = 2500.0

    [source.mwd]
    address = "tcp://127.0.0.1:9872"
    units = "metric"                # must be set: WITS does not transmit units
    items = { bit_depth = "0108", hole_depth = "0110", rotation = "0120" }
    caliper = { first = "5010", groups = 30, order = ["toolface", "depth", "radius"] }

The groups ``live`` of ``helibore settings`` list every setting. ``source_tables.py`` has the tables of the sources,
``sources.py`` what they mean, ``pass_rules.py`` has ``[passes]``, ``depth_limits.py`` has ``[depth]``, and this file
has all other tables and the rules that concern several tables.
"""

from __future__ import annotations

import datetime
import json
import os
import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path as FilePath
from typing import Annotated, Any, Literal
from urllib.parse import urlsplit

import numpy as np

from helibore.base.errors import InputError
from helibore.base.toml_file import parse_toml, read_text
from helibore.live.rules.depth_limits import DepthLimits
from helibore.live.rules.kinds import read_source
from helibore.live.rules.layout import PathReference
from helibore.live.rules.pass_rules import PASSES, PassRules, check_layers
from helibore.live.rules.recorded_values import with_values
from helibore.live.rules.source_tables import ALL_FINITE, TEXT
from helibore.live.rules.sources import OtherTables, Source
from helibore.settings.declared import (
    DEPTH,
    FINITE,
    METRES,
    NOT_NEGATIVE,
    SECONDS,
    Declared,
    Rule,
    Stated,
    at_least,
    within,
)
from helibore.settings.output_settings import RigidBody
from helibore.settings.path_settings import PathSettings
from helibore.settings.toml_reading import TomlSource, read_table
from helibore.settings.wall_settings import Settings
from helibore.wall.wall import Wall

BEFORE_THEY_EXISTED = {"samples": {"most": 0}}
"""The values that tables have in journals that were begun before these tables existed."""
MAIN = ["drill", "rescan", "unknown"]
"""The passes of the layer ``main`` if the file does not state them."""
WORDS = Rule("must be a list of texts that are not empty", all)
STATIONS = Rule("must be finite", lambda stations: all(map(ALL_FINITE.test, stations)))


@dataclass(frozen=True, kw_only=True)
class LiveWall(Settings):
    """Settings of a live wall, ``[wall]``; see also ``[wall]`` of a project."""

    start_depth: Annotated[float, METRES, FINITE, DEPTH, "Depth of the first vertex."] = field()
    threads: Annotated[int | None, "Most threads of an append. None: as ``HELIBORE_THREADS`` says."] = None
    instruction_set: Annotated[str, "Instructions of the processor that are used."] = "automatic"
    basis: Annotated[str, "What toolfaces of the samples count from, as for `helibore.Wall`."] = "azimuthal"


@dataclass(frozen=True, kw_only=True)
class PathTable(PathSettings):
    """How stations become a path, ``[path]``, and the stations that are known before the first one comes."""

    reference: Annotated[PathReference, "Direction of toolface 0."] = "high-side"
    extend: Annotated[float, METRES, NOT_NEGATIVE,
        "Length by which the path goes on straight below the last station.",
    ] = 100.0  # fmt: skip
    stations: Annotated[tuple[tuple[float, float, float], ...], STATIONS,
        "Tie-in: depth in metres, inclination and azimuth in degrees of each station.",
    ] = ()  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class SamplesTable(Declared):
    """Limits that bound the memory where a tool measures at one depth for days, ``[samples]``."""

    most: Annotated[int, within(0, 100_000, "samples"),
        "Most samples of a source, or of the host, that a wall draws near each vertex. It is rounded up to a multiple "
        "of 8. 0: all; then the live wall equals a wall made in one batch, in every bit.",
    ] = 0  # fmt: skip
    image_step: Annotated[float, METRES, within(0, 10, "m"),
        "An image keeps the latest row in each such step of depth. 0: all rows, and it shows the latest row of each "
        "depth.",
    ] = 0.0  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class HoleTable(Declared):
    """The hole that is drilled now, ``[hole]``; a reload (SIGHUP) or a restart may change it; the journal has each."""

    name: Annotated[str,
        "Name of the hole. Another name begins another hole: walls of this name, which leave the walls before as they "
        "are. The name of an earlier hole goes back to it; the first hole has none, or that of the first file.",
    ] = ""  # fmt: skip
    kickoff: Annotated[float | None, METRES, NOT_NEGATIVE,
        "Depth at which the hole leaves the one before: above, both have the same samples. None: they share nothing.",
    ] = None  # fmt: skip
    shift: Annotated[float, METRES, within(-1000, 1000, "m"),
        "Length that is added to every depth that sources send from here on, but for survey stations: a corrected "
        "tally, or a slipped depth that is set right.",
    ] = 0.0  # fmt: skip

    def _check(self) -> None:
        if self.kickoff is not None and not self.name:
            raise InputError("kickoff", "needs the name of the hole that begins there", f"{self.kickoff:g}")

    def layer(self, name: str) -> str:
        """Return the name of the wall that is the layer ``name`` in this hole."""
        return self.name if name == "main" else f"{self.name}-{name}"


@dataclass(frozen=True, kw_only=True)
class JournalTable(Declared):
    """Where and how every byte is stored, ``[journal]``."""

    folder: Annotated[str, TEXT, "Folder of the journal; the command line may state it."] = ""
    sync_ms: Annotated[float, within(0, 60_000, "ms"),
        "Time at risk in a power cut, milliseconds; 0: every append is synced.",
    ] = 100.0  # fmt: skip
    segment_mb: Annotated[int, within(1, 1024, "megabytes"), "Size of a segment; a checkpoint follows each."] = 64
    keep_days: Annotated[float | None, NOT_NEGATIVE,
        "Segments that both checkpoints contain, and whose records are all older than this, are put away. None: they "
        "stay.",
    ] = None  # fmt: skip
    old: Annotated[Literal["archive", "remove"],
        "What happens to such segments: they are compressed into the folder archive, or deleted.",
    ] = "archive"  # fmt: skip

    @property
    def sync_interval(self) -> float:
        """Seconds between two syncs of the journal; 0: every append is synced."""
        return self.sync_ms / 1000.0


@dataclass(frozen=True, kw_only=True)
class NextTable(Declared):
    """The configuration that follows, ``[next]``, from a hole depth or from a time on."""

    file: Annotated[str, TEXT, "File of the configuration, in the folder of this one."]
    hole_depth: Annotated[float | None, METRES, NOT_NEGATIVE, "It applies when the hole is so deep."] = None
    time: Annotated[datetime.datetime | None, "It applies from this time on, with its time zone."] = None

    def _check(self) -> None:
        if (self.hole_depth is None) == (self.time is None):
            raise InputError("", "either hole_depth or time must be set, and not both")
        if self.time and self.time.tzinfo is None:
            raise InputError("time", "must have a time zone, such as 2026-05-01T10:00:00Z", str(self.time))

    def is_due(self, wall: int, hole_depth: float) -> bool:
        """Return whether ``file`` applies at time ``wall`` (ns since 1970) and at this hole depth (NaN: unknown)."""
        return wall / 1e9 >= self.time.timestamp() if self.time else hole_depth >= (self.hole_depth or 0.0)


@dataclass(frozen=True, kw_only=True)
class SnapshotTable(Declared):
    """Exports of the live wall, ``[snapshot]``."""

    folder: Annotated[str, "Folder of the export; the command line may state it."] = ""
    every: Annotated[float, SECONDS, FINITE, at_least(1, "s"), "Time between two exports."] = 60.0
    logs: Annotated[Literal["las", "csv", "none"], "Format of the logs."] = "las"


def _check_webhook(address: str) -> None:
    parts = urlsplit(address)
    if parts.scheme == "env" and parts.path:
        return
    if parts.scheme not in ("http", "https") or not parts.hostname:
        rule = "must be https://..., http://... or env:NAME, an environment variable that holds the address"
        may_hold_secret = "@" in address or "?" in address
        raise InputError("webhook", rule, repr(f"{parts.scheme}:..." if may_hold_secret else address))
    if parts.username is not None or parts.query:
        rule = "must not hold a user, a password or a query, which would be in the journal: use env:NAME"
        raise InputError("webhook", rule, repr(f"{parts.scheme}://{parts.hostname}/..."))


@dataclass(frozen=True, kw_only=True)
class AlarmLimits(Declared):
    """When an alarm begins, and who receives it besides page, metrics and log, ``[alarms]``."""

    lost: Annotated[float, SECONDS, FINITE, at_least(0.1, "s"), "Time without a connection to a source."] = 30.0
    refused: Annotated[float, SECONDS, FINITE, at_least(1, "s"),
        "Time in which samples of a source come, and all are refused.",
    ] = 120.0  # fmt: skip
    standing: Annotated[float, SECONDS, FINITE, at_least(1, "s"),
        "Time in which samples come and the bit depth does not change.",
    ] = 900.0  # fmt: skip
    disk_gb: Annotated[float, NOT_NEGATIVE, "Least space that is left for the journal, gigabytes."] = 1.0
    sync: Annotated[float, SECONDS, FINITE, at_least(0.1, "s"), "Time without a successful sync of the journal."] = 2.0
    clock: Annotated[float, SECONDS, FINITE, at_least(0.1, "s"), "Jump of the machine's clock."] = 2.0
    tight: Annotated[float | None, METRES, NOT_NEGATIVE,
        "Median diameter of a turn below the bit diameter. None: no alarm.",
    ] = None  # fmt: skip
    washout: Annotated[float | None, METRES, NOT_NEGATIVE,
        "Median diameter of a turn above the bit diameter. None: no alarm.",
    ] = None  # fmt: skip
    ahead: Annotated[float | None, METRES, NOT_NEGATIVE,
        "While the string is tripped, so much hole ahead of the bit is searched for tight hole: where the bodies of "
        "``string``, or one as wide as the bit, do not pass, none of them wider than the bit less ``tight``. None: no "
        "search.",
    ] = 30.0  # fmt: skip
    body: Annotated[float, METRES, FINITE, at_least(0.01, "m"),
        "Length of the rigid body whose lower end is the bit, for ``ahead`` without ``string``.",
    ] = 0.3  # fmt: skip
    command: Annotated[tuple[str, ...], WORDS, "Command that gets each alarm as a line of JSON."] = ()
    environment: Annotated[tuple[str, ...], WORDS, "Variables that the command gets besides the usual ones."] = ()
    webhook: Annotated[str | None,
        "Address that gets each alarm: https://, http://, or env:NAME, an environment variable that holds it.",
    ] = None  # fmt: skip

    @property
    def by_kind(self) -> dict[str, float]:
        """The limits of median diameter - bit, metres, by the kind of zone; those of undergauge hole are below 0."""
        limits = {"washout": self.washout, "undergauge": None if self.tight is None else -self.tight}
        return {kind: limit for kind, limit in limits.items() if limit is not None}

    def _check(self) -> None:
        if self.webhook is not None:
            _check_webhook(self.webhook)


@dataclass(frozen=True, kw_only=True)
class LiveTables(Declared):
    """The configuration of a live wall, a file of its own, without ``live.`` in the names of its tables."""

    wall: Annotated[dict[str, Any], Stated(LiveWall), "Settings of the wall."]
    path: Annotated[PathTable, "How stations become a path."] = field(default_factory=PathTable)
    source: Annotated[dict[str, Any], "Sources by their names; the address decides which settings one has."] = field(
        default_factory=dict
    )
    layers: Annotated[dict[str, tuple[str, ...]],
        "Passes that each wall takes, by the name of the wall: drill, ream, rescan, trip, unknown, or 'pass N' by the "
        "sender's number. The wall main takes drill, rescan and unknown if it is not stated.",
    ] = field(default_factory=dict)  # fmt: skip
    passes: Annotated[PassRules, "Limits by which the string's motion decides the pass."] = field(
        default_factory=PassRules
    )
    depth: Annotated[DepthLimits, "Limits of depths."] = field(default_factory=DepthLimits)
    samples: Annotated[SamplesTable, "Limits that bound the memory."] = field(default_factory=SamplesTable)
    hole: Annotated[HoleTable, "The hole that is drilled now."] = field(default_factory=HoleTable)
    journal: Annotated[JournalTable, "Where every byte is stored."] = field(default_factory=JournalTable)
    snapshot: Annotated[SnapshotTable, "Exports of the live wall."] = field(default_factory=SnapshotTable)
    alarms: Annotated[AlarmLimits, "When an alarm begins, and who receives it."] = field(default_factory=AlarmLimits)
    string: Annotated[tuple[RigidBody, ...], METRES,
        "Rigid bodies of the string, which the page draws in the hole with their clearance, and which ``alarms.ahead`` "
        "watches for.",
    ] = ()  # fmt: skip
    next: Annotated[NextTable | None, "The configuration that follows. None: no other one."] = None

    def _check(self) -> None:
        check_layers(self.layers)


@dataclass(frozen=True, kw_only=True)
class Configuration(LiveTables):
    """All settings of a live wall: one checked configuration file.

    Besides the tables, it has what they mean together: ``sources`` by name, and text and path of the file.
    """

    sources: Annotated[dict[str, Source], "What the tables of the sources mean."] = field(default_factory=dict)
    text: Annotated[str, "Text of the file."] = ""
    file: Annotated[FilePath, "Path of the file."] = FilePath()

    def meaning(self) -> str:
        """Return as JSON the settings that affect the wall (not those of transport, journal, alarms ...)."""
        tables = {name: asdict(getattr(self, name)) for name in ("passes", "path", "depth", "samples")}
        meaning: dict[str, Any] = {"wall": self.wall, "layers": self.layers, **tables}
        if self.path.north is None:  # older journals have no such setting
            del tables["path"]["north"]
        if self.hole != HoleTable():  # otherwise as journals that were begun before the table existed
            meaning["hole"] = asdict(self.hole)
        meaning["sources"] = {name: source.meaning() for name, source in self.sources.items()}
        return json.dumps(meaning, sort_keys=True, default=asdict)

    def resolved(self) -> Configuration:
        """Return this configuration with its estimator, for a journal that begins: the journal then records it.

        A journal that records none was begun when inverse distance was the default, and goes on with it.
        """
        return replace(self, wall=self.wall | {"estimator": LiveWall(**self.wall).resolved().estimator})

    def with_meaning(self, meaning: str) -> Configuration:
        """Return this configuration with the values that a journal recorded as its ``meaning``.

        A recorded default counts, even if this version has another default.
        """
        recorded = BEFORE_THEY_EXISTED | json.loads(meaning)
        known = {"wall", "path", "layers", "passes", "depth", "samples", "hole"} & recorded.keys()
        values = {name: with_values(getattr(self, name), recorded[name]) for name in known}
        sources = {
            name: source.with_meaning(recorded["sources"].get(name, {})) for name, source in self.sources.items()
        }
        return replace(self, **values, sources=sources)

    def following(self) -> list[Configuration]:
        """Return the configurations that follow this one by their tables ``next``, in order.

        The path of each file is relative to the folder of the file that names it.

        Raises
        ------
        InputError
            If a file breaks a rule, or occurs twice.
        OSError
            If a file cannot be read.
        """
        found = [self]
        while (last := found[-1]).next is not None:
            file = last.file.parent / last.next.file
            if any(file.resolve() == one.file.resolve() for one in found):
                raise InputError("next.file", "must not occur twice in a chain of next files", repr(str(file)))
            found.append(load(file))
        return found[1:]

    def check(self) -> None:
        """Raise InputError for what concerns several sources or tables.

        A wall can be made with the settings of ``wall``. There must be a source. Two sources must not map the same rig
        quantity or image. A source with a pass number must have a caliper, and one with the table ``pass_numbers`` must
        map the pass number. Some source must map the hole depth if ``next`` names one, and the bit depth if a caliper
        or an image has no depth of its own.
        """
        start = self.wall["start_depth"]
        if self.hole.name:
            walls = {self.hole.layer(name): passes for name, passes in self.layers.items()}
            if walls.keys() & self.layers.keys():
                raise InputError("hole.name", "must differ from the names of the layers", repr(self.hole.name))
            try:
                check_layers(walls)
            except InputError as error:
                raise InputError("hole.name", error.rule, repr(self.hole.name)) from error
        if self.depth.outside(np.array(start)):
            raise InputError("wall.start_depth", self.depth.rule(), f"{start:g}")
        if self.wall.get("arm_biases") is not None:
            rule = "must be left out: live samples have no arm numbers"
            raise InputError("wall.arm_biases", rule, setting="wall.arm_biases")
        automatic = self.wall.get("estimator") == "automatic"
        try:
            Wall(**self.wall | ({"estimator": "inverse-distance"} if automatic else {}))  # with which it begins
        except InputError as error:
            raise InputError(f"wall.{error.place}", error.rule, error.value, error.setting) from None
        if not self.sources:
            raise InputError("source", "is missing: at least one table [source.NAME]")
        seen: dict[str, str] = {}
        for name, source in self.sources.items():
            place = f"source.{name}"
            mapped = {"items": source.rig, "image": [one.name for one in source.images], "show": source.shown}
            for key in [f"{table}.{key}" for table, keys in mapped.items() for key in keys]:
                if key in seen:
                    raise InputError(f"{place}.{key}", f"is mapped by source.{seen[key]} already")
                seen[key] = name
            if source.pass_number and not source.caliper:
                rule = "needs a caliper in this source, because it numbers the passes of caliper samples"
                raise InputError(f"{place}.items.pass_number", rule)
            if source.pass_numbers.listed and not source.pass_number:
                raise InputError(f"{place}.pass_numbers", "items.pass_number must also be set")
        if self.next and self.next.hole_depth is not None and "items.hole_depth" not in seen:
            raise InputError("next.hole_depth", "no source maps hole_depth", f"{self.next.hole_depth:g}")
        if "items.bit_depth" not in seen:
            for name, source in self.sources.items():
                if source.caliper and not source.caliper.depth:
                    raise InputError(f"source.{name}.caliper", "has no depth items, and no source maps bit_depth")
                for image in source.images:
                    if image.depth is None:
                        place = f"source.{name}.image.{image.name}"
                        raise InputError(place, "has no depth item, and no source maps bit_depth")
        if not any(source.pass_number for source in self.sources.values()):
            for name, kind in ((name, kind) for name, kinds in self.layers.items() for kind in kinds):
                if kind not in PASSES:
                    raise InputError(f"layers.{name}", "no source maps pass_number", repr(kind))


def load(file: str | os.PathLike[str]) -> Configuration:
    """Read and check a configuration file.

    Raises
    ------
    InputError
        For the first setting that breaks a rule (``FILE, line N: PLACE = VALUE: RULE``), or if the file is not TOML in
        UTF-8.
    OSError
        If the file cannot be read.
    """
    path = FilePath(file)
    return _read(TomlSource(path.name, path.parent, read_text(path, path.name)), path)


def parse(text: str) -> Configuration:
    """Return the configuration that ``text`` holds; see :func:`load`."""
    return _read(TomlSource("configuration", text=text), FilePath())


def _read(source: TomlSource, file: FilePath) -> Configuration:
    tree = _tree(source)
    tree = {"wall": {}} | tree
    tables = read_table(LiveTables, tree, source)
    bit = read_table(LiveWall, tree["wall"], source, ("wall",)).bit_diameter  # refuses what lacks a setting of the wall
    others = OtherTables(bit, tables.path.reference)
    stated = vars(tables) | {
        "wall": _as_stated(tables.wall, tree["wall"]),
        "layers": {"main": MAIN} | {name: list(passes) for name, passes in tables.layers.items()},
    }
    sources = {name: read_source(name, of, others, source) for name, of in tables.source.items()}
    try:
        found = Configuration(**stated, sources=sources, text=source.text, file=file)
        found.check()
    except InputError as error:
        raise source.located(error) from error
    return found


def _as_stated(values: Mapping[str, Any], stated: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings of the wall with the numbers as the file has them: journals record ``2`` and not ``2.0``."""
    floats = "bit_diameter", "start_depth"
    return {name: value if name in floats or isinstance(stated[name], str) else stated[name]
            for name, value in values.items()}  # fmt: skip


def _tree(source: TomlSource) -> dict[str, Any]:
    try:
        return parse_toml(source.text, source.name)
    except InputError as error:
        if item := re.search(r"^[^#\n]*[=\[,]\s*(0\d{3})\b", source.text, re.MULTILINE):
            line = source.text.count("\n", 0, item.start(1)) + 1
            rule = f'an item must be in quotes: "{item[1]}"'
            raise InputError(f"{source.name}, line {line}", rule, item[1]) from error
        raise
