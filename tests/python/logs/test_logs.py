"""Logs of a wall: exact ellipses and circles, a slow loop, circles by brute force, steps, ages, gaps, error texts."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import given, settings
from hypothesis import strategies as st

import helibore as hb
from helibore.logs.turn_logs import COLUMN_NAMES, Logs, turn_logs


def helix(radius: np.ndarray, sectors: int, pitch: float = 0.1, toolface: float = 30.0) -> Any:
    shape = SimpleNamespace(sectors=sectors, pitch=pitch, start_toolface=toolface)
    return SimpleNamespace(settings=shape, start_depth=1000.0, radius=radius)


def ellipse(a: float, b: float, sectors: int = 64, turns: int = 5, axis: float = 0.0) -> np.ndarray:
    angle = np.radians(np.arange(sectors * turns) * 360 / sectors + 30 - axis)
    return a * b / np.hypot(b * np.cos(angle), a * np.sin(angle))


@pytest.mark.parametrize(("a", "b"), [(0.108, 0.108), (0.13, 0.108), (0.2, 0.108)])
def test_the_equivalent_diameter_of_an_ellipse_is_exact(a: float, b: float) -> None:
    """Half axes a and b: the area is pi a b."""
    logs = turn_logs(helix(ellipse(a, b), 64), 0.216)
    np.testing.assert_allclose(logs.equivalent_diameter, 2 * math.sqrt(a * b), rtol=0, atol=1e-6)
    np.testing.assert_allclose(logs.volume, math.pi * a * b * 0.1, rtol=1e-5)
    np.testing.assert_allclose(logs.excess, a * b / 0.108**2 - 1, rtol=0, atol=2e-5)


def test_an_ellipse_has_its_axes_as_diameters_and_both_ovalities() -> None:
    logs = turn_logs(helix(ellipse(0.13, 0.11, axis=75.0), 64), 0.216)  # 75 deg is a vertex: 30 + 8 x 5.625
    for name, value in {
        "c1": 0.26, "c1_toolface": 75.0, "c2": 0.22, "least_diameter": 0.22, "out_of_roundness": 0.04,
        "ovality_api": 1 / 12, "ovality_dnv": 1 / 6, "enclosing_diameter": 0.26, "centre_0": 0.0, "centre_90": 0.0,
    }.items():  # fmt: skip
        np.testing.assert_allclose(getattr(logs, name), value, atol=1e-12, err_msg=name)
    assert abs(logs.inscribed_diameter - 0.22).max() < 1e-4  # vertices beside the short axis stand back a little


@pytest.mark.parametrize("sectors", [12, 16, 31, 64])
@pytest.mark.parametrize("toolface", [0.0, 17.3, -200.0])
def test_a_circle_off_the_axis_keeps_its_size_and_tells_its_centre(sectors: int, toolface: float) -> None:
    """r = e cos psi + sqrt(R^2 - e^2 sin^2 psi): all circles are that circle, wherever the axis is."""
    R, e, towards = 0.12, 0.01, 200.0
    psi = np.radians(np.arange(sectors * 3) * 360 / sectors + toolface - towards)
    radius = e * np.cos(psi) + np.sqrt(R**2 - (e * np.sin(psi)) ** 2)
    logs = turn_logs(helix(radius, sectors, toolface=toolface), 0.216)
    for name in ("equivalent_diameter", "inscribed_diameter", "enclosing_diameter"):
        np.testing.assert_allclose(getattr(logs, name), 2 * R, atol=1e-9, err_msg=name)
    centre = e * np.cos(np.radians(towards)), e * np.sin(np.radians(towards))
    for names in (("centre_0", "centre_90"), ("inscribed_0", "inscribed_90")):
        np.testing.assert_allclose([getattr(logs, name)[0] for name in names], centre, atol=1e-9)


@pytest.mark.parametrize("sectors", [12, 13, 14, 15])
def test_fixed_pairs_lie_between_the_vertices_that_enclose_them(sectors: int) -> None:
    toolface = np.arange(sectors) * 360 / sectors + 30.0
    radius = 0.1 + 0.01 * np.cos(np.radians(toolface)) + 0.004 * np.cos(np.radians(2 * toolface))
    at = np.interp([0, 90, 180, 270], np.r_[toolface - 360, toolface, toolface + 360], np.tile(radius, 3))
    logs = turn_logs(helix(radius, sectors), 0.2)
    assert logs.diameter_0[0] == pytest.approx(at[0] + at[2], abs=1e-14)
    assert logs.diameter_90[0] == pytest.approx(at[1] + at[3], abs=1e-14)


@pytest.mark.parametrize("pitch", [0.1, -0.1])
def test_every_turn_equals_a_slow_loop(pitch: float) -> None:
    random = np.random.default_rng(4)
    radius = random.uniform(0.1, 0.15, 7 * 12 + 5)
    radius[[14, 15, 40]] = np.nan
    radius[60:72] = np.nan
    logs = turn_logs(helix(radius, 12, pitch), 0.216)
    assert len(logs) == 7
    for turn in range(7):
        vertices = radius[turn * 12 : turn * 12 + 12].tolist()
        there = [r for r in vertices if not math.isnan(r)]
        whole = len(there) == 12
        square = sum(r * r for r in there) / 12 if whole else math.nan
        across = [vertices[k] + vertices[(k + 6) % 12] for k in range(12)]
        longest = max(range(12), key=lambda k: across[k]) if whole else 0
        most, least = (across[longest], min(across)) if whole else (math.nan, math.nan)
        expected = {
            "depth": sum(1000 + k * pitch / 12 for k in range(turn * 12, turn * 12 + 12)) / 12,
            "mean": sum(there) / 12 if whole else math.nan,
            "smallest": min(there, default=math.nan),
            "largest": max(there, default=math.nan),
            "equivalent_diameter": 2 * math.sqrt(square),
            "c1": most,
            "c1_toolface": (30 + longest * 30) % 180 if whole else math.nan,
            "c2": across[(longest + 3) % 12] if whole else math.nan,
            "least_diameter": least,
            "out_of_roundness": most - least,
            "ovality_api": (most - least) / (most + least),
            "ovality_dnv": 2 * (most - least) / (most + least),
            "volume": math.pi * square * 0.1,
            "excess": square / 0.108**2 - 1,
            "coverage": len(there) / 12,
        }
        for name, value in expected.items():
            assert getattr(logs, name)[turn] == pytest.approx(value, rel=1e-12, nan_ok=True), name
    for name in ("centre_0", "diameter_0", "inscribed_diameter", "enclosing_diameter"):
        assert np.isnan(getattr(logs, name)).tolist() == np.isnan(logs.mean).tolist(), name


def smallest_around(points: np.ndarray) -> float:
    """Radius of the smallest circle around points: every pair and triple tried."""
    best = math.inf
    n = len(points)
    for i in range(n):
        for j in range(i):
            centres = [(points[i] + points[j]) / 2]
            for k in range(j):
                a, b, c = points[i], points[j], points[k]
                M = 2 * np.array([b - a, c - a])
                if abs(np.linalg.det(M)) > 1e-12:
                    centres.append(np.linalg.solve(M, [b @ b - a @ a, c @ c - a @ a]))
            for centre in centres:
                reach = np.linalg.norm(points - centre, axis=1).max()
                best = min(best, reach)
    return best


def largest_within(points: np.ndarray, around: np.ndarray, reach: float) -> float:
    """Radius of the largest circle without a point inside, its centre within reach: a grid, refined about its best."""
    best, centre = 0.0, around
    for size in (reach, reach / 8, reach / 64, reach / 512, reach / 4096):
        steps = np.linspace(-size, size, 33)
        grid = centre + np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
        room = np.linalg.norm(grid[:, None] - points, axis=2).min(axis=1)
        if room.max() > best:
            best, centre = float(room.max()), grid[room.argmax()]
    return best


def no_small_move_makes_it_larger(points: np.ndarray, centre: np.ndarray) -> bool:
    """Whether every move of the centre of an inscribed circle brings it nearer to a point that it rests on."""
    away = points - centre
    distance = np.linalg.norm(away, axis=1)
    rests = away[distance < distance.min() + 1e-9]
    towards = np.sort(np.arctan2(rests[:, 1], rests[:, 0]))
    return bool(np.diff(towards, append=towards[0] + 2 * np.pi).max() <= np.pi + 1e-6)


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**31),
    sectors=st.sampled_from([8, 13, 24]),
    rough=st.sampled_from([0.0, 1e-4, 2e-3]),
    bump=st.floats(0, 0.03),
)
def test_circles_equal_brute_force(seed: int, sectors: int, rough: float, bump: float) -> None:
    """Oval, eccentric, rough, with a lobe on one side such as a key seat has."""
    random = np.random.default_rng(seed)
    angle = np.radians(np.arange(sectors) * 360 / sectors + 30)
    radius = 0.11 + random.uniform(0, 0.005) * np.cos(angle - random.uniform(0, 6)) + random.normal(0, rough, sectors)
    radius += random.uniform(0, 0.004) * np.cos(2 * (angle - random.uniform(0, 6)))
    radius += bump * np.exp(-(((angle - random.uniform(0, 6) + np.pi) % (2 * np.pi) - np.pi) ** 2) / 0.1)
    logs = turn_logs(helix(radius, sectors), 0.216)
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    assert logs.enclosing_diameter[0] / 2 == pytest.approx(smallest_around(points), abs=1e-9)
    centre = np.array([logs.inscribed_0[0], logs.inscribed_90[0]])
    assert np.linalg.norm(points - centre, axis=1).min() == pytest.approx(logs.inscribed_diameter[0] / 2, abs=1e-12)
    assert no_small_move_makes_it_larger(points, centre)
    # Rough points leave room at several places near the middle. The largest may be another one, but not by much.
    if bump < 0.005:
        assert logs.inscribed_diameter[0] / 2 >= largest_within(points, np.zeros(2), 0.015) - 1e-3


@pytest.mark.parametrize("shape", ["three lobes", "slot", "square", "star"])
def test_circles_of_odd_sections_keep_their_promise(shape: str) -> None:
    angle = np.radians(np.arange(48) * 7.5 + 30)
    radius = {
        "three lobes": 0.1 + 0.04 * np.cos(3 * angle),
        "slot": np.where(abs(angle - 3) < 0.3, 0.3, 0.1),
        "square": 0.1 / np.maximum(abs(np.cos(angle)), abs(np.sin(angle))),
        "star": np.where(np.arange(48) % 2, 0.05, 0.2),
    }[shape]
    logs = turn_logs(helix(radius, 48), 0.2)
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    assert logs.enclosing_diameter[0] / 2 == pytest.approx(smallest_around(points), abs=1e-9)
    centre = np.array([logs.inscribed_0[0], logs.inscribed_90[0]])
    assert np.linalg.norm(points - centre, axis=1).min() == pytest.approx(logs.inscribed_diameter[0] / 2, abs=1e-12)
    assert logs.inscribed_diameter[0] / 2 >= largest_within(points, centre, 1e-3) - 1e-6


@pytest.mark.parametrize("window", [0.3, 0.5, 1.1, 5.1])
def test_rugosity_equals_a_slow_line_through_every_sector(window: float) -> None:
    random = np.random.default_rng(7)
    turns, K = 700, 8
    radius = 0.1 + 0.0003 * np.arange(turns)[:, None] + random.normal(0, 0.001, (turns, K))
    radius[300, 3] = np.nan
    logs = turn_logs(helix(radius.ravel(), K), 0.2, rugosity_window=window)
    size = round(window / 0.1)
    half = size // 2
    assert logs.rugosity_window == pytest.approx(window)
    for turn in [0, half - 1, half, 255, 256, 257, 300 - half - 1, 300 - half, 300 + half, 301 + half, turns - half - 1,
                 turns - half]:  # fmt: skip
        rows = radius[max(turn - half, 0) : turn + half + 1]
        if len(rows) < size or np.isnan(rows).any():
            assert math.isnan(logs.rugosity[turn])
            continue
        x = np.arange(size)
        left = [rows[:, s] - np.polyval(np.polyfit(x, rows[:, s], 1), x) for s in range(K)]
        expected = math.sqrt(sum(float(of @ of) for of in left) / (K * (size - 2)))
        assert logs.rugosity[turn] == pytest.approx(expected, rel=1e-6)


def test_threads_change_no_bit() -> None:
    random = np.random.default_rng(3)
    radius = random.uniform(0.1, 0.13, 64 * 900)
    radius[random.integers(0, radius.size, 4)] = np.nan
    one, two, seven = (turn_logs(helix(radius, 64), 0.216, threads=threads) for threads in (1, 2, 7))
    for name in COLUMN_NAMES:
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes() == getattr(seven, name).tobytes(), name


def test_a_wall_of_gauge_hole_has_no_excess_and_an_empty_one_no_rows() -> None:
    wall = hb.reconstruct(hb.Caliper.gauge(0, 3, 0.216), bit_diameter=0.216)
    logs = wall.logs()
    assert abs(logs.excess).max() < 1e-12
    assert (logs.ovality_api == 0).all()
    assert logs.basis == "gauge"
    assert "not measured" in repr(logs)
    assert len(hb.Wall(bit_diameter=0.216).logs()) == 0


@pytest.mark.parametrize(
    "caliper", [hb.Caliper.from_average([0.0, 6.0], [0.1, 0.11]), hb.Caliper.gauge(0.0, 6.0, bit_diameter=0.216)]
)
def test_a_wall_that_is_round_by_assumption_has_no_coverage(caliper: hb.Caliper) -> None:
    wall = hb.reconstruct(caliper, bit_diameter=0.216, sectors=16)
    assert np.isnan(wall.logs().coverage).all()
    assert np.isnan(wall.summary().coverage)
    assert "measured" not in wall.summary().numbers()


def test_coverage_nearest_and_age_come_from_the_wall() -> None:
    depth = np.arange(0, 6, 0.001)
    first = np.arange(depth.size, dtype=float)
    caliper = hb.Caliper(depth, depth * 3700 % 360, np.full(depth.size, 0.11), first)
    wall = hb.reconstruct(caliper, bit_diameter=0.216, sectors=16)
    logs = wall.logs()
    assert (logs.coverage == 1).all()
    assert logs.nearest[0] == wall.nearest[:16].max()
    newest = [first[(depth >= d - 0.05) & (depth < d + 0.05)].max() for d in logs.depth]
    np.testing.assert_allclose(logs.age, first.max() - newest)
    wall.append([2.0], [0.0], [0.11], [7000.0])  # a new look at 2 m: there the wall is young
    after = wall.logs()
    assert after.age[np.argmin(abs(after.depth - 2.0))] == 0
    assert after.age[-1] == pytest.approx(7000 - first.max(), abs=10)
    upwards = hb.reconstruct(caliper, bit_diameter=0.216, sectors=16, pitch=-0.1).logs()
    assert upwards.depth[0] > upwards.depth[-1]
    newest = [first[(depth >= d - 0.05) & (depth < d + 0.05)].max() for d in upwards.depth]
    np.testing.assert_allclose(upwards.age, first.max() - newest)
    untimed = hb.reconstruct(hb.Caliper(depth, depth * 3700 % 360, np.full(depth.size, 0.11)), bit_diameter=0.216)
    assert np.isnan(untimed.logs().age).all()


@pytest.mark.parametrize("pitch", [0.1, -0.1, 0.07])
def test_steps_gather_the_turns_whose_middle_they_hold(pitch: float) -> None:
    random = np.random.default_rng(5)
    radius = random.uniform(0.1, 0.12, (100, 16))
    radius[33, 4] = np.nan
    logs = turn_logs(helix(radius.ravel(), 16, pitch), 0.216)
    steps = logs.by_step(0.5)
    assert steps.step == 0.5
    inside = [(logs.depth >= d - 0.25 - 1e-9) & (logs.depth < d + 0.25 - 1e-9) for d in steps.depth]
    assert min(of.sum() for of in inside) >= 5
    for row, of in enumerate(inside):
        square = ((logs.equivalent_diameter[of] / 2) ** 2).mean()
        for name, value in {
            "mean": logs.mean[of].mean(), "smallest": np.nanmin(logs.smallest[of]), "c2": logs.c2[of].mean(),
            "inscribed_diameter": logs.inscribed_diameter[of].min(), "coverage": logs.coverage[of].mean(),
            "volume": np.pi * square * 0.5, "excess": square / 0.108**2 - 1,
        }.items():  # fmt: skip
            assert getattr(steps, name)[row] == pytest.approx(value, nan_ok=True), name
    gapped = np.flatnonzero(np.isnan(steps.mean))
    assert len(gapped) == 1
    assert not math.isnan(steps.smallest[gapped[0]])
    assert np.isnan(steps.inscribed_diameter).sum() == 1


def test_steps_that_the_wall_does_not_reach_across_do_not_count() -> None:
    logs = turn_logs(helix(np.full(16 * 38, 0.1), 16), 0.2)  # 1000.0 to 1003.8 m
    assert logs.by_step(1.0).depth.tolist() == [1000.5, 1001.5, 1002.5]
    assert len(logs.by_step(10.0)) == 0
    assert logs.by_step(1.0).volume == pytest.approx(np.pi * 0.01)


def test_the_axis_of_a_step_is_the_mean_of_axes() -> None:
    logs = turn_logs(
        helix(np.r_[ellipse(0.12, 0.1, turns=5, axis=1.875), ellipse(0.12, 0.1, turns=5, axis=176.25)], 64), 0.2
    )
    axis = logs.by_step(1.0).c1_toolface[0]
    assert axis == pytest.approx(179.0625)


@pytest.mark.parametrize(
    ("call", "place"),
    [
        (lambda logs: logs.by_step(0.05), "step"),
        (lambda logs: logs.by_step(math.nan), "step"),
        (lambda logs: logs.by_step(1000.0).table(), "logs"),
        (
            lambda logs: logs.by_step(0.5).by_step(1),
            "step",
        ),
    ],
)
def test_steps_without_sense_are_refused(call: Any, place: str, golden: Golden) -> None:
    with golden.raises(place):
        call(turn_logs(helix(np.full(160, 0.1), 16), 0.2))


@pytest.mark.parametrize("size", [0.0, -0.2, math.nan, math.inf])
@pytest.mark.parametrize("name", ["bit_diameter", "rugosity_window"])
def test_sizes_must_be_sizes(name: str, size: float) -> None:
    with pytest.raises(ValueError, match=rf"^{name} = {size}: must be finite and above 0$"):
        turn_logs(helix(np.full(24, 0.1), 12), **{"bit_diameter": 0.2, name: size})


def test_every_column_has_a_name_in_files() -> None:
    from helibore.logs.log_columns import COLUMNS, INNER, WORN

    assert {of.name for of in COLUMNS} | {*INNER, *WORN} == {*COLUMN_NAMES, *WORN}
    assert isinstance(turn_logs(helix(np.full(24, 0.1), 12), 0.2), Logs)


@pytest.mark.parametrize("reference", ["high-side", "north", "parallel-transport"])
def test_logs_say_what_toolface_0_is(reference: Any) -> None:
    wall = hb.reconstruct(hb.Caliper.gauge(1000.0, 1005.0, 0.2), bit_diameter=0.2, sectors=8)
    assert wall.logs().facts()["toolface 0"].endswith("neither a path nor an image of the wall says what it is")
    if reference != "parallel-transport":
        wall.images["GR"] = hb.SectorImage(
            [1000.0, 1005.0], np.ones((2, 4)), "GR", "gAPI", origin="edge", reference=reference
        )
        assert wall.logs().facts()["toolface 0"] == {"north": "north", "high-side": "high side of the hole"}[reference]
        wall.images.clear()
    wall.path = hb.Survey([1000.0, 1005.0], [48.0, 48.0], [248.0, 248.0]).path(reference=reference)
    said = wall.logs().by_step(1.0).table().facts["toolface 0"]
    assert said.startswith(
        {"high-side": "high side", "north": "north", "parallel-transport": "north at the top"}[reference]
    )
    wall.made_from = {"toolface": "assumed"}  # as a run notes it
    assert wall.logs().facts()["toolface 0"] == f"{said}, assumed"


def test_a_path_adds_true_depth_inclination_and_azimuth(golden: Golden) -> None:
    k = np.arange(4000)
    wall = hb.reconstruct(hb.Caliper(1000 + k * 0.0025, k * 37.0 % 360, np.full(k.size, 0.1)), bit_diameter=0.2)
    wall.path = hb.Survey([0.0, 1002.0, 1008.0], [0.0, 0.0, 60.0], [0.0, 90.0, 90.0]).path()
    for logs in (wall.logs(), wall.logs().by_step(0.5), wall.logs().between(1003, 1009)):
        table, depth = logs.table(), logs.depth
        inside, vertical = depth <= 1008, depth <= 1002
        bend = np.clip((depth - 1002) / 6, 0, 1) * np.radians(60)
        down = np.where(vertical, depth, 1002 + 6 / np.radians(60) * np.sin(bend))
        np.testing.assert_allclose(table["TVD"].values, np.where(inside, down, np.nan), atol=1e-6)
        np.testing.assert_allclose(table["INCL"].values, np.where(inside, np.degrees(bend), np.nan), atol=1e-6)
        np.testing.assert_allclose(table["AZIM"].values, np.where(inside & ~vertical, 90.0, np.nan), atol=1e-6)
    assert wall.logs().warnings() == []
    survey = hb.Survey([900.0, 1100.0], [48.0, 48.0], [248.0, 248.0])
    wall.path = survey.path()
    table = wall.logs().table()
    assert np.isnan(table["TVD"].values).all()  # nothing says how deep the first station lies
    golden(wall.logs().warnings())
    np.testing.assert_allclose(table["AZIM"].values, 248.0)
    wall.path = survey.path(head=(0.0, 0.0, 850.0))
    assert not np.isnan(wall.logs().table()["TVD"].values).any()
    assert wall.logs().warnings() == []
    wall.path = None
    assert "TVD" not in {one.mnemonic for one in wall.logs().table()}
