"""Check the outputs of commands, record the options that they were made with, and make lines on the written files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from helibore.base.errors import InputError, check_ending, check_names
from helibore.cli.lines import Lines
from helibore.cli.quantities import FILE
from helibore.cli.sections import opt
from helibore.cli.wall_options import SECTIONS

if TYPE_CHECKING:
    from helibore.cli.terminal import Terminal
    from helibore.runs.run import Run
    from helibore.wall.wall import Wall

SIGMA = opt("--sigma", "Add the standard uncertainty of the radius.", is_flag=True)
QUIET = opt("-q --quiet", "Print nothing but errors.", is_flag=True)

NOT_RECORDED = ("source", "output", "centres", "zones", "breakouts", "quiet", "help", "settings", "column",
                "look")  # fmt: skip
"""A command's own options that do not change the bytes of its output; the settings do not record them."""
OF_ANY_COMMAND = ("criteria", "scaled")
"""Options that a command takes also from the settings of another command, because they define the wall's zones."""


def OUTPUT(help: str) -> tuple[str, dict[str, Any]]:  # noqa: A002, N802
    """Return the required option ``--output``; ``help`` says which files it takes."""
    return opt("-o --output", help, type=FILE, required=True)


NEAREST = opt("--nearest", "Add the distance to the nearest sample as the attribute 'nearest'.", is_flag=True)
MEASURED = opt("--measured", "Add the attribute 'measured': whether a quad is measured (1) or interpolated (0). Meshes "
               "of a tool with few arms always have this attribute.", is_flag=True)  # fmt: skip


def add_sigma(wall: Wall, terminal: Terminal) -> Lines:
    """Give a wall its uncertainty as the attribute 'sigma'; return a line on the part without sigma, if any."""
    import numpy as np

    from helibore.wall.interpolation import on_quads

    with terminal.stage("sigma", "Leaving samples out"):
        sigma = on_quads(wall.sigma, wall.settings.sectors)
    wall.attributes["sigma"], wall.attributes.units["sigma"] = sigma, "m"
    missing = float(np.isnan(sigma).mean()) if sigma.size else 0.0
    why = "between fixed arms, and far from samples, the hole is not sampled"
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


def _recorded_options(context: click.Context) -> dict[str, click.Parameter]:
    """Return by name the options that the settings record: the command's own options, and the interval of the wall."""
    shared = {names for options in SECTIONS.values() for names, _ in options}
    of_wall = {name for names in shared for name in names.split()}
    return {
        name: each
        for each in context.command.params
        if (name := str(each.name)) in ("start_depth", "stop_depth")
        or not (of_wall.intersection(each.opts) or name in NOT_RECORDED)
    }


def own_options(run: Run, verb: str, options: dict[str, Any]) -> dict[str, Any]:
    """Return ``options``; where the command line gives no value, a repeated run supplies the value that it recorded.

    If another command made the run, only the values of `OF_ANY_COMMAND` are taken.
    """
    if run.settings.output is None:
        return options
    context, place = click.get_current_context(), f"{run.settings.output.file.name}.toml: options"
    own, found, recorded = _recorded_options(context), dict(options), run.settings.options
    if run.settings.verb != verb:
        recorded = {name: recorded[name] for name in OF_ANY_COMMAND if name in recorded and name in own}
    check_names(f"{place}.", recorded, own)
    for name, value in recorded.items():
        try:
            cast = own[name].type_cast_value(context, value)
            wanted = _plain(cast)
        except (click.BadParameter, TypeError, ValueError) as error:
            raise InputError(f"{place}.{name}", getattr(error, "message", str(error)), repr(value)) from error
        if wanted != value or isinstance(wanted, bool) != isinstance(value, bool):
            raise InputError(f"{place}.{name}", f"must be {wanted!r}", repr(value))
        if context.get_parameter_source(name) is not ParameterSource.COMMANDLINE:
            found[name] = cast
    return found


def _plain(value: Any) -> Any:
    """Return a value of an option as TOML can hold it: a path as text, a tuple as a list."""
    if isinstance(value, Path):
        return str(value.resolve())
    return [_plain(each) for each in value] if isinstance(value, tuple | list) else value


def save_lines(run: Run, output: Path, verb: str, options: dict[str, Any], more: Sequence[Path] = ()) -> Lines:
    """Write the settings beside an output; return lines on the files and on whether a repeated run gave the same bytes.

    ``more`` are the other files that the command wrote.
    """
    from helibore.runs.run import save_settings
    from helibore.runs.run_settings import settings_file

    before, context = run.settings, click.get_current_context()
    recorded = {
        name: _plain(options[name]) for name in _recorded_options(context) if options[name] not in (None, (), False)
    }
    added = not all(one.blake2b for one in before.inputs)
    after = save_settings(run, output, verb, recorded)
    files = ", ".join(f"{file} ({file.stat().st_size / 1e6:,.2f} MB)" for file in (output, *more))
    lines = [("wrote", f"{files}, {settings_file(output).name}")]
    if before.output is None or after.output is None:
        return lines
    earlier = before.output
    if (before.verb, before.options) != (verb, recorded) or added or earlier.file.suffix != output.suffix:
        text = f"the wall of {earlier.file.name}; its bytes are not compared with those of another kind of output"
    elif earlier.blake2b == after.output.blake2b:
        text = "to the last bit"
    else:
        text = "with other bytes: another version or machine wrote it"
    return [*lines, ("repeated", text)]
