"""The project: a TOML file that holds a well, by hand as ``well.toml``, or as helibore writes it beside each output.

    caliper = ["run1.las", "run2.las"]                one well, in one file, for every command
    survey = "survey.csv"
    [header]        company = "ACME"
    [columns]       diameter = ["x_in@0", "y_in@90"]  where the guess is wrong; or a table of a file has a ``map``
    [preparation]   spikes = 6
    [wall]          bit_diameter = "8 1/2in"
    [zones]         washout = "0.3in"
    [print]         scale = 200

What helibore writes beside an output has the same tables, with every guess, default and checksum filled in, so that it
repeats the output to the last bit, also in a later version with other defaults:

    helibore = "0.1.0"          verb = "mesh"         nulls = [-999.25, -9999.0, -9999.25]
    [output]                    file = "wall.glb"     blake2b = "..."
    [[caliper]]                 file = "run1.csv"     blake2b = "..."    set = "MAIN"
    [[caliper.channel]]         channel = "md_m"      role = "depth"     unit = "m" ...
    [average] [archive] [survey] [track]              one file each, like a caliper; or gauge = true
    [[image]]                   file = "gr.las"       blake2b = "..."    name = "GR"    origin = "edge"
    [[scalar]]                  file = "gr.las"       blake2b = "..."    name = "RT"

Files are named relative to the project. What the command line states counts over the project, and the project over what
an archive keeps. ``helibore.runs.run`` has the run itself.
"""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

from helibore.base.atomic_file import write_whole
from helibore.base.errors import InputError, check_choice
from helibore.base.nulls import NULLS
from helibore.channels.roles import ROLES, Role, RoleMap
from helibore.images.sector_image import Origin
from helibore.runs.former_options import with_tables
from helibore.settings.cement_settings import CementTable
from helibore.settings.column_settings import Columns
from helibore.settings.declared import FINITE, METRES, Declared, Stated
from helibore.settings.header_settings import Header
from helibore.settings.interval_settings import CHECKSUM, IntervalInput
from helibore.settings.output_settings import (
    LogSettings,
    MeshSettings,
    PassageSettings,
    StressSettings,
    ViewSettings,
)
from helibore.settings.path_settings import PathSettings
from helibore.settings.preparation_settings import Echo, Preparation
from helibore.settings.print_settings import Look, PrintTable
from helibore.settings.reading_settings import ReadingSettings
from helibore.settings.toml_reading import TomlSource, read_table
from helibore.settings.wall_settings import Settings
from helibore.settings.zone_settings import ImageCriteria, ZoneSettings

SOURCES = ("caliper", "average", "archive", "gauge")
"""Keys of the sources of a wall; each run has exactly one of them."""

FILES = ("caliper", "average", "archive", "image", "scalar", "intervals", "track", "survey")
"""Keys of a project that name files."""

SHOWN = ("header", "zones", "image_zones", "print", "look", "logs", "passage")
"""Tables that say how a wall is shown; an archive keeps them."""


@dataclass(frozen=True)
class Input(Declared):
    """A file that is read, and the role of every channel that is used."""

    file: Annotated[Path, "File, relative to the project."]
    blake2b: Annotated[str, CHECKSUM, "Checksum of its bytes, in hexadecimal; a file with other bytes is refused."] = ""
    set: Annotated[str | None, "Set of the file. None: its only set."] = None
    channel: Annotated[tuple[Role, ...], "Roles of the channels. None: they are guessed."] = ()
    header_line: Annotated[int | None, "Line of a table's column names. None: helibore finds it."] = None
    map: Annotated[Path | None, "Map of the roles of the channels, as `helibore inspect` prints it."] = None

    def _check(self) -> None:
        for role in self.channel:
            check_choice(f"channel {role.channel}: role", role.role, ROLES)

    @property
    def roles(self) -> RoleMap:
        return RoleMap(self.set, {role.channel: role for role in self.channel})


