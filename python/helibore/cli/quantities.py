"""Option values: ``8.5in``, ``0.216m``, ``90deg`` (a bare number is metres or degrees), lists and pairs of them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import click

from helibore.base import units

if TYPE_CHECKING:
    Parameter = click.ParamType
else:
    Read = TypeVar("Read")

    class Parameter(click.ParamType, Generic[Read]):
        """What an option's text is read to; click says so itself only from 8.4 on."""


class Quantity(Parameter[float | None]):
    """A number with a unit of one kind, in metres, degrees or seconds."""

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


class BitDiameter(Quantity):
    """A length no larger than a bit; inches without a unit are the usual mistake."""

    LARGEST = 4.0

    def __init__(self) -> None:
        super().__init__(units.LENGTH)

    def convert(self, value: str | float, param: click.Parameter | None, ctx: click.Context | None) -> float | None:
        """Read the text of an option."""
        metres = super().convert(value, param, ctx)
        if metres is not None and metres > self.LARGEST:
            unit = "mm" if metres > 100 else "in"
            meant = f"; a number without a unit is metres: {value}{unit}?" if _bare(value) else ""
            self.fail(f"'{value}': must be at most {self.LARGEST:g} m{meant}", param, ctx)
        return metres


def _bare(value: str | float) -> bool:
    return str(value).strip()[-1:].isdigit()


class Numbers(Parameter[tuple[int, ...]]):
    """``2,3,5``."""

    name = "numbers"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[int, ...]:
        """Read the text of an option."""
        if isinstance(value, tuple):
            return value
        try:
            return tuple(int(one) for one in str(value).split(","))
        except ValueError:
            self.fail(f"'{value}': must be pass numbers, such as 2,3", param, ctx)


class Shift(Parameter[tuple[int, float]]):
    """``PASS=LENGTH``."""

    name = "pass=length"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[int, float]:
        """Read the text of an option."""
        number, mark, length = str(value).partition("=")
        try:
            found = LENGTH.convert(length, param, ctx)
            if not mark or found is None:
                raise ValueError
            return int(number), found
        except ValueError:
            self.fail(f"'{value}': must be PASS=LENGTH, such as 3=-0.2m", param, ctx)


FILE = click.Path(path_type=Path)
LENGTH = Quantity(units.LENGTH)
LENGTH_OR_NONE = Quantity(units.LENGTH, none=True)
ANGLE = Quantity(units.ANGLE)
TIME = Quantity(units.TIME)
BIT = BitDiameter()
NUMBERS = Numbers()
SHIFT = Shift()
