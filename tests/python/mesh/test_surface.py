"""Surface and Volume: places, topology, outward normals, gaps, positive volume, intervals, attributes, error texts."""

from __future__ import annotations

import itertools
import math
import re
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import helibore as hb
from helibore.mesh.surface import surface_of
from helibore.mesh.volume import volume_of


def wall_of(radius, sectors=16, pitch=0.1, start_depth=1000.0, start_toolface=0.0):
    settings = SimpleNamespace(sectors=sectors, pitch=pitch, start_toolface=start_toolface)
    return SimpleNamespace(settings=settings, start_depth=start_depth, radius=np.array(radius, dtype=float))


def rugged(count, seed=0):
    return 0.108 + 0.02 * np.random.default_rng(seed).random(count)


def depth_of(wall, k):
    return wall.start_depth + k * wall.settings.pitch / wall.settings.sectors


def curved(method="minimum-curvature", reference="high-side", **settings):
    survey = hb.Survey([950, 985, 1005, 1030, 1060], [3, 20, 48, 70, 95], [355, 2, 30, 80, 60])
    return survey.path(method=method, reference=reference, **settings)


def places(wall, path):
    """Vertices by the formula of the conventions, one at a time."""
    rows = []
    for k, radius in enumerate(wall.radius):
        toolface = math.radians(wall.settings.start_toolface + k % wall.settings.sectors * 360 / wall.settings.sectors)
        depth = depth_of(wall, k)
        high_side, right, _ = path.frame(depth)
        rows.append(path.position(depth) + radius * (math.cos(toolface) * high_side + math.sin(toolface) * right))
    return np.array(rows)


def normals(vertices, quads):
    a, b, c, d = (vertices[quads[:, i]] for i in range(4))
    return np.cross(c - a, d - b)


# ------------------------------------------------------------------ places


@pytest.mark.parametrize("method", ["minimum-curvature", "radius-of-curvature"])
@pytest.mark.parametrize("reference", ["high-side", "north"])
@pytest.mark.parametrize(("pitch", "sectors", "start_toolface"), [(0.1, 16, 0.0), (-0.07, 5, 123.4), (3.0, 64, -20.0)])
def test_every_vertex_lies_where_the_conventions_say(method, reference, pitch, sectors, start_toolface):
    wall = wall_of(rugged(800), sectors, pitch, 1000.0, start_toolface)
    path = curved(method, reference, head=(6.5e6, 4.5e5, -30))
    surface = surface_of(wall, path)
    assert surface.vertices.dtype == np.float64
    assert surface.vertices.shape == (800, 3)
    assert np.abs(surface.vertices - places(wall, path)).max() <= 2e-9  # two units in the last place of 6.5e6
    near = curved(method, reference)
    assert np.abs(surface_of(wall, near).vertices - places(wall, near)).max() <= 2e-13


def test_without_a_path_the_hole_is_straight_down_and_toolface_0_is_north():
    wall = wall_of([0.1] * 9, sectors=4, pitch=0.4, start_depth=50)
    expected = [
        [[0.1, 0, 50], [0, 0.1, 50.1], [-0.1, 0, 50.2], [0, -0.1, 50.3]],
        [[0.1, 0, 50.4], [0, 0.1, 50.5], [-0.1, 0, 50.6], [0, -0.1, 50.7]],
    ]
    surface = surface_of(wall)
    assert surface.vertices[:8] == pytest.approx(np.reshape(expected, (8, 3)), abs=1e-15)
    assert surface.quads.tolist() == [[k, k + 1, k + 5, k + 4] for k in range(4)]
    assert surface.quads.dtype == np.int64


def test_threads_and_intervals_give_the_same_bits():
    wall = wall_of(rugged(60_000), sectors=64, pitch=0.05)
    whole = surface_of(wall, curved(), threads=1)
    for threads in (2, 7):
        again = surface_of(wall, curved(), threads=threads)
        assert again.vertices.tobytes() == whole.vertices.tobytes()
        assert again.quads.tobytes() == whole.quads.tobytes()
    piece = surface_of(wall, curved(), start=1003.3, stop=1017.7)
    assert piece.vertices.tobytes() == whole.vertices[piece.vertex_index].tobytes()