@dataclass(frozen=True)
class ImageInput(Declared):
    """A sector image that is read."""

    file: Annotated[Path, "File, relative to the project."]
    name: Annotated[str, "Channel."]
    origin: Annotated[Origin, "What of sector 1 lies at toolface 0."]
    blake2b: Annotated[str, CHECKSUM, "Checksum of the file's bytes, in hexadecimal."] = ""
    reference: Annotated[Literal["high-side", "north"] | None,
        "What its toolfaces count from. None: from the reference of the wall.",
    ] = None  # fmt: skip
    header_line: Annotated[int | None, "Line of a table's column names. None: helibore finds it."] = None


@dataclass(frozen=True)
class ScalarInput(Declared):
    """A channel along the hole that is drawn in a track of its own."""

    file: Annotated[Path, "File, relative to the project."]
    name: Annotated[str, "Channel."]
    blake2b: Annotated[str, CHECKSUM, "Checksum of the file's bytes, in hexadecimal."] = ""
    header_line: Annotated[int | None, "Line of a table's column names. None: helibore finds it."] = None


AnyInput = Input | ImageInput | ScalarInput | IntervalInput


@dataclass(frozen=True)
class Output(Declared):
    """The file that was written."""

    file: Annotated[Path, "File, relative to the project."]
    blake2b: Annotated[str, CHECKSUM, "Checksum of its bytes, in hexadecimal."]


@dataclass(frozen=True, kw_only=True)
class Project(Declared):
    """A well: its files, and everything that decides the bytes of an output."""

    helibore: Annotated[str, "Version that wrote the file; a file that a person writes has none."] = ""
    verb: Annotated[str, "Command that wrote the file."] = field(default_factory=lambda: "reconstruct")
    nulls: Annotated[tuple[float, ...], "Numbers that mean no value."] = field(default_factory=lambda: NULLS)
    gauge: Annotated[bool, "Whether the wall is a gauge hole, which was not measured."] = False
    output: Annotated[Output | None, "File that was written. None: none yet."] = None
    start_depth: Annotated[float | None, METRES, FINITE, "Start of what is shown. None: top of the wall."] = None
    stop_depth: Annotated[float | None, METRES, FINITE, "End of what is shown. None: bottom of the wall."] = None
    caliper: Annotated[tuple[Input, ...], "Caliper files of one hole, earliest first."] = ()
    average: Annotated[Input | None, "Average caliper."] = None
    archive: Annotated[Input | None, "Archive of a wall."] = None
    track: Annotated[Input | None, "Depth and toolface by time."] = None
    survey: Annotated[Input | None, "Survey. None: the hole is straight and vertical."] = None
    image: Annotated[tuple[ImageInput, ...], "Images."] = ()
    scalar: Annotated[tuple[ScalarInput, ...], "Curves of a print or report."] = ()
    intervals: Annotated[tuple[IntervalInput, ...], "Formation tops, casings, mud logs; else the archive's."] = ()
    columns: Annotated[Columns, "Columns of the files."] = field(default_factory=Columns)
    reading: Annotated[ReadingSettings, "How files are read."] = field(default_factory=ReadingSettings)
    echo: Annotated[Echo | None, "How travel times become radii."] = None
    preparation: Annotated[Preparation, "Preparation of the samples."] = field(default_factory=Preparation)
    path: Annotated[PathSettings, "How the survey becomes a path."] = field(default_factory=PathSettings)
    wall: Annotated[Settings | None, "Settings of the wall; an archive has its own."] = None
    header: Annotated[dict[str, Any], Stated(Header), "Header."] = field(default_factory=dict)
    zones: Annotated[dict[str, Any], Stated(ZoneSettings), "Criteria of zones."] = field(default_factory=dict)
    image_zones: Annotated[dict[str, Any], Stated(ImageCriteria), "Criteria of breakouts in images."] = field(
        default_factory=dict
    )
    print: Annotated[dict[str, Any], Stated(PrintTable), "Prints and reports."] = field(default_factory=dict)
    look: Annotated[dict[str, Look], "Colours of images and scales of curves."] = field(default_factory=dict)
    logs: Annotated[dict[str, Any], Stated(LogSettings), "Tables of logs and zones."] = field(default_factory=dict)
    passage: Annotated[dict[str, Any], Stated(PassageSettings), "What passes through the hole."] = field(
        default_factory=dict
    )
    stress: Annotated[dict[str, Any], Stated(StressSettings), "Direction of the greatest horizontal stress."] = field(
        default_factory=dict
    )
    cement: Annotated[dict[str, Any], Stated(CementTable), "Cement of a casing."] = field(default_factory=dict)
    mesh: Annotated[dict[str, Any], Stated(MeshSettings), "Meshes."] = field(default_factory=dict)
    view: Annotated[dict[str, Any], Stated(ViewSettings), "The page in the browser."] = field(default_factory=dict)

    def _check(self) -> None:
        if sum(bool(getattr(self, name)) for name in SOURCES) != 1:
            raise InputError(", ".join(SOURCES), "give exactly one of them")
        if (self.wall is None) != (self.archive is not None):
            raise InputError("wall", "must be left out for an archive" if self.archive else "is missing")

    def files(self, key: str) -> tuple[AnyInput, ...]:
        """Return the files of one of `FILES`, in order."""
        value = getattr(self, key)
        return value if isinstance(value, tuple) else () if value is None else (value,)

    @property
    def inputs(self) -> tuple[AnyInput, ...]:
        """Every file that the run reads, except role maps."""
        return tuple(one for key in FILES for one in self.files(key))

    @property
    def shown(self) -> tuple[AnyInput, ...]:
        """The files whose values are shown: all but intervals, track and survey; picks are beside the first."""
        return tuple(one for key in FILES[:-3] for one in self.files(key))


