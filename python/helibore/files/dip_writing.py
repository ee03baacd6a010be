"""Write the true dips of picks for programs of structural geology: Petrel, Techlog, Geolog, WellCAD.

    .csv    MD,DIP,DIP_AZIMUTH,TYPE,NOTE,DIP_SIGMA,DIP_AZIMUTH_SIGMA    names, units below them, then rows:
            m,deg,deg,,,deg,deg                                         Techlog, Geolog, WellCAD
    .dip    # comments, then the same columns between blanks; a missing text is a dash: point well data of Petrel

All of them let the user say which column is what. A dip counts from the horizontal, its azimuth from the north of the
path; depths are measured depths. Sigmas are those of the table of picks.
"""

from __future__ import annotations

import csv
import io
import math
import os
from collections.abc import Iterable
from pathlib import Path as FilePath

from helibore.base.atomic_file import write_whole
from helibore.base.errors import InputError, check_ending
from helibore.base.harmless import cell
from helibore.files.las_writing import NULL
from helibore.logs.picks import Pick
from helibore.trajectory.survey import Path

NAMES = ("MD", "DIP", "DIP_AZIMUTH", "TYPE", "NOTE", "DIP_SIGMA", "DIP_AZIMUTH_SIGMA")
UNITS = ("m", "deg", "deg", "", "", "deg", "deg")
ENDINGS = (".csv", ".dip")


def save_dips(picks: Iterable[Pick], path: Path, filename: str | os.PathLike[str], well: str = "") -> int:
    """Write the true dips of planes, one line each, by depth; return how many were written.

    Parameters
    ----------
    picks
        Of any class. Breakouts, and planes where the path or toolface 0 has no direction, are left out.
    path
        The path of the wall, from which true dips follow.
    filename
        Ends in .csv or .dip; an existing file is replaced.
    well
        Name of the well, for the comments of .dip.

    Raises
    ------
    InputError
        If the name has another ending, or no pick has a true dip.
    """
    check_ending(filename, ENDINGS)
    known = [(pick, *pick.dip(path)) for pick in sorted(picks, key=lambda one: one.depth)]
    rows = [
        (
            f"{pick.depth:.3f}",
            f"{dip:.2f}",
            _angle(azimuth),
            pick.kind,
            pick.note,
            *map(_angle, pick.dip_sigmas(path)),
        )
        for pick, dip, azimuth in known
        if not math.isnan(dip)
    ]
    if not rows:
        raise InputError("picks", "none is a plane with a true dip on this path")
    text = _between_commas(rows) if FilePath(filename).suffix.lower() == ".csv" else _between_blanks(rows, path, well)
    write_whole(FilePath(filename), lambda file: file.write(text.encode()))
    return len(rows)


def north_text(path: Path) -> str:
    """Return as text which north the azimuths of a path count from."""
    return f"{path.survey.north} north" if path.survey.north else "a north that the survey does not state"


def _angle(degrees: float) -> str:
    return f"{NULL:g}" if math.isnan(degrees) else f"{degrees:.2f}"


def _between_commas(rows: Iterable[tuple[str, ...]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([NAMES, UNITS, *([*row[:3], *map(cell, row[3:5]), *row[5:]] for row in rows)])
    return text.getvalue()


def _between_blanks(rows: Iterable[tuple[str, ...]], path: Path, well: str) -> str:
    lines = [
        "# TRUE DIPS FROM HELIBORE",
        f"# WELL NAME: {' '.join(well.split())}",
        f"# MD IN METRES; ANGLES IN DEGREES; AZIMUTHS FROM {north_text(path).upper()}; MISSING: {NULL:g}",
        f"# {' '.join(NAMES)}",
    ]
    lines += [" ".join(["_".join(text.split()) or "-" for text in row]) for row in rows]
    return "\n".join(lines) + "\n"
