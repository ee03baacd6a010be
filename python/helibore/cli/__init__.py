"""The command line: ``helibore <verb>``. The module of a verb is loaded when the verb is called or listed.

    exit code 0   done
              1   an error in helibore itself, with a traceback; or Ctrl-C
              2   wrong input or option, or an error of the disk; one line on stderr names place, value and rule
              3   ``reprocess``: some wells failed and the others are done, or the catalogue could not be written
              130 ``reprocess``: stopped by Ctrl-C

Each verb turns its options into calls of the library and prints the result.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import IO, Any

import click

from helibore.base.errors import MissingExtraError, shown

VERBS = {
    "cement": "Write the cement sheet of a casing in the measured hole.",
    "demo": "Simulate a hole and write its wall as a mesh and a picture.",
    "inspect": "Show what a file holds and which role each channel gets.",
    "journal": "Check, list, replay, export and archive a journal.",
    "live": "Build a wall from live sources while a hole is drilled.",
    "logs": "Write the logs of a wall as LAS, CSV, Parquet or DLIS.",
    "mesh": "Build a mesh or a volume of a wall with its images.",
    "page": "Write one HTML file that rebuilds walls in a browser, offline.",
    "passage": "Find which cylinders and strings pass the measured hole.",
    "plot": "Draw the log of a wall as PNG, SVG or PDF at a true scale.",
    "reconstruct": "Build the wall of a borehole from caliper files and a survey.",
    "report": "Write a report of a wall as one HTML page.",
    "reprocess": "Rebuild the walls of many wells, on this machine or a cluster.",
    "settings": "List the settings that -s states, with their defaults.",
    "simulate": "Simulate a hole and a tool, and write the samples to files.",
    "stress": "Write the direction of SHmax with its World Stress Map rank.",
    "view": "Show a wall in the browser.",
    "zones": "Write the washouts, breakouts and key seats of a wall.",
}
"""Each verb and what it does; the list of verbs is shown without loading their modules."""
MODULES = {"reconstruct": "mesh", "report": "plot", "zones": "logs"}
"""The module of each verb whose module has another name: ``reconstruct`` is in ``mesh_command``."""


class BadInput(click.ClickException):
    """An error that the user can correct; the error is shown in one line and ends the command with exit code 2."""

    exit_code = 2

    def show(self, file: IO[Any] | None = None) -> None:
        click.echo(f"helibore: {shown(' '.join(self.message.split()))}", file=file, err=True)


@contextmanager
def _one_line_errors(ctx: click.Context | None = None) -> Iterator[None]:
    """Turn each error that a user can correct into `BadInput`; it names the option of the setting that it is about."""
    try:
        yield
    except click.UsageError as error:
        if type(error).__name__ == "NoArgsIsHelpError":  # click 8.2 and later raise this to show the help
            raise
        hint = f" (see {error.ctx.command_path} --help)" if error.ctx else ""
        raise BadInput(error.format_message() + hint) from error
    except BrokenPipeError:
        raise
    except OSError as error:
        reason = error.strerror or str(error)
        raise BadInput(f"{error.filename}: {reason}" if error.filename else reason) from error
    except (ValueError, MissingExtraError) as error:
        option = _option_of(getattr(error, "setting", ""), ctx)
        raise BadInput(f"{error} (option: {option})" if option else str(error)) from error


def _option_of(setting: str, ctx: click.Context | None) -> str:
    """Return what states a setting in the command that runs; "" if it has no option for it."""
    if not setting or ctx is None or not isinstance(ctx.command, click.Group):
        return ""
    command = ctx.command.get_command(ctx, ctx.invoked_subcommand or "")
    if command is None:
        return ""
    from helibore.cli.sections import spelled_setting

    return spelled_setting(command, setting)


class Verbs(click.Group):
    """The group of all verbs; the module of a verb is loaded when the verb is called."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002
        return list(VERBS)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        """List the verbs; their modules are not loaded."""
        with formatter.section("Commands"):
            formatter.write_dl(list(VERBS.items()))

    def resolve_command(self, ctx: click.Context, args: list[str]) -> Any:
        """Find the verb; an unknown one is an error that names the nearest."""
        if args and args[0] not in VERBS and not args[0].startswith("-"):
            import difflib

            near = difflib.get_close_matches(args[0], VERBS, 1)
            raise click.UsageError(f"No such command '{args[0]}'.{f' Did you mean {near[0]}?' if near else ''}", ctx)
        return super().resolve_command(ctx, args)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002
        """Load the module of a verb and return its command; None if there is no such verb."""
        if cmd_name not in VERBS:
            return None
        module = importlib.import_module(f"helibore.cli.{MODULES.get(cmd_name, cmd_name)}_command")
        command: click.Command = getattr(module, cmd_name)
        return command

    def make_context(self, *args: Any, **extra: Any) -> click.Context:
        with _one_line_errors():
            return super().make_context(*args, **extra)

    def invoke(self, ctx: click.Context) -> Any:
        with _one_line_errors(ctx):
            return super().invoke(ctx)


@click.group(cls=Verbs, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.version_option(package_name="helibore", message="helibore %(version)s", help="Show the version.")
def cli() -> None:
    """Turn scattered borehole measurements into a wall.

    \b
    helibore demo                                       a simulated hole, from samples to mesh and picture
    helibore reconstruct caliper.csv --bit-diameter 8.5in -o well.wall
    helibore plot well.wall -o well.pdf
    """


def main() -> None:
    """Run the command line and exit with its code."""
    sys.exit(cli(prog_name="helibore"))
