"""Copy a live wall at one moment, for exports that take longer than the time to the next packet.

live           ... append  append | append ...      everything is copied in memory, between two appends
                                  |
frozen copy                       walls, images, stations, passes, events       sorted, exported (``snapshot_files.py``)
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from helibore.base.arrays import Floats
from helibore.images.sector_image import SectorImage
from helibore.live.live import Live
from helibore.live.model.events import Event
from helibore.live.model.image_rows import sorted_rows
from helibore.live.model.pass_log import Pass
from helibore.live.rules.file_names import RULE, can_be_file
from helibore.live.rules.layout import Layout
from helibore.trajectory.survey import Path
from helibore.wall.state import WallState

Rows = tuple[tuple[Floats, Floats, float], str, Layout | None]
"""The rows of an image: (depth, values, step) in order of arrival, unit and layout."""


@dataclass(frozen=True)
class FrozenCopy:
    """The state of a live wall at one moment.

    Attributes
    ----------
    wall_time
        Time at which the last record in the copy was received, ns since 1970 (UTC).
    records
        Number of journal records that the copy contains.
    walls
        The wall of each layer that has vertices.
    images
        (depth, values) of each image that has rows.
    stations, path
        Survey stations (n, 3): depth m, inclination and azimuth deg; and the path through them, as `Live.path`.
    passes, events
        As `Live.passes`, and one event for each rule of each source.
    main
        Name of the wall of the hole that is drilled now.
    left_out
        One text, with the reason, for each image that ``images`` lacks, because its name is not allowed in a file name,
        and for each image that is on no wall, because `SectorImage` refuses it. There is no text for an image that is
        on no wall because it has no layout, no values, only one row, or other depths than the walls.
    """

    wall_time: int
    records: int
    walls: dict[str, WallState]
    images: dict[str, tuple[Floats, Floats]]
    stations: Floats
    path: Path | None
    passes: list[Pass]
    events: list[Event]
    left_out: list[str]
    main: str = "main"


def frozen_copy(live: Live) -> FrozenCopy:
    """Return a copy of a live wall, made between two appends; its images are sorted and placed on the walls."""
    of, images = live.at_one_moment(lambda: _copied(live))
    for name, (rows, unit, layout) in images.items():
        if not can_be_file(name):
            of.left_out.append(f"image {name[:60]!r}: its name {RULE}: left out")
            continue
        depth, values = of.images[name] = sorted_rows(*rows)
        if layout is None or len(depth) < 2 or np.isnan(values).all():
            continue
        try:
            image = layout.image(name, unit, (depth, values), None)
        except ValueError as error:
            of.left_out.append(f"image '{name}': {error}: not laid on a wall")
            continue
        for layer, wall in of.walls.items():
            if _meets(image, wall):
                of.walls[layer] = replace(wall, images={**wall.images, name: image})
    return of


def _copied(live: Live) -> tuple[FrozenCopy, dict[str, Rows]]:
    """Return the copy without images, and by name the rows of each image; rows never change after they arrive."""
    model = live.model
    walls = {
        name: replace(
            state := wall._state(), path=model.path_of(name), images={},
            made_from=state.made_from | {"configuration": model.stretches},
        )
        for name, wall in live.layers.items()
        if len(wall)
    }  # fmt: skip
    images = {name: ((*image.so_far()[1:], image.step), image.unit, model.layouts.get(name))
              for name, image in live.images.items() if len(image)}  # fmt: skip
    of = FrozenCopy(model.wall_time, model.records, walls, {}, model.stations.rows(), live.path, live.passes,
               model.events.latest, [], model.main)  # fmt: skip
    return of, images


def _meets(image: SectorImage, wall: WallState) -> bool:
    """Return whether the image covers more than one turn between the first and the last turn of the wall.

    If it does, it surely covers one quad of the wall or more.
    """
    pitch = wall.settings.pitch
    ends = sorted((wall.start_depth, wall.start_depth + len(wall) / wall.settings.sectors * pitch))
    top, bottom = image.depth[0] - image.reach, image.depth[-1] + image.reach
    shared = min(ends[1] - abs(pitch), bottom) - max(ends[0] + abs(pitch), top)
    return bool(shared > abs(pitch))
