"""The settings of what is made from a wall: tables of logs, passage of bodies, meshes, the page in the browser."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from helibore.base.file_endings import VOLUME_ENDINGS
from helibore.settings.declared import (
    DEGREES,
    FINITE,
    METRES,
    NOT_NEGATIVE,
    POSITIVE,
    Declared,
    Formerly,
    Option,
    Rule,
    at_least,
    within,
)

SHORTEST = 0.001
"""Metres: a body is at least this long."""
Mandrel = Literal["api-casing", "api-large-casing", "api-tubing"]
"""The drift mandrels of API 5CT."""
TableUnit = Literal["m", "mm", "in", "ft"]
ALL_POSITIVE = Rule("must be finite and above 0", lambda values: all(map(POSITIVE.test, values)))
LENGTH_OR_MANDREL = Rule(
    "must be finite and above 0, or the name of an API mandrel",
    lambda value: isinstance(value, str) or POSITIVE.test(value),
)
ALL_LENGTHS = Rule(LENGTH_OR_MANDREL.text, lambda values: all(map(LENGTH_OR_MANDREL.test, values)))


@dataclass(frozen=True, kw_only=True)
class LogSettings(Declared, group="logs"):
    """What tables of a wall hold: logs, zones, passage."""

    step: Annotated[float | None, METRES, POSITIVE, Option("one row for each turn"),
        "One row for each step of depth. None: one row for each turn.",
    ] = None  # fmt: skip
    rugosity_window: Annotated[float, METRES, POSITIVE, Option(),
        "Length of hole for rugosity, made an odd number of turns. 1 m at a pitch of 0.1 m is 9 turns.",
    ] = 1.0  # fmt: skip
    sigma: Annotated[bool, Option(), "Also write the uncertainty of diameters and volumes: DEQ_SIGMA, C1_SIGMA..."] = (
        False
    )
    caliper_accuracy: Annotated[float, METRES, NOT_NEGATIVE, Option(),
        "Standard uncertainty that all radii share: the tool's calibration, the velocity in the mud.",
    ] = 0.0  # fmt: skip
    by_sector: Annotated[bool, Option(),
        "Also write radius, images and, with sigma, uncertainty by turn and sector: arrays in DLIS, columns NAME[1] "
        "... in the others.",
    ] = False  # fmt: skip
    casing: Annotated[tuple[float, ...], METRES, ALL_POSITIVE, Formerly("casings"), Option(metavar="LENGTH"),
        "Outer diameter of a casing, for its annulus and clearance.",
    ] = ()  # fmt: skip
    drift: Annotated[tuple[float | Mandrel, ...], METRES, ALL_LENGTHS, Formerly("drifts"), Option(metavar="LENGTH"),
        "Length of a rigid cylinder, or api-casing, api-large-casing or api-tubing, for its greatest diameter: 9m "
        "gives DRIFT_9M.",
    ] = ()  # fmt: skip
    unit: Annotated[TableUnit, Option(),
        "Unit of diameters, radii and other sizes across the hole, also of the criteria; depths stay in metres. ft: "
        "inches, and feet for depths. Volumes stay in m3.",
    ] = "m"  # fmt: skip


@dataclass(frozen=True)
class RigidBody(Declared, group="passage.body"):
    """A cylinder of a string.

    A value that breaks its rule is refused: ``length = 0: must be at least 0.001 m``.
    """

    diameter: Annotated[float, METRES, NOT_NEGATIVE, "Outer diameter."]
    length: Annotated[float, METRES, NOT_NEGATIVE, at_least(SHORTEST, "m"), "Length."]
    position: Annotated[float, METRES, NOT_NEGATIVE,
        "From the lower end of the string, the bit, up to the lower end of the body.",
    ] = 0.0  # fmt: skip
    name: Annotated[str, "What it is, such as stabiliser."] = ""


@dataclass(frozen=True, kw_only=True)
class PassageSettings(Declared, group="passage"):
    """What shall pass through the hole."""

    length: Annotated[float | Mandrel | None, METRES, LENGTH_OR_MANDREL,
        Option("api-large-casing, 0.305 m", metavar="LENGTH"),
        "Length of one rigid cylinder, whose greatest diameter is sought: 9m, or api-casing, api-large-casing or "
        "api-tubing.",
    ] = None  # fmt: skip
    body: Annotated[tuple[RigidBody, ...], METRES, Formerly("bodies"), Option(metavar="BODY"),
        "Body of a rigid string, DIAMETER,LENGTH, then perhaps POSITION and NAME: 8.5in,0.3m and 8in,9m,0.3m,collar. "
        "The position is that of the body's lower end above the string's.",
    ] = ()  # fmt: skip
    limit: Annotated[float | None, METRES, NOT_NEGATIVE, Option("bit size; 0"),
        "List the intervals below this diameter, or this clearance of a string.",
    ] = None  # fmt: skip
    sigma: Annotated[bool, Option(), "Also write the 95 % interval: LOW, HIGH."] = False


@dataclass(frozen=True, kw_only=True)
class StressSettings(Declared, group="stress"):
    """The direction of the greatest horizontal stress, SHmax."""

    feature: Annotated[Literal["breakout", "induced fracture"], Option(), "Class of picks."] = "breakout"
    of_zones: Annotated[bool, Option(), "Take the breakouts of the wall's zones, not the picks."] = False
    scheme: Annotated[Literal["image", "caliper"] | None, Option("image for picks, caliper for zones"),
        "Limits of the ranks, by the log.",
    ] = None  # fmt: skip
    weighting: Annotated[Literal["length", "number"], Option(), "What weighs a feature."] = "length"
    to_true: Annotated[float | None, DEGREES, FINITE, Option("none; needed if the survey states another north"),
        "Angle that turns azimuths to true north: declination of magnetic, convergence of grid azimuths.",
    ] = None  # fmt: skip
    latitude: Annotated[float | None, FINITE, Option(), "Latitude of the well, degrees; south is negative."] = None
    longitude: Annotated[float | None, FINITE, Option(), "Longitude of the well, degrees; west is negative."] = None
    regime: Annotated[Literal["NF", "NS", "SS", "TS", "TF", "U"], Option("U: not known"), "Regime of the record."] = "U"


@dataclass(frozen=True, kw_only=True)
class MeshSettings(Declared, group="mesh"):
    """What a mesh holds."""

    shell: Annotated[tuple[float, ...], METRES, ALL_POSITIVE, Formerly("shells"), Option(metavar="LENGTH"),
        f"Write a volume of hexahedra this thick around the wall ({', '.join(VOLUME_ENDINGS)}).",
    ] = ()  # fmt: skip
    sigma: Annotated[bool, Option(), "Add the standard uncertainty of the radius."] = False
    nearest: Annotated[bool, Option(), "Add the distance to the nearest sample as the attribute 'nearest'."] = False
    measured: Annotated[bool, Option(),
        "Add the attribute 'measured': whether a quad is measured (1) or interpolated (0). Meshes of a tool with few "
        "arms always have this attribute.",
    ] = False  # fmt: skip
    color_by: Annotated[str | None, Option("the first image, or else radius", metavar="NAME"),
        "Attribute that colours a GLB, PLY or VTK file: an image, difference, sigma, nearest, measured or radius. "
        "None: the first image, or else the radius.",
    ] = None  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class ViewSettings(Declared, group="view"):
    """The page in the browser."""

    host: Annotated[str, Option(metavar="ADDRESS"), "Address of the page."] = "127.0.0.1"
    port: Annotated[int, within(0, 65535), Option(), "Port; 0: a free port."] = 0
    browser: Annotated[bool, "Open the page."] = True
    sigma: Annotated[bool, Option(), "Add the standard uncertainty of the radius."] = False
