"""The state of a live wall as files, each whole or not there: walls, mesh, images, survey.

main.npz        depth m, toolface deg, radius m, nearest m, support       one file a layer
main.glb        the wall along the path                                   when a path covers it
image-GR.npz    depth m, values                                           one file an image
survey.csv      depth_m, inclination_deg, azimuth_deg
"""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO

import numpy as np
import numpy.typing as npt

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
    written: list[Path] = []

    def save(name: str, **arrays: npt.NDArray[np.generic]) -> None:
        def write(file: BinaryIO) -> None:
            np.savez_compressed(file, allow_pickle=False, **arrays)

        write_whole(target / name, write)
        written.append(target / name)

    for name, wall in live.layers.items():
        if len(wall):
            save(f"{name}.npz", depth=wall.depth, toolface=wall.toolface, radius=wall.radius, nearest=wall.nearest,
                 support=wall.support)  # fmt: skip
    for name, image in live.images.items():
        if len(image):
            depth, values = image.arrays()
            save(f"image-{name}.npz", depth=depth, values=values)
    rows = live.model.stations.rows()
    if len(rows):
        text = "depth_m,inclination_deg,azimuth_deg\n" + "".join(f"{d!r},{i!r},{a!r}\n" for d, i, a in rows.tolist())
        write_whole(target / "survey.csv", lambda file: file.write(text.encode()))
        written.append(target / "survey.csv")
    path = live.path
    if len(live.wall) and (path is None or path.stop_depth >= live.wall.depth[-1]):
        live.wall.surface(path).save(target / "main.glb")
        written.append(target / "main.glb")
    return written
