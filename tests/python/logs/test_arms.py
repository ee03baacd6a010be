"""Tools with few arms: diameters, shape and zones are the arms' own, and every output says so."""

from __future__ import annotations

import csv
import gzip
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import given
from hypothesis import strategies as st
from locations import SHARED

import helibore as hb
from helibore import _core
from helibore.files.facts import read_facts
from helibore.logs.turn_logs import NO_UNCERTAINTY
from helibore.plot.diameters import diameters
from helibore.simulation.hole import Breakout, Hole, Washout

BIT = 0.216
F12 = SHARED / "calipers/volve_F-12_2010_pfcs_xy_caliper.csv.gz"


def four_arms(
    radius: Any, turn: float = 30.0, step: float = 0.05, length: float = 60.0, top: float = 0.0
) -> hb.Caliper:
    """Samples of four arms that turn once in ``turn`` metres; ``radius`` of depth and toolface."""
    depth = np.repeat(np.arange(top, top + length, step), 4)
    arm = np.tile([0, 1, 2, 3], depth.size // 4)
    toolface = (depth * 360 / turn + arm * 90) % 360
    return hb.Caliper(depth, toolface, radius(depth, toolface), arm=arm)


def ellipse(_depth: np.ndarray, toolface: np.ndarray) -> np.ndarray:
    """216 x 240 mm, the long axis at 30 degrees."""
    angle = np.radians(toolface - 30)
    return 0.120 * 0.108 / np.hypot(0.108 * np.cos(angle), 0.120 * np.sin(angle))


def test_four_arms_in_an_ellipse() -> None:
    wall = hb.reconstruct(four_arms(ellipse), bit_diameter=BIT)
    logs = wall.logs()
    assert logs.shape == "arms"
    true = [2 * ellipse(logs.depth, 12 * logs.depth + 90 * arm) for arm in (0, 1)]
    for arm in (0, 1):
        np.testing.assert_allclose(logs.arm_diameter[arm], true[arm], atol=1e-4, rtol=0)
    np.testing.assert_allclose(logs.c1, np.maximum(*true), atol=1e-4, rtol=0)
    np.testing.assert_allclose(logs.c1 - logs.c2, np.abs(true[0] - true[1]), atol=2e-4, rtol=0)
    np.testing.assert_allclose(logs.ovality_api, np.abs(true[0] - true[1]) / (true[0] + true[1]), atol=1e-3, rtol=0)
    np.testing.assert_array_equal(logs.least_diameter, np.minimum(*logs.arm_diameter))
    larger = np.where(true[0] > true[1], 0, 90)
    apart = (logs.c1_toolface - 12 * logs.depth - larger + 90) % 180 - 90
    assert np.abs(apart[np.abs(true[0] - true[1]) > 1e-3]).max() < 0.5
    assert logs.coverage.mean() == pytest.approx(12 / 90, abs=0.01)


def test_no_circle_passes_where_an_arm_was_narrower() -> None:
    wall = hb.reconstruct(four_arms(ellipse, turn=1e9), bit_diameter=0.216, max_distance=2.0)
    logs = wall.logs()
    assert logs.shape == "arms"
    assert (logs.inscribed_diameter <= logs.least_diameter).all()
    assert (logs.enclosing_diameter >= logs.c1).all()
    found = wall.summary()
    assert found.inscribed_diameter.value <= found.least_diameter.value
    drawn = diameters(wall, logs)
    np.testing.assert_array_equal(drawn.least, logs.least_diameter)
    np.testing.assert_array_equal(drawn.greatest, logs.c1)


def test_a_table_and_its_files_say_what_comes_from_the_arms(tmp_path: Path, golden: Golden) -> None:
    logs = hb.reconstruct(four_arms(ellipse, length=10.0), bit_diameter=BIT).logs()
    table = logs.table()
    assert "come from the tool's arms" in table.facts["shape"]
    np.testing.assert_array_equal(table["ARM_DIAMETER_2"].values, logs.arm_diameter[1])
    golden(table["ARM_DIAMETER_2"].description)
    golden(table.facts["arms"])
    logs.by_step(0.5).save(tmp_path / "a.csv")
    text = (tmp_path / "a.csv").read_text()
    assert "ARM_DIAMETER_1" in text
    facts = read_facts(tmp_path / "a.csv")[0]
    assert "come from the tool's arms" in facts["shape"]
    assert facts["uncertainty"] == NO_UNCERTAINTY
    few, metres = logs.between(2, 4), logs.by_step(1.0)
    assert few.arm_diameter[0].size == len(few)
    inside = (logs.depth >= 2) & (logs.depth < 3)
    assert metres.arm_diameter[0][2] == pytest.approx(logs.arm_diameter[0][inside].mean(), abs=1e-12)


def test_an_imaging_tool_has_the_walls_shape_whether_its_arms_are_known_or_not(golden: Golden) -> None:
    caliper = four_arms(ellipse, turn=0.005 / 20.3, step=0.005, length=10.0)
    logs = hb.reconstruct(caliper, bit_diameter=BIT).logs()
    assert (logs.shape, logs.arm_diameter) == ("wall", ())
    assert "ARM_DIAMETER_1" not in [column.mnemonic for column in logs.table()]
    golden(logs.table().facts["shape"])
    assert np.isnan(logs.shape_kept)
    assert logs.warnings() == []
    assert not {"arms", "uncertainty"} & set(logs.facts())


@pytest.mark.parametrize("kept", [0.69, 0.71])
def test_a_wall_with_less_than_seven_tenths_of_the_arms_shape_is_warned_of(kept: float) -> None:
    logs = hb.reconstruct(four_arms(ellipse, length=10.0), bit_diameter=BIT).logs()
    rounder = replace(logs, wall_out_of_roundness=kept * logs.out_of_roundness)
    few = (
        f"a tool with few arms measured {100 * logs.coverage.mean():.0f} % of the turns; the wall between its arms is "
        "interpolated, and C1, C2, ovality and zones are the arms'"
    )
    warning = (
        f"the wall has {kept:.2f} of the out-of-roundness that the arms measured: its sections are rounder than the "
        "hole"
    )
    assert rounder.warnings() == [few, NO_UNCERTAINTY, *([warning] if kept < 0.7 else [])]


def test_a_wall_that_is_rounder_than_the_arms_is_reported() -> None:
    """Both arms of a tool that hardly turns miss the short axis in most of the section: the wall mixes them."""
    wall = hb.reconstruct(four_arms(ellipse, turn=1e9, step=0.15), bit_diameter=BIT, max_distance=2.0)
    summary = wall.summary()
    assert (summary.shape, summary.arms) == ("arms", 2)
    true = abs(2 * ellipse(np.zeros(1), np.zeros(1))[0] - 2 * ellipse(np.zeros(1), np.full(1, 90.0))[0])
    logs = wall.logs()
    np.testing.assert_allclose(logs.out_of_roundness, true, atol=1e-7)
    kept = logs.wall_out_of_roundness.mean() / true
    assert summary.shape_kept == pytest.approx(kept, rel=1e-5)
    assert summary.coverage < 0.1
    assert summary.warnings[0].startswith("a tool with few arms measured ")
    assert (len(summary.warnings) == 3) == (kept < 0.7)


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("kind", ["breakout", "washout"])
def test_an_x_y_log_knows_a_breakout_from_a_washout(kind: str, seed: int) -> None:
    """A lobe of 20 mm on both sides, seen by two diameters half a foot apart; the tool stands in it, as it does."""
    random = np.random.default_rng(seed)
    axis = random.uniform(0, 180)
    shape = {
        "breakout": Hole(start=1000, stop=1030, breakouts=(Breakout(1010, 1020, axis, 60.0, 0.020),), seed=seed),
        "washout": Hole(start=1000, stop=1030, washouts=(Washout(1010, 1020, 0.020),), seed=seed),
    }[kind]
    depth = np.repeat(np.arange(1000, 1030, 0.1524), 4)
    bearing = axis + random.uniform(-8, 8) + 2 * np.sin(depth)  # arms lock into lobes
    toolface = (bearing + np.tile([0, 90, 180, 270], depth.size // 4)) % 360
    radius = shape.radius(depth, toolface) + random.normal(0, 0.0003, depth.size // 4).repeat(4)
    arm = np.tile([0, 1, 0, 1], depth.size // 4)
    wall = hb.reconstruct(hb.Caliper(depth, toolface, radius, arm=arm), bit_diameter=BIT)
    found = wall.zones()
    assert found.logs.shape == "arms"
    assert [zone.kind for zone in found.zones] == [kind]
    assert found.zones[0].start == pytest.approx(1010, abs=2.5)  # it tapers
    assert found.zones[0].stop == pytest.approx(1020, abs=2.5)
    if kind == "breakout":
        assert abs((found.zones[0].toolface - axis + 90) % 180 - 90) < 10
        assert np.isnan(found.zones[0].lobes[0].opening)


@pytest.mark.parametrize("turn", [1e9, 1000.0])
def test_arms_that_do_not_turn_know_no_spread_and_no_opening(turn: float) -> None:
    """In an oval hole; 0 would say that the axis is exactly known, while it is that of the arms."""
    shape = lambda depth, tf: 0.108 + 0.02 * np.cos(np.radians(tf)) ** 2 * (abs(depth % 10 - 5) < 1)  # noqa: E731
    found = hb.reconstruct(four_arms(shape, length=20.0, turn=turn), bit_diameter=BIT).zones()
    broken, axis = found.of("breakout"), found.breakout_axis()
    assert len(broken) > 1
    assert [math.isnan(zone.deviation) for zone in broken] == [turn == 1e9] * len(broken)
    assert math.isnan(axis.deviation) == (turn == 1e9)
    assert np.isnan(found.table()["OPEN1"].values).all()
    assert np.isnan(found.table()["AXISDEV"].values).all() == (turn == 1e9)
    assert turn != 1e9 or axis.spread("zone", " deg", 1) == f"{len(broken)} zones"


def test_one_arm_that_reaches_out_is_a_key_seat_on_its_side() -> None:
    caliper = four_arms(lambda _depth, tf: np.where(np.abs(tf - 90) < 20, 0.140, 0.108), turn=1e9)
    (zone,) = hb.reconstruct(caliper, bit_diameter=BIT).zones().zones
    assert (zone.kind, zone.toolface) == ("key seat", 90.0)


@pytest.mark.parametrize("larger", [0, 90, 180, 270])
def test_the_larger_lobe_of_a_breakout_lies_on_its_own_side(larger: int) -> None:
    def shape(_depth: np.ndarray, toolface: np.ndarray) -> np.ndarray:
        off = np.abs((toolface - larger + 180) % 360 - 180)
        return np.select([off < 20, off > 160], [0.138, 0.123], 0.108)

    (zone,) = hb.reconstruct(four_arms(shape, turn=1e9), bit_diameter=BIT).zones().zones
    heights = {round(lobe.toolface): lobe.height for lobe in zone.lobes}
    assert heights == {larger: pytest.approx(0.030), (larger + 180) % 360: pytest.approx(0.015)}


def test_a_key_seat_lies_on_its_side_also_if_most_axes_are_on_the_other_side_of_zero() -> None:
    """The tool stands at 359.5 degrees over six tenths of each metre, and at 2.5 over the rest."""
    depth = np.repeat(np.arange(0, 60, 0.05), 4)
    arm = np.tile([0, 1, 2, 3], depth.size // 4)
    toolface = (np.where(depth % 1 < 0.6, -0.5, 2.5) + 90 * arm) % 360
    radius = np.where(np.abs((toolface + 180) % 360 - 180) < 20, 0.140, 0.108)
    (zone,) = hb.reconstruct(hb.Caliper(depth, toolface, radius, arm=arm), bit_diameter=BIT).zones().zones
    assert (zone.kind, zone.toolface) == ("key seat", pytest.approx(0.7, abs=0.2))


def oval(_depth: np.ndarray, toolface: np.ndarray) -> np.ndarray:
    return 0.111 + 0.004 * np.cos(np.radians(2 * (toolface - 60)))


def slotted(_depth: np.ndarray, toolface: np.ndarray) -> np.ndarray:
    away = np.abs((toolface - 60 + 180) % 360 - 180)
    return 0.108 + 0.02 * np.maximum(1 - (away / 45) ** 2, 0)


def worn(depth: np.ndarray, toolface: np.ndarray) -> np.ndarray:
    return 0.108 + 3 * (slotted(depth, toolface) - 0.108)


@pytest.mark.parametrize("shape", [oval, slotted, worn])
@pytest.mark.parametrize("biases", [None, (3e-4, 0.0, -4e-4, 1e-4)], ids=["as they are", "less biases"])
def test_diameters_do_not_show_on_which_side_a_hole_is_wide_and_radii_do(shape: Any, biases: Any) -> None:
    rng = np.random.default_rng(5)
    depth = np.repeat(np.arange(0, 60, 0.15), 4)
    arm = np.tile([0, 1, 2, 3], depth.size // 4)
    toolface = (np.cumsum(rng.normal(0.8, 0.3, depth.size // 4)).repeat(4) + 90 * arm) % 360
    radius = shape(depth, toolface) + rng.normal(0, 5e-4, depth.size)
    rows = radius.reshape(-1, 4)
    half = (rows + np.roll(rows, 2, axis=1)).ravel() / 2
    of_radii, of_diameters = (
        hb.reconstruct(hb.Caliper(depth, toolface, of, arm=arm), bit_diameter=BIT, arm_biases=biases).zones()
        for of in (radius, half)
    )
    assert {zone.kind for zone in of_diameters.zones} == ({"breakout"} if shape is worn else set())
    assert all(0.5 <= zone.confidence < 0.8 for zone in of_diameters.zones)  # it may be a key seat
    assert {zone.kind for zone in of_radii.zones} == (set() if shape is oval else {"key seat"})


def test_an_arm_without_readings_has_no_diameter_there() -> None:
    caliper = four_arms(ellipse, length=20.0)
    keep = (caliper.depth < 5) | (caliper.depth > 15) | np.isin(caliper.arm, (0, 2))
    some = hb.Caliper(caliper.depth[keep], caliper.toolface[keep], caliper.radius[keep], arm=caliper.arm[keep])
    logs = hb.reconstruct(some, bit_diameter=BIT).logs()
    middle = (logs.depth > 6.1) & (logs.depth < 13.9)
    assert np.isfinite(logs.arm_diameter[0]).all()
    assert np.isnan(logs.arm_diameter[1][middle]).all()
    assert np.isnan(logs.c1[middle]).all()
    assert np.isfinite(logs.c1[~middle & ((logs.depth < 5.9) | (logs.depth > 14.1))]).all()


def test_arms_without_opposite_arms_leave_the_shape_to_the_wall() -> None:
    depth = np.repeat(np.arange(0, 10, 0.05), 3)
    arm = np.tile([0, 1, 2], depth.size // 3)
    caliper = hb.Caliper(depth, 12 * depth + 120 * arm, np.full(depth.size, 0.11), arm=arm)
    assert hb.reconstruct(caliper, bit_diameter=BIT).logs().shape == "wall"


def test_logs_without_a_row_warn_of_no_shape() -> None:
    logs = hb.reconstruct(four_arms(ellipse), bit_diameter=BIT).logs()
    assert logs.warnings() != []
    assert logs.between(100, 200).warnings() == []


def test_a_wall_of_arms_without_a_full_turn_has_no_logs_and_no_warning_of_numpy() -> None:
    logs = hb.reconstruct(four_arms(ellipse, step=0.01, length=0.02), bit_diameter=BIT).logs()
    assert (len(logs), logs.shape, logs.warnings()) == (0, "wall", [])


def test_where_an_arm_is_missing_no_size_of_the_turn_is_stated() -> None:
    caliper = four_arms(ellipse, length=30.0)
    kept = ~((caliper.depth > 10) & (caliper.depth < 20) & (caliper.arm % 2 == 1))
    columns = (caliper.depth[kept], caliper.toolface[kept], caliper.radius[kept])
    logs = hb.reconstruct(hb.Caliper(*columns, arm=caliper.arm[kept]), bit_diameter=BIT).logs()
    missing = np.isnan(logs.c1)
    assert 0 < missing.sum() < len(logs)
    for name in ("c1_toolface", "c2", "least_diameter", "uneven", "out_of_roundness"):
        assert (np.isnan(getattr(logs, name)) == missing).all(), name


def test_arms_survive_the_archive_and_further_appends(tmp_path: Path) -> None:
    first, more = four_arms(ellipse, length=10.0), four_arms(ellipse, length=5.0, top=10.0)
    wall = hb.reconstruct(first, bit_diameter=BIT)
    wall.append(more.depth, more.toolface, more.radius, arm=more.arm)
    wall.save(tmp_path / "a.wall")
    again = hb.load(tmp_path / "a.wall")
    for name in ("c1", "c2", "uneven"):
        np.testing.assert_array_equal(getattr(again.logs(), name), getattr(wall.logs(), name))
    assert again.logs().shape == "arms"
    whole = hb.reconstruct(four_arms(ellipse, length=15.0), bit_diameter=BIT)
    np.testing.assert_allclose(wall.logs().c1, whole.logs().c1, atol=1e-12)


def test_bad_arm_numbers_are_refused(golden: Golden) -> None:
    with golden.raises():
        hb.Caliper([1, 2], [0, 90], [0.1, 0.1], arm=[0])
    with golden.raises():
        hb.Caliper([1, 2], [0, 90], [0.1, 0.1], arm=[0, 0.5])


@pytest.mark.skipif(not F12.exists(), reason="needs the shared data")
def test_an_x_y_log_of_volve_keeps_the_ovality_of_its_arms() -> None:
    """Pass 26 of F-12: the wall alone has a quarter of it."""
    with gzip.open(F12, "rt") as file:
        rows = [row for row in csv.DictReader(file) if row["pass"] == "26" and 3080 <= float(row["md_m"]) <= 3240]
    names = ("md_m", "rb_deg", "pfc1_x_in", "pfc2_y_in")
    depth, bearing, x, y = (np.array([float(row[name]) for row in rows]) for name in names)
    x, y = x * 0.0254, y * 0.0254
    toolface = np.concatenate([bearing, bearing + 180, bearing + 90, bearing + 270])
    caliper = hb.Caliper(
        np.tile(depth, 4), toolface, np.concatenate([x, x, y, y]) / 2, arm=np.repeat([0, 0, 1, 1], depth.size)
    )
    summary = hb.reconstruct(caliper, bit_diameter=6.2 * 0.0254).summary()
    logs = hb.reconstruct(caliper, bit_diameter=6.2 * 0.0254).logs()
    assert logs.out_of_roundness.mean() == pytest.approx(np.abs(x - y).mean(), rel=0.01)
    assert summary.mean_diameter == pytest.approx((x.mean() + y.mean()) / 2, rel=1e-3)
    assert [of.mean() for of in logs.arm_diameter] == pytest.approx([x.mean(), y.mean()], rel=1e-4)
    assert summary.shape_kept < 0.7
    assert len(summary.warnings) == 3


def test_a_round_hole_keeps_its_shape_without_a_warning_of_division() -> None:
    logs = hb.reconstruct(four_arms(lambda depth, _: np.full(depth.size, 0.108)), bit_diameter=BIT).logs()
    assert logs.shape == "arms"
    assert np.isnan(logs.shape_kept)
    assert len(logs.warnings()) == 2


@pytest.mark.parametrize("alone", [0, 100])
def test_two_diameters_over_one_direction_show_no_side(alone: int) -> None:
    """Over 8 of 30 m the second caliper reads 20 mm less; in the last ``alone`` rows there is no first caliper."""
    rng = np.random.default_rng(3)
    depth = np.arange(1000, 1030, 0.15)
    rows = np.arange(depth.size)
    first = 0.108 + rng.normal(0, 2e-4, depth.size) + 0.01 * ((depth > 1008) & (depth < 1016))
    second, across = 0.108 + rng.normal(0, 2e-4, (2, depth.size))
    few = rows[: depth.size - alone]
    parts = [(0, 0, first, few), (0, 180, first, few), (1, 0, second, rows), (1, 180, second, rows)]
    parts += [(2, 90, across, rows), (2, 270, across, rows)]
    columns = [(depth[at], np.full(at.size, angle), radius[at], np.full(at.size, n)) for n, angle, radius, at in parts]
    at, toolface, radius, arm = (np.concatenate(column) for column in zip(*columns, strict=True))
    wall = hb.reconstruct(hb.Caliper(at, toolface, radius, arm=arm), bit_diameter=BIT, max_distance=1.0)
    logs = wall.logs()
    assert logs.shape == "arms"
    assert len(logs.arm_diameter) == 2
    np.testing.assert_allclose(logs.uneven, 0.0, atol=1e-12)
    assert "key seat" not in [zone.kind for zone in wall.zones().zones]


def slow_diameters(arms: hb.Caliper, depth: np.ndarray, height: float) -> dict[int, np.ndarray]:
    """The mean diameter of each arm in each turn, by trapezoids between all readings, ends and edges of the turn."""
    assert arms.arm is not None
    ends: dict[tuple[float, float, float], dict[float, list[tuple[int, float]]]] = {}
    time = np.zeros(len(arms)) if arms.time is None else arms.time
    for at, when, toolface, radius, arm in zip(arms.depth, time, arms.toolface, arms.radius, arms.arm, strict=True):
        direction = round(toolface % 360, 3) % 360
        ends.setdefault((at, when, round(direction % 180, 3)), {}).setdefault(direction, []).append((int(arm), radius))
    readings: dict[int, dict[float, list[float]]] = {}
    for (at, _, _), sides in ends.items():
        if len(sides) == 2:
            name = min(arm for side in sides.values() for arm, _ in side)
            size = sum(float(np.mean([radius for _, radius in side])) for side in sides.values())
            readings.setdefault(name, {}).setdefault(at, []).append(size)
    found = {}
    for name, sizes in readings.items():
        known = np.array(sorted(sizes))
        values = np.array([np.mean(sizes[at]) for at in known])
        found[name] = np.full(depth.size, np.nan)
        for turn, middle in enumerate(depth):
            low, high = np.clip([middle - height / 2, middle + height / 2], known[0], known[-1])
            inside = np.concatenate([[low], known[(known > low) & (known < high)], [high]])
            there = np.interp(inside, known, values)
            wide = high - low > 1e-3 * height
            mean = np.trapezoid(there, inside) / (high - low) if wide else np.interp(middle, known, values)
            found[name][turn] = mean
    return found


@given(
    st.integers(2, 6),
    st.integers(1, 25),
    st.floats(0.03, 0.4),
    st.sampled_from([0, 1237, 7919, 39_001]),
    st.integers(0, 2**32 - 1),
)
def test_diameters_are_the_means_of_opposite_samples(axes: int, rows: int, step: float, turn: int, seed: int) -> None:
    """In any order, with samples that are missing, repeated, or of a second pass."""
    draw = np.random.default_rng(seed)
    row, end = np.divmod(np.arange(2 * axes * rows), 2 * axes)
    passes = draw.integers(0, 2, rows)[row]
    toolface = ((turn * row + 180_000 * (end % 2) + 180_000 // axes * (end // 2)) % 360_000) / 1000
    radius = draw.uniform(0.1, 0.13, row.size)
    kept = draw.permutation(row.size)[: draw.integers(1, row.size + 1)]
    kept = np.concatenate([kept, draw.choice(kept, kept.size // 4)])
    columns = 1000 + step * row, toolface, radius, passes.astype(float)
    arms = hb.Caliper(*(column[kept] for column in columns), arm=(end // 2)[kept])
    depth = np.arange(999.5, 1000.5 + step * rows, 0.1)
    samples = (arms.depth, arms.toolface, arms.radius, np.asarray(arms.arm), np.asarray(arms.time))
    found = _core.arm_diameters(samples, depth, 0.1, np.inf)
    wanted = slow_diameters(arms, depth, 0.1)
    if len(wanted) < 2:
        assert found is None
        return
    diameters = np.array([wanted[name] for name in sorted(wanted)])
    np.testing.assert_allclose(found["diameter"].reshape(diameters.shape), diameters, rtol=0, atol=1e-9)
    np.testing.assert_allclose(found["c1"], diameters.max(axis=0), rtol=0, atol=1e-9)
    np.testing.assert_allclose(found["least_diameter"], diameters.min(axis=0), rtol=0, atol=1e-9)


def test_columns_of_arms_must_have_one_length() -> None:
    one = np.ones(1)
    with pytest.raises(hb.InputError, match="toolface has 2 values"):
        _core.arm_diameters((one, np.ones(2), one, np.ones(1, np.int64), np.empty(0)), one, 0.1, np.inf)
