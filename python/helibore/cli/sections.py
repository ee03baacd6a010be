"""A command whose help lists its options in sections, for verbs that have many."""

from __future__ import annotations

import click


class Sectioned(click.Command):
    """``sections`` names the first option of each section: {"--depth": "Columns", ...}."""

    sections: dict[str, str] = {}  # noqa: RUF012

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options under their headings, in the order they were given."""
        heading = "Options"
        rows: dict[str, list[tuple[str, str]]] = {}
        for parameter in (one for one in self.get_params(ctx) if isinstance(one, click.Option)):
            heading = next((self.sections[name] for name in parameter.opts if name in self.sections), heading)
            record = parameter.get_help_record(ctx)
            if record is not None:
                rows.setdefault(heading if parameter.name != "help" else "Options", []).append(record)
        for title, records in rows.items():
            with formatter.section(title):
                formatter.write_dl(records)
