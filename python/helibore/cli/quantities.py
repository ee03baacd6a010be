"""Parse values of options: ``8.5in``, ``90deg`` (a number without a unit is metres or degrees), lists and pairs."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import click

from helibore.base import units

if TYPE_CHECKING:
    Parameter = click.ParamType
else:
    Read = TypeVar("Read")

    class Parameter(click.ParamType, Generic[Read]):
        """The type to which the text of an option is converted; click has such types only from 8.4 on."""


class Quantity(Parameter[float | None]):
    """The type of an option that is a number with a unit of ``kind``; the number becomes metres, degrees or seconds.

    A number above ``largest`` is refused. With ``none``, the word none is allowed and becomes None.
    """

    def __init__(self, kind: str, none: bool = False, largest: float = float("inf")) -> None:
        self.kind, self.name, self.none, self.largest = kind, kind, none, largest

    def convert(self, value: str | float, param: click.Parameter | None, ctx: click.Context | None) -> float | None:
        if self.none and str(value).lower() == "none":
            return None
        try:
            number = units.quantity(value, self.kind) if isinstance(value, str) else value
        except ValueError as error:
            self.fail(str(error), param, ctx)
        if number is not None and number > self.largest:  # most often the user left out the unit inches
            bare, unit = str(value).strip()[-1:].isdigit(), "mm" if number > 100 else "in"
            meant = f"; a number without a unit is metres; did you mean {value}{unit}?" if bare else ""
            self.fail(f"'{value}': must be at most {self.largest:g} m{meant}", param, ctx)
        return number


ACROSS = ("bit diameter", *(f"criterion {name}" for name in ("elongation", "washout", "key seat", "undergauge")))
"""Names of the facts that are sizes across the hole; the other lengths among the facts lie along it."""


def across_and_along(unit: str) -> tuple[str, str]:
    """Return the units that ``--unit`` means, first across the hole, then along it; ft: inches across, feet along."""
    return ("in", "ft") if unit == "ft" else (unit, "m")


def facts_in(facts: Mapping[str, str], unit: str) -> dict[str, str]:
    """Return the facts of a table (texts by name), with lengths in the units that ``--unit`` means."""
    across, along = across_and_along(unit)

    def changed(name: str, text: str) -> str:
        length, to = re.match(r"([-+.\de]+) m(?= of depth$|$)", text), across if name in ACROSS else along
        if length is None or to == "m":
            return text
        return f"{float(length[1]) / units.factor(to, units.LENGTH):.6g} {to}{text[length.end() :]}"

    return {name: changed(name, text) for name, text in facts.items()}


class Parsed(Parameter[Any]):
    """The type of an option whose text ``parse`` reads; ``rule`` says what the text must be."""

    def __init__(self, name: str, rule: str, parse: Callable[[str], Any]) -> None:
        self.name, self.rule, self.parse = name, rule, parse

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
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


def _body_length(text: str) -> float | str:
    return text if text.startswith("api-") else units.quantity(text, units.LENGTH)


def split_pair(option: str, text: str, form: str = "NAME=...") -> tuple[str, str]:
    """Split NAME=VALUE at its last equals sign; if a part is missing, a usage error states the form of the option."""
    name, equals, value = text.rpartition("=")
    if not (name and equals and value):
        raise click.UsageError(f"--{option} {text}: must be {form}")
    return name, value


FILE = click.Path(path_type=Path)
FOLDER = click.Path(path_type=Path, file_okay=False)
LENGTH = Quantity(units.LENGTH)
LENGTH_OR_NONE = Quantity(units.LENGTH, none=True)
ANGLE = Quantity(units.ANGLE)
TIME = Quantity(units.TIME)
BIT = Quantity(units.LENGTH, largest=4.0)
NUMBERS = Parsed("numbers", "pass numbers, such as 2,3", lambda text: tuple(int(number) for number in text.split(",")))
SHIFT = Parsed("pass=length", "PASS=LENGTH, such as 3=-0.2m", _shift)
BODY_LENGTH = Parsed("length", "a length, such as 9m, or the name of an API mandrel", _body_length)
LIFT = Parsed("depth:length", "DEPTH:LENGTH in metres, such as 2030:5", _lift)
