"""The name of each log in files, its unit, and how turns are combined into steps.

`COLUMNS` lists for each log the attribute of `Logs`, the mnemonic, the unit, the description and the rule for steps.
Mnemonics are those usual for caliper logs. Other files define further columns:

    turn_logs      uncertainty of the volume, diameters of the arms, columns along the path
    zones          class of hole
    annulus        columns of a casing
    image_means    mean of an image
    difference_columns   difference from earlier passes
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

DIFFERENCE = "difference"
"""Name of the attribute with the radius of a wall minus the radius of the wall from its earlier passes, m."""

Rule = Literal["mean", "least", "greatest", "least there", "greatest there", "own"]


@dataclass(frozen=True)
class Definition:
    """The name of a log in files; ``by_step`` is the rule that combines the turns of a step into one value.

    If a turn has no value, neither has its step, except with "least there" and "greatest there", which ignore such
    turns. "own": `by_step` computes this log by a separate rule.
    """

    name: str
    mnemonic: str
    unit: str
    description: str
    by_step: Rule


COLUMNS = tuple(
    Definition(*row)
    for row in (
        ("depth", "DEPT", "m", "Measured depth", "own"),
        ("mean", "RMEAN", "m", "Mean radius", "mean"),
        ("smallest", "RMIN", "m", "Smallest radius", "least there"),
        ("largest", "RMAX", "m", "Largest radius", "greatest there"),
        ("equivalent_diameter", "DEQ", "m", "Diameter of the circle of the same area", "own"),
        ("c1", "C1", "m", "Largest diameter", "mean"),
        ("c1_toolface", "C1TF", "deg", "Toolface of the largest diameter, 0 to 180", "own"),
        ("c2", "C2", "m", "Diameter at right angles to the largest", "mean"),
        ("least_diameter", "DMIN", "m", "Smallest diameter", "mean"),
        ("diameter_0", "D0", "m", "Diameter across toolfaces 0 and 180", "mean"),
        ("diameter_90", "D90", "m", "Diameter across toolfaces 90 and 270", "mean"),
        ("ovality_api", "OVAL_API", "", "Ovality after API, (max - min)/(max + min)", "mean"),
        ("ovality_dnv", "OVAL_DNV", "", "Ovality after DNV and ISO, 2 (max - min)/(max + min)", "mean"),
        ("out_of_roundness", "OOR", "m", "Out of roundness, largest less smallest diameter", "mean"),
        ("wall_out_of_roundness", "OOR_WALL", "m", "Out of roundness of the wall as interpolated", "mean"),
        ("uneven", "UNEVEN", "m", "Difference between the two ends of the arms' largest diameter", "mean"),
        ("centre_0", "CEN0", "m", "Centre of the area from the axis towards toolface 0", "mean"),
        ("centre_90", "CEN90", "m", "Centre of the area from the axis towards toolface 90", "mean"),
        ("inscribed_diameter", "DINSC", "m", "Largest inscribed circle, diameter", "least"),
        ("inscribed_0", "INSC0", "m", "Centre of the circle of DINSC from the axis towards toolface 0", "mean"),
        ("inscribed_90", "INSC90", "m", "Centre of the circle of DINSC from the axis towards toolface 90", "mean"),
        ("enclosing_diameter", "DENCL", "m", "Smallest enclosing circle, diameter", "greatest"),
        ("unworn_diameter", "UNWORN", "m", "Diameter of the unworn circle, which the bit left", "own"),
        ("lobe1_height", "LOBE", "m", "Height of the highest lobe over the circle of UNWORN", "own"),
        ("rugosity", "RUGO", "m", "Rugosity, detrended rms of the radius over the window", "mean"),
        ("volume", "VOL", "m3", "Volume of the hole in this row", "own"),
        ("excess", "EXCESS", "", "Volume over that of gauge hole, less 1", "own"),
        ("coverage", "COVER", "", "Share of the turn that is measured, not interpolated", "mean"),
        ("nearest", "NEAREST", "m", "Largest distance to the nearest sample", "greatest there"),
        ("diameter_sigma", "DEQ_SIGMA", "m", "Standard uncertainty of DEQ", "own"),
        ("age", "AGE", "s", "Time from the newest sample here to the newest of the wall", "least there"),
    )
)

SHAPE_SIGMA = {
    name: Definition(name, mnemonic, unit, f"Standard uncertainty of {of}", "mean")
    for name, mnemonic, unit, of in (
        ("c1_sigma", "C1_SIGMA", "m", "C1"),
        ("c2_sigma", "C2_SIGMA", "m", "C2"),
        ("c1_c2_sigma", "C1_C2_SIGMA", "m", "C1 less C2"),
        ("ovality_sigma", "OVAL_SIGMA", "", "OVAL_API"),
    )
}
"""Logs of how sure the diameters of a turn are, by name; files have them with DEQ_SIGMA. A step has their means."""

INNER = ("sampled", "alike", "shared_sigma")
"""Logs that files do not have; a step has their means."""
LOBES = tuple(f"lobe{number}_{name}" for number in (1, 2) for name in ("toolface", "width", "height", "pipe"))
"""Logs of lobes, of which files have one, ``lobe1_height``; a step has those of the turn with the highest lobe."""
CIRCLE = ("unworn_diameter", "unworn_0", "unworn_90")
"""Logs of the unworn circle, of which files have the first; a step has their means."""
WORN = CIRCLE + LOBES
