"""The configuration, a TOML file: which sources are connected, what their items mean, and which wall grows from them.

    [wall]
    bit_diameter = 0.216            # metres, like all lengths in [wall] and [passes]
    start_depth = 2500.0

    [source.mwd]
    address = "tcp://127.0.0.1:9872"
    units = "metric"                # must be set: WITS does not transmit units
    items = { bit_depth = "0108", hole_depth = "0110", rotation = "0120" }
    caliper = { first = "5010", groups = 30, order = ["toolface", "depth", "radius"] }

``docs/live.md`` lists every setting. Each table is a class that ``checks.py`` checks. ``sources.py`` has the tables of
the sources and converts their units, ``pass_rules.py`` has ``[passes]``, ``depth_limits.py`` has ``[depth]``, and this
file has all other tables and the rules that concern several tables.
"""

from __future__ import annotations

import dataclasses
import datetime
import json
import os
import re
import tomllib
from dataclasses import asdict
from pathlib import Path as FilePath
from typing import Annotated, Any, Literal
from urllib.parse import urlsplit

import numpy as np
from pydantic import AfterValidator, ConfigDict, Field, PlainValidator

from helibore.base.errors import InputError
from helibore.base.regular_file import check_regular
from helibore.base.toml_file import check_parts
from helibore.live.rules.checks import Derived, Table, check, with_values, within
from helibore.live.rules.depth_limits import DepthLimits
from helibore.live.rules.kinds import read_source
from helibore.live.rules.layout import PathReference
from helibore.live.rules.pass_rules import PASSES, PassRules, read_layers
from helibore.live.rules.sources import Source, Text
from helibore.settings.wall_settings import Settings
from helibore.wall.wall import Wall

BEFORE_THEY_EXISTED = {"samples": {"most": 0}}
"""The values that tables have in journals that were begun before these tables existed."""
OF_WALL = {*(f.name for f in dataclasses.fields(Settings)), "threads", "instruction_set", "basis"}


class WallTable(Table):
    """The table ``wall``; `Wall` checks the settings that are not fields of this class."""

    model_config = ConfigDict(extra="allow")

    bit_diameter: float = Field(description="metres")
    start_depth: float = Field(description="metres, the depth of the first vertex")


def _three(rule: str) -> AfterValidator:
    def check_three(values: list[float]) -> list[float]:
        if len(values) != 3:
            raise ValueError(rule)
        return values

    return AfterValidator(check_three)


class PathTable(Table):
    """The table ``path``: given survey stations, and how the path through all stations is computed."""

    method: Literal["minimum-curvature", "radius-of-curvature"] = "minimum-curvature"
    reference: PathReference = "high-side"
    head: Annotated[list[float], _three("must be three numbers: north, east, down in metres")] = [0.0, 0.0, 0.0]
    extend: Annotated[float, within(0)] = 100.0
    stations: list[Annotated[list[float], _three("must be [depth m, inclination deg, azimuth deg]")]] = []


class SamplesTable(Table):
    """The table ``samples``: limits that bound the memory where a tool measures at one depth for days.

    ``most``: the most samples of a source, or of the host, that a wall draws near each vertex, rounded up to a multiple
    of 8; 0: all. With 0, the live wall equals a wall made in one batch, in every bit. ``image_step``: metres of depth;
    an image keeps the latest row in each step; 0: the image keeps all rows and shows the latest row of each depth.
    """

    most: Annotated[int, within(0, 100_000)] = 0
    image_step: Annotated[float, within(0, 10)] = 0.0


class JournalTable(Table):
    """The table ``journal``.

    Segments that both checkpoints contain, and whose records are all older than ``keep_days``, are compressed into the
    folder ``archive``, or deleted if ``old`` is "remove"; without ``keep_days`` they stay.
    """

    folder: Text | None = None
    sync_ms: Annotated[float, within(0, 60_000)] = 100.0
    segment_mb: Annotated[int, within(1, 1024)] = 64
    keep_days: Annotated[float, within(0)] | None = None
    old: Literal["archive", "remove"] = "archive"

    @property
    def sync_interval(self) -> float:
        """Seconds between two syncs of the journal; 0: every append is synced."""
        return self.sync_ms / 1000.0


