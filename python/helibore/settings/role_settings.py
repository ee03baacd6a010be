"""The settings of a role map: what the channels of a file are, and names that mean a role in every file."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Literal, cast

from helibore.base import units
from helibore.settings.declared import DEGREES, FINITE, METRES, SECONDS, Declared, Rule
from helibore.settings.path_settings import North

ROLES: dict[str, str] = {
    "depth": units.LENGTH,
    "time": units.TIME,
    "toolface": units.ANGLE,
    "radius": units.LENGTH,
    "diameter": units.LENGTH,
    "mean-diameter": units.LENGTH,
    "radius-image": units.LENGTH,
    "travel-time": units.TIME,
    "image": "",
    "inclination": units.ANGLE,
    "azimuth": units.ANGLE,
    "tvd": units.LENGTH,
    "north": units.LENGTH,
    "east": units.LENGTH,
    "bit-diameter": units.LENGTH,
    "pass": "",
    "toolface-reference": "",
    "none": "",
}
"""Every role, and what its unit must measure ("" for any unit)."""

A_ROLE = Rule(f"must be one of {', '.join(ROLES)}", lambda value: value in ROLES)
NOT_EMPTY = Rule("must name at least one", lambda value: len(value) > 0)
ToolfaceReference = Literal["north", "horizontal-north", "high-side", "automatic"]


@dataclass(frozen=True, kw_only=True)
class ChannelRole(Declared, group="map.channels.NAME"):
    """What a channel is. A key that is left out keeps its guess, which names and units give."""

    role: Annotated[str, A_ROLE,
        "What the values of the channel are.",
    ] = cast(str, None)  # fmt: skip  # None: as guessed; the text none is a role
    unit: Annotated[str | None, "Unit of the values."] = None
    angle: Annotated[float | None, DEGREES, FINITE, "Direction of a radius or diameter from the toolface."] = None
    first: Annotated[float | None, DEGREES, FINITE,
        "Angle of the first sector of an image; in a radius image, of the sector's centre.",
    ] = None  # fmt: skip
    step: Annotated[float | None, DEGREES, FINITE, "Angle from one sector of an image to the next."] = None
    offset: Annotated[float | None, METRES, FINITE,
        "How far this sensor lies above the point whose depth is recorded.",
    ] = None  # fmt: skip
    latency: Annotated[float | None, SECONDS, FINITE, "Time from a measurement to its time stamp."] = None
    zero: Annotated[float | None, METRES, FINITE,
        "What is added to each radius of this sensor: where its values are standoffs, how far the face of the tool "
        "lies from its axis; to a diameter twice as much.",
    ] = None  # fmt: skip
    reference: Annotated[ToolfaceReference | None,
        "What a toolface counts from. horizontal-north: the angle lies in the horizontal plane, as the azimuth of a "
        "pad does; the others lie across the hole. automatic: north where the hole is nearly vertical, else the high "
        "side.",
    ] = None  # fmt: skip
    north: Annotated[North | None, "Which north a toolface or an azimuth counts from."] = None


@dataclass(frozen=True, kw_only=True)
class RoleOfNames(Declared, group="map.names"):
    """Names that mean a role in every file that is read with the map."""

    names: Annotated[tuple[str, ...], NOT_EMPTY, "Names of channels, without units."]
    role: Annotated[str, A_ROLE, "What the values of these channels are."]
    unit: Annotated[str | None, "Unit of the values, where the file states none."] = None
    reference: Annotated[ToolfaceReference | None, "What a toolface counts from."] = None
    north: Annotated[North | None, "Which north a toolface or an azimuth counts from."] = None
    angle: Annotated[float | None, DEGREES, FINITE, "Direction of an arm from the toolface."] = None


@dataclass(frozen=True, kw_only=True)
class MapOfRoles(Declared, group="map"):
    """A role map, a file of its own, without ``map.`` in the names of its tables; `helibore inspect` prints one."""

    set: Annotated[str | None, "Which set of the file. None: its only set."] = None
    channels: Annotated[dict[str, ChannelRole], "What a channel is, by its name."] = field(default_factory=dict)
    names: Annotated[tuple[RoleOfNames, ...], "Names that mean a role."] = ()
