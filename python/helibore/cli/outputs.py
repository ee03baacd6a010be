"""Check the outputs of commands, record the options that they were made with, and make lines on the written files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from helibore.base.errors import InputError, check_ending
from helibore.cli.lines import Lines
from helibore.cli.quantities import FILE
from helibore.cli.sections import FAMILIES, SectionOption, opt
from helibore.cli.wall_options import SECTIONS
from helibore.settings.declared import members
from helibore.settings.groups import GROUPS
from helibore.settings.print_settings import Look

if TYPE_CHECKING:
    from helibore.cli.terminal import Terminal
    from helibore.runs.project import Project
    from helibore.runs.run import Run
    from helibore.wall.wall import Wall

QUIET = opt("-q --quiet", "Print nothing but errors.", is_flag=True)

NOT_RECORDED = (
    "source", "output", "centres", "zones", "breakouts", "interval_table", "rose", "quiet", "help", "settings",
    "column",
)  # fmt: skip
"""A command's own options that do not change the bytes of its output; a project does not record them."""
TABLES = ("header", "zones", "image_zones", "print", "look", "logs", "passage", "stress", "cement", "mesh", "view")
"""Tables of a project that say what an output holds."""


def OUTPUT(help: str) -> tuple[str, dict[str, Any]]:  # noqa: A002, N802
    """Return the required option ``--output``; ``help`` says which files it takes."""
    return opt("-o --output", help, type=FILE, required=True)


def add_sigma(wall: Wall, terminal: Terminal) -> Lines:
    """Give a wall its uncertainty as the attribute 'sigma'; return a line on the part without sigma, if any."""
    import numpy as np

    from helibore.wall.interpolation import on_quads

    with terminal.stage("sigma", "Leaving samples out"):
        sigma = on_quads(wall.sigma, wall.settings.sectors)
    wall.attributes["sigma"], wall.attributes.units["sigma"] = sigma, "m"
    missing = float(np.isnan(sigma).mean()) if sigma.size else 0.0
    why = "between arms, and far from samples, the hole is not sampled"
    why = why if wall.basis == "azimuthal" else wall.basis_text
    return [("missing", f"{100 * missing:.1f} % of the wall has no sigma: {why}")] if missing else []


def add_nearest(wall: Wall) -> None:
    """Give a wall the attribute 'nearest', for meshes: the distance from each quad to the nearest sample."""
    from helibore.wall.interpolation import on_quads

    wall.attributes["nearest"] = on_quads(wall.nearest, wall.settings.sectors)
    wall.attributes.units["nearest"] = "m"


def add_measured(wall: Wall) -> None:
    """Give a wall the attribute 'measured', for meshes; a wall of a tool with few arms always has it."""
    from helibore.wall.interpolation import measured_quads
    from helibore.wall.wall_columns import MEASURED

    if wall.basis != "azimuthal":
        raise InputError("--measured", f"needs a shape that was measured; this wall: {wall.basis_text}")
    wall.attributes[MEASURED] = measured_quads(wall._state())


def check_file(file: Path, endings: Sequence[str], why: str = "") -> None:
    """Raise InputError unless the file has one of these endings, its folder exists, and it is not itself a folder."""
    check_ending(file, endings, why)
    check_folder(file)


def check_folder(file: Path) -> None:
    """Raise InputError unless the folder of a file exists and the file is not itself a folder."""
    if not file.parent.is_dir():
        raise InputError(str(file), f"the folder {file.parent} must exist")
    if file.is_dir():
        raise InputError(str(file), "is a folder")


def _recorded_options(context: click.Context) -> dict[str, SectionOption]:
    """Return by name the options that a project records: the command's own options, and the interval of the wall."""
    shared = {names for options in SECTIONS.values() for names, _ in options}
    of_wall = {name for names in shared for name in names.split()}
    return {
        name: each
        for each in context.command.params
        if isinstance(each, SectionOption)
        and (
            (name := str(each.name)) in ("start_depth", "stop_depth")
            or not (of_wall.intersection(each.opts) or name in NOT_RECORDED)
        )
    }


