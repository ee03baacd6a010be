"""Options in sections of the help; the rare ones of a command are settings, stated as ``-s NAME=VALUE``.

    @click.command(cls=Sectioned, common=("output", "sectors"))     the options of these names stand in the help
    -s wall.power=2                                                 the others, by the names of their settings
    --power 2                                                       an error that says so

An option of one command may be a setting of another. Both ways convert the same text with the same type, so a value
that breaks its rule gives the same words.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import click

Command = Callable[..., Any]
Text = tuple[str, str]

SHOWN = ("reconstruct", "mesh", "plot", "report", "view", "logs", "zones")
"""The commands that take settings."""

GROUPS = {
    "Source": "source", "Columns": "columns", "Reading": "reading", "Sensors": "preparation",
    "Conditioning": "preparation", "Passes": "preparation", "Path and toolface": "path", "Wall": "wall",
    "Mesh": "mesh", "Logs": "logs",
    "Zones": "zones", "Passage": "passage", "Stress": "stress", "Cement": "cement", "Print": "print", "Page": "view",
}  # fmt: skip
"""What stands before the dot in the names of the settings of a section."""

NAMES = {
    "bit_diameter": "wall.bit_diameter", "start_depth": "wall.start_depth", "stop_depth": "wall.stop_depth",
    "survey_depth": "columns.survey_depth", "inclination": "columns.inclination", "azimuth": "columns.azimuth",
    "template": "print.template", "beside": "print.beside", "picks": "print.picks", "scalar": "print.scalar",
    "look": "look",
    "maps": "source.map", "sets": "source.set", "well": "header.well", "criteria": "zones.criteria",
        "scaled": "zones.scaled", "zones": "logs.zones", "breakouts": "logs.breakouts",
        "interval_table": "logs.interval_table",
    "absent": "nulls", "threads": "threads", "header_lines": "header_line", "track": "track.file",
    "track_map": "track.map", "mud_velocity": "echo.velocity", "tool_radius": "echo.tool_radius",
    "echo_window": "echo.window", "mud_velocity_sigma": "echo.velocity_sigma", "echo_casing": "echo.casing",
    "echo_casing_sigma": "echo.casing_sigma", "survey": "survey.file", "survey_map": "survey.map",
    "survey_set": "survey.set",
    "intervals": "intervals.file", "intervals_well": "intervals.well", "intervals_unit": "intervals.unit",
}  # fmt: skip
"""Names of settings that the section does not give."""

HEADINGS = {
    "Columns": "Source", "Reading": "Source", "Sensors": "Source", "Path and toolface": "Source",
    "Conditioning": "Preparation", "Passes": "Preparation",
}  # fmt: skip
"""Headings under which the help lists the options of a section; other sections have their own."""

FAMILIES = {"criteria": "zones", "image_criteria": "image_zones", "header": "header", "look": "look"}
"""Options that take NAME=VALUE, and the groups whose other names they take: ``-s header.company=ACME``."""

ALWAYS = ("output", "settings", "quiet")
"""Options of every command that has settings."""

REMOVED = {
    "--from-settings": "give the settings file as SOURCE",
    "--samples-from": "it is now -s preparation.shallowest=LENGTH",
    "--samples-to": "it is now -s preparation.deepest=LENGTH",
    "--keep-saturated": "it is now -s preparation.saturated=false",
    "--keep-closed": "it is now -s preparation.drop_closed=false",
    "--drop-closed": "it is now -s preparation.closed=RADIUS",
    "--drop-stuck": "it is now -s preparation.stuck=ROWS",
    "--radius-range": "it is now -s preparation.least_radius=LENGTH and -s preparation.greatest_radius=LENGTH",
    "--drop-repeated": "it is now -s preparation.repeated=true",
    "--drop-spikes": "it is now --spikes DEVIATIONS",
    "--split-passes": "it is now -s preparation.reversal=LENGTH",
    "--shift": "it is now --shifts PASS=LENGTH",
    "--compare-with": "it is now --earlier NUMBERS",
    "--switch": "it is now -s preparation.steep=ANGLE and -s preparation.level=ANGLE",
    "--curve": "it is now --curves C1,C2",
    "--limits": "it is now --look NAME=LOW,HIGH",
    "--color-map": "it is now --look NAME=map:MAP",
    "--log": "it is now --look NAME=log",
    "--linear": "it is now --look NAME=linear",
    "--dynamic": "it is now --look NAME=window:LENGTH",
}
"""Options of earlier versions that are gone or have another name now, and what to do instead."""


class SectionOption(click.Option):
    """An option in a section of the help. If it is ``rare``, it is a setting and has no option of its own."""

    section = "Options"
    rare = False

    @property
    def setting(self) -> str:
        """The name of the setting, such as ``wall.power``."""
        name = str(self.name)
        return NAMES.get(name, f"{GROUPS.get(self.section, 'run')}.{name}")

    @property
    def spelled(self) -> str:
        """What a user writes on the command line: ``--sectors``, ``-s wall.power`` or ``--column radius``."""
        if not self.rare:
            return self.opts[0]
        group, _, name = self.setting.partition(".")
        return f"--column {name.replace('_', '-')}" if group == "columns" else f"-s {self.setting}"

    @property
    def form(self) -> str:
        """`spelled` with its value, such as ``-s wall.power=NUMBER``."""
        if self.name in FAMILIES:
            return f"-s {FAMILIES[self.name]}.NAME=VALUE"
        value = (
            str(not self.default).lower()
            if self.is_flag
            else self.make_metavar(click.Context(click.Command("helibore")))
        )
        return f"{self.spelled}={value}"

    def add_to_parser(self, parser: Any, ctx: click.Context) -> None:
        """Let the parser know the option, unless it is rare."""
        if not self.rare:
            super().add_to_parser(parser, ctx)

    def process_value(self, ctx: click.Context, value: Any) -> Any:
        """Return the value for the command: None for a list that is not given, so that [] can state an empty one."""
        made = super().process_value(ctx, value)
        return None if self.joins and not (isinstance(value, tuple | list) and value) else made

    @property
    def joins(self) -> bool:
        """Whether the values of the option, which may be given several times, are parts of one list."""
        return self.multiple and hasattr(self.type, "joined")

    def type_cast_value(self, ctx: click.Context, value: Any) -> Any:
        """Convert the value; the values of a list that is given several times become one list."""
        joined: Any = getattr(self.type, "joined", None)
        return joined(value, self, ctx) if self.joins and value else super().type_cast_value(ctx, value)

    def get_error_hint(self, ctx: click.Context | None) -> str:
        """Return what an error names."""
        return f"'{self.spelled}'" if self.rare else super().get_error_hint(ctx)

    def handle_parse_result(self, ctx: click.Context, opts: Mapping[str, Any], args: list[str]) -> Any:
        """Take the values that ``-s`` and ``--column`` state; the option itself wins over them."""
        stated = list(_stated(opts))
        if not stated:
            return super().handle_parse_result(ctx, opts, args)
        texts = [value for name, value in stated if name == self.setting]
        family = FAMILIES.get(str(self.name), "")
        known = _settings_of(ctx.command)
        texts += [
            f"{name}={value}"
            for name, value in stated
            if family and name.startswith(f"{family}.") and name not in known
        ]
        if texts:
            opts = {**opts, str(self.name): self._values(texts, opts.get(str(self.name)))}
        return super().handle_parse_result(ctx, opts, args)

    def _values(self, texts: list[str], given: Any) -> Any:
        if self.multiple:
            return [*(given or ()), *texts]
        if given is not None:
            return given
        return tuple(texts[-1].split(",")) if self.nargs > 1 else texts[-1]


def _stated(opts: Mapping[str, Any]) -> Iterator[Text]:
    """Yield the settings that the command line states, in the order of the options that state them."""
    for text in opts.get("settings") or ():
        name, _, value = text.partition("=")
        yield _setting_name(name), value
    for text in opts.get("column") or ():
        name, _, value = text.partition("=")
        yield f"columns.{name.replace('-', '_')}", value


def _setting_name(text: str) -> str:
    """Return the name of a setting with hyphens as it is declared; the name of an image in it stays as it is."""
    return text if text.startswith("look.") else text.replace("-", "_")


def _settings_of(command: click.Command) -> dict[str, SectionOption]:
    """Return the options of a command by the names of their settings."""
    return {each.setting: each for each in command.params if isinstance(each, SectionOption)}


def spelled_setting(command: click.Command, setting: str) -> str:
    """Return what states a setting in a command, such as ``--sectors`` or ``-s wall.power``; "" if nothing does."""
    known = _settings_of(command)
    if setting in known:
        return known[setting].spelled
    if any(setting.startswith(f"{FAMILIES[name]}.") for each in known.values() if (name := str(each.name)) in FAMILIES):
        return f"-s {setting}"
    own = next((each for each in command.params if each.name == setting), None)
    return own.spelled if isinstance(own, SectionOption) else own.opts[0] if own is not None else ""


class Sectioned(click.Command):
    """A command whose help lists its common options in sections; the others are settings.

    ``common``: the names of the parameters that have an option of their own; None: all.
    """

    def __init__(self, *args: Any, common: Sequence[str] | None = None, **extra: Any) -> None:
        super().__init__(*args, **extra)
        for each in self.params:
            if common is not None and isinstance(each, SectionOption) and each.name not in (*common, *ALWAYS):
                each.rare = each.hidden = True

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the options; an option that is now a setting names it."""
        try:
            return super().parse_args(ctx, args)
        except click.NoSuchOption as error:
            name = error.option_name
            for each in self.params:
                if isinstance(each, SectionOption) and each.rare and name in each.opts:
                    rule = f"no option of {ctx.command.name}, but a setting: {each.form}"
                    raise click.UsageError(f"{name}: {rule}", ctx) from error
            if name in REMOVED:
                raise click.UsageError(f"{name}: no longer an option; {REMOVED[name]}", ctx) from error
            raise

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options under the headings of their sections, in the order in which the command has them."""
        rows: dict[str, list[Text]] = {"Options": []}
        for parameter in (each for each in self.get_params(ctx) if isinstance(each, click.Option)):
            record = parameter.get_help_record(ctx)
            if record is not None:
                own = getattr(parameter, "section", "Options")
                rows.setdefault(HEADINGS.get(own, own), []).append(record)
        for title, records in rows.items():
            if records:
                with formatter.section(title):
                    formatter.write_dl(records)


def section(name: str, *options: tuple[str, dict[str, Any]]) -> Callable[[Command], Command]:
    """Return a decorator that gives a command ``options``, as `opt` makes them, in a section of its help."""
    kind = type("SectionOption", (SectionOption,), {"section": name})

    def add(command: Command) -> Command:
        for names, settings in reversed(options):
            command = click.option(*names.split(), cls=kind, **settings)(command)
        return command

    return add


def opt(names: str, help: str, **settings: Any) -> tuple[str, dict[str, Any]]:  # noqa: A002
    """Return an option for `section`: its names, and the arguments of `click.option`. The help shows its default."""
    shown = settings.get("default") not in (None, ()) and "is_flag" not in settings
    return names, {"help": help, "show_default": shown} | settings


def opts(names: str, help: str, **settings: Any) -> tuple[str, dict[str, Any]]:  # noqa: A002
    """Return an option for `section` that a user may give several times."""
    return opt(names, f"{help} Repeatable.", multiple=True, **settings)


def spelled(name: str) -> str:
    """Return what a user of the current command writes for the parameter ``name``."""
    for each in click.get_current_context().command.params:
        if each.name == name:
            return each.spelled if isinstance(each, SectionOption) else each.opts[0]
    return f"--{name.replace('_', '-')}"


def _known(ctx: click.Context, param: click.Parameter, texts: tuple[str, ...]) -> None:
    """Refuse a setting that the command does not have; the error names the nearest one that it has."""
    known = _settings_of(ctx.command)
    families = {FAMILIES.get(str(each.name)) for each in known.values()}
    for text in texts:
        name, equals, _ = text.partition("=")
        if not equals:
            raise click.BadParameter(f"'{text}': must be NAME=VALUE", ctx, param)
        full = f"columns.{name}" if param.name == "column" else name
        full = _setting_name(full)
        if full not in known and full.partition(".")[0] not in families:
            raise click.UsageError(f"{param.opts[0]} {name}: {_nearest(ctx, name, known, param)}", ctx)


def _nearest(ctx: click.Context, name: str, known: Mapping[str, SectionOption], param: click.Parameter) -> str:
    verbs = ctx.find_root().command
    if "." in name and param.name != "column" and isinstance(verbs, click.Group):
        commands = {verb: verbs.get_command(ctx, verb) for verb in SHOWN}
        others = [verb for verb, each in commands.items() if each and spelled_setting(each, _setting_name(name))]
        if others:
            return f"no setting of this command, but of {', '.join(others)}"
    names = [each.removeprefix("columns.").replace("_", "-") for each in known if each.startswith("columns.")]
    if param.name != "column":
        names = list(known)
        every = "`helibore settings` lists the settings"
    else:
        every = f"must be one of {', '.join(names)}"
    return f"no setting of this command; {near(name, names)}{every}"


def near(name: str, known: Sequence[str]) -> str:
    """Return the hint on the known name that is nearest to an unknown one; "" if none is near."""
    found = [each for each in known if each.partition(".")[2] == name] or difflib.get_close_matches(name, known, 1, 0.5)
    return f"the nearest is {found[0]}; " if found else ""


SETTING = opts(
    "-s --setting settings", "Any other setting, such as wall.power=2; helibore settings lists them.",
    metavar="NAME=VALUE", expose_value=False, callback=_known,
)  # fmt: skip
COLUMN = opts(
    "--column", "Column of a role, such as depth=md_m:ft, radius=CAL1@90:in or toolface=rb:deg.  [guessed; see "
    "helibore inspect]",
    metavar="ROLE=COLUMN", expose_value=False, callback=_known,
)  # fmt: skip
