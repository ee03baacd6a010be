"""Define the options for criteria of zones, which ``helibore logs``, ``plot``, ``report`` and ``view`` have."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from helibore.base.errors import InputError
from helibore.cli.quantities import split_pair
from helibore.cli.sections import near, opt, opts
from helibore.settings.declared import members
from helibore.settings.toml_reading import parse_setting

if TYPE_CHECKING:
    from helibore.logs.zone_criteria import Criteria
    from helibore.wall.wall import Wall

CRITERIA = (
    opts("--criterion criteria", "Criterion of zones, such as washout=0.3in (least C2 - bit), elongation (least C1 - "
         "C2 of a breakout), key-seat (least height), undergauge (bit - least diameter), symmetry, least-length, join. "
         "C1 is the largest diameter, C2 the diameter across C1.", metavar="NAME=VALUE"),
    opt("--scaled", "Scale the default criteria, which are for a bit of 8.5 in, to the bit size.", is_flag=True),
)  # fmt: skip


def criteria_stated(texts: Sequence[str]) -> dict[str, float]:
    """Return the criteria that ``-s zones.NAME=VALUE`` states, by name."""
    from helibore.logs.zone_criteria import Criteria

    known, found = members(Criteria), {}
    for text in texts:
        name, value = split_pair("setting", text, "zones.NAME=VALUE")
        name = name.replace("-", "_")
        if name not in known:
            raise click.UsageError(f"-s zones.{name}: {near(name, list(known))}must be one of {', '.join(known)}")
        try:
            found[name] = parse_setting(known[name], value)
        except InputError as error:
            raise click.UsageError(f"-s zones.{text}: {error.rule}") from None
    return found


def criteria_of(wall: Wall, options: dict[str, Any]) -> Criteria:
    """Return the criteria of zones: the values that are stated, and default values of the other criteria.

    With ``zones.scaled``, the default values are scaled to the bit size.
    """
    from helibore.logs.zone_criteria import Criteria

    found = options["criteria"]
    if wall.basis != "azimuthal" and (found or options["scaled"]):
        raise InputError("zones", f"need a shape that was measured; this wall: {wall.basis_text}")
    return Criteria.scaled(wall.settings.bit_diameter, **found) if options["scaled"] else Criteria(**found)
