"""The state of a live wall as files, each whole or not there: walls, mesh, logs, images, survey.

    main.wall       settings, samples, vertices and survey: hb.load opens it          one file a layer
    main.las        every turn measured, or main.csv                                  one file a layer of a turn or more
    main.glb        the wall along the path                                           when a path covers it
    image-GR.csv    depth_m, GR[1], GR[2] ...                                         one file an image
    survey.csv      depth_m, inclination_deg, azimuth_deg

A file is written beside and renamed. The files are those of one call, not of one instant: samples may come between two.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from helibore.atomic_file import write_whole
from helibore.live.live import Live


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
    path = live.path
    for name, wall in live.layers.items():
        if not len(wall):
            continue
        wall.path = path
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
    wall = live.wall
    if len(wall) > wall.settings.sectors + 1:
        deepest = float(wall.vertices(len(wall) - 1, len(wall)).depth[0])
        top, bottom = min(wall.start_depth, deepest), max(wall.start_depth, deepest)
        if path is None or (path.start_depth <= top and path.stop_depth >= bottom):
            wall.surface(path, stop=deepest).save(target / "main.glb")
            written.append(target / "main.glb")
    return written


def _table(file: Path, heads: list[str], rows: Iterable[list[float]]) -> Path:
    """Write a table of numbers with every digit; a missing one is an empty cell."""
    lines = (",".join("" if number != number else repr(number) for number in row) for row in rows)
    text = "\n".join([",".join(heads), *lines, ""])
    write_whole(file, lambda whole: whole.write(text.encode()))
    return file
