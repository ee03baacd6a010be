"""Settings that repeat an output: a TOML file beside it, in one format for every mesh, log and picture.

    helibore = "0.1.0"          verb = "mesh"         nulls = [-999.25, -9999.0, -9999.25]
    [output]                    file = "wall.glb"     blake2b = "..."
    [[caliper]]                 file = "run1.csv"     blake2b = "..."    set = "MAIN"
    [[caliper.channel]]         channel = "md_m"      role = "depth"     unit = "m" ...
    [average] [archive] [survey] [track]              one file each, like a caliper; or gauge = true
    [[image]]                   file = "gr.las"       blake2b = "..."    name = "GR"    origin = "edge"
    [[scalar]]                  file = "gr.las"       blake2b = "..."    name = "RT"
    [preparation] [echo] [path] [wall]                settings by their names in Python
    [options]                                         the verb's own options

Files are named relative to the settings file. In [preparation], [echo], [path] and [wall] defaults are also written, so
that a later version with other defaults repeats the run. ``helibore.runs.run`` has the run itself.
"""

from __future__ import annotations

import dataclasses
import os
import types
import typing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, get_type_hints

from helibore._core import __version__
from helibore.base.atomic_file import write_whole
from helibore.base.errors import InputError, check_choice
from helibore.base.nulls import NULLS
from helibore.base.toml_file import read_toml
from helibore.channels.roles import ROLES, Role, RoleMap
from helibore.images.sector_image import Origin
from helibore.preparation.conditioning import Echo
from helibore.preparation.prepare import Preparation
from helibore.settings.wall_settings import Settings
from helibore.trajectory.references import Reference
from helibore.trajectory.survey import Method

SOURCES = ("caliper", "average", "archive", "gauge")
"""Keys of the sources of a wall; each run has exactly one of them."""


@dataclass(frozen=True)
class Input:
    """A file that was read: its checksum, the set, and the role of every channel that was used."""

    file: Path
    blake2b: str = ""  # checksum of its bytes, in hexadecimal; "" while not known
    set: str | None = None  # None: the only set of the file
    channel: tuple[Role, ...] = ()
    header_line: int | None = None  # the line of a table's column names, if it was stated

    def __post_init__(self) -> None:
        for role in self.channel:
            check_choice(f"channel {role.channel}: role", role.role, ROLES)

    @property
    def roles(self) -> RoleMap:
        return RoleMap(self.set, {role.channel: role for role in self.channel})


@dataclass(frozen=True)
class ImageInput:
    """A sector image that was read; if ``reference`` is None, its toolfaces count from the reference of the wall."""

    file: Path
    name: str
    origin: Origin
    blake2b: str = ""
    reference: Literal["north", "high-side"] | None = None
    header_line: int | None = None


@dataclass(frozen=True)
class ScalarInput:
    """A channel along the hole that was read to be drawn in a track of its own."""

    file: Path
    name: str
    blake2b: str = ""
    header_line: int | None = None


@dataclass(frozen=True)
class Output:
    """The file that was written, and the checksum of its bytes."""

    file: Path
    blake2b: str


@dataclass(frozen=True, kw_only=True)
class PathSettings:
    """Settings of a path; see `helibore.Survey.path`.

    Without a survey, ``reference`` states the direction of toolface 0 of the wall. None: the high side if there is a
    path, else not known.
    """

    method: Method = "minimum-curvature"
    reference: Reference | None = None
    head: tuple[float, float, float] = (0.0, 0.0, 0.0)
    extend: float = 0.0


@dataclass(frozen=True, kw_only=True)
class RunSettings:
    """Everything that decides the bytes of an output."""

    helibore: str = field(default_factory=lambda: __version__)  # the version that wrote these settings
    verb: str = field(default_factory=lambda: "reconstruct")  # the command
    nulls: tuple[float, ...] = field(default_factory=lambda: NULLS)  # numbers that mean no value
    gauge: bool = False  # whether the wall is a gauge hole, which was not measured
    output: Output | None = None  # the file that was written; None before that
    caliper: tuple[Input, ...] = ()  # caliper files of one hole, earliest first
    average: Input | None = None  # an average caliper, with a channel of the role mean-diameter
    archive: Input | None = None  # the archive of a wall
    track: Input | None = None  # depth and toolface by time
    survey: Input | None = None
    image: tuple[ImageInput, ...] = ()
    scalar: tuple[ScalarInput, ...] = ()  # curves of a print or report
    echo: Echo | None = None  # how travel times become radii
    preparation: Preparation = field(default_factory=Preparation)
    path: PathSettings = field(default_factory=PathSettings)  # how the survey becomes a path
    wall: Settings | None = None  # settings of the wall; None for an archive
    options: dict[str, Any] = field(default_factory=dict)  # the command's own options by name

    def __post_init__(self) -> None:
        if sum(bool(getattr(self, name)) for name in SOURCES) != 1:
            raise InputError(", ".join(SOURCES), "give exactly one of them")
        if (self.wall is None) != (self.archive is not None):
            raise InputError("wall", "must be left out for an archive" if self.archive else "is missing")

    @property
    def inputs(self) -> tuple[Input | ImageInput | ScalarInput, ...]:
        """Every file that the run reads, except role maps."""
        placing = (one for one in (self.track, self.survey) if one is not None)
        return (*self.shown, *placing)

    @property
    def shown(self) -> tuple[Input | ImageInput | ScalarInput, ...]:
        """The files whose values are shown, without survey and track; picks are saved beside the first of them."""
        alone = (one for one in (self.average, self.archive) if one is not None)
        return (*self.caliper, *alone, *self.image, *self.scalar)