class NextTable(Table):
    """The table ``next``: the configuration ``file`` that applies from a hole depth (metres) or from a time on."""

    file: Text = Field(description="the file of the configuration")
    hole_depth: Annotated[float, within(0)] | None = None
    time: datetime.datetime | None = None

    def model_post_init(self, _: object) -> None:
        if (self.hole_depth is None) == (self.time is None):
            raise InputError("", "either hole_depth or time must be set, and not both")
        if self.time and self.time.tzinfo is None:
            raise InputError("time", "must have a time zone, such as 2026-05-01T10:00:00Z", str(self.time))

    def is_due(self, wall: int, hole_depth: float) -> bool:
        """Return whether ``file`` applies at time ``wall`` (ns since 1970) and at this hole depth (NaN: unknown)."""
        return wall / 1e9 >= self.time.timestamp() if self.time else hole_depth >= (self.hole_depth or 0.0)


class SnapshotTable(Table):
    """The table ``snapshot``: folder, interval in seconds and format of logs for exports of the live wall."""

    folder: str = ""
    every: Annotated[float, within(1)] = 60.0
    logs: Literal["las", "csv", "none"] = "las"


def _webhook(address: str) -> str:
    parts = urlsplit(address)
    if parts.scheme == "env" and parts.path:
        return f"env:{parts.path}"
    if parts.scheme not in ("http", "https") or not parts.hostname:
        rule = "must be https://..., http://... or env:NAME, an environment variable that holds the address"
        may_hold_secret = "@" in address or "?" in address
        raise InputError("", rule, repr(f"{parts.scheme}:..." if may_hold_secret else address))
    if parts.username is not None or parts.query:
        rule = "must not hold a user, a password or a query, which would be in the journal: use env:NAME"
        raise InputError("", rule, repr(f"{parts.scheme}://{parts.hostname}/..."))
    return address


class AlarmLimits(Table):
    """The table ``alarms``: when an alarm begins, and who receives it besides page, metrics and log.

    An alarm begins after ``lost`` seconds without a connection, after ``refused`` seconds in which all samples are
    refused, after ``standing`` seconds in which samples come and the bit depth does not change, and after ``sync``
    seconds without a successful sync. It also begins if the clock of the machine jumps by more than ``clock`` seconds,
    if less than ``disk_gb`` gigabytes are left for the journal, or if the median diameter of a turn is more than
    ``tight`` metres below, or more than ``washout`` metres above, the bit diameter. ``command`` and ``webhook`` get
    each alarm as a line of JSON; ``environment`` names variables that the command gets besides the usual ones.
    """

    lost: Annotated[float, within(0.1)] = 30.0
    refused: Annotated[float, within(1)] = 120.0
    standing: Annotated[float, within(1)] = 900.0
    disk_gb: Annotated[float, within(0)] = 1.0
    sync: Annotated[float, within(0.1)] = 2.0
    clock: Annotated[float, within(0.1)] = 2.0
    tight: Annotated[float, within(0)] | None = None
    washout: Annotated[float, within(0)] | None = None
    command: list[Text] = []
    environment: list[Text] = []
    webhook: Annotated[str, AfterValidator(_webhook)] | None = None


def _wall(entries: Any) -> dict[str, Any]:
    settings = check(WallTable, entries).model_dump()
    for name in settings:
        if name not in OF_WALL:
            raise InputError(name, "is not a setting")
    try:
        Wall(**settings)
    except (ValueError, TypeError) as error:
        place, _, rule = str(error).partition(": ")
        raise InputError(place, rule) from None
    return settings


