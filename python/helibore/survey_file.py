"""A survey from a file: its stations, checked line by line.

    MD,Incl,Azim              --depth MD:ft --inclination Incl:deg --azimuth Azim:deg
    0,0,0

``channels`` explains how columns are named. Not here: WITSML trajectories, and the path through the stations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from helibore.arrays import Floats
from helibore.channels import Channel, Mask, absent_rows, choose
from helibore.survey import Survey
from helibore.table_file import ABSENT, Table, open_table


@dataclass(frozen=True)
class SurveyReading:
    """The survey, the rows in its file, the rows dropped for each column without a value, and the choices made."""

    survey: Survey
    rows: int
    dropped: dict[str, int]
    notes: tuple[str, ...]


def read_survey(
    path: str | Path,
    *,
    depth: str | None = None,
    inclination: str | None = None,
    azimuth: str | None = None,
    absent: Sequence[float] = ABSENT,
) -> SurveyReading:
    """Read a survey from CSV (.gz) or NPZ.

    Parameters
    ----------
    path
        The file. Its content tells the format.
    depth, inclination, azimuth
        Columns, as ``NAME[:UNIT]``; a column of a usual name where None.
    absent
        Numbers that mean there is no value; empty cells are absent too. A station that lacks one is dropped.

    Raises
    ------
    ValueError
        Naming file, column, line and rule: depth must increase, inclination lie within 0 to 180 deg.
    OSError
        If the file cannot be read.
    """
    table = open_table(path)
    spelled = {"depth": depth, "inclination": inclination, "azimuth": azimuth}
    channels = [choose(table, role, spelling) for role, spelling in spelled.items()]
    columns = table.read([channel.name for channel in channels])
    kept = np.ones(columns[0].size, dtype=bool)
    dropped = {}
    for channel, values in zip(channels, columns, strict=True):
        gone = absent_rows(table, channel, values, absent)
        if gone is not None and gone.any():
            dropped[channel.name] = int(gone.sum())
            kept &= ~gone
        channel.convert(values)
    _check_stations(table, channels, columns, kept)
    survey = Survey(*(values[kept] for values in columns))
    return SurveyReading(survey, kept.size, dropped, (table.format, *(channel.note for channel in channels)))


def _check_stations(table: Table, channels: list[Channel], columns: list[Floats], kept: Mask) -> None:
    depth, inclination, azimuth = (values[kept] for values in columns)
    if depth.size < 2:
        raise ValueError(f"{table.path}: stations: {depth.size}: must be 2 or more")
    rows = np.flatnonzero(kept)
    back = np.concatenate([[False], np.diff(depth) <= 0])
    if back.any():
        index = int(np.argmax(back))
        place = table.place(channels[0].name, int(rows[index]))
        raise ValueError(f"{table.path}: {place}: {depth[index]:g} m after {depth[index - 1]:g} m: must increase")
    for channel, values, low, high in ((channels[1], inclination, 0, 180), (channels[2], azimuth, -360, 360)):
        wrong = (values < low) | (values > high)
        if wrong.any():
            index = int(np.argmax(wrong))
            place = table.place(channel.name, int(rows[index]))
            raise ValueError(f"{table.path}: {place}: {values[index]:g} deg: must be in [{low}, {high}]")
