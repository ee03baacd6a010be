"""VTU, VTP and VTKHDF: written here, read back by PyVista; parts added; broken disks and foreign files."""

from __future__ import annotations

import errno
import itertools
import re
import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from late_imports import pyvista

import helibore as hb

ENDINGS = (".vtu", ".vtp", ".vtkhdf")
UTM = (6.5e6, 4.5e5, -31.0)


def wall(seed: int = 0, gap: bool = True) -> hb.Wall:
    rng = np.random.default_rng(seed)
    depth = rng.uniform(1000, 1004, 6_000)
    if gap:
        depth = depth[abs(depth - 1002.3) > 0.2]
    made = hb.reconstruct(
        hb.Caliper(depth, rng.uniform(0, 360, depth.size), rng.uniform(0.1, 0.13, depth.size)),
        bit_diameter=0.216,
        sectors=16,
        start_depth=1000.0,
        max_distance=0.1,
    )
    made.path = hb.Survey([950, 985, 1005, 1030], [3, 20, 48, 70], [355, 2, 30, 80]).path(head=UTM)
    made.made_from = {"files": ["run ä.las"]}
    return made


def surface(**interval: Any) -> hb.Surface:
    made = wall().surface(**interval)
    made.attributes["GR <1>"] = np.where(made.quad_index % 3, made.quad_index * 1.5, np.nan)
    made.attributes.units["GR <1>"] = "gAPI"
    made.attributes["RT"] = np.cos(made.quad_index)
    return made


def east_north_up(vertices: np.ndarray) -> np.ndarray:
    return np.column_stack([vertices[:, 1], vertices[:, 0], -vertices[:, 2]])


def require_same(mesh: Any, made: hb.Surface) -> None:
    """Every place, quad and value, bit for bit."""
    assert mesh.points.tobytes() == east_north_up(made.vertices).tobytes()
    cells = mesh.faces.reshape(-1, 5) if isinstance(mesh, pyvista().PolyData) else mesh.cells.reshape(-1, 5)
    assert (cells[:, 0] == 4).all()
    assert (cells[:, 1:] == made.quads).all()
    if isinstance(mesh, pyvista().UnstructuredGrid):
        assert (mesh.celltypes == pyvista().CellType.QUAD).all()
    assert mesh.cell_data["radius"].tobytes() == made.quad_radius().tobytes()
    for name, values in made.attributes.items():
        assert np.array_equal(mesh.cell_data[name], values, equal_nan=True)
    of_wall = wall()
    for name in ("radius", "depth", "toolface"):
        assert mesh.point_data[name].tobytes() == getattr(of_wall, name)[made.vertex_index].tobytes()


@pytest.mark.parametrize("ending", ENDINGS)
def test_pyvista_reads_every_place_quad_value_and_note(tmp_path: Path, ending: str, golden: Golden) -> None:
    made = surface()
    assert len(made.quads) < len(wall()) - 17  # there is a gap
    made.save(tmp_path / f"a{ending}", color_by="RT")
    mesh = pyvista().read(tmp_path / f"a{ending}")
    require_same(mesh, made)
    notes = {name: str(mesh.field_data[name][0]) for name in mesh.field_data}
    assert notes["axes"] == "x east, y north, z up"
    golden(notes["basis"])
    golden(notes["helix"])
    assert notes["toolface 0"] == "high-side"
    assert notes["path"].startswith("minimum-curvature through 4 stations from 950.0 to 1030.0 m, extended by 0.0 m")
    assert notes["made_from"] == '{"files": ["run ä.las"]}'
    assert (notes["unit of GR <1>"], notes["unit of depth"], notes["bit_diameter"]) == ("gAPI", "m", "0.216 m")
    if ending != ".vtkhdf":
        assert mesh.active_scalars_name == "RT"


@pytest.mark.parametrize("ending", ENDINGS)
def test_an_origin_moves_the_points_and_is_noted(tmp_path: Path, ending: str) -> None:
    made = surface()
    made.save(tmp_path / f"a{ending}", origin=(6.5e6, 4.5e5, 900.0))
    mesh = pyvista().read(tmp_path / f"a{ending}")
    assert np.array_equal(mesh.points, east_north_up(made.vertices - np.array([6.5e6, 4.5e5, 900.0])))
    assert str(mesh.field_data["origin"][0]) == "north 6500000.0, east 450000.0, down 900.0 m"