def test_a_new_station_moves_only_vertices_below_the_previous_last_one():
    stations = [950, 985, 1005, 1030, 1060], [3, 20, 48, 70, 95], [355, 2, 30, 80, 60]
    wall = wall_of(rugged(8_000), pitch=0.1)  # 1000 to 1050
    before = surface_of(wall, hb.Survey(*(column[:4] for column in stations)).path(extend=25))
    after = surface_of(wall, hb.Survey(*stations).path())
    depth = depth_of(wall, np.arange(8_000))
    assert before.vertices[depth <= 1030].tobytes() == after.vertices[depth <= 1030].tobytes()
    moved = (before.vertices != after.vertices).any(axis=1)
    assert moved[depth > 1030.1].all()


# ------------------------------------------------------------------ topology


@pytest.mark.parametrize("sectors", [3, 16])
@pytest.mark.parametrize("pitch", [0.1, -0.1])
@pytest.mark.parametrize("path", [None, curved(), curved("radius-of-curvature", "north")], ids=["none", "arc", "curve"])
def test_normals_point_away_from_the_axis(sectors, pitch, path):
    wall = wall_of(np.full(1500, 0.108), sectors, pitch)
    surface = surface_of(wall, path)
    middle = surface.vertices[surface.quads].mean(axis=1)
    depth = depth_of(wall, surface.quad_index + (sectors + 1) / 2)
    axis = np.column_stack([0 * depth, 0 * depth, depth]) if path is None else path.position(depth)
    normal = normals(surface.vertices, surface.quads)
    outward = (normal * (middle - axis)).sum(axis=1)
    assert (outward > 0.4 * np.linalg.norm(normal, axis=1) * np.linalg.norm(middle - axis, axis=1)).all()
    assert (surface.quads[:, 0] == surface.quad_index).all()


@pytest.mark.parametrize("sectors", [3, 4, 64])
def test_no_crack_anywhere_neither_at_0_nor_between_turns(sectors):
    count = 10 * sectors + 1
    quads = surface_of(wall_of(np.full(count, 0.1), sectors)).quads
    edges = np.sort(np.concatenate([quads[:, [i, (i + 1) % 4]] for i in range(4)]), axis=1)
    _, shared = np.unique(edges, axis=0, return_counts=True)
    assert shared.max() == 2
    # One strip wound up, each turn sewn to the next: only the first turn, the last, and the two ends are open.
    assert (shared == 1).sum() == 2 * sectors + 2


def quads_one_by_one(radius, sectors):
    """The quads of a wall with gaps, as vertices k of the helix."""
    rows = []
    for k in range(len(radius) - sectors - 1):
        corners = [k, k + 1, k + 1 + sectors, k + sectors]
        if not np.isnan(radius[corners]).any():
            rows.append(corners)
    return np.array(rows, dtype=int).reshape(-1, 4)


@given(
    missing=st.lists(st.booleans(), min_size=0, max_size=120),
    sectors=st.integers(3, 9),
    downwards=st.booleans(),
    threads=st.integers(1, 3),
)
def test_gaps_leave_out_their_vertices_and_every_quad_that_touches_them(missing, sectors, downwards, threads):
    radius = np.where(missing, np.nan, rugged(len(missing))) if missing else np.zeros(0)
    surface = surface_of(wall_of(radius, sectors, 0.1 if downwards else -0.1), threads=threads)
    assert surface.vertex_index.tolist() == np.flatnonzero(~np.isnan(radius)).tolist()
    assert np.isfinite(surface.vertices).all()
    assert surface.radius.tolist() == radius[~np.isnan(radius)].tolist()
    expected = quads_one_by_one(radius, sectors)
    assert surface.quad_index.tolist() == expected[:, 0].tolist()
    corners = surface.vertex_index[surface.quads] if len(surface.quads) else surface.quads
    assert corners.tolist() == (expected if downwards else expected[:, [0, 3, 2, 1]]).tolist()


def test_long_gapped_walls_on_several_threads():
    radius = rugged(300_000)
    radius[np.random.default_rng(1).random(300_000) < 0.01] = np.nan
    wall = wall_of(radius, sectors=64, pitch=0.01)
    surface = surface_of(wall, curved(), threads=3)
    dense = surface_of(wall_of(rugged(300_000), 64, 0.01), curved(), threads=1)
    assert surface.vertices.tobytes() == dense.vertices[~np.isnan(radius)].tobytes()
    k = np.arange(300_000 - 65)
    corners = np.column_stack([k, k + 1, k + 65, k + 64])
    kept = ~np.isnan(radius[corners]).any(axis=1)
    assert (surface.quad_index == k[kept]).all()
    assert (surface.vertex_index[surface.quads] == corners[kept]).all()


