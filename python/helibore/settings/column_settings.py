"""The columns of files, where the guess of their roles is wrong: NAME[@ANGLE][:UNIT][+ZERO], as on the command line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from helibore.settings.declared import Declared


@dataclass(frozen=True, kw_only=True)
class Columns(Declared, group="columns"):
    """Columns of roles, such as md_m, rb:deg, x_in@0, CAL1@90:in, USTO@0:in+3.25in; a role not stated is guessed."""

    depth: Annotated[str | None, "Depth of the caliper files."] = None
    toolface: Annotated[str | None, "Toolface or relative bearing."] = None
    time: Annotated[str | None, "Time of the caliper files."] = None
    radius: Annotated[tuple[str, ...], "Radii; ANGLE is where on the tool the arm is mounted."] = ()
    diameter: Annotated[tuple[str, ...], "Diameters, each of which counts for both sides."] = ()
    travel_time: Annotated[tuple[str, ...], "Travel times of echoes."] = ()
    survey_depth: Annotated[str | None, "Depth of the stations of the survey."] = None
    inclination: Annotated[str | None, "Inclination of the survey."] = None
    azimuth: Annotated[str | None, "Azimuth of the survey."] = None
