"""Define the options that take NAME=VALUE of a group of settings: criteria of zones, entries of a header, looks.

``helibore logs``, ``zones``, ``plot``, ``report`` and ``view`` have them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from helibore.base.errors import InputError, unknown_name
from helibore.cli.declared_options import option_of
from helibore.cli.sections import opts
from helibore.settings.declared import members
from helibore.settings.groups import GROUPS
from helibore.settings.look_texts import look_of_setting, look_of_text, merged_looks
from helibore.settings.toml_reading import parse_setting
from helibore.settings.zone_settings import ZoneSettings

if TYPE_CHECKING:
    from helibore.logs.zone_criteria import Criteria
    from helibore.wall.wall import Wall


def stated_of(group: str, texts: Sequence[str]) -> dict[str, Any]:
    """Return the settings of a group that texts state, by name: ``washout=0.3in``, or with its group before it."""
    if group == "look":
        looks = merged_looks(
            look_of_setting(text.removeprefix("look."), "-s look.")
            if text.startswith("look.")
            else look_of_text(text, "--look")
            for text in texts
        )
        return dict(looks)
    known, found = members(GROUPS[group]), {}
    for text in texts:
        place = f"-s {group}." if text.startswith(f"{group}.") else f"--{group} "
        name, equals, value = text.removeprefix(f"{group}.").partition("=")
        name = name.replace("-", "_")
        if name not in known:
            raise unknown_name(f"{place}{name}", name, known)
        if not equals:
            raise InputError(f"{place}{text}", "must be NAME=VALUE")
        found[name] = parse_setting(known[name], value, f"{place}{name}")
    return found


def _family(group: str, names: str, help: str, metavar: str) -> tuple[str, dict[str, Any]]:  # noqa: A002
    """Return an option that takes NAME=VALUE of a group; its value is what the command line states, by name."""
    return opts(names, help, metavar=metavar, callback=lambda _, __, texts: stated_of(group, texts))


CRITERIA = (
    _family("zones", "--criterion criteria", "Criterion of zones.", "NAME=VALUE"),
    option_of(members(ZoneSettings)["scaled"]),
)
IMAGE_CRITERIA = _family(
    "image_zones", "--image-criterion image_criteria", "Criterion of breakouts in an image.", "NAME=VALUE"
)
HEADER = _family(
    "header", "--header", "Entry of the header, such as company=ACME.  [as the files state it]", "NAME=TEXT"
)
LOOK = _family(
    "look", "--look",
    "Colours of an image or scale of a curve: GR=20,150 or RES=0.2,2000,log or GR=map:viridis,window:2m.",
    "NAME=LOOK",
)  # fmt: skip


def criteria_of(wall: Wall, options: dict[str, Any]) -> Criteria:
    """Return the criteria of zones: the values that are stated, and default values of the other criteria.

    With ``zones.scaled``, the default values are scaled to the bit size.
    """
    from helibore.logs.zone_criteria import Criteria

    found = options["criteria"]
    if wall.basis != "azimuthal" and (found or options["scaled"]):
        raise InputError("zones", f"need a shape that was measured; this wall: {wall.basis_text}")
    return Criteria.scaled(wall.settings.bit_diameter, **found) if options["scaled"] else Criteria(**found)