def test_walls_too_short_for_a_quad_and_empty_ones():
    assert surface_of(wall_of(np.full(17, 0.1))).quads.shape == (0, 4)
    assert surface_of(wall_of(np.full(18, 0.1))).quads.shape == (1, 4)
    empty = surface_of(wall_of([]))
    assert empty.vertices.shape == (0, 3)
    assert empty.triangles().shape == (0, 3)
    assert empty.quad_index.shape == (0,)


def test_surfaces_and_volumes_of_a_real_wall(golden):
    random = np.random.default_rng(5)
    depth = np.sort(random.uniform(1000, 1020, 8_000))
    caliper = hb.Caliper(depth, random.uniform(0, 360, 8_000), random.uniform(0.1, 0.12, 8_000))
    wall = hb.reconstruct(caliper, bit_diameter=0.216, sectors=16, start_toolface=30.0)
    surface = wall.surface(curved())
    assert (
        np.abs(surface.vertices - places(wall_of(wall.radius, 16, 0.1, wall.start_depth, 30.0), curved())).max() < 1e-12
    )
    assert len(surface.quads) == len(wall) - 17
    assert len(wall.volume(curved(), shells=[0.1], start=1005, stop=1006).hexes) == 160
    assert wall.surface(start=1005, stop=1006).quad_index[0] == math.ceil((1005 - wall.start_depth) * 160)
    assert len(hb.Wall(bit_diameter=0.216).surface().vertices) == 0
    straight, along = wall.surface(), wall.surface(curved())
    wall.path = curved()
    assert wall.surface().vertices.tobytes() == along.vertices.tobytes()  # its own
    assert wall.surface(None).vertices.tobytes() == straight.vertices.tobytes()  # straight down, as ever
    assert wall.volume(shells=[0.1]).vertices.tobytes() == wall.volume(curved(), shells=[0.1]).vertices.tobytes()
    below = wall.volume(None, shells=[0.1])
    assert below.vertices[: len(straight.vertices)].tobytes() == straight.vertices.tobytes()
    with golden.raises():
        wall.surface("down")
    assert len(hb.Wall(bit_diameter=0.216).volume().hexes) == 0


def test_triangles_cut_each_quad_and_face_outwards():
    surface = surface_of(wall_of(rugged(100)), curved())
    assert surface.triangles()[:2].tolist() == [[0, 1, 17], [0, 17, 16]]
    mesh = surface.to_trimesh()
    assert len(mesh.faces) == 2 * len(surface.quads)
    assert (mesh.vertices == surface.vertices).all()


# ------------------------------------------------------------------ intervals


@pytest.mark.parametrize("pitch", [0.1, -0.1])
def test_surfaces_of_neighbouring_intervals_meet_without_overlap_or_gap(pitch):
    wall = wall_of(rugged(3_000), pitch=pitch)
    depth = depth_of(wall, np.arange(3_000))
    cut = [depth.min() + 4.03, depth[1500]]  # between two vertices, and at one
    bounds = [None, *sorted(cut), None]
    pieces = [surface_of(wall, start=start, stop=stop) for start, stop in itertools.pairwise(bounds)]
    index = np.concatenate([piece.quad_index for piece in pieces])
    assert sorted(index.tolist()) == surface_of(wall).quad_index.tolist()
    inside = depth[pieces[1].quad_index]
    assert sorted(cut)[0] <= inside.min()
    assert inside.max() < sorted(cut)[1]


OUTSIDE = "no vertex lies in [start, stop); the wall reaches from 1000 to 1018.74 m"


@pytest.mark.parametrize(
    ("start", "stop"),
    [
        (math.nan, None),
        (1010, 1005),
        (1005, 1005),
        (2000, None),
        (None, 900),
    ],
)
def test_bad_intervals(start, stop, golden):
    with golden.raises():
        surface_of(wall_of(rugged(3_000)), start=start, stop=stop)


# ------------------------------------------------------------------ volume


def corner_determinants(vertices, hexes):
    """The volume spanned by the three edges at each corner of each hexahedron, positive if VTK's order is kept."""
    neighbours = [(1, 3, 4), (2, 0, 5), (3, 1, 6), (0, 2, 7), (7, 5, 0), (4, 6, 1), (5, 7, 2), (6, 4, 3)]
    corner = vertices[hexes]
    return np.stack([np.linalg.det(corner[:, list(of)] - corner[:, [i]]) for i, of in enumerate(neighbours)], axis=1)