class Configuration(Table):
    """All settings of a live wall: one checked configuration file.

    Attributes
    ----------
    sources
        The sources by name. Each is checked by itself, because WITS and WITSML sources differ.
    text, file
        The text of the file, and its path.
    """

    wall: Annotated[dict[str, Any], PlainValidator(_wall)] = Field(default_factory=dict, validate_default=True)
    path: PathTable = PathTable()
    source: dict[str, dict[str, Any]] = {}
    layers: Annotated[dict[str, list[str]], AfterValidator(read_layers)] = Field({}, validate_default=True)
    passes: PassRules = PassRules()
    depth: DepthLimits = DepthLimits()
    samples: SamplesTable = SamplesTable()
    journal: JournalTable = JournalTable()
    snapshot: SnapshotTable = SnapshotTable()
    alarms: AlarmLimits = AlarmLimits()
    next: NextTable | None = None
    sources: Derived[dict[str, Source]] = {}
    text: Derived[str] = ""
    file: Derived[FilePath] = FilePath()

    def model_post_init(self, text: str) -> None:
        start = self.wall["start_depth"]
        if self.depth.outside(np.array(start)):
            raise InputError("wall.start_depth", self.depth.rule(), f"{start:g}")
        sources = {
            name: read_source(name, entries, self.wall["bit_diameter"], self.path.reference)
            for name, entries in self.source.items()
        }
        self._derive(sources=sources, text=text)
        self._check_sources()
        if not any(source.items.pass_number for source in self.sources.values()):
            for name, kind in ((name, kind) for name, kinds in self.layers.items() for kind in kinds):
                if kind not in PASSES:
                    raise InputError(f"layers.{name}", "no source maps pass_number", repr(kind))

    def meaning(self) -> str:
        """Return as JSON the settings that affect the wall (not those of transport, journal, alarms ...)."""
        meaning = self.model_dump(include={"wall", "layers", "passes", "path", "depth", "samples"})
        meaning["sources"] = {name: source.meaning() for name, source in self.sources.items()}
        return json.dumps(meaning, sort_keys=True, default=asdict)

    def with_meaning(self, meaning: str) -> Configuration:
        """Return this configuration with the values that a journal recorded as its ``meaning``.

        A recorded default counts, even if this version has another default.
        """
        recorded = BEFORE_THEY_EXISTED | json.loads(meaning)
        known = {"wall", "path", "layers", "passes", "depth", "samples"} & recorded.keys()
        values = {name: with_values(getattr(self, name), recorded[name]) for name in known}
        sources = {
            name: source.with_meaning(recorded["sources"].get(name, {})) for name, source in self.sources.items()
        }
        return self.model_copy(update=values | {"sources": sources})

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

    def _check_sources(self) -> None:
        """Check what concerns several sources or tables.

        There must be a source. Two sources must not map the same rig quantity or image. A source with a pass number
        must have a caliper, and one with the table ``pass_numbers`` must map the pass number. Some source must map the
        hole depth if ``next`` names one, and the bit depth if a caliper or an image has no depth of its own.
        """
        if not self.sources:
            raise InputError("source", "must be set: at least one table [source.NAME]")
        seen: dict[str, str] = {}
        for name, source in self.sources.items():
            place = f"source.{name}"
            for key in [*(f"items.{key}" for key in source.rig), *(f"image.{key}" for key in source.image)]:
                if key in seen:
                    raise InputError(f"{place}.{key}", f"is mapped by source.{seen[key]} already")
                seen[key] = name
            if source.items.pass_number and not source.caliper:
                rule = "needs a caliper in this source, because it numbers the passes of caliper samples"
                raise InputError(f"{place}.items.pass_number", rule)
            if source.pass_numbers.listed and not source.items.pass_number:
                raise InputError(f"{place}.pass_numbers", "items.pass_number must also be set")
        if self.next and self.next.hole_depth is not None and "items.hole_depth" not in seen:
            raise InputError("next.hole_depth", "no source maps hole_depth", f"{self.next.hole_depth:g}")
        if "items.bit_depth" not in seen:
            for name, source in self.sources.items():
                if source.caliper and not source.caliper.depth:
                    raise InputError(f"source.{name}.caliper", "has no depth items, and no source maps bit_depth")
                for key, image in source.image.items():
                    if image.depth is None:
                        raise InputError(
                            f"source.{name}.image.{key}", "has no depth item, and no source maps bit_depth"
                        )


def load(file: str | os.PathLike[str]) -> Configuration:
    """Read and check a configuration file.

    Raises
    ------
    InputError
        For the first setting that breaks a rule (``FILE: PLACE = VALUE: RULE``), or if the file is not TOML in UTF-8.
    OSError
        If the file cannot be read.
    """
    check_regular(FilePath(file))
    try:
        text = FilePath(file).read_text(encoding="utf-8-sig")  # some editors write a byte order mark
    except UnicodeDecodeError as error:
        raise InputError(str(file), f"must be in UTF-8: {error}") from None
    entries = _toml(text, str(file))
    try:
        found = check(Configuration, entries, context=text)
    except InputError as error:
        raise error.within(str(file)) from None
    found._derive(file=FilePath(file))
    return found


def parse(text: str) -> Configuration:
    """Return the configuration that ``text`` holds; see :func:`load`."""
    return check(Configuration, _toml(text, "configuration"), context=text)


def _toml(text: str, name: str) -> dict[str, Any]:
    check_parts(text, name)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        if item := re.search(r"^[^#\n]*[=\[,]\s*(0\d{3})\b", text, re.MULTILINE):
            line = text.count("\n", 0, item.start(1)) + 1
            raise InputError(f"{name}, line {line}", f'an item must be in quotes: "{item[1]}"', item[1]) from None
        raise InputError(name, f"is not TOML: {error}") from None
    except (RecursionError, ValueError) as error:  # nested too deep, or an integer of thousands of digits
        raise InputError(name, f"is not sensible TOML ({type(error).__name__})") from None
