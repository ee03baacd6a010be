"""Surfaces written and read back: places, orientation, colours, attributes, map coordinates, whole files or none."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from late_imports import trimesh

import helibore as hb
from helibore.base.atomic_file import write_whole
from helibore.base.colors import colors_of
from helibore.mesh.glb_file import check_size
from helibore.mesh.surface import surface_of

UTM = (6.5e6, 4.5e5, -31.0)


def surface(head=(0.0, 0.0, 0.0), count=3_000, gap=()):
    settings = SimpleNamespace(sectors=16, pitch=0.1, start_toolface=0.0)
    radius = 0.108 + 0.02 * np.random.default_rng(0).random(count)
    radius[list(gap)] = np.nan
    wall = SimpleNamespace(settings=settings, start_depth=1000.0, radius=radius)
    survey = hb.Survey([950, 985, 1005, 1030], [3, 20, 48, 70], [355, 2, 30, 80])
    return surface_of(wall, survey.path(head=head))


def outward_share(mesh, positions, quads):
    """The share of triangles whose normal agrees with the quad's, after both have gone through the file's axes."""
    a, b, c = (positions[quads[:, i]] for i in range(3))
    expected = np.repeat(np.cross(b - a, c - a), 2, axis=0)
    return ((mesh.face_normals * expected).sum(axis=1) > 0).mean()


def windings(triangles):
    """Triangles whatever their order and first corner, but not turned over."""
    first = triangles.argmin(axis=1)
    return {tuple(np.roll(triangle, -start).tolist()) for triangle, start in zip(triangles, first, strict=True)}


def y_up(vertices):
    return np.column_stack([vertices[:, 1], -vertices[:, 2], -vertices[:, 0]])


def z_up(vertices):
    return np.column_stack([vertices[:, 1], vertices[:, 0], -vertices[:, 2]])


def read_glb(path):
    content = path.read_bytes()
    magic, version, length = struct.unpack_from("<4sII", content)
    assert (magic, version, length) == (b"glTF", 2, len(content))
    size, kind = struct.unpack_from("<I4s", content, 12)
    assert kind == b"JSON"
    assert size % 4 == 0
    binary_size, binary_kind = struct.unpack_from("<I4s", content, 20 + size)
    assert binary_kind == b"BIN\0"
    assert 28 + size + binary_size == length
    return json.loads(content[20 : 20 + size]), content[28 + size :]


# ------------------------------------------------------------------ GLB


def test_a_well_in_map_coordinates_comes_back_from_glb_within_a_millimetre(tmp_path):
    well = surface(UTM)
    well.save(tmp_path / "well.glb")
    scene = trimesh().load_scene(tmp_path / "well.glb")
    mesh = scene.to_mesh()
    expected = y_up(well.vertices)[well.quads.reshape(-1)]
    assert mesh.vertices.shape == expected.shape
    assert np.abs(mesh.vertices - expected).max() <= 1e-5  # the well is 20 m long; a millimetre is for kilometres
    assert outward_share(mesh, y_up(well.vertices), well.quads) == 1


def test_a_well_of_ten_kilometres_comes_back_from_glb_within_a_millimetre(tmp_path):
    settings = SimpleNamespace(sectors=8, pitch=8.0, start_toolface=0.0)
    wall = SimpleNamespace(settings=settings, start_depth=0.0, radius=np.full(10_000, 0.108))
    survey = hb.Survey(np.arange(0, 10_001, 1000), np.linspace(5, 85, 11), np.linspace(340, 400, 11) % 360)
    well = surface_of(wall, survey.path(head=UTM))
    well.save(tmp_path / "well.glb")
    mesh = trimesh().load_scene(tmp_path / "well.glb").to_mesh()
    assert np.abs(mesh.vertices - y_up(well.vertices)[well.quads.reshape(-1)]).max() <= 1e-3


def test_glb_keeps_its_promises_to_readers(tmp_path):
    well = surface(UTM, gap=[100, 101])
    well.save(tmp_path / "well.glb")
    scene, binary = read_glb(tmp_path / "well.glb")
    position = np.frombuffer(binary, "<f4", 12 * len(well.quads)).reshape(-1, 3)
    accessor = scene["accessors"][0]
    assert accessor["count"] == 4 * len(well.quads)
    assert accessor["min"] == position.min(axis=0).astype(float).tolist()
    assert accessor["max"] == position.max(axis=0).astype(float).tolist()
    assert np.isfinite(position).all()
    assert scene["buffers"][0]["byteLength"] == len(binary)
    views = scene["bufferViews"]
    ends = np.cumsum([view["byteLength"] for view in views])
    assert [view["byteOffset"] for view in views] == [0, *ends[:-1]]
    assert ends[-1] == len(binary)
    corners = np.frombuffer(binary, "<u4", offset=views[2]["byteOffset"])
    assert corners[:6].tolist() == [0, 1, 2, 0, 2, 3]
    assert corners.max() == 4 * len(well.quads) - 1


def test_each_quad_has_a_colour_of_its_own_by_radius_or_attribute(tmp_path):
    well = surface()
    well.attributes["GR"] = np.where(np.arange(len(well.quads)) % 2, 20.0, 120.0)
    well.attributes["GR"] = np.where(np.arange(len(well.quads)) == 7, np.nan, well.attributes["GR"])
    for color_by in (None, "GR"):
        well.save(tmp_path / "well.glb", color_by=color_by)
        scene, binary = read_glb(tmp_path / "well.glb")
        view = scene["bufferViews"][1]
        colors = np.frombuffer(binary, "u1", view["byteLength"], view["byteOffset"]).reshape(-1, 4, 4)
        assert (colors == colors[:, :1]).all()  # four corners alike
        assert (colors[..., 3] == 255).all()
        brightness = colors[:, 0].astype(float) @ [0.2126, 0.7152, 0.0722, 0]  # linear light
        values = well.quad_radius() if color_by is None else well.attributes["GR"]
        there = np.isfinite(values)
        order = np.argsort(values[there])
        assert (np.diff(brightness[there][order]) > -3).all()  # brighter with the value, but for rounding
        assert brightness[there].max() > 150 > 30 > brightness[there].min()
        if color_by:
            assert len(set(colors[7, 0, :3].tolist())) == 1  # grey


def test_trimesh_finds_colours_and_attributes_in_a_glb(tmp_path, golden):
    well = surface(gap=[77])
    well.attributes["GR"] = np.where(np.arange(len(well.quads)) == 7, np.nan, np.arange(len(well.quads)))
    well.attributes.units["GR"] = "gAPI"
    well.save(tmp_path / "well.glb", color_by="GR")
    mesh = trimesh().load_scene(tmp_path / "well.glb").to_mesh()
    expected = np.where(np.arange(len(well.quads)) == 7, -999.25, np.arange(len(well.quads)))
    assert (mesh.vertex_attributes["_GR"].reshape(-1, 4) == expected[:, None]).all()
    extras = read_glb(tmp_path / "well.glb")[0]["meshes"][0]["extras"]
    assert (extras["missing"], extras["basis"], extras["units"]) == (-999.25, "azimuthal", {"GR": "gAPI"})
    assert extras["metadata"] == well.metadata
    golden(extras["metadata"]["helix"])
    colors = mesh.visual.vertex_colors.reshape(-1, 4, 4)
    assert (colors == colors[:, :1]).all()
    assert len(np.unique(colors[:, 0], axis=0)) > 100


def test_colors_span_the_values_or_the_limits():
    values = np.array([1.0, 2, 3, np.nan, np.inf])
    colors = colors_of(values)
    assert colors[0].tolist() == [68, 1, 84, 255]
    assert colors[1].tolist() == pytest.approx([33, 144, 141, 255], abs=1)
    assert colors[2].tolist() == [253, 231, 37, 255]
    assert colors[3].tolist() == colors[4].tolist() == [176, 176, 176, 255]
    assert colors_of(values, (0, 10))[2].tolist() == colors_of(np.array([0, 3.0, 10]))[1].tolist()
    assert colors_of(np.array([-5.0, 15.0]), (0, 10)).tolist() == colors_of(np.array([0, 10.0])).tolist()
    assert len(np.unique(colors_of(np.full(5, 0.1)), axis=0)) == 1
    assert colors_of(np.full(2, np.nan)).tolist() == [[176, 176, 176, 255]] * 2


# ------------------------------------------------------------------ PLY, OBJ, STL


def read_ply(path):
    content = path.read_bytes()
    header, _, body = content.partition(b"end_header\n")
    lines = header.decode("ascii").split("\n")
    assert lines[:2] == ["ply", "format binary_little_endian 1.0"]
    counts = [int(line.split()[2]) for line in lines if line.startswith("element")]
    names = [line.split()[-1] for line in lines if line.startswith("property double")]
    vertex = np.dtype([("xyz", "<f8", 3), ("color", "u1", 3)])
    vertices = np.frombuffer(body, vertex, counts[0])
    face = np.dtype([("n", "u1"), ("quad", "<i4", 4), *[(name, "<f8") for name in names[3:]]])
    faces = np.frombuffer(body, face, counts[1], offset=vertices.nbytes)
    assert vertices.nbytes + faces.nbytes == len(body)
    return vertices, faces


def test_ply_holds_quads_float64_colours_and_attributes(tmp_path):
    well = surface(UTM, gap=[500])
    well.attributes["GR"] = np.where(np.arange(len(well.quads)) < 40, np.nan, np.arange(len(well.quads)) // 1000)
    well.save(tmp_path / "well.ply", color_by="GR")
    vertices, faces = read_ply(tmp_path / "well.ply")
    assert vertices["xyz"].tobytes() == z_up(well.vertices).tobytes()
    assert (faces["n"] == 4).all()
    assert (faces["quad"] == well.quads).all()
    assert faces["GR"].tobytes() == well.attributes["GR"].tobytes()
    assert (faces["radius"] == well.quad_radius()).all()
    palette = colors_of(np.array([0.0, 1, 2]))[:, :3].tolist()
    for quad, value in ((300, 0), (1500, 1), (2800, 2)):  # amid quads of the same value
        assert vertices["color"][well.quads[quad]].tolist() == [palette[value]] * 4
    assert vertices["color"][0].tolist() == [176, 176, 176]
    mesh = trimesh().load_mesh(tmp_path / "well.ply", process=False)
    assert np.abs(mesh.vertices - z_up(well.vertices)).max() == 0
    assert windings(mesh.faces) == windings(well.triangles())
    assert (mesh.visual.vertex_colors[:, :3] == vertices["color"]).all()


@pytest.mark.parametrize("name", ["", "gamma ray", "\u03b3", "vertex_indices", "a\nb"])
def test_attribute_names_a_ply_header_cannot_hold(tmp_path, name, golden):
    well = surface()
    well.attributes[name] = np.zeros(len(well.quads))
    with golden.raises():
        well.save(tmp_path / "well.ply")
    assert not list(tmp_path.iterdir())


def test_obj_keeps_map_coordinates(tmp_path):
    well = surface(UTM)
    well.save(tmp_path / "well.obj")
    mesh = trimesh().load_mesh(tmp_path / "well.obj", process=False)
    assert np.abs(mesh.vertices - z_up(well.vertices)).max() <= 1e-8
    assert (mesh.faces == well.triangles()).all()


@pytest.mark.parametrize("ending", [".obj", ".ply"])
@pytest.mark.parametrize("name", ["Größe", "two\nlines"])
def test_a_comment_is_one_line_of_ascii_whatever_the_name_of_its_text(tmp_path, ending, name):
    well = surface()
    well.metadata[name] = "x"
    well.save(tmp_path / f"well{ending}")
    lines = (tmp_path / f"well{ending}").read_bytes().splitlines()
    assert sum(line.endswith(b"helibore: %s: x" % ascii(name)[1:-1].encode()) for line in lines) == 1
    mesh = trimesh().load_mesh(tmp_path / f"well{ending}", process=False)
    assert len(mesh.faces) == 2 * len(well.quads)


def test_a_unit_of_an_attribute_with_any_name_does_not_stop_an_obj(tmp_path):
    well = surface()
    well.attributes["Δr"] = np.zeros(len(well.quads))
    well.attributes.units["Δr"] = "m"
    well.save(tmp_path / "well.obj")
    assert b"unit of \\u0394r: m" in (tmp_path / "well.obj").read_bytes()


def test_stl_is_refused_where_float32_would_move_the_wall_and_taken_from_an_origin(tmp_path, golden):
    well = surface(UTM)
    with golden.raises():
        well.save(tmp_path / "well.stl")
    assert not list(tmp_path.iterdir())
    origin = (UTM[0], UTM[1], 900.0)
    well.save(tmp_path / "well.stl", origin=origin)
    mesh = trimesh().load_mesh(tmp_path / "well.stl", process=False)
    expected = z_up(well.vertices - np.array(origin))
    assert np.abs(mesh.triangles - expected[well.triangles()]).max() <= 1e-4
    assert outward_share(mesh, expected, well.quads) == 1


def test_every_format_counts_from_the_origin(tmp_path):
    well = surface(UTM)
    for ending, turned in ((".glb", y_up), (".ply", z_up), (".obj", z_up)):
        well.save(tmp_path / f"well{ending}", origin=UTM)
        mesh = trimesh().load_scene(tmp_path / f"well{ending}").to_mesh()
        expected = turned(well.vertices - np.array(UTM))
        assert mesh.bounds == pytest.approx(np.array([expected.min(axis=0), expected.max(axis=0)]), abs=1e-5)


# ------------------------------------------------------------------ whole files or none


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("well.xyz", {}),
        ("well", {}),
        ("well.glb", {"color_by": "GR"}),
        ("well.ply", {"color_by": "GR"}),
        ("well.glb", {"limits": (5, 5)}),
        ("well.glb", {"origin": (0, np.nan, 0)}),
    ],
)
def test_bad_saves_write_nothing(tmp_path, name, settings, golden):
    well = surface()
    well.attributes["RT"] = np.ones(len(well.quads))
    with golden.raises():
        well.save(tmp_path / name, **settings)
    assert not list(tmp_path.iterdir())


def test_a_glb_of_more_bytes_than_its_header_counts_is_refused_before_it_is_made(tmp_path, monkeypatch, golden):
    well = surface()
    well.attributes["RT"] = np.ones(len(well.quads))
    well.save(tmp_path / "well.glb")
    size = (tmp_path / "well.glb").stat().st_size
    monkeypatch.setattr("helibore.mesh.glb_file.LARGEST", size - 1)
    with golden.raises():
        well.save(tmp_path / "well.glb")
    assert [file.stat().st_size for file in tmp_path.iterdir()] == [size]
    monkeypatch.undo()
    check_size(Path("a.glb"), 48_000_000, 0)
    with golden.raises():
        check_size(Path("a.glb"), 48_900_000, 0)


def test_a_surface_without_quads_is_not_a_file(tmp_path, golden):
    with golden.raises():
        surface(count=10).save(tmp_path / "well.glb")
    assert not list(tmp_path.iterdir())


def test_a_failed_write_leaves_the_old_file_and_nothing_beside_it(tmp_path):
    target = tmp_path / "well.bin"
    write_whole(target, lambda file: file.write(b"old"))

    def fail(file):
        file.write(b"half of the n")
        raise RuntimeError("disk full")

    with pytest.raises(RuntimeError, match="disk full"):
        write_whole(target, fail)
    assert target.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [target]
    write_whole(str(target), lambda file: file.write(b"new"))
    assert target.read_bytes() == b"new"


def test_a_folder_that_is_not_there_is_an_error(tmp_path):
    with pytest.raises(FileNotFoundError):
        surface().save(tmp_path / "nowhere" / "well.glb")