def own_options(run: Run, verb: str, options: dict[str, Any]) -> dict[str, Any]:
    """Return ``options``; where the command line gives no value, the project supplies it, or else the default.

    The interval of what is shown counts only for the command that wrote the project.
    """
    context, found = click.get_current_context(), dict(options)
    for option in (each for each in context.command.params if isinstance(each, SectionOption)):
        name = str(option.name)
        group, _, key = option.setting.partition(".")
        if name in FAMILIES:
            found[name] = _family(run.settings, FAMILIES[name], options[name])
        elif group in TABLES and context.get_parameter_source(name) is not ParameterSource.COMMANDLINE:
            member = members(GROUPS[group]).get(key)
            usual = None if member is None or member.default is MISSING else member.default
            usual = usual if found[name] is None else found[name]
            found[name] = getattr(run.settings, group).get(key, usual)
    same = run.settings.output is not None and run.settings.verb == verb
    for name in ("start_depth", "stop_depth"):
        if same and found[name] is None:
            found[name] = getattr(run.settings, name)
    _interval_of_wall(run.settings, found)
    return found


def _family(settings: Project, group: str, stated: dict[str, Any]) -> dict[str, Any]:
    """Return the settings of a group that an option takes as NAME=VALUE: of the command line, else of the project."""
    table: dict[str, Any] = getattr(settings, group)
    if group == "look":
        return table | {name: replace(table.get(name, Look()), **of) for name, of in stated.items()}
    own = {each.setting for each in click.get_current_context().command.params if isinstance(each, SectionOption)}
    return {name: value for name, value in table.items() if f"{group}.{name}" not in own} | stated


def _interval_of_wall(settings: Project, found: dict[str, Any]) -> None:
    """Let what is shown be the interval for which a project makes the wall, as for files of the command line."""
    wall = settings.wall
    if wall is not None and settings.output is None:
        ends = (wall.stop_depth, wall.start_depth) if wall.pitch < 0 else (wall.start_depth, wall.stop_depth)
        found["start_depth"], found["stop_depth"] = ends


def recorded_tables(context: click.Context, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the tables and keys of a project that the command's own options are; those without effect are left out."""
    made: dict[str, Any] = {}
    for name, option in _recorded_options(context).items():
        value = options.get(name)
        given = context.get_parameter_source(name) is ParameterSource.COMMANDLINE
        if value in (None, (), [], {}, "") or (value is False and not given):
            continue
        if name in ("start_depth", "stop_depth"):
            made[name] = value
        elif name in FAMILIES:
            made.setdefault(FAMILIES[name], {}).update(value)
        else:
            group, _, key = option.setting.partition(".")
            made.setdefault(group, {})[key] = _plain(value)
    return made


def _plain(value: Any) -> Any:
    """Return a value of an option as a project holds it: a path as a whole path, a tuple as a list."""
    if isinstance(value, Path):
        return value.resolve()
    return [_plain(each) for each in value] if isinstance(value, tuple | list) else value


def _recipe(project: Project) -> Project:
    """Return a project without its output, in a form in which equal tables are equal."""
    tables: dict[str, Any] = {
        group: {name: _plain(value) for name, value in getattr(project, group).items()} for group in TABLES
    }
    return replace(project, output=None, **tables)


def save_lines(run: Run, output: Path, verb: str, options: dict[str, Any], more: Sequence[Path] = ()) -> Lines:
    """Write the project beside an output; return lines on the files and on whether a repeated run gave the same bytes.

    ``more`` are the other files that the command wrote.
    """
    from helibore.files.facts import facts_path
    from helibore.runs.project import project_file
    from helibore.runs.run import save_project

    before = run.settings
    made = dict.fromkeys(("start_depth", "stop_depth")) | recorded_tables(click.get_current_context(), options)
    tables = {name: getattr(before, name) | of if isinstance(of, dict) else of for name, of in made.items()}
    after = save_project(run, output, verb, tables)
    sizes = [f"{file} ({file.stat().st_size / 1e6:,.2f} MB)" for file in (output, *more)]
    facts = [beside.name for file in (output, *more) if (beside := facts_path(file)).is_file()]
    lines = [("wrote", ", ".join([*sizes, *facts, project_file(output).name]))]
    if before.output is None or after.output is None:
        return lines
    earlier = before.output
    same = not run.changed and _recipe(before) == _recipe(after)
    if not same or earlier.file.suffix != output.suffix:
        text = f"the wall of {earlier.file.name}; its bytes are not compared with those of another kind of output"
    elif earlier.blake2b == after.output.blake2b:
        text = "to the last bit"
    else:
        text = "with other bytes: another version or machine wrote it"
    return [*lines, ("repeated", text)]