def settings_file(output: str | os.PathLike[str]) -> Path:
    """Return the file of the settings of an output: ``wall.glb.toml`` beside ``wall.glb``."""
    output = Path(output)
    return output.with_name(f"{output.name}.toml")


def write_settings(path: str | os.PathLike[str], settings: RunSettings) -> None:
    """Write settings as TOML; after an error, the file is as it was before."""
    import tomli_w

    path = Path(path)
    first = f"# To repeat this run: helibore {settings.verb} {path.name} -o OUTPUT\n"
    content = (first + tomli_w.dumps(_tree(settings, path.resolve().parent))).encode()
    write_whole(path, lambda file: file.write(content))


COMPLETE = (Settings, Preparation, PathSettings, Echo)
"""Groups whose defaults are written; defaults of other groups are left out."""


def _tree(value: Any, folder: Path) -> Any:
    """Return a value as TOML can hold it: tables, lists, names of files relative to ``folder``, "none" for None."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        tree = {}
        for each in dataclasses.fields(value):
            found = getattr(value, each.name)
            usual = found == each.default if not isinstance(value, COMPLETE) else found is None and each.default is None
            if not usual and found != {}:
                tree[each.name] = _tree(found, folder)
        return tree
    if isinstance(value, dict):
        return {name: _tree(one, folder) for name, one in value.items()}
    if isinstance(value, tuple | list):
        return [_tree(one, folder) for one in value]
    if isinstance(value, Path):
        try:
            return Path(os.path.relpath(value.resolve(), folder)).as_posix()
        except ValueError:  # on another drive
            return value.resolve().as_posix()
    return "none" if value is None else value


def read_settings(path: str | os.PathLike[str]) -> RunSettings:
    """Read the settings of a run. File names become paths from the working folder; no file is opened.

    Raise InputError if a setting breaks its rule; the error names the file, the table, the key and the rule.
    """
    path = Path(path)
    reader = _Reader(path.name, path.parent)
    return typing.cast(RunSettings, reader.group("", RunSettings, read_toml(path, path.name)))


def run_settings(tree: dict[str, Any], place: str) -> RunSettings:
    """Return settings from the tables of a settings file; every error begins with ``place``."""
    return typing.cast(RunSettings, _Reader(place, Path()).group("", RunSettings, {"helibore": __version__} | tree))


class _Reader:
    """Turns a TOML tree into the types that the dataclasses state; every error names the place of the wrong value."""

    def __init__(self, name: str, folder: Path) -> None:
        self.name, self.folder = name, folder

    def error(self, place: str, rule: str, value: Any = dataclasses.MISSING) -> InputError:
        shown = None if value is dataclasses.MISSING else repr(value)
        return InputError(f"{self.name}: {place}" if place else self.name, rule, shown)

    def group(self, place: str, kind: type[Any], tree: Any) -> Any:
        if not isinstance(tree, dict):
            raise self.error(place, "must be a table")
        hints, dot = get_type_hints(kind), f"{place}." if place else ""
        for key in tree:
            if key not in hints:
                raise self.error(f"{dot}{key}", f"must be one of {', '.join(hints)}")
        for each in dataclasses.fields(kind):
            needed = each.default is dataclasses.MISSING and each.default_factory is dataclasses.MISSING
            if (needed and each.name not in tree) or (kind is RunSettings and "helibore" not in tree):
                raise self.error(f"{dot}{each.name}", "is missing")
        values = {key: self.value(f"{dot}{key}", hints[key], value) for key, value in tree.items()}
        try:
            return kind(**values)
        except InputError as error:
            raise error.within(f"{self.name}: {place}" if place else self.name) from error
        except ValueError as error:
            raise self.error(place, str(error)) from error

    def value(self, place: str, hint: Any, value: Any) -> Any:
        """Return a value of TOML as the type ``hint`` states; "none" stands for None where None is allowed."""
        kinds = typing.get_args(hint) if typing.get_origin(hint) in (types.UnionType, typing.Union) else (hint,)
        if value == "none" and type(None) in kinds:
            return None
        (kind,) = (one for one in kinds if one is not type(None))
        origin = typing.get_origin(kind) or kind
        if dataclasses.is_dataclass(kind):
            return self.group(place, typing.cast(type[Any], kind), value)
        if origin is tuple:
            return self.tuple_of(place, typing.get_args(kind), value)
        if origin is Path and isinstance(value, str):
            return self.folder / value
        if origin is float and type(value) is int:
            return float(value)
        known = typing.get_args(kind) if origin is Literal else ()
        if type(value) is origin or value in known:
            return value
        rule = f"one of {', '.join(known)}" if known else RULES[origin]
        raise self.error(place, f"must be {rule}", value)

    def tuple_of(self, place: str, parts: tuple[Any, ...], value: Any) -> tuple[Any, ...]:
        """Return a list of TOML as a tuple of the types ``parts``; places of tables are counted from 1."""
        endless, tables = parts[-1] is Ellipsis, dataclasses.is_dataclass(parts[0])
        if not isinstance(value, list) or not (endless or len(parts) == len(value)):
            if tables:
                raise self.error(place, f"must be tables, [[{place}]]")
            raise self.error(place, "must be a list" if endless else f"must be a list of {len(parts)}", value)
        kinds = [parts[0]] * len(value) if endless else parts
        places = [f"{place} {number}" if tables else place for number in range(1, len(value) + 1)]
        return tuple(map(self.value, places, kinds, value))


RULES = {
    float: "a number", int: "a whole number", str: "text", bool: "true or false", Path: "the name of a file",
    dict: "a table",
}  # fmt: skip
