"""Write a path as a well trace (.dev), and an image as WellCAD text (.wai), for programs that read these.

    .dev    comments, the names MD X Y Z TVD DX DY AZIM INCL DLS, one line a station; Z is up, TVD from KB downwards
    .wai    Depth,0.00 deg,5.00 deg, ...     one line a depth, at one step; a column's name is where its sector starts
            m,mV,mV, ...

WellCAD takes one step of depth and sectors from 0 to 360 degrees, clockwise: an image is laid out so, by its cells.
"""

from __future__ import annotations

import os
from pathlib import Path as FilePath

import numpy as np

from helibore.base.angles import wrapped
from helibore.base.atomic_file import write_whole
from helibore.base.errors import InputError, check_ending
from helibore.files.las_writing import NULL
from helibore.images.sector_image import SectorImage
from helibore.trajectory.survey import Path


def save_trace(path: Path, filename: str | os.PathLike[str], well: str = "", kb: float = 0.0) -> None:
    """Write a path as a well trace in the layout of Petrel, in metres.

    Parameters
    ----------
    path
        Its ``head`` has the map position; X is east, Y is north, and Z is ``kb`` less the true depth.
    filename
        Ends in .dev.
    well
        Name of the well.
    kb
        Elevation of the kelly bushing, from which depths count, metres above the datum.
    """
    check_ending(filename, (".dev",))
    depth, inclination, azimuth = path.survey.depth, path.survey.inclination, path.survey.azimuth
    north, east, down = path.position(depth).T
    tvd = down - path.head[2]
    tangent = path.tangent(depth)
    turned = 2 * np.arctan2(
        np.linalg.norm(np.diff(tangent, axis=0), axis=1), np.linalg.norm(tangent[1:] + tangent[:-1], axis=1)
    )
    dls = np.concatenate([[0.0], np.degrees(turned) / np.diff(depth) * 30])
    names = ("MD", "X", "Y", "Z", "TVD", "DX", "DY", f"AZIM{NORTHS[path.survey.north]}", "INCL", "DLS")
    columns = (depth, east, north, kb - tvd, tvd, east - east[0], north - north[0], azimuth, inclination, dls)
    lines = [
        "# WELL TRACE FROM HELIBORE",
        f"# WELL NAME: {' '.join(well.split())}",
        f"# WELL HEAD X-COORDINATE: {east[0]:.2f} (m)",
        f"# WELL HEAD Y-COORDINATE: {north[0]:.2f} (m)",
        f"# WELL KB: {kb:.2f} (m)",
        "# MD AND TVD ARE REFERENCED (=0) AT KB AND INCREASE DOWNWARDS",
        f"# ANGLES ARE GIVEN IN DEGREES; DLS IN DEGREES PER 30 M; {path.method}",
        "#" + "=" * 70,
        " ".join(f"{name:>12}" for name in names),
        "#" + "=" * 70,
        *(" ".join(f"{value:12.4f}" for value in row) for row in zip(*columns, strict=True)),
    ]
    write_whole(FilePath(filename), lambda file: file.write(("\n".join(lines) + "\n").encode()))


NORTHS = {"": "", "true": "_TN", "grid": "_GN", "magnetic": "_MAG"}
"""Ending of the name of the azimuth in a trace, by north."""


def save_wellcad(image: SectorImage, filename: str | os.PathLike[str]) -> None:
    """Write an image as WellCAD text, at the median step of its rows; -999.25 where it is missing.

    Parameters
    ----------
    image
        Its toolfaces stay as they are: sector 1 of the file starts at toolface 0 of the image's reference.
    filename
        Ends in .wai.

    Raises
    ------
    InputError
        If the image has one row, or so many at the median step that the file would hold more than 100 million cells.
    """
    check_ending(filename, (".wai",))
    if image.depth.size < 2:
        raise InputError("image", "must have two rows or more, for a step", str(image.depth.size))
    step = float(np.median(np.diff(image.depth)))
    count = round((image.depth[-1] - image.depth[0]) / step) + 1
    if count * image.sectors > MOST_CELLS:
        raise InputError("image", f"must have at most {MOST_CELLS:,} cells at its median step", f"{count} rows")
    depth = image.depth[0] + step * np.arange(count)
    low, high = image.cover()
    row = np.clip(np.searchsorted(high, depth, side="right"), 0, image.depth.size - 1)
    there = (depth >= low[row]) & (depth < high[row])
    centres = (np.arange(image.sectors) + 0.5) * (360 / image.sectors)
    away = np.abs(wrapped(centres[:, None] - image.toolface + 180.0) - 180.0)
    values = np.where(there[:, None], image.values[row][:, np.argmin(away, axis=1)], np.nan)
    values = np.where(np.isnan(values), NULL, values)
    starts = [f"{number * 360 / image.sectors:.2f} deg" for number in range(image.sectors)]
    lines = [",".join(["Depth", *starts]), ",".join(["m", *[image.unit or " "] * image.sectors])]
    lines += [
        f"{at:.4f}," + ",".join(f"{value:.6g}" for value in cells) for at, cells in zip(depth, values, strict=True)
    ]
    write_whole(FilePath(filename), lambda file: file.write(("\n".join(lines) + "\n").encode()))


MOST_CELLS = 100_000_000
"""Most cells of a WellCAD text."""
