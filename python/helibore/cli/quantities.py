"""Option values with units: ``8.5in``, ``0.216m``, ``90deg``; a bare number is metres or degrees."""

from __future__ import annotations

import click

from helibore import units


class Quantity(click.ParamType[float | None]):
    """A number with a unit of one kind, read to metres, degrees or seconds."""

    def __init__(self, kind: str, none: bool = False) -> None:
        self.kind, self.name, self.none = kind, kind, none

    def convert(self, value: str | float, param: click.Parameter | None, ctx: click.Context | None) -> float | None:
        """Read the text of an option."""
        if not isinstance(value, str):
            return value
        if self.none and value.lower() == "none":
            return None
        try:
            return units.quantity(value, self.kind)
        except ValueError as error:
            self.fail(str(error), param, ctx)


LENGTH = Quantity(units.LENGTH)
LENGTH_OR_NONE = Quantity(units.LENGTH, none=True)
ANGLE = Quantity(units.ANGLE)
TIME = Quantity(units.TIME)