@pytest.mark.parametrize("ending", [".vtu", ".vtkhdf"])
def test_volumes_come_back_with_layers_and_positive_cells(tmp_path: Path, ending: str) -> None:
    made = wall().volume(shells=[0.05, 0.2])
    made.hang("RT", [2.0, 20.0], unit="ohm.m")
    made.save(tmp_path / f"a{ending}")
    mesh = pyvista().read(tmp_path / f"a{ending}")
    assert mesh.points.tobytes() == east_north_up(made.vertices).tobytes()
    assert (mesh.celltypes == pyvista().CellType.HEXAHEDRON).all()
    assert (mesh.cells.reshape(-1, 9)[:, 1:] == made.hexes).all()
    assert (mesh.cell_data["layer"] == made.hex_layer).all()
    assert (mesh.cell_data["RT"] == np.where(made.hex_layer == 0, 2.0, 20.0)).all()
    assert mesh.point_data["radius"].tobytes() == made.radius.tobytes()
    own = mesh.compute_cell_sizes(length=False, area=False)["Volume"]
    assert (own > 0).all()
    assert own.sum() == pytest.approx(made.hex_volume().sum(), rel=1e-6)  # VTK cuts cells into tetrahedra


def test_parts_added_one_by_one_are_the_whole_wall(tmp_path: Path) -> None:
    path = tmp_path / "a.vtkhdf"
    cuts = [None, 1000.7, 1002.3, 1003.1, None]
    parts = [surface(start=start, stop=stop) for start, stop in itertools.pairwise(cuts)]
    for part in parts:
        part.append_to(path)
    blocks = pyvista().read(path)
    assert len(blocks) == len(parts)
    for mesh, part in zip(blocks, parts, strict=True):
        require_same(mesh, part)
    whole = surface()
    assert np.concatenate([mesh.cell_data["RT"] for mesh in blocks]).tobytes() == whole.attributes["RT"].tobytes()


def test_parts_that_do_not_belong_are_refused_and_the_file_kept(tmp_path: Path, golden: Golden) -> None:
    path = tmp_path / "a.vtkhdf"
    first = surface(stop=1001)
    first.append_to(path)
    before = path.read_bytes()
    bare = wall().surface(start=1001)
    with golden.raises():
        bare.append_to(path)
    with golden.raises():
        wall().volume(start=1001).append_to(path)
    with golden.raises():
        first.append_to(tmp_path / "a.vtu")
    moved = surface(start=1001)
    moved.metadata["toolface 0"] = "north"
    with golden.raises():
        moved.append_to(path)
    assert path.read_bytes() == before
    (tmp_path / "b.vtkhdf").write_bytes(b"no HDF5 at all")
    with golden.raises():
        first.append_to(tmp_path / "b.vtkhdf")
    h5py = pytest.importorskip("h5py")
    h5py.File(tmp_path / "c.vtkhdf", "w").close()
    with golden.raises():
        first.append_to(tmp_path / "c.vtkhdf")
    with h5py.File(tmp_path / "c.vtkhdf", "w") as other:
        other.create_group("VTKHDF/PointData").parent.attrs["Type"] = np.bytes_("ImageData")
    with golden.raises():
        first.append_to(tmp_path / "c.vtkhdf")
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.vtkhdf", "b.vtkhdf", "c.vtkhdf"]


