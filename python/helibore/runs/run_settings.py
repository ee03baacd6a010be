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
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from helibore._core import __version__
from helibore.base.atomic_file import write_whole
from helibore.base.errors import InputError, check_choice
from helibore.base.nulls import NULLS
from helibore.channels.roles import ROLES, Role, RoleMap
from helibore.images.sector_image import Origin
from helibore.settings.path_settings import PathSettings
from helibore.settings.preparation_settings import Echo, Preparation
from helibore.settings.toml_reading import TomlSource, read_table
from helibore.settings.wall_settings import Settings

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
    source, tree = TomlSource.load(Path(path))
    if "helibore" not in tree:
        raise InputError(f"{source.name}: helibore", "is missing")
    return read_table(RunSettings, tree, source)


def run_settings(tree: dict[str, Any], place: str) -> RunSettings:
    """Return settings from the tables of a settings file; every error begins with ``place``."""
    return read_table(RunSettings, tree, TomlSource(place, recorded=True))