@pytest.mark.parametrize("pitch", [0.1, -0.1])
@pytest.mark.parametrize("path", [None, curved(), curved("radius-of-curvature")], ids=["none", "arc", "curve"])
def test_hexahedra_have_positive_volume_everywhere(pitch, path):
    volume = volume_of(wall_of(np.full(2_000, 0.108), pitch=pitch), path, shells=[0.05, 0.20])
    assert volume.hexes.dtype == np.int64
    assert (corner_determinants(volume.vertices, volume.hexes) > 0).all()


def test_volume_of_a_round_hole():
    sectors, count = 64, 64 * 50 + 65
    volume = volume_of(wall_of(np.full(count, 0.1), sectors), shells=[0.05, 0.20])
    cells = corner_determinants(volume.vertices, volume.hexes).mean(axis=1)
    for layer, (inner, outer) in enumerate([(0.1, 0.15), (0.15, 0.3)]):
        mine = cells[volume.hex_layer == layer].sum()
        polygon = sectors / 2 * math.sin(2 * math.pi / sectors)  # of a circle of radius 1
        assert mine == pytest.approx(polygon * (outer**2 - inner**2) * 0.1 * 50, rel=1e-2)


@pytest.mark.parametrize("threads", [1, 4])
def test_volumes_are_the_surfaces_of_their_shells_layer_by_layer(threads):
    radius = rugged(40_000)
    radius[[7, 500, 501, 30_000]] = np.nan
    second = radius + 0.03
    second[1234] = np.nan
    wall = wall_of(radius, pitch=0.01)
    volume = volume_of(wall, curved(), [second - radius, wall_of(radius + 0.1, pitch=0.01)], threads=threads)
    shells = [surface_of(wall_of(r, pitch=0.01), curved()) for r in (radius, second, radius + 0.1)]
    assert volume.vertices.tobytes() == np.concatenate([shell.vertices for shell in shells]).tobytes()
    assert (volume.vertex_index == np.concatenate([shell.vertex_index for shell in shells])).all()
    assert (volume.vertex_shell == np.repeat([0, 1, 2], [len(shell.vertices) for shell in shells])).all()
    starts = np.cumsum([0] + [len(shell.vertices) for shell in shells])
    row = 0
    for layer in (0, 1):
        inner, outer = shells[layer], shells[layer + 1]
        common = np.intersect1d(inner.quad_index, outer.quad_index)
        stop = row + len(common)
        assert (volume.hex_index[row:stop] == common).all()
        assert (volume.hex_layer[row:stop] == layer).all()
        for side, shell, start in ((slice(0, 4), inner, starts[layer]), (slice(4, 8), outer, starts[layer + 1])):
            of = shell.quads[np.isin(shell.quad_index, common)] + start
            assert (volume.hexes[row:stop, side] == of).all()
        row = stop
    assert row == len(volume.hexes)


def test_a_longer_or_shorter_second_wall_counts_where_both_are():
    wall = wall_of(np.full(100, 0.1))
    longer, shorter = wall_of(np.full(150, 0.2)), wall_of(np.full(60, 0.2))
    assert len(volume_of(wall, shells=[longer]).hexes) == 100 - 17
    assert len(volume_of(wall, shells=[shorter]).hexes) == 60 - 17


@pytest.mark.parametrize(
    "shells",
    [
        [],
        [0.0],
        [0.25, 0.125],
        [math.nan],
        [[0.1, 0.2]],
        [[0.25] * 42 + [-0.0625] + [0.25] * 57],
        [wall_of([0.5] * 100, sectors=8)],
    ],
)
def test_bad_shells(shells, golden):
    with golden.raises():
        volume_of(wall_of([0.125] * 100), shells=shells)


def test_volumes_refuse_formats_without_hexahedra(tmp_path, golden):
    volume = volume_of(wall_of([0.1] * 100))
    with golden.raises():
        volume.save(tmp_path / "well.glb")
    assert not list(tmp_path.iterdir())


# ------------------------------------------------------------------ attributes


def test_attributes_are_one_value_a_cell_or_one_for_each_of_the_whole_wall(golden):
    radius = rugged(100)
    radius[40] = np.nan
    surface = surface_of(wall_of(radius))
    assert len(surface.quads) == 83 - 4
    surface.attributes["GR"] = np.arange(79, dtype=np.float32)
    surface.attributes["whole"] = np.arange(83)
    assert surface.attributes["GR"].dtype == np.float64
    assert surface.attributes["whole"].tolist() == surface.quad_index.tolist()
    assert list(surface.attributes) == ["GR", "whole"]
    with golden.raises():
        surface.attributes["bad"] = np.zeros(80)
    with golden.raises():
        surface.attributes["bad"] = np.zeros((79, 1))
    assert "bad" not in surface.attributes
    values = np.zeros(79)
    surface.attributes["GR"] = values
    values[:] = 7
    assert surface.attributes["GR"].max() == 0
    with pytest.raises(ValueError, match="read-only"):
        surface.attributes["GR"][0] = 1
    del surface.attributes["GR"]
    assert len(surface.attributes) == 1
    mesh = surface.to_trimesh()
    assert mesh.face_attributes["whole"][:4].tolist() == [0, 0, 1, 1]


