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

from helibore._core import __version__
from helibore.base.errors import MissingExtraError

VERBS = ("demo", "inspect", "journal", "live", "logs", "mesh", "plot", "reconstruct", "report", "reprocess",
         "simulate", "view")  # fmt: skip
MODULES = {"reconstruct": "mesh", "report": "plot"}
"""The module of each verb whose module has another name: ``reconstruct`` is in ``mesh_command``."""


class BadInput(click.ClickException):
    """An error that the user can correct; the error is shown in one line and ends the command with exit code 2."""

    exit_code = 2

    def show(self, file: IO[Any] | None = None) -> None:
        click.echo(f"helibore: {' '.join(self.message.split())}", file=file, err=True)


@contextmanager
def _one_line_errors() -> Iterator[None]:
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
        raise BadInput(str(error)) from error


class Verbs(click.Group):
    """The group of all verbs; the module of a verb is loaded when the verb is called."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002
        return list(VERBS)

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
        with _one_line_errors():
            return super().invoke(ctx)


@click.group(cls=Verbs, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.version_option(__version__, message="helibore %(version)s", help="Show the version.")
def cli() -> None:
    """Turn scattered borehole measurements into a wall.

    \b
    helibore demo                                       a simulated hole, from samples to mesh and picture
    helibore reconstruct caliper.csv -o wall.glb --bit-diameter 8.5in
    """


def main() -> None:
    """Run the command line and exit with its code."""
    sys.exit(cli(prog_name="helibore"))
