"""Classification: kinds by hand, six breakouts of a simulated hole, none in gauge hole, criteria, axial statistics."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import given, settings
from hypothesis import strategies as st

import helibore as hb
from helibore.base.axial import axial_mean
from helibore.cli.lines import zone_lines
from helibore.files.facts import read_facts
from helibore.files.log_writing import save_table
from helibore.logs.summary import summarize
from helibore.logs.turn_logs import turn_logs
from helibore.logs.zone_criteria import Criteria
from helibore.logs.zones import KINDS, SIZES, Classification, classify
from helibore.simulation.hole import Breakout, Hole
from helibore.simulation.tool import Tool, simulate

K, BIT = 72, 0.216
TOOLFACE = np.arange(K) * 5.0


def lobe(toolface: float, height: float, width: float = 60.0) -> np.ndarray:
    off = (TOOLFACE - toolface + 180) % 360 - 180
    return height * np.maximum(1 - (2 * off / width) ** 2, 0)


def wall_of(*stretches: tuple[int, np.ndarray], pitch: float = 0.1, toolface: float = 0.0) -> Any:
    rows = np.concatenate([np.tile(shape, (turns, 1)) for turns, shape in stretches])
    shape = SimpleNamespace(sectors=K, pitch=pitch, start_toolface=toolface, bit_diameter=BIT)
    return SimpleNamespace(settings=shape, start_depth=1000.0, radius=rows.ravel())


GAUGE = np.full(K, BIT / 2)
WASHED = GAUGE + 0.02
BROKEN = GAUGE + lobe(100, 0.02) + lobe(280, 0.02)
SEATED = GAUGE + lobe(180, 0.02, 40)
TIGHT = GAUGE - 0.004


def test_every_kind_is_told_and_placed() -> None:
    missing = np.full(K, np.nan)
    wall = wall_of((10, GAUGE), (5, WASHED), (10, GAUGE), (20, BROKEN), (10, GAUGE), (6, SEATED), (10, GAUGE),
                   (7, TIGHT), (4, missing), (10, GAUGE))  # fmt: skip
    found = classify(wall)
    assert [(zone.kind, round(zone.start - 1000, 1), round(zone.stop - 1000, 1)) for zone in found.zones] == [
        ("washout", 1.0, 1.5), ("breakout", 2.5, 4.5), ("key seat", 5.5, 6.1), ("undergauge", 7.1, 7.8),
    ]  # fmt: skip
    washout, breakout, seat, tight = found.zones
    assert washout.enlargement == pytest.approx(0.04)
    assert breakout.toolface == pytest.approx(100, abs=0.01)
    assert [side.toolface for side in breakout.lobes] == pytest.approx([100, 280], abs=0.1)
    assert [side.height for side in breakout.lobes] == pytest.approx([0.02, 0.02], abs=1e-4)
    # A parabola falls to a quarter of its height at sqrt(3/4) of its half width.
    assert [side.opening for side in breakout.lobes] == pytest.approx([60 * math.sqrt(0.75)] * 2, abs=1)
    assert breakout.deviation == pytest.approx(0, abs=1e-5)
    assert seat.toolface == pytest.approx(180, abs=0.01)
    assert len(seat.lobes) == 1
    assert tight.enlargement == pytest.approx(-0.008)
    codes = found.kind.tolist()
    assert [codes.count(code) for code in (-1, 0, 1, 2, 3, 4)] == [4, 50, 5, 20, 6, 7]
    assert min(zone.confidence for zone in found.zones) > 0.8


def logged(grown: Any, per_turn: float = 32, noise: float = 0.001, pitch: float = 0.05, length: float = 6) -> hb.Wall:
    """Return the wall of a hole in gauge whose readings are longer by ``grown`` of depth and toolface."""
    rng = np.random.default_rng(7)
    turns = np.arange(round(length / pitch * per_turn)) / per_turn
    depth, toolface = turns * pitch, turns * 360
    radius = BIT / 2 + grown(depth, toolface) + 0.006 * np.cos(np.radians(toolface - 40))
    return hb.reconstruct(hb.Caliper(depth, toolface, radius + rng.normal(0, noise, depth.size)), bit_diameter=BIT)


@pytest.mark.parametrize("noise", [0.0005, 0.002])
@pytest.mark.parametrize("per_turn", [16, 64])
@pytest.mark.parametrize(("aperture", "dip"), [(0.005, 65), (0.015, 65), (0.030, 50), (0.030, 65), (0.015, 73)])
def test_an_open_fracture_is_no_zone(aperture: float, dip: float, per_turn: int, noise: float) -> None:
    def grown(depth: Any, toolface: Any) -> Any:
        trace = 3 + BIT / 2 * np.tan(np.radians(dip)) * np.cos(np.radians(toolface - 100))
        return 0.02 * (np.abs(depth - trace) * np.cos(np.radians(dip)) < aperture / 2)

    assert logged(grown, per_turn, noise).zones().zones == ()


@pytest.mark.parametrize("turn", [0, 6])  # degrees a metre
@pytest.mark.parametrize("length", [0.5, 1.0, 4.5])
def test_a_key_seat_of_any_length_is_one_though_it_wanders(length: float, turn: float) -> None:
    def grown(depth: Any, toolface: Any) -> Any:
        away = (toolface - 100 - turn * (depth - 3) + 180) % 360 - 180
        return 0.02 * np.maximum(1 - (away / 25) ** 2, 0) * (np.abs(depth - 3) < length / 2)

    (zone,) = logged(grown).zones().zones
    assert (zone.kind, zone.length) == ("key seat", pytest.approx(length, abs=0.25))


def test_noise_makes_no_key_seat_that_is_sure() -> None:
    rough = logged(lambda depth, _: 0 * depth, 16.3, 0.005, 0.068, 120).zones()
    assert np.nanmax(rough.logs.lobe1_height) > 0.009  # higher than a key seat must be
    assert not any(zone.sure for zone in rough.of("key seat"))


@pytest.mark.parametrize("pitch", [0.1, -0.1])
def test_a_zone_has_the_depth_of_its_worst_turn_and_its_measured_share(pitch: float) -> None:
    wall = wall_of((10, GAUGE), (3, WASHED), (1, WASHED + 0.001), (5, WASHED), (10, GAUGE),
                   (4, TIGHT), (1, TIGHT - 0.001), (1, TIGHT), (10, GAUGE), pitch=pitch)  # fmt: skip
    logs = turn_logs(wall)
    logs.coverage[13:19] = 0.5
    washout, tight = sorted(classify(wall, None, logs).zones, key=lambda zone: zone.kind, reverse=True)
    assert (washout.peak, tight.peak) == (logs.depth[13], logs.depth[33])
    assert (washout.enlargement, tight.enlargement) == pytest.approx((0.042, -0.010))  # those of the logs at the peak
    assert (washout.coverage, tight.coverage) == (pytest.approx((3 + 6 * 0.5) / 9), 1.0)
    table = classify(wall, None, logs).table()
    assert set(table["PEAK"].values) == {washout.peak, tight.peak}
    assert set(table["ENLARGE"].values) == {washout.enlargement, tight.enlargement}
    assert set(table["COVER"].values) == {washout.coverage, 1.0}


def test_the_extreme_of_what_the_criterion_limits_orders_the_zones_and_the_median_stands_beside_it(
    golden: Golden,
) -> None:
    wide = WASHED + lobe(100, 0.03)  # the largest diameter of its zone, while C2 is that of the other turns
    lobes, seat = lobe(100, 0.02) + lobe(280, 0.02), lobe(180, 0.02, 40)
    wall = wall_of((9, GAUGE), (3, WASHED), (1, wide), (1, WASHED + 0.01), (9, GAUGE), (4, BROKEN),
                   (1, BROKEN + lobes / 2), (9, GAUGE), (4, SEATED), (1, SEATED + seat / 2), (9, GAUGE), (4, TIGHT),
                   (1, TIGHT - 0.004), (9, GAUGE))  # fmt: skip
    found = classify(wall)
    washout, breakout, seated, tight = found.zones
    assert [zone.measure for zone in found.zones] == pytest.approx([0.06, 0.06, 0.03, -0.016], abs=1e-5)
    assert [zone.median for zone in found.zones] == pytest.approx([0.04, 0.04, 0.02, -0.008], abs=1e-5)
    assert washout.enlargement == pytest.approx(0.07, abs=1e-4)
    assert washout.peak == found.logs.depth[12]
    assert (breakout.elongation, tight.enlargement) == (breakout.measure, tight.measure)
    limits = found.criteria.limits()
    assert [zone.severity for zone in found.zones] == [zone.measure / limits[zone.kind] for zone in found.zones]
    assert found.by_severity() == [washout, seated, tight, breakout]
    unsure = Classification(found.logs, found.kind, (replace(washout, confidence=0.5), seated), found.criteria)
    assert unsure.by_severity() == [seated, unsure.zones[0]]  # washout is worse, but it is hardly more than a guess
    assert washout.severity * 0.5 < seated.severity * seated.confidence
    table = found.table()
    for name in ("MEASURE", "MEDIAN", "SEVERITY", "ENLARGE", "ELONG"):
        attribute = {"ENLARGE": "enlargement", "ELONG": "elongation"}.get(name, name.lower())
        assert table[name].values.tolist() == [getattr(zone, attribute) for zone in found.zones]
    golden(table["MEASURE"].description)
    for name, text in SIZES.items():  # the report has the same words
        mnemonic = {"enlargement": "ENLARGE", "elongation": "ELONG"}.get(name, name.upper())
        assert table.facts[mnemonic.lower()] == text
        assert table[mnemonic].description.lower() == text.lower()


def test_a_gap_belongs_to_the_zone_that_joins_it_and_not_to_its_turns_and_metres() -> None:
    wall = wall_of((9, GAUGE), (5, WASHED), (4, GAUGE), (2, BROKEN), (6, WASHED), (9, GAUGE))
    found = classify(wall)
    (zone,) = found.zones
    assert (zone.kind, round(zone.length, 1)) == ("washout", 1.7)
    assert found.kind.tolist() == [0] * 9 + [1] * 5 + [0] * 6 + [1] * 6 + [0] * 9
    summary = summarize(wall, zones=found)
    assert (summary.washed_out, summary.kinds) == (pytest.approx(1.1), {"washout": summary.washed_out})
    assert "1 zone, 1.1 m" in found._repr_html_()
    assert zone_lines(found, summary, "m")[0] == ("zones", "1 washout, 1.1 m")
    assert found.column().description.startswith("Kind of the zone whose criterion the turn meets, 0 gauge, 1 washout")


@pytest.mark.parametrize("pitch", [0.1, -0.1])
@pytest.mark.parametrize("toolface", [0.0, 33.0, -100.0])
def test_directions_do_not_depend_on_the_helix(pitch: float, toolface: float) -> None:
    turned = toolface % 5 == 0
    shift = round(toolface / 5) if turned else 0
    wall = wall_of((10, GAUGE), (9, np.roll(BROKEN, -shift)), (9, GAUGE), (9, np.roll(SEATED, -shift)), (9, GAUGE),
                   pitch=pitch, toolface=toolface)  # fmt: skip
    found = classify(wall)
    by_kind = {zone.kind: zone for zone in found.zones}
    assert by_kind["breakout"].toolface == pytest.approx((100 if turned else 133), abs=0.1)
    assert by_kind["key seat"].toolface == pytest.approx((180 if turned else 213), abs=0.1)
    assert all(zone.start < zone.stop for zone in found.zones)


def six_breakouts(seed: int) -> tuple[Hole, Classification]:
    """Six breakouts, each an axis of its own, in an oval, spiral, rough hole."""
    random = np.random.default_rng(seed)
    axes = (np.arange(6) * 30.0 + random.uniform(0, 30, 6)) % 180
    zones = tuple(
        Breakout(
            2004 + 8 * i, 2009 + 8 * i, float(axis), float(random.uniform(50, 80)), float(random.uniform(0.016, 0.024))
        )
        for i, axis in enumerate(random.permutation(axes))
    )
    hole = Hole(start=2000, stop=2052, ovality=0.0015, ovality_toolface=20, spiral=0.0015, spiral_length=1.1,
                rugosity=0.0006, breakouts=zones, seed=seed)  # fmt: skip
    run = simulate(hole, Tool(sample_rate=10), seed=seed)
    wall = hb.reconstruct(hb.Caliper(run.depth, run.toolface, run.radius, run.time), bit_diameter=BIT)
    return hole, wall.zones()


@pytest.mark.parametrize("seed", range(4))
def test_six_breakouts_of_a_simulated_hole_are_found_within_five_degrees(seed: int) -> None:
    hole, found = six_breakouts(seed)
    assert {zone.kind for zone in found.zones} == {"breakout"}
    assert len(found.zones) == 6
    for truth, zone in zip(hole.breakouts, found.zones, strict=True):
        off = (zone.toolface - truth.toolface + 90) % 180 - 90
        assert abs(off) < 5
        assert truth.start < zone.start < zone.stop < truth.stop
        assert zone.length > 0.4 * (truth.stop - truth.start)
        for side, opposite in zip(zone.lobes, (0, 180), strict=True):
            assert abs((side.toolface - zone.toolface - opposite + 180) % 360 - 180) < 5


@pytest.mark.parametrize("seed", range(3))
def test_gauge_hole_has_no_zone(seed: int) -> None:
    """Oval, spiral and rough, as drilled, with the noise of the tool: gauge by every criterion."""
    hole = Hole(start=2000, stop=2050, ovality=0.0015, spiral=0.0015, spiral_length=1.1, rugosity=0.0006, seed=seed)
    run = simulate(hole, Tool(sample_rate=10), seed=seed)
    wall = hb.reconstruct(hb.Caliper(run.depth, run.toolface, run.radius, run.time), bit_diameter=BIT)
    found = wall.zones()
    assert found.zones == ()
    assert (found.kind == 0).all()
    assert math.isnan(found.breakout_axis().mean)
    assert found.table().rows == 0


def test_zones_join_over_short_gaps_and_must_be_long_enough() -> None:
    wall = wall_of((10, GAUGE), (8, BROKEN), (2, GAUGE), (8, BROKEN), (15, GAUGE), (2, WASHED), (9, GAUGE))
    assert [(zone.kind, round(zone.length, 1)) for zone in classify(wall).zones] == [("breakout", 1.8)]
    apart = classify(wall, Criteria(join=0.1, least_length=0.1))
    assert [zone.kind for zone in apart.zones] == ["breakout", "breakout", "washout"]
    between = wall_of((10, GAUGE), (8, BROKEN), (3, WASHED), (8, BROKEN), (5, GAUGE))
    assert [zone.kind for zone in classify(between).zones] == ["breakout", "washout", "breakout"]
    gapped = wall_of((10, GAUGE), (8, BROKEN), (1, np.full(K, np.nan)), (8, BROKEN), (5, GAUGE))
    assert len(classify(gapped).zones) == 2


def test_zones_are_one_if_the_hole_between_is_nearly_as_they_are_however_long() -> None:
    """A breakout whose height wavers about the limit, over more than the metres that are joined."""
    low, broken, slight = (GAUGE + lobe(0, height) + lobe(180, height) for height in (0.012, 0.015, 0.008))
    wavering = classify(wall_of((10, GAUGE), (8, broken), (20, low), (8, broken), (10, GAUGE))).zones
    assert [(zone.kind, round(zone.length, 1)) for zone in wavering] == [("breakout", 3.6)]
    assert len(classify(wall_of((10, GAUGE), (8, broken), (20, slight), (8, broken), (10, GAUGE))).zones) == 2
    washed, between = GAUGE + 0.016, GAUGE + 0.0055
    wide = classify(wall_of((10, GAUGE), (8, washed), (40, between), (8, washed), (10, GAUGE))).zones
    assert [(zone.kind, round(zone.length, 1)) for zone in wide] == [("washout", 0.8)] * 2, "a wide hole joins nothing"
    goes_on = classify(wall_of((10, GAUGE), (20, low), (8, broken), (20, low), (20, slight), (10, GAUGE))).zones
    assert [(zone.kind, round(zone.length, 1)) for zone in goes_on] == [("breakout", 4.8)], "and where it ends, as long"
    mixed = classify(wall_of((10, GAUGE), (8, washed), (3, broken), (8, GAUGE + 0.0055), (10, GAUGE))).zones
    assert [(zone.kind, round(zone.length, 1)) for zone in mixed] == [("washout", 0.8), ("breakout", 0.3)], (
        "to its own end"
    )
    tight = (GAUGE - half / 2 for half in (0.009, 0.004))
    deep, shallow = tight
    under = classify(wall_of((10, GAUGE), (8, deep), (20, shallow), (8, deep), (10, GAUGE))).zones
    assert [(zone.kind, round(zone.length, 1)) for zone in under] == [("undergauge", 0.8)] * 2, "noise is as tight"


def test_every_criterion_can_be_set() -> None:
    mild = GAUGE + lobe(100, 0.008) + lobe(280, 0.008)
    wall = wall_of((9, GAUGE), (9, mild), (9, GAUGE), (9, GAUGE + 0.004), (9, GAUGE), (9, GAUGE + lobe(0, 0.004, 40)),
                   (9, GAUGE - 0.002), (9, GAUGE))  # fmt: skip
    assert classify(wall).zones == ()
    keen = Criteria(elongation=0.01, washout=0.006, key_seat=0.003, undergauge=0.003)
    assert [zone.kind for zone in classify(wall, keen).zones] == ["breakout", "washout", "key seat", "undergauge"]
    free = classify(wall_of((9, WASHED)), Criteria(washout=0))
    assert free.zones[0].severity == math.inf
    assert np.isnan(free.table()["SEVERITY"].values).all(), "files have no infinite number"
    uneven = wall_of((9, GAUGE), (9, GAUGE + lobe(100, 0.03) + lobe(280, 0.011)), (9, GAUGE))
    assert [zone.kind for zone in classify(uneven).zones] == ["breakout"]
    assert [zone.kind for zone in classify(uneven, Criteria(symmetry=0.8)).zones] == ["key seat"]
    wide, narrow = (classify(wall_of((9, BROKEN)), Criteria(opening_level=level)) for level in (0.1, 0.8))
    assert wide.zones[0].lobes[0].opening > narrow.zones[0].lobes[0].opening + 20


def test_a_washout_beside_the_axis_is_no_key_seat_and_an_eccentric_hole_is_gauge() -> None:
    psi = np.radians(TOOLFACE)
    eccentric = 0.012 * np.cos(psi) + np.sqrt(0.108**2 - (0.012 * np.sin(psi)) ** 2)
    assert classify(wall_of((30, eccentric))).zones == ()


@settings(max_examples=50, deadline=None)
@given(angles=st.lists(st.floats(0, 179.99), min_size=1, max_size=12), turn=st.floats(0, 360))
def test_axial_statistics_turn_with_the_axes(angles: list[float], turn: float) -> None:
    axes = np.array(angles)
    one, other = axial_mean(axes), axial_mean((axes + turn) % 360)
    assert other.concentration == pytest.approx(one.concentration, abs=1e-9)
    if one.concentration > 0.01:
        assert (other.mean - one.mean - turn + 90) % 180 - 90 == pytest.approx(0, abs=1e-6)


def test_axial_statistics_by_hand() -> None:
    found = axial_mean(np.array([10.0, 170.0]))
    assert min(found.mean, 180 - found.mean) < 1e-9
    # R = cos 20 deg; s = 1/2 sqrt(-2 ln R)
    assert found.deviation == pytest.approx(math.degrees(0.5 * math.sqrt(-2 * math.log(math.cos(math.radians(20))))))
    assert axial_mean(np.array([0.0, 90.0])).concentration == pytest.approx(0, abs=1e-12)
    assert axial_mean(np.array([30.0, 60.0]), np.array([3.0, 0.0])).mean == pytest.approx(30)
    assert axial_mean(np.array([])).count == 0
    one, two = axial_mean(np.array([93.0])), axial_mean(np.array([93.0, 93.0]))
    assert math.isnan(one.deviation)  # a spread needs two
    assert (one.spread("zone", " deg", 1), two.spread("zone", " deg", 1)) == ("1 zone", "s.d. 0.0 deg")


def test_files_state_class_zones_and_criteria(tmp_path: Any) -> None:
    wall = wall_of((10, GAUGE), (9, BROKEN), (3, np.full(K, np.nan)), (9, WASHED), (9, GAUGE))
    found = classify(wall)
    found.logs.save(tmp_path / "well.csv", [found.column()], found.facts())
    save_table(found.table(), tmp_path / "zones.csv")
    for name in ("well.csv", "zones.csv"):
        facts = read_facts(tmp_path / name)[0]
        assert (facts["criterion elongation"], facts["criterion symmetry"]) == ("0.0254 m", "0.5")
    with hb.open(tmp_path / "well.csv") as file:
        np.testing.assert_array_equal(file["CLASS"].values, np.where(found.kind < 0, np.nan, found.kind))
    with hb.open(tmp_path / "zones.csv") as file:
        assert file["CLASS"].values.tolist() == [KINDS.index("breakout"), KINDS.index("washout")]
        assert file["AXIS (deg)"].values[0] == pytest.approx(100, abs=0.01)
        assert np.isnan(file["OPEN1 (deg)"].values[1])


@pytest.mark.parametrize(
    ("call", "place"),
    [
        (lambda: Criteria(washout=-1), "washout"),
        (lambda: Criteria(symmetry=1.5), "symmetry"),
        (lambda: Criteria(opening_level=1), "opening_level"),
        (
            lambda: classify(wall_of((9, GAUGE))).of("cave"),
            "kind",
        ),
        (
            lambda: classify(wall_of((9, GAUGE)), logs=turn_logs(wall_of((30, GAUGE))).by_step(1.0)),
            "logs",
        ),
    ],
)
def test_bad_input_is_named(call: Any, place: str, golden: Golden) -> None:
    with golden.raises(place):
        call()


def test_few_samples_a_turn_show_a_key_seat_by_all_of_its_turns() -> None:
    """Two samples a turn at any toolface, as by telemetry: no turn has a shape of its own."""
    random = np.random.default_rng(3)
    depth, toolface = np.sort(random.uniform(1000, 1012, 240)), random.uniform(0, 360, 240)
    away = np.abs((toolface - 200 + 180) % 360 - 180)
    slot = 0.025 * np.maximum(1 - (away / 45) ** 2, 0) * ((depth > 1004) & (depth < 1008))
    wall = hb.reconstruct(hb.Caliper(depth, toolface, BIT / 2 + slot), bit_diameter=BIT)
    found = wall.zones()
    (zone,) = found.zones
    assert (zone.kind, zone.sure) == ("key seat", True)
    assert (zone.start, zone.stop) == pytest.approx((1004, 1008), abs=0.6)
    assert {0} <= set(found.kind[:30].tolist()) <= {-1, 0}


@pytest.mark.parametrize("arms", [3, 4])
def test_few_arms_that_turn_slowly_show_one_long_breakout(arms: int) -> None:
    """Each half metre of hole has arms at three or four toolfaces only; together they pass the whole turn."""
    depth = np.repeat(np.arange(0, 40, 0.05), arms)
    arm = np.tile(np.arange(arms), depth.size // arms)
    toolface = (20 + 12 * depth + 360 / arms * arm) % 360
    away = (toolface - 70 + 90) % 180 - 90
    lobes = 0.02 * np.maximum(np.cos(np.radians(3.6 * np.clip(away, -25, 25))), 0) * ((depth > 10) & (depth < 30))
    radius = 0.109 + lobes + np.random.default_rng(5).normal(0, 5e-4, depth.size)
    caliper = hb.Caliper(depth, toolface, radius, arm=arm)
    (zone,) = hb.reconstruct(caliper, bit_diameter=BIT, estimator="automatic").zones().zones
    assert (zone.kind, zone.sure) == ("breakout", True)
    assert (zone.start, zone.stop) == pytest.approx((10, 30), abs=2.0)


@pytest.mark.parametrize("rate", [2.0, 5.0, 9.0])
def test_two_sensors_that_turn_slowly_show_no_pieces_of_a_zone(rate: float) -> None:
    """Now and then each sees two of the 32 parts of its half metre. These were zones of half a metre, "98 % sure"."""
    depth = np.repeat(np.arange(0, 40, 0.05), 2)
    arm = np.tile([0, 1], depth.size // 2)
    toolface = (20 + rate * depth + 180 * arm) % 360
    away = (toolface - 90 + 90) % 180 - 90
    over = 0.05 * np.maximum(np.cos(np.radians(3 * np.clip(away, -30, 30))), 0) * ((depth > 5) & (depth < 35))
    radius = 0.109 + over + np.random.default_rng(6).normal(0, 5e-4, depth.size)
    found = hb.reconstruct(hb.Caliper(depth, toolface, radius, arm=arm), bit_diameter=BIT).zones()
    assert found.zones == ()
    assert set(found.kind.tolist()) == {-1}


def test_three_sensors_that_do_not_turn_do_not_show_that_a_hole_is_gauge() -> None:
    """A breakout goes on between them, where none of them looks."""
    random = np.random.default_rng(8)
    depth = np.r_[np.sort(random.uniform(0, 6, 3000)), np.repeat(np.arange(6, 12, 0.05), 3)]
    toolface = np.r_[random.uniform(0, 360, 3000), np.tile([0.0, 120.0, 240.0], 120)]
    away = (toolface - 90 + 90) % 180 - 90
    lobes = 0.03 * np.maximum(np.cos(np.radians(4.5 * np.clip(away, -20, 20))), 0) * (depth > 3)
    found = hb.reconstruct(hb.Caliper(depth, toolface, 0.109 + lobes), bit_diameter=BIT).zones()
    stands = found.logs.depth > 6.3
    assert KINDS.index("gauge") not in found.kind[stands]
    assert KINDS.index("gauge") in found.kind[~stands]


@pytest.mark.parametrize(("arms", "stop"), [((92,), 2120.1), ((0, 90, 180, 270), 2123.0)])
def test_where_turning_stops_in_a_breakout_no_zone_is_invented(arms: tuple[int, ...], stop: float) -> None:
    """The wall between is interpolated; it once was a washout of 47 mm. Four sensors show that the breakout goes on."""
    hole, random = Hole.example(2000.0, 2150.0, seed=4), np.random.default_rng(1)
    turning, still = np.sort(random.uniform(2117, 2120, 6000)), np.sort(random.uniform(2120, 2123, 6000))
    fixed = np.asarray(arms)[random.integers(0, len(arms), still.size)] + random.uniform(-3, 3, still.size)
    depth, toolface = np.r_[turning, still], np.r_[random.uniform(0, 360, turning.size), fixed] % 360
    wall = hb.reconstruct(hb.Caliper(depth, toolface, hole.radius(depth, toolface)), bit_diameter=BIT)
    found = wall.zones()
    (zone,) = found.zones
    assert (zone.kind, zone.stop) == ("breakout", pytest.approx(stop, abs=0.15))
    assert set(found.kind[-20:].tolist()) == {-1 if len(arms) == 1 else KINDS.index("breakout")}
    logs = found.logs
    still = logs.depth > 2120.3
    around = np.arange(0, 360, 1.0)
    true = [2 * np.sqrt(np.mean(hole.radius(np.full(360, at), around) ** 2)) for at in logs.depth[still]]
    low, high = (end[still] for end in logs.diameter_range)
    assert ((low <= true) & (true <= high)).mean() > 0.9
    width = high - low
    assert width[0] < 0.012, "the turns above show the shape"
    assert width[-1] > width[0], "and show it less, the farther they are"
    assert np.abs(logs.equivalent_diameter[still] - true).max() > 0.01, "the interpolated wall is wrong by more"
    turning = logs.depth < 2119.5
    np.testing.assert_array_equal(logs.diameter_range[0][turning], logs.equivalent_diameter[turning])
    for name, end in (("DEQ_LOW", low), ("DEQ_HIGH", high)):
        np.testing.assert_array_equal(logs.table()[name].values[still], end)
        assert np.isnan(logs.table()[name].values[turning]).all()
    summary = summarize(wall, 2120.5, 2122.5, zones=found)
    assert summary.ranged
    assert summary.mean_diameter_range[0] <= 0.226 <= summary.mean_diameter_range[1]
    assert summarize(wall, 2117.5, 2119.0, zones=found).excess_text().count("to") == 0
    steps = logs.by_step(1.0)
    assert steps.diameter_range[0][-2] <= 0.226 <= steps.diameter_range[1][-2]


def test_a_tool_off_centre_sees_no_key_seat_and_a_true_one_is_likely() -> None:
    """Four radii of a round hole 9 mm off centre meet the criterion of a key seat as a seat of 30 mm does."""
    depth, arm = np.repeat(np.arange(1000, 1010, 0.05), 4), np.tile([0, 1, 2, 3], 200)
    toolface = (90 * arm + 12 * depth) % 360
    along, aside = 0.009 * np.cos(np.radians(toolface - 40)), 0.009 * np.sin(np.radians(toolface - 40))
    centred = along + np.sqrt((BIT / 2) ** 2 - aside**2)
    away = np.abs((toolface - 200 + 180) % 360 - 180)
    slot = 0.03 * np.maximum(1 - (away / 45) ** 2, 0)
    walls = [
        hb.reconstruct(hb.Caliper(depth, toolface, of, arm=arm), bit_diameter=BIT) for of in (centred, BIT / 2 + slot)
    ]
    quiet, worn = (wall.zones() for wall in walls)
    assert (quiet.logs.uneven / 2).max() > Criteria().key_seat
    assert quiet.zones == ()
    assert {zone.kind for zone in worn.zones} == {"key seat"}
    assert max(zone.confidence for zone in worn.zones) > 0.5
    np.testing.assert_array_equal(worn.table()["CONF"].values, [zone.confidence for zone in worn.zones])


def test_no_kind_is_certain_in_table_and_lists() -> None:
    found = classify(wall_of((10, GAUGE), (20, WASHED), (10, GAUGE)))
    assert [zone.kind for zone in found.zones] == ["washout"]
    assert found.table()["CONF"].values.tolist() == [0.99]
    assert found.zones[0].confidence_text == "99 %"


@pytest.mark.parametrize(("arms", "kind"), [(4, "breakout"), (32, "undergauge")])
def test_what_no_gauge_section_explains_is_a_zone(arms: int, kind: str) -> None:
    """An oval of 72 mm, of which the library of sections has nothing like."""
    depth = np.repeat(np.arange(2000, 2010, 0.05), arms)
    around = np.array([0, 60, 180, 240]) if arms == 4 else np.arange(arms) * 360 / arms
    toolface = (np.tile(around, depth.size // arms) + 4 * depth) % 360
    radius = 0.115 + 0.018 * np.cos(np.radians(2 * toolface)) * (np.abs(depth - 2005) < 3)
    arm = np.tile(np.arange(arms) % 2, depth.size // arms) if arms == 4 else None
    wall = hb.reconstruct(hb.Caliper(depth, toolface, radius, arm=arm), bit_diameter=0.2159)
    zones = wall.zones()
    assert [zone.kind for zone in zones.zones if zone.start < 2005 < zone.stop] == [kind]
    assert zones.of(kind)[0].confidence == 0.5
    assert not zones.of(kind)[0].sure
    (label, text), *_ = zone_lines(zones, wall.summary(), "m")
    assert label == "zones"
    assert "not sure" in text


def test_a_washout_at_an_open_fracture_that_was_picked_counts_nowhere_as_one() -> None:
    depth = np.repeat(np.arange(1000.0, 1010.0, 0.02), 36)
    radius = BIT / 2 + np.where(np.abs(depth - 1003) < 0.4, 0.03, 0.0) + np.where(np.abs(depth - 1007) < 0.5, 0.03, 0.0)
    samples = hb.Caliper(depth, np.tile(np.arange(0.0, 360.0, 10.0), depth.size // 36), radius)
    wall = hb.reconstruct(samples, bit_diameter=BIT, sectors=36, pitch=0.02)
    wall.intervals = [hb.Interval("Upper", 1000.0, 1005.0), hb.Interval("Lower", 1005.0, 1010.0)]
    both = wall.zones()
    pick = hb.Pick(kind="fracture", depth=1003.0, toolface=0.0, apparent_dip=75.0, aperture=0.1)
    wall.picks = [pick]
    found, summary = wall.zones(), wall.summary()
    assert [round(zone.peak) for zone in both.zones] == [1003, 1007]
    assert [round(zone.peak) for zone in found.zones] == [1007]
    assert [round(zone.peak) for zone in found.fractures] == [1003]
    np.testing.assert_array_equal(found.kind, np.where(found.logs.depth < 1005, 0, both.kind))
    assert summary.washed_out == pytest.approx(both.zones[1].length, abs=0.05)
    assert [row.summary.kinds for row in wall.interval_table().intervals if row.summary] == [{}, summary.kinds]
    assert found.table().facts["left out"] == "1 washout is an open fracture that was picked"
    assert found.left_out() in [text for _, text in zone_lines(found, summary, "m")]
    for other in (replace(pick, aperture=None), replace(pick, apparent_dip=50.0), replace(pick, depth=1004.0)):
        wall.picks = [other]
        assert len(wall.zones().zones) == 2, "a fracture that is closed, or too short, or elsewhere"
    assert len(classify(wall, picks=[pick]).zones) == 1