def test_attributes_of_a_volume(golden):
    radius = rugged(100)
    radius[40] = np.nan
    volume = volume_of(wall_of(radius))
    volume.attributes["RT"] = np.arange(2 * 83)
    assert volume.attributes["RT"].tolist() == (volume.hex_index + 83 * volume.hex_layer).tolist()
    with golden.raises():
        volume.attributes["RT"] = np.zeros(83)


# ------------------------------------------------------------------ refusals


def test_paths_that_do_not_cover_the_wall():
    path = hb.Survey([950, 1002], [10, 20], [30, 40]).path(extend=1)
    text = (
        "vertex 799 at depth 1004.99375: must not lie below the last station of the survey, at 1002 m, "
        "plus extend = 1 m"
    )
    with pytest.raises(ValueError, match=f"^{re.escape(text)}$"):
        surface_of(wall_of(rugged(800)), path)
    text = "vertex 0 at depth 900: must not lie above the first station of the survey, at 950 m"
    with pytest.raises(ValueError, match=f"^{re.escape(text)}$"):
        surface_of(wall_of(rugged(800), start_depth=900), path)
    radius = rugged(800)
    radius[400:] = np.nan  # nothing measured where the path does not reach
    assert len(surface_of(wall_of(radius), path).vertices) == 400


@pytest.mark.parametrize("threads", [1, 4])
def test_vertices_whose_reference_is_undefined(threads):
    kicked = hb.Survey([0, 1002, 1100], [0, 0, 30], [0, 0, 60])
    wall = wall_of(rugged(80_000), pitch=0.01)
    text = "vertex 0 at depth 1000: the high side is undefined where the hole is vertical; use the reference north"
    with pytest.raises(ValueError, match=f"^{re.escape(text)}$"):
        surface_of(wall, kicked.path(), threads=threads)
    assert len(surface_of(wall, kicked.path(reference="north"), threads=threads).vertices) == 80_000
    below = surface_of(wall, kicked.path(), start=1002.01, threads=threads)
    assert np.isfinite(below.vertices).all()
    first = depth_of(wall, np.arange(80_000)).searchsorted(1001.5)
    radius = wall.radius.copy()
    radius[:first] = np.nan
    with pytest.raises(ValueError, match=f"^vertex {first} at depth"):
        surface_of(wall_of(radius, pitch=0.01), kicked.path(), threads=threads)


@pytest.mark.parametrize(
    "wall",
    [
        wall_of([0.1] * 9, sectors=2),
        wall_of([0.1] * 9, pitch=0.0),
        wall_of([0.1] * 9, start_toolface=math.nan),
        wall_of([0.1, 0.1, -0.1]),
        wall_of([0.1, math.inf]),
        wall_of([0.1] * 100 + [0.0] + [0.1] * 100),
    ],
)
def test_bad_walls(wall, golden):
    with golden.raises():
        surface_of(wall)


def test_what_is_no_path_and_no_image_is_refused_where_it_is_given(golden):
    k = np.arange(400.0)
    wall = hb.reconstruct(hb.Caliper(2000 + k / 1000, k * 37, np.full(400, 0.11)), bit_diameter=0.216, sectors=16)
    survey = hb.Survey([0, 3000], [0, 1], [0, 1])
    for act in (wall.surface, wall.volume, lambda path: setattr(wall, "path", path)):
        with golden.raises():
            act(survey)
    with golden.raises():
        surface_of(wall, (1, 2))
    assert wall.path is None
    with golden.raises():
        wall.images["GR"] = np.zeros((4, 8))
    assert not wall.images
    wall.path = survey.path()
    assert np.isfinite(wall.surface().vertices).all()


def test_an_origin_that_json_cannot_hold_is_refused(golden):
    wall = hb.reconstruct(hb.Caliper.gauge(10, 11, 0.216), bit_diameter=0.216, sectors=16)
    wall.made_from = {"files": {"a.las"}}
    with golden.raises():
        wall.surface()
