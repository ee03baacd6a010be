"""A caliper from a file: its columns become wall points, what has no value is dropped and counted.

    depth md_m, toolface rb_deg, diameters x_in@0 and y_in@90      an X-Y caliper: a row is four wall points,
                                                                   x/2 at rb and rb + 180, y/2 at rb + 90 and rb + 270
    depth MD:ft, toolface tf:rad, radius r:mm                      one wall point a row, at its toolface

``channels`` explains how columns are named. Not here: passes, sensor offsets, eccentering.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from helibore.arrays import Floats
from helibore.caliper import Caliper
from helibore.channels import Channel, Mask, absent_rows, choose, usual
from helibore.table_file import ABSENT, Table, open_table

LARGEST_RADIUS = 2.0
"""Metres. A larger one is a wrong unit or a wrong column."""


@dataclass(frozen=True)
class CaliperReading:
    """What was read.

    Attributes
    ----------
    caliper
        The samples.
    rows
        Rows in the file.
    dropped
        Rows without a value in a column, for each such column: ``{"radius_m": 12}``.
    notes
        One line for each choice that was made: format, columns, units, arms.
    """

    caliper: Caliper
    rows: int
    dropped: dict[str, int]
    notes: tuple[str, ...]


def read_caliper(
    path: str | Path,
    *,
    depth: str | None = None,
    toolface: str | None = None,
    radius: Sequence[str] = (),
    diameter: Sequence[str] = (),
    time: str | None = None,
    absent: Sequence[float] = ABSENT,
) -> CaliperReading:
    """Read a caliper from CSV (.gz) or NPZ.

    Parameters
    ----------
    path
        The file. Its content tells the format.
    depth, toolface, time
        Columns, as ``NAME[:UNIT]``; a column of a usual name where None. Time is optional.
    radius, diameter
        Columns, as ``NAME[@ANGLE][:UNIT]``. With an angle (deg) the arm is mounted there: its radius stands at toolface
        + angle, half its diameter there and opposite. Without one, radius or half the diameter stand at the toolface.
    absent
        Numbers that mean there is no value. Empty cells, and NaN in a radius or diameter, are absent too.

    Returns
    -------
    CaliperReading
        Samples in the order of the file; within a row, radii before diameters, as given.

    Raises
    ------
    ValueError
        Naming file, column, line and rule.
    OSError
        If the file cannot be read.
    """
    table = open_table(path)
    channels = [choose(table, "depth", depth), choose(table, "toolface", toolface)]
    if time is not None or usual(table, "time"):
        channels.append(choose(table, "time", time))
    arms = [choose(table, "radius", arm) for arm in radius] + [choose(table, "diameter", arm) for arm in diameter]
    arms = arms or [choose(table, "radius" if usual(table, "radius") else "diameter")]
    values = table.read([channel.name for channel in channels + arms])
    rows = values[0].size
    dropped: dict[str, int] = {}

    def present(channel: Channel, column: Floats, nan_is_absent: bool) -> Mask | bool:
        gone = absent_rows(table, channel, column, absent, nan_is_absent)
        if gone is None or not gone.any():
            return True
        dropped[channel.name] = int(gone.sum())
        return ~gone

    in_row: Mask | bool = True
    for channel, column in zip(channels, values, strict=False):
        in_row = in_row & present(channel, column, nan_is_absent=False)
        channel.convert(column)
    points = []
    for arm, column in zip(arms, values[len(channels) :], strict=True):
        in_arm = in_row & present(arm, column, nan_is_absent=True)
        _check_radius(table, arm, column, in_arm)
        points += _points(arm, arm.convert(column), in_arm)
    samples = _samples(values[: len(channels)], points)
    if not samples[0].size:
        reasons = ", ".join(f"{count} of {rows} rows without {name}" for name, count in dropped.items())
        raise ValueError(f"{table.path}: no samples: {reasons}")
    notes = (table.format, *(channel.note for channel in channels + arms))
    return CaliperReading(Caliper(*samples), rows, dropped, notes)


_Point = tuple[float, Floats, Mask | bool]
"""A wall point a row: angle from the toolface (deg), radius (m), and the rows that have it (True: all)."""


def _points(arm: Channel, values: Floats, kept: Mask | bool) -> list[_Point]:
    angle = arm.angle or 0.0
    if arm.role == "radius":
        return [(angle, values, kept)]
    values *= 0.5
    return [(angle, values, kept)] if arm.angle is None else [(angle, values, kept), (angle + 180.0, values, kept)]


def _samples(shared: list[Floats], points: list[_Point]) -> tuple[Floats, ...]:
    """Depth, toolface, radius and, where there is one, time of every wall point, row by row."""
    shape = (shared[0].size, len(points))
    kept = None
    if any(mask is not True for _, _, mask in points):
        kept = np.column_stack([np.broadcast_to(mask, shape[:1]) for _, _, mask in points])

    def every(grid: Floats) -> Floats:
        return grid.reshape(-1) if kept is None else grid[kept]

    depth, toolface, *time = (every(np.broadcast_to(column[:, None], shape)) for column in shared)
    angle = every(np.broadcast_to([point[0] for point in points], shape))
    radius = points[0][1] if len(points) == 1 else np.column_stack([point[1] for point in points])
    return depth, _wrapped(toolface, angle), every(radius.reshape(shape)), *time


def _wrapped(toolface: Floats, angle: Floats) -> Floats:
    """toolface + angle in [0, 360)."""
    toolface = toolface + angle if angle.any() else toolface
    if toolface.size and not (toolface.min() >= 0.0 and toolface.max() < 360.0):
        toolface = toolface % 360.0
        toolface[toolface == 360.0] = 0.0  # the remainder of a tiny negative number
    return toolface


def _check_radius(table: Table, arm: Channel, values: Floats, kept: Mask | bool) -> None:
    largest = LARGEST_RADIUS if arm.role == "radius" else 2.0 * LARGEST_RADIUS
    metres = arm.convert(np.ones(1))[0]
    if values.min() > 0.0 and values.max() * metres <= largest:
        return
    wrong = kept & ~((values > 0.0) & (values * metres <= largest))
    if wrong.any():
        row = int(np.argmax(wrong))
        raise ValueError(
            f"{table.path}: {table.place(arm.name, row)}: {arm.role} {values[row]:g} {arm.unit}: "
            f"must be larger than 0 and at most {largest:g} m"
        )
