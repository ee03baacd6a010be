"""The state of a live wall as files, each whole or not there: walls, mesh, logs, images, survey.

    main.wall       settings, samples, vertices, survey, images: hb.load opens it     one file a layer
    main.las        every turn measured, or main.csv                                  one file a layer of a turn or more
    main.glb        the wall along the path                                           when a path covers it
    image-GR.csv    depth_m, GR[1], GR[2] ...                                         one file an image
    survey.csv      depth_m, inclination_deg, azimuth_deg
    passes.csv      source, pass, number, start_utc, stop_utc, top_m, bottom_m, samples: which samples are of which pass

A file is written beside and renamed. The files are those of one call, not of one instant: samples may come between two.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from helibore.atomic_file import write_whole
from helibore.live.clock import utc
from helibore.live.live import Live
from helibore.sector_image import SectorImage
from helibore.wall import Wall


def snapshot(live: Live, folder: str | Path) -> list[Path]:
    """Write the files; returns those written. A wall that the path does not reach yet has no mesh.

    Raises
    ------
    OSError
        If the folder cannot be written.
    """
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    logs = live.configuration.snapshot["logs"]
    written: list[Path] = []
    path, images = live.path, _images(live)
    for name, wall in live.layers.items():
        if not len(wall):
            continue
        wall.path, wall.images = path, {image.name: image for image in images if _meets(image, wall)}
        written.append(target / f"{name}.wall")
        wall.save(written[-1])
        if logs != "none" and len(wall) > wall.settings.sectors:
            written.append(target / f"{name}.{logs}")
            wall.logs().save(written[-1])
    for name, image in live.images.items():
        if len(image):
            depth, values = image.arrays()
            heads = ["depth_m", *(f"{name}[{number}]" for number in range(1, image.sectors + 1))]
            rows = ([d, *row] for d, row in zip(depth.tolist(), values.tolist(), strict=True))
            written.append(_table(target / f"image-{name}.csv", heads, rows))
    stations = live.model.stations.rows()
    if len(stations):
        heads = ["depth_m", "inclination_deg", "azimuth_deg"]
        written.append(_table(target / "survey.csv", heads, stations.tolist()))
    if passes := live.passes:
        heads = ["source", "pass", "number", "start_utc", "stop_utc", "top_m", "bottom_m", "samples"]
        rows = ([run.source, run.name, run.number, utc(run.start), utc(run.stop), run.top, run.bottom, run.samples]
                for run in passes)  # fmt: skip
        written.append(_table(target / "passes.csv", heads, rows))
    wall = live.wall
    if len(wall) > wall.settings.sectors + 1:
        deepest = float(wall.vertices(len(wall) - 1, len(wall)).depth[0])
        top, bottom = min(wall.start_depth, deepest), max(wall.start_depth, deepest)
        if path is None or (path.start_depth <= top and path.stop_depth >= bottom):
            wall.surface(path, stop=deepest).save(target / "main.glb")
            written.append(target / "main.glb")
    return written


def _images(live: Live) -> list[SectorImage]:
    """The images of the sources, as soon as they have two rows and a value."""
    found = []
    for source in live.configuration.sources.values():
        for items in source.images:
            depth, values = live.images[items.name].arrays()
            if len(depth) > 1 and not np.isnan(values).all():
                found.append(live.image(items.name))
    return found


def _meets(image: SectorImage, wall: Wall) -> bool:
    """Whether they share a turn or more: elsewhere an image has no quad of the wall to lie on, and says so."""
    pitch = wall.settings.pitch
    ends = sorted((wall.start_depth, wall.start_depth + len(wall) / wall.settings.sectors * pitch))
    top, bottom = image.depth[0] - image.reach, image.depth[-1] + image.reach
    shared = min(ends[1] - abs(pitch), bottom) - max(ends[0] + abs(pitch), top)
    return bool(shared > abs(pitch))


def _table(file: Path, heads: list[str], rows: Iterable[Sequence[float | str | None]]) -> Path:
    """Write a table, of numbers every digit; a missing one is an empty cell."""
    lines = (",".join(_cell(value) for value in row) for row in rows)
    text = "\n".join([",".join(heads), *lines, ""])
    write_whole(file, lambda whole: whole.write(text.encode()))
    return file


def _cell(value: float | str | None) -> str:
    if isinstance(value, str):
        return value
    return "" if value is None or value != value else repr(value)
