"""Volumes: against the divergence theorem and the smooth hole, positive everywhere, layers, and what is refused."""

from __future__ import annotations

import math
import re
from collections import Counter
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import given, settings
from hypothesis import strategies as st

import helibore as hb
from helibore.mesh.volume import Volume, volume_of

FACES = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]  # outwards


def wall_of(radius: Any, sectors: int = 16, pitch: float = 0.1, start: float = 1000.0) -> Any:
    chosen = SimpleNamespace(sectors=sectors, pitch=pitch, start_toolface=0.0)
    return SimpleNamespace(settings=chosen, start_depth=start, radius=np.array(radius, dtype=float))


def curved(most: float = 70.0) -> hb.Path:
    return hb.Survey([950, 985, 1005, 1030], [3, 20, 48, most], [355, 2, 30, 80]).path()


def rough(count: int, seed: int = 3) -> np.ndarray:
    return 0.108 + 0.02 * np.random.default_rng(seed).random(count)


def flux(corners: np.ndarray) -> float:
    """A third of the integral of x . n over bilinear patches, (n, 4, 3), by Gauss-Legendre points: exact for them."""
    total = 0.0
    points = 0.5 + 0.5 / math.sqrt(3) * np.array([-1, 1])
    for u in points:
        for v in points:
            share = np.array([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v])
            along_u = np.array([-(1 - v), 1 - v, v, -v])
            along_v = np.array([-(1 - u), -u, u, 1 - u])
            x, du, dv = (np.einsum("c,ncd->nd", weight, corners) for weight in (share, along_u, along_v))
            total += float((x * np.cross(du, dv)).sum()) / 4
    return total / 3


def enclosed(volume: Volume) -> float:
    """The volume within the faces that belong to one hexahedron only: neighbours must share all others."""
    faces = np.concatenate([volume.hexes[:, list(face)] for face in FACES])
    keys = [tuple(sorted(face)) for face in faces.tolist()]
    times = Counter(keys)
    assert set(times.values()) <= {1, 2}
    outer = faces[[times[key] == 1 for key in keys]]
    middle = volume.vertices.mean(axis=0)  # the theorem holds from anywhere; from near it loses no digits
    return flux(volume.vertices[outer] - middle)


@pytest.mark.parametrize("pitch", [0.1, -0.1])
@pytest.mark.parametrize("path", [None, curved()], ids=["straight", "curved"])
def test_hexahedra_hold_what_the_faces_around_them_enclose(pitch: float, path: hb.Path | None) -> None:
    radius = rough(1500)
    radius[[300, 301, 900]] = np.nan
    second = np.random.default_rng(9).uniform(0.01, 0.2, 1500)
    volume = volume_of(wall_of(radius, pitch=pitch, start=1010.0), path, [0.005, second])
    each = volume.hex_volume()
    assert each.shape == (len(volume.hexes),)
    assert (each > 0).all()
    assert each.sum() == pytest.approx(enclosed(volume), rel=1e-9)


def test_volume_is_that_of_the_smooth_hole_to_the_polygon() -> None:
    """720 sectors: pi (outer^2 - inner^2) pitch for every turn of quads, but for the circle's sagitta."""
    sectors, turns = 720, 20
    volume = volume_of(wall_of(np.full(sectors * turns + sectors + 1, 0.108), sectors), shells=[0.05, 0.20])
    each = volume.hex_volume()
    for layer, (inner, outer) in enumerate([(0.108, 0.158), (0.158, 0.308)]):
        smooth = math.pi * (outer**2 - inner**2) * 0.1 * turns
        assert each[volume.hex_layer == layer].sum() == pytest.approx(smooth, rel=2e-5)


def test_volume_of_a_bent_hole_is_that_of_the_straight_one() -> None:
    """Pappus: a section whose centroid runs on the path sweeps area times length, bend or not."""
    count = 720 * 21 + 1
    straight = volume_of(wall_of(np.full(count, 0.108), 720)).hex_volume().sum()
    path = hb.Survey([990, 1020], [0, 60], [40, 40]).path(reference="parallel-transport")
    assert volume_of(wall_of(np.full(count, 0.108), 720), path).hex_volume().sum() == pytest.approx(straight, rel=1e-5)


