"""Define the options that turn files into a wall, the same in every command, in `takes_a_wall` and `open_run`.

    well.wall                                   an archive, as `Wall.save` wrote it
    run1.csv run2.csv --bit-diameter 8.5in      caliper files, prepared and rebuilt
    --average log.las:CALI --bit-diameter ...   an average caliper: the size is measured, the shape is assumed round
    --gauge --bit-diameter ... --image ...      a hole at bit size, not measured, on which images are shown
    well.toml                                   a project, written by hand, or by helibore as wall.glb.toml

What a channel means is guessed from names and units; ``--map`` overrules the guess, and ``--column`` overrules both. A
column is NAME[@ANGLE][:UNIT]: md_m, rb:deg, x_in@0, CAL1@90:in.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from helibore.base.errors import InputError
from helibore.base.file_endings import ARCHIVE_ENDING, SURFACE_ENDINGS, VOLUME_ENDINGS
from helibore.base.units import size_text
from helibore.cli.declared_options import option_of, options_of, stated
from helibore.cli.quantities import FILE, LENGTH
from helibore.cli.sections import COLUMN, SETTING, Command, SectionOption, opt, opts, section, spelled
from helibore.cli.set_names import set_names, sets_of_calipers
from helibore.settings.declared import members
from helibore.settings.header_settings import Header
from helibore.settings.interval_settings import IntervalInput
from helibore.settings.path_settings import PathSettings
from helibore.settings.preparation_settings import Echo, Preparation
from helibore.settings.print_settings import PrintTable
from helibore.settings.reading_settings import ReadingSettings
from helibore.settings.wall_settings import Settings

if TYPE_CHECKING:
    from helibore.cli.terminal import Terminal
    from helibore.logs.curves import ScalarCurve
    from helibore.runs.project import ImageInput, Input, Project, ScalarInput
    from helibore.runs.run import OpenFiles, Run
    from helibore.settings.template import Template
    from helibore.wall.wall import Wall

PROJECT = ".toml"
INCLINATION = "inclination"
"""The name of the scalar track that needs no file, because it comes from the survey."""


SENSORS = (
    "sensor_offset", "latency", "toolface_from", "declination", "convergence", "steep", "level",
)  # fmt: skip
"""Settings of the preparation that concern the sensors."""

BY_PASS = ("reversal", "passes", "latest", "shifts", "toolface_shifts", "find_shifts", "bias", "earlier")
"""Settings of the preparation that concern the passes."""

APART = (*SENSORS, *BY_PASS)
"""Settings of the preparation that are not in the section of its steps."""

STATED_APART = ("bit_diameter", "start_depth", "stop_depth", "sigma")
"""Settings of the wall whose options stand in other sections."""

ECHO = {
    "velocity": "mud_velocity", "tool_radius": "tool_radius", "window": "echo_window",
    "velocity_sigma": "mud_velocity_sigma", "casing": "echo_casing", "casing_sigma": "echo_casing_sigma",
}  # fmt: skip
"""Parameters of the conversion of travel times, by the names of the settings."""


def _renamed(option: tuple[str, dict[str, Any]], name: str) -> tuple[str, dict[str, Any]]:
    """Return an option with another name of its parameter, because settings of two groups have the same name."""
    return f"--{name.replace('_', '-')} {name}", option[1]


SECTIONS: dict[str, tuple[tuple[str, dict[str, Any]], ...]] = {
    "Source": (
        *options_of(Settings, "bit_diameter"),
        opt("--average", "Average caliper in place of SOURCE; the shape is assumed round.", metavar="FILE:CHANNEL"),
        opt("--gauge", "Gauge hole in place of SOURCE, which only carries images.", is_flag=True),
        opts("--image", "Image FILE:CHANNEL:ORIGIN[:REFERENCE]; ORIGIN, centre or edge of sector 1, lies at toolface 0 "
             "of REFERENCE, north or high-side.  [the wall's reference]", metavar="IMAGE"),
        opts("--intervals", "Formation tops, casings or a mud log (CSV, Petrel).  [those of the archive]", type=FILE),
        *(_renamed(option_of(members(IntervalInput)[name]), f"intervals_{name}") for name in ("well", "unit")),
        opt("--from start_depth", "Start depth.  [top of the wall]", type=LENGTH),
        opt("--to stop_depth", "Stop depth.  [bottom of the wall]", type=LENGTH),
    ),
    "Columns": (
        opts("--map maps", "Roles of the channels as TOML (see helibore inspect), for all files or for each.",
             type=FILE),
        opts("--set sets", "Sets of a file that holds several, each a pass: names, numbers (2,5-8) or with=COLUMNS.",
             metavar="SETS"),
        opt("--depth", "NAME[:UNIT] of the depth.", metavar="COLUMN"),
        opt("--toolface", "NAME[:UNIT] of the toolface or relative bearing.", metavar="COLUMN"),
        opts("--radius", "NAME[@ANGLE][:UNIT] of a radius; ANGLE is where on the tool the arm is mounted.",
             metavar="COLUMN"),
        opts("--diameter", "NAME[@ANGLE][:UNIT] of a diameter, which counts for both sides.", metavar="COLUMN"),
        opt("--time", "NAME[:UNIT] of the time.", metavar="COLUMN"),
        opts("--travel-time", "NAME[@ANGLE][:UNIT] of an echo's travel time.", metavar="COLUMN"),
        opts("--header-line header_lines", "Line of the column names of a table (CSV, XLSX): LINE for SOURCE, "
             "FILE=LINE for any other file.  [helibore finds it]", metavar="[FILE=]LINE"),
        opts("--absent", "Number that means no value, besides -999.25, -9999, -9999.25.", type=float),
    ),
    "Reading": tuple(options_of(ReadingSettings)),
    "Sensors": (
        opt("--track", "File with depth (and toolface) by time.", type=FILE),
        opt("--track-map", "Roles of the channels of the --track file, as TOML.", type=FILE),
        *options_of(Preparation, *(name for name in members(Preparation) if name in SENSORS)),
        *(_renamed(option_of(member), ECHO[name]) for name, member in members(Echo).items()),
    ),
    "Conditioning": tuple(options_of(Preparation, *(name for name in members(Preparation) if name not in APART))),
    "Passes": tuple(options_of(Preparation, *(name for name in members(Preparation) if name in BY_PASS))),
    "Path and toolface": (
        opt("--survey", "Survey file.  [the hole is straight and vertical]", type=FILE),
        opt("--survey-map", "Roles of the channels of the survey file, as TOML.", type=FILE),
        opt("--survey-set", "Set of the survey file, if it holds several.", metavar="NAME"),
        opt("--survey-depth", "NAME[:UNIT] of the stations' depth.", metavar="COLUMN"),
        opt("--inclination", "NAME[:UNIT] of the inclination.", metavar="COLUMN"),
        opt("--azimuth", "NAME[:UNIT] of the azimuth.", metavar="COLUMN"),
        *options_of(PathSettings),
    ),
    "Wall": (
        *(option_of(member) for name, member in members(Settings).items() if name not in STATED_APART),
        opt("--tune", "Find estimator, angular scale and nugget by leaving samples out.", is_flag=True),
        opt("--threads", "Number of threads.  [all cores]", type=int),
    ),
}  # fmt: skip
"""Every option of a wall, by section of the help."""

ANYWHERE = (
    "image", "intervals", "intervals_well", "intervals_unit", "header_lines", "start_depth", "stop_depth", "threads",
)  # fmt: skip
"""Options that also go with an archive, although it has its own settings of the wall."""


INTERVAL = ("start_depth", "stop_depth")
"""Options of the interval: of the wall, if it is made from samples; else of what is shown."""

SHOWN = (
    "bit_diameter", "survey", "column", "maps", "image", "intervals", "average", "gauge", "start_depth", "stop_depth",
)  # fmt: skip
"""Parameters of a wall that have an option of their own in every command that shows a wall."""

MADE = (
    *SHOWN, "sets", "track", "spikes", "recentre", "passes", "latest", "shifts", "find_shifts", "bias", "earlier",
    "sectors", "pitch", "estimator", "tune", "threads",
)  # fmt: skip
"""Parameters of a wall that have an option of their own in the command that makes a wall."""


def takes_a_wall(command: Command) -> Command:
    """Give a command the argument SOURCE and the options that say how to make a wall from it."""
    for name in reversed(SECTIONS):
        command = section(name, *SECTIONS[name])(command)
    command = section("Source", COLUMN)(section("Options", SETTING)(command))
    return click.argument("source", type=FILE, nargs=-1)(command)


def open_run(options: dict[str, Any], terminal: Terminal, outputs: Sequence[Path] = ()) -> Run:
    """Open the files that the options of `takes_a_wall` name, and return the run, ready for `make_wall`.

    An output is refused if that file, or the file of its settings, is a file that the run reads.
    """
    _check_source(options)
    given = next(iter(options["source"]), None)
    file = given if given is not None and given.suffix.lower() == PROJECT else None
    with terminal.stage("import", "Loading helibore"):
        from helibore.runs.project import project_file
    with terminal.stage("read", "Opening files"):
        run = _opened(options, file)
        read = [*([file] if file else []), *(each.file for each in run.settings.inputs)]
        _check_outputs(outputs, read, project_file)
    return run


def refuse_interval(run: Run, options: dict[str, Any]) -> None:
    """Refuse --from and --to for a saved wall, which a command shows whole."""
    if run.settings.archive is not None or run.settings.output is not None:
        for name in ("start_depth", "stop_depth"):
            if options[name] is not None:
                raise click.UsageError(f"{spelled(name)}: does not go with a saved wall, which is shown whole")


def load_picks(run: Run, file: Path | None) -> Path | None:
    """Give the wall the picks of ``file``, if it exists; None: the picks beside the first file that the run shows.

    Return the file of the picks, which need not exist yet; None if ``file`` is None and the run shows no file. A survey
    does not count as shown.
    """
    from helibore.logs.picks import ENDING, Picks

    if file is None:
        first = next(iter(run.settings.shown), None)
        if first is None:
            return None
        file = first.file.with_name(f"{first.file.name}{ENDING}")
    if file.exists():
        run.wall.picks = Picks.load(file, run.wall.path)
        run.messages.append(("picks", f"{len(run.wall.picks)} of {file.name}"))
    elif run.wall.picks and run.settings.archive is not None:
        ours = f"{len(run.wall.picks)} of {run.settings.archive.file.name}{ENDING}"
        run.messages.append(("picks", f"{ours}, as {file.name} does not exist yet"))
    return file


def picks_option(*, exists: bool) -> Any:
    """Return the option ``--picks``. ``exists``: the table must exist already."""
    text = "Table of the picks (CSV).  [FILE.picks.csv beside the first file shown]"
    return opt("--picks", text, type=click.Path(exists=exists, dir_okay=False, path_type=Path))


TEMPLATE = opt("--template", "TOML file of tracks, widths, units and scale, as the viewer saves it.",
               type=FILE)  # fmt: skip
BESIDE = option_of(members(PrintTable)["beside"])
SCALAR = opts(
    "--scalar",
    f"Curve FILE:CHANNEL in a track of its own; {INCLINATION}: that of the survey.",
    metavar="CURVE",
)


def walls_beside(options: dict[str, Any]) -> dict[str, Wall]:
    """Load the walls of ``--beside``; return them by the names of their files without the last ending."""
    from helibore.wall.load import load

    files = {Path(file).stem: Path(file) for file in options["beside"]}
    if len(files) < len(options["beside"]):
        raise click.UsageError("--beside: two files have the same name")
    return {name: load(file) for name, file in files.items()}


def curves_of_files(run: Run, options: dict[str, Any]) -> list[ScalarCurve]:
    """Return the curves of ``--scalar``: one for each file in the settings, and the inclination if it is named."""
    curves = [_curve(one, run) for one in run.settings.scalar]
    return [*curves, *(_inclination(run) for text in options["scalar"] if text == INCLINATION)]


def _inclination(run: Run) -> ScalarCurve:
    import numpy as np

    from helibore.logs.curves import ScalarCurve

    path = run.wall.path
    if path is None:
        raise click.UsageError(f"--scalar {INCLINATION}: needs --survey")
    depth = np.linspace(path.start_depth, path.stop_depth, 1000)
    values = np.degrees(np.arccos(np.clip(path.tangent(depth)[:, 2], -1.0, 1.0)))
    return ScalarCurve("Inclination", "deg", depth, values)


def _curve(one: ScalarInput, run: Run) -> ScalarCurve:
    """Read a curve along the hole from its file, sorted by depth."""
    import numpy as np

    from helibore.channels.columns import depths
    from helibore.channels.roles import guess
    from helibore.logs.curves import ScalarCurve

    log = run.files.log(one.file).set()
    depth = depths(log, guess(log))[1]
    if log.channel(one.name).shape != depth.shape:
        rule = f"has {log[one.name].shape[1]} values a row: a curve has one value a row"
        raise InputError(f"{log.path.name}, column {one.name}", rule)
    values = log.numbers(one.name)
    order = np.argsort(depth, kind="stable")
    order = order[np.isfinite(depth[order])]
    return ScalarCurve(one.name, log[one.name].unit, depth[order], values[order])


def header_of(run: Run, options: dict[str, Any]) -> dict[str, str]:
    """Return the entries of a log's header by name; entries of the options replace those of the run's files."""
    from helibore.runs.run import stated_header

    found = stated_header(run) | options["header"]
    found |= {"well": options["well"]} if options["well"] else {}
    return {name: found[name] for name in members(Header) if found.get(name)}


def template_of_option(template: Path | dict[str, Any] | None) -> Template | None:
    """Return the template of a file, or the one that a project or an archive holds itself."""
    from helibore.settings.template import Template
    from helibore.settings.toml_reading import TomlSource, read_table

    if isinstance(template, dict):
        return read_table(Template, template, TomlSource("template", recorded=True))
    return None if template is None else Template.load(template)


def _check_outputs(outputs: Sequence[Path], inputs: Sequence[Path], project_file: Callable[[Path], Path]) -> None:
    for output in outputs:
        for file in inputs:
            if file.resolve() in (output.resolve(), project_file(output).resolve()):
                raise InputError(str(output), f"would overwrite {file}, from which it is made")


def _check_source(options: dict[str, Any]) -> None:
    """Refuse a mesh as source, no source, several kinds of source, and options that would have no effect."""
    source = options["source"]
    endings = {file.suffix.lower() for file in source}
    for file in source:
        if file.suffix.lower() in (*SURFACE_ENDINGS, *VOLUME_ENDINGS):
            settings_beside = file.with_name(f"{file.name}{PROJECT}")
            instead = f"its settings, {settings_beside.name}, a saved .wall, or the caliper file"
            instead = f"the settings beside it, {settings_beside.name}" if settings_beside.is_file() else instead
            raise InputError(file.name, f"a mesh has no samples; use {instead}")
    if bool(source) + (options["average"] is not None) + options["gauge"] != 1:
        one = "exactly one of SOURCE, --average and --gauge"
        raise click.UsageError(f"give {one}")
    if len(source) > 1 and endings & {ARCHIVE_ENDING, PROJECT}:
        raise click.UsageError("several SOURCE files must all be caliper files, not archives or settings")
    if not endings & {ARCHIVE_ENDING, PROJECT}:
        _check_numbers(options)


def _archive(options: dict[str, Any]) -> Path | None:
    return next((file for file in options["source"] if file.suffix.lower() == ARCHIVE_ENDING), None)


def _check_effect(gauge: bool, average: object, archive: Path | None) -> None:
    """Refuse options that have no effect on a gauge hole, an average caliper or an archive."""
    of_calipers = ("Columns", "Sensors", "Conditioning", "Passes")
    if gauge:
        _refuse(of_calipers, ("absent", "header_lines"), "--gauge, which reads no caliper")
    elif average:
        of_average = ("absent", "sets", "header_lines", "least_radius", "greatest_radius")
        _refuse(of_calipers, of_average, "--average, which names its channel")
    elif archive is not None:
        sections = tuple(name for name in SECTIONS if name != "Path and toolface")
        _refuse(sections, ("source", "absent", *ANYWHERE), f"{archive.name}, which has its own settings")


def _refuse(sections: Sequence[str], allowed: Sequence[str], source: str) -> None:
    """Refuse options of ``sections`` on the command line, except ``allowed``; they have no effect on this source."""
    context = click.get_current_context()
    for parameter in context.command.params:
        if not isinstance(parameter, SectionOption) or parameter.section not in sections or not parameter.expose_value:
            continue
        if on_command_line(parameter.name or "") and parameter.name not in allowed:
            raise click.UsageError(f"{parameter.spelled}: does not go with {source}")


def on_command_line(name: str) -> bool:
    return click.get_current_context().get_parameter_source(name) is ParameterSource.COMMANDLINE


def _check_numbers(options: dict[str, Any]) -> None:
    chosen = [
        name for name in ("estimator", "angular_scale", "nugget", "neighbors", "kriging_range") if on_command_line(name)
    ]
    if options["tune"] and chosen:
        raise click.UsageError(f"{spelled(chosen[0])}: does not go with --tune, which finds it")
    start, stop = options["start_depth"], options["stop_depth"]
    if start is not None and stop is not None and not start < stop:
        raise InputError(f"--to {stop:g} m", f"must be deeper than --from {start:g} m")
    if options["reference"] not in (None, "north", "high-side") and options["survey"] is None:
        raise click.UsageError(f"-s path.reference={options['reference']}: needs --survey")
    if (options["mud_velocity"] is None) != (options["tool_radius"] is None):
        raise click.UsageError("echo.velocity and echo.tool_radius: travel times need both")
    if len(options["maps"]) not in (0, 1, len(options["source"])):
        counts = f"{len(options['maps'])} maps for {len(options['source'])} caliper files"
        raise click.UsageError(f"{counts}: must be one map for all files, or one for each file")
    if options["track"] is not None and len(options["source"]) > 1:
        raise click.UsageError("--track: goes with one caliper file only")


def _opened(options: dict[str, Any], project: Path | None) -> Run:
    """Open every file that the project and the options name, and return the run."""
    from helibore.base.nulls import NULLS
    from helibore.runs.project import read_project
    from helibore.runs.run import OpenFiles, open_run

    over, files, bit_lines = _over(options), None, []
    if project is None:
        _check_effect(options["gauge"], options["average"], _archive(options))
        over["nulls"] = tuple(dict.fromkeys((*NULLS, *options["absent"])))
        files = OpenFiles(over["nulls"], _header_lines(options), ReadingSettings(**over.get("reading", {})))
        over |= _source(options, files)
        if "archive" not in over and options["bit_diameter"] is None:
            bit_lines = _bit_of_files(over, files)
        if "archive" not in over and options["bit_diameter"] is None and not bit_lines:
            for one in () if "columns" in over else over.get("caliper", ()):  # images alone get a command with a size
                _check_caliper(files, files.input(one.file, one.set, one.map), options)
            rule = "Missing option '--bit-diameter': no archive (.wall), project (.toml) or caliper file states it."
            raise click.UsageError(rule)
    settings = _with_more(read_project(project, over), options, project is not None)
    _check_effect(settings.gauge, settings.average, settings.archive.file if settings.archive else None)
    if files is None:
        lines = _header_lines(options, [one.file for one in settings.inputs])
        files = OpenFiles(settings.nulls, lines, settings.reading)
    guessed = [one.file for one in settings.caliper if not one.channel]
    run = open_run(settings, files)
    run.messages += bit_lines
    run.tune = options["tune"]
    run.changed = settings.output is not None and settings != read_project(project)
    for one in run.settings.caliper:
        if one.file in guessed:
            _check_caliper(run.files, one, options | {"bit_diameter": settings.wall and settings.wall.bit_diameter})
    return run


def _bit_of_files(over: dict[str, Any], files: OpenFiles) -> list[tuple[str, str]]:
    """Add the bit diameter that the caliper files state to ``over``; return the message on it, or nothing.

    It is used if each file that states one states the same.
    """
    from helibore.channels.channel_readings import ONE_BIT, stated_bit

    found = []
    for one in (*over.get("caliper", ()), *([over["average"]] if "average" in over else [])):
        read = files.input(one.file, one.set, one.map)
        if (bit := stated_bit(files.log_set(read), read.roles)) is not None:
            found.append((*bit, one.file.name))
    if not found:
        return []
    sizes = [size for size, _, _ in found]
    if max(sizes) - min(sizes) > ONE_BIT:
        listed = ", ".join(f"{size_text(size)} in {name}" for size, _, name in found)
        raise InputError("bit diameter", f"the files state several: {listed}", setting="wall.bit_diameter")
    over["wall"] = {**over.get("wall", {}), "bit_diameter": sizes[0]}
    return [("bit", f"{size_text(sizes[0])}, as {found[0][1]} of {found[0][2]} states")]


def _over(options: dict[str, Any]) -> dict[str, Any]:
    """Return what the command line states and counts over a project, by key."""
    from helibore.runs.project import Input
    from helibore.settings.column_settings import Columns

    given = {name: options[name] for name in options if on_command_line(name)}
    groups = {"preparation": Preparation, "path": PathSettings, "columns": Columns, "reading": ReadingSettings}
    over: dict[str, Any] = {
        group: {name: given[name] for name in members(kind) if name in given} for group, kind in groups.items()
    }
    over["echo"] = {name: given[param] for name, param in ECHO.items() if param in given}
    wall = stated(Settings, options)
    over["wall"] = {name: of for name, of in wall.items() if name not in INTERVAL and (name != "sigma" or of)}
    over = {group: table for group, table in over.items() if table}
    if options["survey"] is not None:
        over["survey"] = Input(options["survey"], set=options["survey_set"], map=options["survey_map"])
    if options["track"] is not None:
        over["track"] = Input(options["track"], map=options["track_map"])
    if options["intervals"]:
        named = {name: options[f"intervals_{name}"] for name in ("well", "unit")}
        over["intervals"] = tuple(IntervalInput(file, **named) for file in options["intervals"])
    elif over_named := {name: given[f"intervals_{name}"] for name in ("well", "unit") if f"intervals_{name}" in given}:
        over["intervals"] = over_named
    return over


def _source(options: dict[str, Any], files: OpenFiles) -> dict[str, Any]:
    """Return the source of the wall that the command line states without a project, by its key."""
    from helibore.runs.project import Input

    if (archive := _archive(options)) is not None:
        return {"archive": Input(archive)}
    if options["gauge"]:
        return {"gauge": True}
    if options["average"] is not None:
        return {"average": _average(files, options)}
    maps = options["maps"] or (None,)
    names_of = set_names if options["maps"] else sets_of_calipers
    calipers = (
        Input(file, set=name, map=maps[number % len(maps)])
        for number, file in enumerate(options["source"])
        for name in names_of(files.log(file), options["sets"])
    )
    return {"caliper": tuple(calipers)}


def _with_more(settings: Project, options: dict[str, Any], by_project: bool) -> Project:
    """Return a project with the images, curves, null values and interval of the command line."""
    more: dict[str, Any] = {"image": settings.image + _images(options), "scalar": settings.scalar + _scalars(options)}
    if by_project and options["absent"]:
        more["nulls"] = tuple(dict.fromkeys((*settings.nulls, *options["absent"])))
    if settings.wall is not None and settings.output is None:  # what helibore wrote is repeated, and shown in part
        ends = INTERVAL[::-1] if settings.wall.pitch < 0 else INTERVAL  # a helix that goes up starts at its deep end
        given = {end: options[name] for end, name in zip(ends, INTERVAL, strict=True) if options[name] is not None}
        more["wall"] = replace(settings.wall, **given)
    return replace(settings, **more)


def _check_caliper(files: OpenFiles, one: Input, options: dict[str, Any]) -> None:
    """Refuse a source with images but without a caliper around the hole; the error has a command for the images."""
    from helibore.cli.without_caliper import without_caliper

    verb = click.get_current_context().info_name or ""
    more = [word for name in ("survey", "output") if options.get(name) for word in (f"--{name}", str(options[name]))]
    lacks, command = without_caliper(one.file, files.log(one.file), one.roles, verb, options["bit_diameter"], more)
    if command:
        raise InputError(one.file.name, f"{lacks}. Run: {command}")


def _average(files: OpenFiles, options: dict[str, Any]) -> Input:
    """Return the file and channel of ``--average`` as an `Input`; the channel of the depth is guessed."""
    from helibore.channels.roles import Role, guess
    from helibore.runs.project import Input

    text, _, channel = options["average"].rpartition(":")
    if not text:
        raise click.UsageError(f"--average {options['average']}: must be FILE:CHANNEL")
    log = files.log(Path(text))
    names = set_names(log, options["sets"])
    if len(names) > 1:
        raise click.UsageError(f"--average: needs one set, not {len(names)}")
    found = log.set(names[0])
    depth = guess(found).one("depth")
    if depth is None:
        raise InputError(log.path.name, "no channel is a depth")
    mean = Role(channel, "mean-diameter", "named by --average", found.channel(channel).unit)
    return Input(Path(text), "", found.name, (depth, mean))


def _header_lines(options: dict[str, Any], others: Sequence[Path] = ()) -> dict[Path, int]:
    """Return, by file, the line numbers of ``header_line``; a number without a file applies to all sources.

    ``others`` are files that a project names.
    """
    sources = [file for file in options["source"] if file.suffix.lower() not in (ARCHIVE_ENDING, PROJECT)]
    if options["average"] is not None:
        sources.append(Path(options["average"].rpartition(":")[0]))
    images, curves = _images(options), _scalars(options)
    read = [*sources, options["survey"], options["track"], *others]
    read += [*(one.file for one in images), *(one.file for one in curves)]
    lines: dict[Path, int] = {}
    for text in options["header_lines"]:
        file, _, number = text.rpartition("=")
        if not number.isascii() or not number.isdigit():
            raise click.UsageError(f"-s header_line={text}: must be LINE or FILE=LINE")
        if not file and not sources:
            raise click.UsageError(f"-s header_line={text}: must be FILE=LINE, as no SOURCE is a table")
        if file and Path(file) not in read:
            raise click.UsageError(f"-s header_line={text}: no option reads the file {file}")
        lines |= dict.fromkeys([Path(file)] if file else sources, int(number))
    return lines


def _scalars(options: dict[str, Any]) -> tuple[ScalarInput, ...]:
    """Return the curves that ``--scalar`` takes from files, FILE:CHANNEL; no file is opened."""
    from helibore.runs.project import ScalarInput

    found = []
    for text in options.get("scalar", ()):
        file, _, name = text.rpartition(":")
        if not file and text != INCLINATION:
            raise click.UsageError(f"--scalar {text}: must be FILE:CHANNEL or {INCLINATION}")
        if file:
            found.append(ScalarInput(Path(file), name))
    return tuple(found)


def _images(options: dict[str, Any]) -> tuple[ImageInput, ...]:
    return tuple(_image(text) for text in options["image"])


def _image(text: str) -> ImageInput:
    """Parse the text of ``--image``, FILE:CHANNEL:ORIGIN[:REFERENCE]."""
    from helibore.runs.project import ImageInput

    reference: Any = next((word for word in ("north", "high-side") if text.endswith(f":{word}")), None)
    parts: Any = (text.removesuffix(f":{reference}") if reference else text).rsplit(":", 2)
    if len(parts) != 3 or not all(parts) or parts[2] not in ("centre", "edge"):
        forms = "FILE:CHANNEL:ORIGIN or FILE:CHANNEL:ORIGIN:REFERENCE; ORIGIN is centre or edge, REFERENCE"
        raise click.UsageError(f"--image {text}: must be {forms} north or high-side")
    return ImageInput(Path(parts[0]), parts[1], parts[2], reference=reference)
