"""A cement job: one casing in the measured hole, with what is above it and how it is pumped."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from helibore.base.errors import InputError
from helibore.settings.declared import FINITE, INCHES, METRES, NOT_NEGATIVE, POSITIVE, Declared, Option, at_most


@dataclass(frozen=True, kw_only=True)
class CementJob(Declared, group="cement"):
    """A casing to cement. Depths are measured depths; `helibore.Logs.cement_sheet` says what is summed."""

    casing: Annotated[float, INCHES, POSITIVE, Option(), "Outer diameter of the casing."]
    shoe: Annotated[float, METRES, FINITE, Option(), "Depth of its shoe."]
    inner_diameter: Annotated[float | None, INCHES, POSITIVE, Option("no shoe track and no displacement"),
        "Inner diameter of the casing.",
    ] = None  # fmt: skip
    shoe_track: Annotated[float, METRES, NOT_NEGATIVE, Option(), "Length from the float collar to the shoe."] = 0.0
    previous_shoe: Annotated[float | None, METRES, FINITE, Option("none"), "Depth of the previous casing's shoe."] = (
        None
    )
    previous_inner: Annotated[float | None, INCHES, POSITIVE, Option(), "Inner diameter of the previous casing."] = None
    top: Annotated[float | None, METRES, FINITE, Option("the previous shoe, or the top of the logs"),
        "Top of cement. Above the previous shoe there is a lap.",
    ] = None  # fmt: skip
    tail_top: Annotated[float | None, METRES, FINITE, Option("one slurry"), "Top of the tail slurry."] = None
    excess: Annotated[float, NOT_NEGATIVE, at_most(5), Option(),
        "Excess over the open hole, as a fraction: 0.1 is 10 %.",
    ] = 0.0  # fmt: skip
    stab_in: Annotated[float | None, INCHES, POSITIVE, Option("none"),
        "Inner diameter of the drill pipe of a stab-in job: it is displaced, and no shoe track is left.",
    ] = None  # fmt: skip

    def _check(self) -> None:
        if (self.previous_shoe is None) != (self.previous_inner is None):
            raise InputError("previous_shoe", "goes with previous_inner: state both or none", str(self.previous_shoe))
        for name, value in (("inner_diameter", self.inner_diameter), ("previous_inner", self.previous_inner)):
            if value is not None and (value < self.casing) != (name == "inner_diameter"):
                side = "less" if name == "inner_diameter" else "more"
                raise InputError(name, f"must be {side} than the casing, {self.casing:g} m", f"{value:g}")
        for name, depth in (("top", self.top), ("tail_top", self.tail_top), ("previous_shoe", self.previous_shoe)):
            if depth is not None and depth >= self.shoe:
                raise InputError(name, f"must be above the shoe, {self.shoe:g} m", f"{depth:g}")
        if self.shoe_track > 0 and self.inner_diameter is None:
            raise InputError("shoe_track", "needs inner_diameter", f"{self.shoe_track:g}")


@dataclass(frozen=True, kw_only=True)
class CementTable(CementJob):
    """A casing to cement, and how sure the volumes of the hole are."""

    sigma: Annotated[bool, Option(), "Also compute the uncertainty, by leaving samples out."] = False
    caliper_accuracy: Annotated[float, METRES, NOT_NEGATIVE, Option(),
        "Standard uncertainty that all radii share.",
    ] = 0.0  # fmt: skip