@settings(deadline=None, max_examples=40)
@given(
    st.integers(3, 40),
    st.sampled_from([0.002, 0.1, 3.0, -0.5]),
    st.lists(st.floats(1e-6, 0.5), min_size=1, max_size=4),
    st.integers(0, 1000),
)
def test_any_rough_wall_gives_positive_volume(sectors: int, pitch: float, steps: list[float], seed: int) -> None:
    radius = np.random.default_rng(seed).uniform(0.05, 0.5, 4 * sectors + 7)
    volume = volume_of(wall_of(radius, sectors, pitch), None, np.cumsum(steps).tolist())
    assert (volume.hex_volume() > 0).all()
    assert len(volume.hexes) == len(steps) * (3 * sectors + 6)


@pytest.mark.parametrize("threads", [1, 3])
def test_volumes_do_not_depend_on_threads(threads: int) -> None:
    volume = volume_of(wall_of(rough(40_000), pitch=0.01), curved())
    assert volume.hex_volume(threads).tobytes() == volume.hex_volume(1).tobytes()


def test_a_shell_that_the_path_folds_is_refused_with_its_place(golden: Golden) -> None:
    """90 degrees within 1.5 m: a bend of 0.95 m radius, which a shell of 2 m reaches across."""
    path = hb.Survey([999, 1001, 1002.5, 1010], [5, 5, 85, 85], [40, 40, 40, 40]).path()
    wall = wall_of(np.full(1200, 0.108), 16, 0.1)
    assert (volume_of(wall, path, [0.5]).hex_volume() > 0).all()
    with golden.raises():
        volume_of(wall, path, [0.5, 2.0])
    at = re.search(
        r"vertex (\d+), depth ([\d.]+)", str(_refused(lambda: volume_of(wall, path, [0.5, 2.0], start=1000.5)))
    )
    assert at is not None
    assert float(at[2]) == pytest.approx(1000 + int(at[1]) * 0.1 / 16)
    assert 1000.9 < float(at[2]) < 1002.6


def _refused(make: Any) -> ValueError:
    with pytest.raises(ValueError) as raised:  # noqa: PT011
        make()
    return raised.value


def test_crossing_shells_are_refused_with_vertex_and_depth_of_the_whole_wall(golden: Golden) -> None:
    radius = np.full(400, 0.125)
    second = np.full(400, 0.25)
    second[300] = 0.0625
    text = str(_refused(lambda: volume_of(wall_of(radius), None, [0.0625, wall_of(second)], start=1001.0)))
    golden(text)


# ------------------------------------------------------------------ an attribute a shell


def test_each_layer_has_values_of_its_own(golden: Golden) -> None:
    wall = hb.reconstruct(hb.Caliper.gauge(1000, 1003, 0.216), bit_diameter=0.216, sectors=16)
    room = len(wall) - 17
    shallow = np.arange(room, dtype=float)
    volume = wall.volume(shells=[0.1, 0.3, 0.7], start=1000.5, stop=1001.5)
    volume.hang("RT", [shallow, 20.0, -shallow], unit="ohm.m")
    values = volume.attributes["RT"]
    for layer, expected in enumerate([shallow, np.full(room, 20.0), -shallow]):
        own = volume.hex_layer == layer
        assert (values[own] == expected[volume.hex_index[own]]).all()
    volume.hang("of NumPy", [np.int64(3), np.float32(0.5), np.array(7.0)])
    assert (volume.attributes["of NumPy"] == np.array([3.0, 0.5, 7.0])[volume.hex_layer]).all()
    assert volume.attributes.units["RT"] == "ohm.m"
    assert volume.layers == 3
    assert np.array_equal(volume.radius[volume.vertex_shell == 2], np.full(sum(volume.vertex_shell == 2), 0.108 + 0.3))
    with golden.raises():
        volume.hang("RT", [1.0, 2.0])
    with golden.raises():
        volume.hang("RT", [1.0, [1, 2, 3], 2.0])
