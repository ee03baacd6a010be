"""Define the options for criteria of zones, which ``helibore logs``, ``plot``, ``report`` and ``view`` have."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any

import click

from helibore.base.errors import InputError
from helibore.cli.quantities import split_pair
from helibore.cli.sections import near, opt, opts

if TYPE_CHECKING:
    from helibore.logs.zone_criteria import Criteria
    from helibore.wall.wall import Wall

CRITERIA = (
    opts("--criterion criteria", "Criterion of zones, such as washout=0.3in (least C2 - bit), elongation (least C1 - "
         "C2 of a breakout), key-seat (least height), undergauge (bit - least diameter), symmetry, least-length, join. "
         "C1 is the largest diameter, C2 the diameter across C1.", metavar="NAME=VALUE"),
    opt("--scaled", "Scale the default criteria, which are for a bit of 8.5 in, to the bit size.", is_flag=True),
)  # fmt: skip


def criteria_of(wall: Wall, options: dict[str, Any]) -> Criteria:
    """Return the criteria of zones: the values that ``-s zones.NAME`` states, and default values of the other criteria.

    With ``zones.scaled``, the default values are scaled to the bit size.
    """
    from helibore.base import units
    from helibore.logs.zone_criteria import Criteria

    if wall.basis != "azimuthal" and (options["criteria"] or options["scaled"]):
        raise InputError("zones", f"need a shape that was measured; this wall: {wall.basis_text}")
    shares = ("symmetry", "opening_level")
    known = [field.name for field in fields(Criteria)]
    found = {}
    for text in options["criteria"]:
        name, value = split_pair("setting", text, "zones.NAME=VALUE")
        name = name.replace("-", "_")
        if name not in known:
            raise click.UsageError(f"-s zones.{name}: {near(name, known)}must be one of {', '.join(known)}")
        try:
            if name not in (*shares, "least_length", "join") and value[-1:].isdigit():  # no unit is stated
                raise click.UsageError(f"-s zones.{text}: needs a unit, such as {value}in or {value}mm")
            found[name] = float(value) if name in shares else units.quantity(value, units.LENGTH)
        except ValueError as error:
            rule = "must be a number from 0 to 1" if name in shares else error
            raise click.UsageError(f"-s zones.{text}: {rule}") from None
    return Criteria.scaled(wall.settings.bit_diameter, **found) if options["scaled"] else Criteria(**found)
