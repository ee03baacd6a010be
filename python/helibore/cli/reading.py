"""The options that say which columns of which files mean what, shared by the verbs that read calipers and surveys.

    NAME[@ANGLE][:UNIT]     md_m      rb:deg      x_in@0      CAL1@90:in

A file of any format that ``helibore.open`` knows; roles are guessed from names and units, laid over by ``--map``, and
by these options last.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from helibore.cli.quantities import LENGTH

if TYPE_CHECKING:
    from helibore.base.settings import Settings
    from helibore.channels.log_set import LogFile
    from helibore.channels.roles import RoleMap
    from helibore.runs.run import Opened

Command = Callable[..., Any]
FILE = click.Path(path_type=Path)

COLUMNS: tuple[Callable[[Command], Command], ...] = (
    click.option("--map", "maps", type=FILE, multiple=True, help="Roles as TOML (see inspect); one, or one a file."),
    click.option("--set", "set_name", metavar="NAME", help="Set of the caliper file, where it holds several."),
    click.option("--depth", metavar="COLUMN", help="NAME[:UNIT] of the depth."),
    click.option("--toolface", metavar="COLUMN", help="NAME[:UNIT] of the toolface or relative bearing."),
    click.option("--radius", metavar="COLUMN", multiple=True, help="NAME[@ANGLE][:UNIT] of a radius; repeatable."),
    click.option("--diameter", metavar="COLUMN", multiple=True, help="NAME[@ANGLE][:UNIT] of a diameter; repeatable."),
    click.option("--time", metavar="COLUMN", help="NAME[:UNIT] of the time."),
    click.option(
        "--absent", type=float, multiple=True, help="A number that means no value.  [-999.25, -9999, -9999.25]"
    ),
)  # fmt: skip

SURVEY_FILE: tuple[Callable[[Command], Command], ...] = (
    click.option("--survey", type=FILE, help="Survey file; without one the hole is straight and vertical."),
    click.option("--survey-map", type=FILE, help="Roles of the survey file as TOML (see inspect)."),
    click.option("--survey-set", metavar="NAME", help="Set of the survey file, where it holds several."),
    click.option("--survey-depth", metavar="COLUMN", help="NAME[:UNIT] of the stations' depth."),
    click.option("--inclination", metavar="COLUMN", help="NAME[:UNIT] of the inclination."),
    click.option("--azimuth", metavar="COLUMN", help="NAME[:UNIT] of the azimuth."),
    click.option("--extend", type=LENGTH, default="0m", show_default=True, help="Straight on past the last station."),
    click.option(
        "--head", type=LENGTH, nargs=3, default=(0.0, 0.0, 0.0), help="North, east, down of the first station."
    ),
)  # fmt: skip

SURVEY: tuple[Callable[[Command], Command], ...] = (
    *SURVEY_FILE[:-2],
    click.option(
        "--reference", type=click.Choice(["high-side", "north", "parallel-transport"]), default="high-side",
        show_default=True,
        help="What toolface 0 of the wall is; parallel-transport: north at the top, then without twist.",
    ),
    *SURVEY_FILE[-2:],
)  # fmt: skip


def taking(*options: Callable[[Command], Command]) -> Callable[[Command], Command]:
    """Give a command several options, in this order."""

    def add(command: Command) -> Command:
        for option in reversed(options):
            command = option(command)
        return command

    return add


def refuse_beside_settings(ctx: click.Context, allowed: tuple[str, ...]) -> None:
    """Refuse what is given beside --from-settings and is not among ``allowed``: it would be another run."""
    for parameter in ctx.command.params:
        name = parameter.name or ""
        given = ctx.get_parameter_source(name) is ParameterSource.COMMANDLINE and ctx.params[name] != ()
        if given and name not in allowed:
            shown = parameter.opts[0] if isinstance(parameter, click.Option) else name.upper()
            raise click.UsageError(f"{shown}: does not go with --from-settings, which repeats a run as it was")


def wall_settings(options: dict[str, Any]) -> Settings:
    """Return the settings that the options of a verb name; those it does not have are the defaults."""
    from helibore.base.settings import Settings

    found = {each.name: options[each.name] for each in fields(Settings) if each.name in options}
    if options["pitch"] < 0:  # the helix starts at its deep end
        found["start_depth"], found["stop_depth"] = options["stop_depth"], options["start_depth"]
    return Settings(**found)


def nulls(options: dict[str, Any]) -> tuple[float, ...]:
    """Return the numbers that mean no value."""
    from helibore.runs.run_settings import NULLS

    return tuple(options["absent"]) or NULLS


def open_calipers(files: Sequence[Path], options: dict[str, Any], tracked: bool = False) -> tuple[Opened, ...]:
    """Open caliper files with the roles that guess, maps and options give their channels."""
    from helibore.runs.run import opened

    maps = options["maps"]
    if len(maps) not in (0, 1, len(files)):
        raise click.UsageError(f"{len(maps)} maps for {len(files)} caliper files: must be one, or one a file")
    columns = {name: options[name] for name in ("depth", "toolface", "time")}
    arms = {name: options[name] for name in ("radius", "diameter")} | {"travel-time": options.get("travel_time", ())}
    found = []
    for number, file in enumerate(files):
        own = maps[number % len(maps)] if maps else None
        choose = partial(_roles, set_name=options["set_name"], map_file=own, columns=columns, arms=arms)
        found.append(opened(file, nulls(options), choose))
    if tracked and len(found) > 1:
        raise click.UsageError("--track: is for one caliper file")
    return tuple(found)


def open_survey(options: dict[str, Any]) -> Opened | None:
    """Open the survey file, where there is one."""
    if options["survey"] is None:
        return None
    from helibore.runs.run import opened

    columns = {"depth": options["survey_depth"]} | {name: options[name] for name in ("inclination", "azimuth")}
    name, file = options["survey_set"], options.get("survey_map")
    return opened(options["survey"], nulls(options), lambda log: _roles(log, name, file, columns, {}))


def open_track(options: dict[str, Any]) -> Opened | None:
    """Open the file that has depth and toolface by time, where there is one."""
    if options["track"] is None:
        return None
    from helibore.runs.run import opened

    return opened(options["track"], nulls(options), lambda log: _roles(log, None, options["track_map"], {}, {}))


def _roles(
    log: LogFile, set_name: str | None, map_file: Path | None, columns: dict[str, Any], arms: dict[str, Any]
) -> RoleMap:
    """The set's roles: guessed, laid over by a map, laid over by options."""
    from helibore.channels.role_map import parse_options, read_map
    from helibore.channels.roles import guess

    roles = read_map(map_file, log) if map_file is not None else guess(log.set(set_name))
    if set_name is not None and roles.set_name != set_name:
        raise ValueError(f"--set {set_name}: the map is for the set {roles.set_name}")
    return parse_options(log.set(roles.set_name), roles, columns, arms)
