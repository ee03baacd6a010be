"""The settings of a print and a report, and of the colours of what they show."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from string import ascii_uppercase
from typing import Annotated, Any, Literal

from helibore.base.errors import InputError
from helibore.settings.declared import (
    DEGREES,
    FINITE,
    INCHES,
    METRES,
    POSITIVE,
    Declared,
    Formerly,
    Option,
    Rule,
    within,
)
from helibore.settings.template import SizeUnit

MOST_SECTIONS = len(ascii_uppercase)
LARGEST_SCALE = 1_000_000
Diameter = Literal["C1", "C2", "D0", "D90"]

A_SIDE = Rule("must be 0, 90, 180 or 270", lambda value: value in (0, 90, 180, 270))
FEW_SECTIONS = Rule(f"must be at most {MOST_SECTIONS} depths", lambda value: len(value) <= MOST_SECTIONS)
TWO_OR_NONE = Rule("must be two depths, or none to draw no body", lambda value: len(value) in (0, 2))
ALL_FINITE = Rule("must be finite", lambda values: all(map(math.isfinite, values)))


@dataclass(frozen=True, kw_only=True)
class PrintSettings(Declared, group="print"):
    """What a print and a report show, and how."""

    scale: Annotated[int | None, within(1, LARGEST_SCALE), Option("the finest usual scale that fits", metavar="N"),
        "Depth scale, 200 or 1:200. None: the finest usual scale for the length of the interval.",
    ] = None  # fmt: skip
    unit: Annotated[SizeUnit, Option(), "Unit of diameters; ft: inches, and feet for depths."] = "mm"
    curves: Annotated[tuple[Diameter, ...], Option("C1,C2", metavar="CURVES"),
        "Diameters in the caliper track, beside the diameter by area. C1 is the largest diameter, C2 the diameter at "
        "right angles to it, D0 reaches from toolface 0 to 180, D90 from 90 to 270.",
    ] = ("C1", "C2")  # fmt: skip
    left: Annotated[float, DEGREES, A_SIDE, Option(),
        "Toolface at the left edge of images. With 180, toolface 0 is in the middle.",
    ] = 0.0  # fmt: skip
    images: Annotated[tuple[str, ...] | None, Option("all", metavar="NAMES"),
        "Names of the images to draw, in this order. None: all images of the wall.",
    ] = None  # fmt: skip
    polar: Annotated[tuple[float, ...] | None, METRES, FEW_SECTIONS, ALL_FINITE,
        Option("helibore chooses up to four", metavar="DEPTHS"),
        "Depths of cross sections. None: in the worst zone of each kind, a usual turn, the largest or oval one; empty: "
        "no cross sections.",
    ] = None  # fmt: skip
    body: Annotated[tuple[float, ...] | None, METRES, TWO_OR_NONE, ALL_FINITE,
        Option("the 12 m with most relief", metavar="FROM,TO"),
        "Interval of the 3-D view. None: the 12 m with most relief, or no body if calipers did not measure all around; "
        "empty: no body.",
    ] = None  # fmt: skip
    ticks: Annotated[float | None, POSITIVE, Option("none", metavar="M3"),
        "Volume between the ticks of integrated hole volume (IHV), m3, beside the calipers; every tenth is long.",
    ] = None  # fmt: skip
    casing: Annotated[float | None, INCHES, POSITIVE, Option("none", metavar="LENGTH"),
        "Outer diameter of a casing, for ticks of its annulus (ICV), which need `ticks`.",
    ] = None  # fmt: skip
    dpi: Annotated[int, within(30, 1200), Option(), "Pixels an inch."] = 150
    elevation: Annotated[float | None, METRES, FINITE, Option("depths below the zero of the wall"),
        "Height of depth 0 above sea level; true depths are then TVDSS. Depth 0 is the rotary table or kelly bushing. "
        "True depths stand under the measured depths if the survey gives them. None: true depths are TVD.",
    ] = None  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class PrintTable(PrintSettings):
    """What a print and a report show, and the files that belong to them."""

    paper: Annotated[Literal["a4", "a3", "roll"], Option(), "Paper of a PDF; PNG and SVG are rolls."] = "a4"
    template: Annotated[Any,
        "TOML file of tracks, widths, units and scale, as the viewer saves it, or its tables. None: helibore chooses.",
    ] = None  # fmt: skip
    beside: Annotated[tuple[Path, ...], Formerly("besides"), Option(metavar="FILE"),
        "Archive of another well or pass, to show on the same depths.",
    ] = ()  # fmt: skip
    picks: Annotated[Path | None,
        "Table of the picks (CSV). None: FILE.picks.csv beside the first file shown.",
    ] = None  # fmt: skip
    scalar: Annotated[tuple[Literal["inclination"], ...], Formerly("scalars"),
        "Curves in tracks of their own that need no file; those of files are the tables [[scalar]].",
    ] = ()  # fmt: skip
    sigma: Annotated[bool, Option(), "Add the standard uncertainty of the radius."] = False
    no_polar: Annotated[bool, Option(), "Draw no cross sections."] = False
    no_body: Annotated[bool, Option(), "Draw no 3-D view."] = False


@dataclass(frozen=True, kw_only=True)
class Look(Declared, group="look.NAME"):
    """The colours of an image, or the scale of a curve. What is None is as usual for the quantity."""

    limits: Annotated[tuple[float, float] | None, ALL_FINITE, "Values of the first and the last colour."] = None
    color_map: Annotated[str | None, "Colour map, one of `helibore.plot.COLOR_MAPS`."] = None
    log: Annotated[bool | None, "Whether colours follow the logarithm."] = None
    window: Annotated[float | None, METRES, POSITIVE,
        "Length of a window that slides along the hole, for dynamic normalisation. A colour then has no fixed value.",
    ] = None  # fmt: skip

    def _check(self) -> None:
        if self.color_map is not None:
            from helibore.base.colors import check_map

            check_map(self.color_map)
        if self.limits is not None and not self.limits[0] < self.limits[1]:
            raise InputError("limits", "the first must be below the second", str(self.limits))
        if self.window is not None and self.limits is not None:
            raise InputError("window", "has its own limits; give limits or window", f"{self.window:g}")
