"""`hb.load`: reopen an archive, by appending its samples in canonical order to an empty wall.

How samples are split into appends does not change a wall. So the reopened wall equals the saved wall in every bit, also
after further appends. The stored vertices show whether this version of helibore still computes
the same values.
"""

from __future__ import annotations

import math
import os
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats
from helibore.base.errors import InputError
from helibore.images.sector_image import SectorImage
from helibore.logs.intervals import Interval
from helibore.logs.picks import ENDING as PICKS
from helibore.logs.picks import Picks
from helibore.samples.caliper import Caliper
from helibore.settings.wall_settings import Settings
from helibore.trajectory.survey import Survey
from helibore.wall.archive import ARMS, SAMPLES, STATIONS, VERTICES, Arrays, Members, opened
from helibore.wall.wall import Wall


def load(filename: str | os.PathLike[str], threads: int | None = None, recompute: bool = False) -> Wall:
    """Reopen a wall that `Wall.save` wrote. It equals the saved wall in every bit, and you can append more samples.

    Parameters
    ----------
    filename
        An archive; its name may have any ending.
    threads
        As in `Wall`.
    recompute
        Accept the values that this version of helibore computes from the samples, even if they differ from the saved
        ones.

    Returns
    -------
    Wall
        The wall with the settings, basis, samples, vertices, ``path``, ``images``, ``attributes``, ``intervals`` and
        ``made_from`` of the saved wall, and with the ``picks`` of FILENAME.picks.csv if that file exists. Later appends
        give exactly the same numbers as they would on the saved wall.

    Raises
    ------
    InputError
        If the file is not an archive, is truncated, damaged or of a newer version, if this version computes other
        values than the saved ones, or if FILENAME.picks.csv is not a table of picks. The error names the file and the
        reason.
    OSError
        If the file cannot be read.
    """
    with opened(filename) as members:
        wall = _wall(members, threads, recompute)
    beside = Path(f"{os.fspath(filename)}{PICKS}")
    if beside.exists():
        wall.picks = Picks.load(beside, wall.path)
    return wall


def _wall(members: Members, threads: int | None, recompute: bool) -> Wall:
    contents = members.contents()
    unknown = sorted(set(contents["settings"]) - {field.name for field in fields(Settings)})
    if unknown:
        versions = f"written by helibore {contents['helibore']}; helibore {_core.__version__} lacks these settings"
        raise InputError(f"settings {', '.join(unknown)}", versions)
    wall = Wall(threads=threads, basis=contents["basis"], **contents["settings"])
    samples = [members.array(f"samples/{name}") for name in contents["samples"]]
    columns: dict[str, Any] = {name: members.array(f"arms/{name}", ARMS[name]) for name in contents.get("arms", ())}
    if not samples:  # all of them have arms
        samples = [columns[name] for name in SAMPLES if name in columns]
    saved = {name: members.array(f"vertices/{name}", dtype) for name, dtype in VERTICES.items()}
    path = None
    if contents["path"] is not None:
        placing = contents["path"] | {"head": tuple(contents["path"]["head"])}
        north = placing.pop("north", "")
        path = Survey(*(members.array(f"survey/{name}") for name in STATIONS), north=north).path(**placing)
    images = {}
    for number, image in enumerate(contents["images"]):
        key = image.pop("key")
        depth, values = members.array(f"images/{number}/depth"), members.array(f"images/{number}/values", "<f8", 2)
        images[key] = SectorImage(depth, values, **image)
    attributes, units = {}, {}
    for number, row in enumerate(contents["attributes"]):
        start = math.nan if row["start_depth"] is None else row["start_depth"]
        attributes[row["name"]] = start, members.array(f"attributes/{number}")
        if row["unit"] is not None:
            units[row["name"]] = row["unit"]
    arms = Caliper(**columns) if columns else None
    intervals = [
        Interval(name, start, math.inf if stop is None else stop, *more)
        for name, start, stop, *more in contents.get("intervals", ())
    ]
    wall.__setstate__((samples, arms, path, images, attributes, units, contents["made_from"], (), intervals))
    if not recompute:
        _require_same(wall, saved, contents)
    return wall


def _require_same(wall: Wall, saved: Arrays, contents: dict[str, Any]) -> None:
    """Raise an InputError if the vertices computed from the samples differ from those saved."""
    versions = f"saved by helibore {contents['helibore']}, but helibore {_core.__version__} computes"
    advice = "hb.load(..., recompute=True) accepts the values of this version"
    for name, before in saved.items():
        now: Floats = getattr(wall, name)
        if now.size != before.size:
            raise InputError(f"{before.size} vertices", f"{versions} {now.size}; {advice}")
        differ = np.flatnonzero(now.view(f"u{now.itemsize}") != before.view(f"u{before.itemsize}"))
        if differ.size:
            k = differ[0]
            raise InputError(f"{name}[{k}]", f"{versions} {now[k]}; {advice}", str(before[k]))