def project_file(output: str | os.PathLike[str]) -> Path:
    """Return the project of an output: ``wall.glb.toml`` beside ``wall.glb``."""
    output = Path(output)
    return output.with_name(f"{output.name}.toml")


def write_project(path: str | os.PathLike[str], project: Project) -> None:
    """Write a project as TOML; after an error, the file is as it was before."""
    import tomli_w

    path = Path(path)
    first = f"# To repeat this run: helibore {project.verb} {path.name} -o OUTPUT\n"
    content = (first + tomli_w.dumps(_tree(project, path.resolve().parent))).encode()
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
            if not usual and found not in ({}, Columns(), ReadingSettings()):
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


def read_project(path: str | os.PathLike[str] | None, over: Mapping[str, Any] | None = None) -> Project:
    """Read a project. File names become paths from the working folder; no file is opened.

    ``over`` holds what counts over the file, by key; a mapping for a table. Without a file, it is the whole project.
    Raise InputError if a setting breaks its rule; the error names file, line, table, key and rule.
    """
    source, tree = (TomlSource(""), {}) if path is None else TomlSource.load(Path(path))
    tree = with_tables(tree, source) if source.recorded else tree
    over = dict(over or {})
    of_intervals = over.pop("intervals", ())
    if not isinstance(of_intervals, Mapping):
        over |= {"intervals": of_intervals} if of_intervals else {}
        of_intervals = {}
    if "archive" in tree or "archive" in over:
        over.pop("wall", None)
    else:
        over.setdefault("wall", {})  # an error names the setting that is missing
    project = read_table(Project, tree, source, over=over)
    template = project.print.get("template")
    named = {"template": source.folder / template} if isinstance(template, str) else {}
    if of_intervals and not project.intervals:
        raise InputError("intervals", "name a file of them", setting="intervals.file")
    intervals = tuple(dataclasses.replace(one, **of_intervals) for one in project.intervals)
    return dataclasses.replace(project, intervals=intervals, print=project.print | named)


def project_of(tree: dict[str, Any], place: str) -> Project:
    """Return a project from its tables; every error begins with ``place``."""
    source = TomlSource(place, recorded=True)
    return read_table(Project, with_tables(tree, source), source)


def shown_tables(tables: Any, place: str) -> dict[str, dict[str, Any]]:
    """Return what the tables of a project state that say how a wall is shown; errors begin with ``place``."""
    read = project_of({**tables, "gauge": True, "wall": {"bit_diameter": 1.0}}, place)
    return {name: getattr(read, name) for name in SHOWN if getattr(read, name)}