@contextmanager
def disk_of(size: int) -> Iterator[None]:
    """A limit on the size of files stands for the end of the disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize("size", [0, 3_000, 30_000])
@pytest.mark.parametrize("ending", [".glb", ".ply", ".obj", ".stl", *ENDINGS])
def test_a_full_disk_keeps_the_old_file_and_leaves_nothing_beside_it(tmp_path: Path, ending: str, size: int) -> None:
    path = tmp_path / f"a{ending}"
    path.write_bytes(b"old")
    made = wall().surface()
    made.attributes["RT"] = np.cos(made.quad_index)
    origin = (6.5e6, 4.5e5, 900.0)
    with disk_of(size), pytest.raises(OSError, match=re.escape(path.name)) as raised:
        made.save(path, origin=origin)
    assert raised.value.errno in (errno.EFBIG, None)
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]
    made.save(path, origin=origin)
    assert path.stat().st_size > 30_000


def test_a_disk_that_fills_while_a_part_is_added_keeps_the_parts_before(tmp_path: Path) -> None:
    path = tmp_path / "a.vtkhdf"
    surface(stop=1001).append_to(path)
    before = path.read_bytes()
    for size in (1_000, len(before) // 2, len(before) - 1):
        with disk_of(size), pytest.raises(OSError, match=r"a\.vtkhdf"):
            surface(start=1001).append_to(path)
        assert path.read_bytes() == before
        assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_folder_that_is_not_there_is_named(tmp_path: Path, ending: str) -> None:
    with pytest.raises(OSError, match=rf"nowhere.a\{ending}"):
        surface().save(tmp_path / "nowhere" / f"a{ending}")


def test_bad_saves_write_nothing(tmp_path: Path, golden: Golden) -> None:
    made = surface()
    with golden.raises():
        made.save(tmp_path / "a.vtu", color_by="SP")
    with golden.raises():
        made.save(tmp_path / "a.vtp", origin=(0, np.nan, 0))
    made.attributes["GR/1"] = made.attributes["RT"]
    with golden.raises():
        made.save(tmp_path / "a.vtkhdf")
    del made.attributes["GR/1"]
    made.metadata["km/h"] = "100"
    with golden.raises():
        made.save(tmp_path / "a.vtkhdf")
    with golden.raises():
        hb.Wall(bit_diameter=0.2, sectors=16).volume().save(tmp_path / "a.vtu")
    assert not list(tmp_path.iterdir())


def test_names_that_xml_would_misread_come_back(tmp_path: Path) -> None:
    made = surface()
    names = ['a"b', "a<b>&c", "Δr"]
    for number, name in enumerate(names):
        made.attributes[name] = np.full(len(made.quads), float(number))
    made.save(tmp_path / "a.vtu")
    mesh = pyvista().read(tmp_path / "a.vtu")
    assert [mesh.cell_data[name][0] for name in names] == [0, 1, 2]


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("name", ["", "a\nb", "a\x01b", "a\x00b", "a\ud800b"])
def test_names_that_no_vtk_file_can_hold_are_refused(tmp_path: Path, ending: str, name: str) -> None:
    made = surface()
    made.attributes[name] = np.zeros(len(made.quads))
    text = f"attributes[{name!r}]: a name in a VTK file must not be empty or contain characters that XML forbids"
    with pytest.raises(hb.InputError, match=f"^{re.escape(text)}$"):
        made.save(tmp_path / f"a{ending}")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_file_name_that_is_not_utf_8_does_not_stop_a_save(tmp_path: Path, ending: str) -> None:
    """Python gives such a name lone surrogates, and they cannot be encoded again."""
    of = wall()
    of.made_from = {"files": [b"run \xe4.las".decode(errors="surrogateescape")]}
    of.surface().save(tmp_path / f"a{ending}")
    note = str(pyvista().read(tmp_path / f"a{ending}").field_data["made_from"][0])
    assert note == r'{"files": ["run \udce4.las"]}'


@pytest.mark.parametrize(("first", "second"), [((0.0, 0.0, 0.0), UTM), (UTM, (0.0, 0.0, 0.0))])
def test_a_part_with_another_origin_is_refused_also_if_one_has_none(
    tmp_path: Path, first: Any, second: Any, golden: Golden
) -> None:
    path = tmp_path / "a.vtkhdf"
    surface(stop=1001).append_to(path, origin=first)
    before = path.read_bytes()
    with golden.raises():
        surface(start=1001).append_to(path, origin=second)
    assert path.read_bytes() == before


def test_a_folder_in_place_of_a_file_of_parts_is_an_error_of_the_file_system(tmp_path: Path) -> None:
    (tmp_path / "a.vtkhdf").mkdir()
    with pytest.raises(IsADirectoryError):
        surface().append_to(tmp_path / "a.vtkhdf")
