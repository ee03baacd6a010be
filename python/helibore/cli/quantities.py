"""Option values: ``8.5in``, ``0.216m``, ``90deg`` (a bare number is metres or degrees), lists and pairs of them."""

from __future__ import annotations

from collections.abc import Callable
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


class Parsed(Parameter[Any]):
    """A text that a function reads; ``rule`` says what it must be."""

    def __init__(self, name: str, rule: str, parse: Callable[[str], Any]) -> None:
        self.name, self.rule, self.parse = name, rule, parse

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Read the text of an option."""
        if not isinstance(value, str):
            return value
        try:
            return self.parse(value)
        except ValueError:
            self.fail(f"'{value}': must be {self.rule}", param, ctx)


def _shift(text: str) -> tuple[int, float]:
    number, length = text.split("=")
    return int(number), units.quantity(length, units.LENGTH)


def _lift(text: str) -> tuple[float, float]:
    depth, length = text.split(":")
    return float(depth), float(length)


FILE = click.Path(path_type=Path)
LENGTH = Quantity(units.LENGTH)
LENGTH_OR_NONE = Quantity(units.LENGTH, none=True)
ANGLE = Quantity(units.ANGLE)
TIME = Quantity(units.TIME)
BIT = BitDiameter()
NUMBERS = Parsed("numbers", "pass numbers, such as 2,3", lambda text: tuple(int(number) for number in text.split(",")))
SHIFT = Parsed("pass=length", "PASS=LENGTH, such as 3=-0.2m", _shift)
LIFT = Parsed("depth:length", "DEPTH:LENGTH in metres, such as 2030:5", _lift)
