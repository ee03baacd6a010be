"""Real images on walls, saved as GLB and VTU, opened by trimesh and PyVista: the values in place, quad by quad.

Nothing of helibore is asked where a quad lies: its centre comes from the points of the file, of a hole straight down,
and a loop looks the cell up in the rows that the log file holds.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from late_imports import pyvista, trimesh
from locations import SHARED

import helibore as hb

FOLDER = SHARED / "lwd-images"
P11 = "P11-A-02_Composite_MEM_Image_NF.las"
F15 = "15_9-F-15_D__WL_RAW_BHPR-CAL-DEN-GR-MECH-NEU-REMP_MWD_2.json"
INCH = 0.0254
EDGE = 1.0  # degrees: where sector 1 is taken to start; the files do not say
SECTORS, PITCH = 32, 0.1
OFF = 0.0005  # metres: keeps centres away from the borders between rows


def opened(name: str) -> Any:
    if not (FOLDER / name).exists():
        pytest.skip(f"shared/data/lwd-images/{name} is not beside the project")
    return hb.open(FOLDER / name)


def images_of(file: Any, names: list[str]) -> dict[str, Any]:
    return {name: file.image(name) for name in names}


def hung(wall: hb.Wall, images: dict[str, Any]) -> hb.Wall:
    for name, columns in images.items():
        wall.images[name] = columns.sector_image(origin="edge", reference="north", offset=EDGE)
    return wall


def cells(columns: Any, reach: float, centres: np.ndarray) -> np.ndarray:
    """For each centre (east, north, up) the value of the cell that holds it, by a loop over the file's rows."""
    depths, rows = columns.depth.tolist(), columns.values.tolist()
    sectors, found = len(rows[0]), []
    for east, north, up in centres.tolist():
        below = bisect_left(depths, -up)
        row = min((i for i in (below - 1, below) if 0 <= i < len(depths)), key=lambda i: abs(depths[i] + up))
        toolface = math.degrees(math.atan2(east, north))
        column = int((toolface - EDGE) % 360.0 / (360.0 / sectors))
        found.append(rows[row][column] if abs(depths[row] + up) <= reach else math.nan)
    return np.array(found)


def in_vtu(path: Path) -> tuple[np.ndarray, Any]:
    mesh = pyvista().read(path)
    return mesh.points[mesh.cells.reshape(-1, 5)[:, 1:]].mean(axis=1), mesh.cell_data


def in_glb(path: Path) -> tuple[np.ndarray, Any]:
    """GLB is Y up, (east, up, -north), and knows attributes at vertices, four of its own for each quad."""
    mesh = trimesh().load_scene(path).to_mesh()
    x, y, z = mesh.vertices.reshape(-1, 4, 3).mean(axis=1).T
    values = {name[1:]: of.reshape(-1, 4) for name, of in mesh.vertex_attributes.items() if name != "color"}
    assert all((of == of[:, :1]).all() for of in values.values())
    return np.column_stack([x, -z, y]), {name: np.where(of == -999.25, np.nan, of)[:, 0] for name, of in values.items()}


def require_in_place(wall: hb.Wall, images: dict[str, Any], folder: Path) -> None:
    surface = wall.surface()
    assert len(surface.quads) == len(wall) - SECTORS - 1
    for ending, read, precision in ((".vtu", in_vtu, np.float64), (".glb", in_glb, np.float32)):
        surface.save(folder / f"well{ending}", color_by=next(iter(images)))
        centres, values = read(folder / f"well{ending}")
        assert len(centres) == len(surface.quads)
        for name, columns in images.items():
            expected = cells(columns, wall.images[name].reach, centres)
            assert np.isfinite(expected).mean() > 0.3
            np.testing.assert_array_equal(values[name].astype(precision), expected.astype(precision))


def test_p11_a_02_density_and_gamma_on_a_gauge_hole(tmp_path: Path, golden: Golden) -> None:
    """16 and 8 sectors over 736 m; no caliper was run, so the hole is at bit size, and says so."""
    images = images_of(opened(P11), ["ABDC", "GRAS"])
    assert [of.values.shape[1] for of in images.values()] == [16, 8]
    start, stop = float(images["ABDC"].depth[0]), float(images["ABDC"].depth[-1])
    wall = hb.reconstruct(
        hb.Caliper.gauge(start, stop, 8.5 * INCH),
        bit_diameter=8.5 * INCH,
        sectors=SECTORS,
        pitch=PITCH,
        start_depth=start + OFF,
    )
    require_in_place(hung(wall, images), images, tmp_path)
    golden(str(pyvista().read(tmp_path / "well.vtu").field_data["basis"]))


def test_f_15_d_four_images_on_its_caliper(tmp_path: Path) -> None:
    file = opened(F15)
    images = images_of(file, ["ABDC", "GRCS", "APRA", "NBGRCS"])
    assert [of.values.shape[1] for of in images.values()] == [16, 8, 16, 16]
    diameter = file.set().numbers("CALCM")
    diameter = np.where((diameter > 6) & (diameter < 20), diameter * INCH, np.nan)  # spikes are none of this test's
    depth = images["ABDC"].depth
    assert diameter.size == depth.size
    wall = hb.reconstruct(
        hb.Caliper.from_average(depth, diameter),
        bit_diameter=8.5 * INCH,
        sectors=SECTORS,
        pitch=PITCH,
        start_depth=float(depth[~np.isnan(diameter)][0]) + OFF,
        max_distance=None,
    )
    assert np.isfinite(wall.radius).all()
    require_in_place(hung(wall, images), images, tmp_path)
    again = pyvista().read(tmp_path / "well.vtu")
    assert str(again.field_data["unit of GRCS"][0]) == images["GRCS"].unit
    assert again.point_data["radius"].tobytes() == wall.radius.tobytes()
