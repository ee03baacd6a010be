"""SHmax and its rank, beside hand calculations, the limits of the World Stress Map, and a televiewer's picks."""

from __future__ import annotations

import csv
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from locations import SHARED

import helibore as hb
from helibore.logs.picks import Pick, plane
from helibore.logs.stress import SCHEMES, horizontal_stress, stress_of_picks

VERTICAL = hb.Survey([0, 1000], [0, 0], [0, 0]).path(reference="north")


def by_hand(axes: np.ndarray, weights: np.ndarray) -> tuple[float, float]:
    """Mean and standard deviation of axes as the guide of the World Stress Map states them."""
    c, s = (float((weights * f(2 * np.radians(axes))).sum() / weights.sum()) for f in (np.cos, np.sin))
    return math.degrees(math.atan2(s, c)) / 2 % 180, 90 / math.pi * math.sqrt(-2 * math.log(min(1.0, math.hypot(c, s))))


@given(
    axes=st.lists(st.floats(0, 360), min_size=2, max_size=30),
    seed=st.integers(0, 99),
    by=st.sampled_from(["length", "number"]),
)
def test_mean_and_deviation_are_those_by_hand(axes: list[float], seed: int, by: str) -> None:
    lengths = np.random.default_rng(seed).uniform(0.1, 9, len(axes))
    found = horizontal_stress(axes, lengths, weighting=by)
    mean, deviation = by_hand(np.array(axes), lengths if by == "length" else np.ones(len(axes)))
    if found.deviation < 40:  # else no direction
        assert abs((found.azimuth - mean - 90 + 90) % 180 - 90) < 1e-6
        assert found.deviation == pytest.approx(deviation, abs=1e-5)
    assert 0 <= found.azimuth < 180
    assert found.length == pytest.approx(lengths.sum())


@pytest.mark.parametrize(
    ("count", "length", "spread", "scheme", "rank", "limit"),
    [
        (10, 100.0, 10.0, "image", "A", ""),
        (9, 100.0, 10.0, "image", "B", "A needs 10 features"),
        (10, 99.0, 10.0, "image", "B", "A needs 100 m"),
        (10, 100.0, 15.0, "image", "B", "A needs s.d. at most 12 deg"),
        (10, 100.0, 10.0, "caliper", "B", "A needs 300 m"),
        (4, 20.0, 22.0, "image", "C", "B needs 6 features"),
        (4, 20.0, 10.0, "caliper", "D", "C needs 30 m"),
        (3, 500.0, 1.0, "image", "D", "C needs 4 features"),
        (10, 500.0, 30.0, "image", "D", "C needs s.d. at most 25 deg"),
        (10, 500.0, 45.0, "image", "E", "s.d. "),
        (0, 0.0, 0.0, "image", "E", "no feature"),
    ],
)
def test_the_lowest_of_three_limits_decides(
    count: int, length: float, spread: float, scheme: str, rank: str, limit: str
) -> None:
    # Half of the axes at -a, half at a: R = cos 2a, so that the standard deviation is close to ``spread``.
    a = math.degrees(math.acos(math.exp(-2 * math.radians(spread) ** 2))) / 2
    axes = [30 + (a if each % 2 else -a) for each in range(count)]
    if count % 2:
        axes[0] = 30.0
    found = horizontal_stress(axes, np.full(count, length / max(count, 1)), scheme=scheme)
    assert (found.rank, found.limit[: len(limit)]) == (rank, limit)
    assert all(one.deviation <= two.deviation for one, two in zip(SCHEMES[scheme], SCHEMES[scheme][1:], strict=False))


def test_one_feature_has_no_deviation_and_no_better_rank_than_d() -> None:
    found = horizontal_stress([10.0], [400.0])
    assert (found.azimuth, found.rank) == (pytest.approx(100.0), "D")
    assert math.isnan(found.deviation)
    assert "one feature" in str(found)
    assert found.record(60.0, 2.0)["SD"] == ""


@pytest.mark.skipif(not SHARED.is_dir(), reason="the real data are not here")
def test_the_breakouts_of_a_televiewer() -> None:
    with (SHARED / "calipers" / "breakout_picks.csv").open(newline="") as file:
        rows = [{name: float(text) for name, text in row.items()} for row in csv.DictReader(file)]
    axes, lengths = (np.array([row[name] for row in rows]) for name in ("azimuth_deg", "length_m"))
    for by, weights in (("length", lengths), ("number", np.ones(len(rows)))):
        found = horizontal_stress(axes, lengths, weighting=by)
        mean, deviation = by_hand(axes, weights)
        assert found.azimuth == pytest.approx((mean + 90) % 180)
        assert found.deviation == pytest.approx(deviation)
        assert (found.count, found.rank, found.limit) == (14, "D", "C needs 20 m")


def test_picks_on_a_path_give_the_azimuth_from_north() -> None:
    breakouts = [
        Pick(kind="breakout", depth=float(at), toolface=35.0 + 180 * (at % 2), height=10.0, opening=30.0)
        for at in range(100, 200, 10)
    ]
    found = stress_of_picks(breakouts, VERTICAL)
    assert (found.azimuth, found.rank, found.count, found.length) == (pytest.approx(125.0), "A", 10, 100.0)
    assert found.depth == pytest.approx(145.0)
    fracture = plane("induced fracture", 150.0, 85.0, 215.0, VERTICAL)
    assert stress_of_picks([fracture], VERTICAL, "induced fracture").azimuth == pytest.approx(125.0)
    assert stress_of_picks([fracture], VERTICAL).count == 0


@pytest.mark.parametrize("azimuth", [0.0, 70.0, 250.0])
def test_a_hole_too_inclined_gives_no_direction(azimuth: float) -> None:
    pick = Pick(kind="breakout", depth=500.0, toolface=35.0, height=10.0, opening=30.0)
    steep = hb.Survey([0, 1000], [15, 15], [azimuth, azimuth]).path(reference="north")
    flat = hb.Survey([0, 1000], [25, 25], [azimuth, azimuth]).path(reference="north")
    assert (stress_of_picks([pick], steep).count, stress_of_picks([pick], steep).left_out) == (1, 0)
    assert (stress_of_picks([pick], flat).count, stress_of_picks([pick], flat).left_out) == (0, 1)
    beyond = Pick(kind="breakout", depth=1500.0, toolface=35.0, height=10.0, opening=30.0)
    assert stress_of_picks([beyond], steep).left_out == 1


def test_a_record_of_the_world_stress_map() -> None:
    found = horizontal_stress([1.0] * 10, [10.0] * 10, depth=[2500.0] * 10)
    record = found.record(-33.5, 151.25, "SS", "Well 1")
    assert list(record)[:9] == ["ID", "SITE", "LAT", "LON", "AZI", "TYPE", "DEPTH", "QUALITY", "REGIME"]
    assert list(record.values())[:9] == ["", "Well 1", "-33.50000", "151.25000", "91", "BOT", "2.500", "A", "SS"]
    assert horizontal_stress([], []).record(0, 0)["AZI"] == "999"


@pytest.mark.parametrize(
    ("call", "place"),
    [
        (lambda: horizontal_stress([1.0, math.nan], [1, 1]), "azimuth[1] = nan"),
        (lambda: horizontal_stress([1.0], [0]), "length[0] = 0"),
        (lambda: horizontal_stress([1.0], [1, 2]), "length"),
        (lambda: horizontal_stress([1.0], [1], kind="fault"), "kind = 'fault'"),
        (lambda: horizontal_stress([1.0], [1], scheme="core"), "scheme = 'core'"),
        (lambda: horizontal_stress([1.0], [1], weighting="depth"), "weighting = 'depth'"),
        (lambda: horizontal_stress([1.0], [1]).record(91, 0), "latitude = 91"),
        (lambda: horizontal_stress([1.0], [1]).record(0, 0, "XX"), "regime = 'XX'"),
    ],
)
def test_what_is_refused(call: object, place: str) -> None:
    with pytest.raises(hb.InputError) as caught:
        call()  # type: ignore[operator]
    assert str(caught.value).startswith(place)


def test_a_wall_without_a_path_has_no_direction_of_stress() -> None:
    with pytest.raises(hb.InputError, match=r"^path = None: must be a well path"):
        stress_of_picks([], None)  # type: ignore[arg-type]


TABLE = [
    ("caliper", "A", 10, 300.0, 12.0), ("caliper", "B", 6, 100.0, 20.0), ("caliper", "C", 4, 30.0, 25.0),
    ("image", "A", 10, 100.0, 12.0), ("image", "B", 6, 40.0, 20.0), ("image", "C", 4, 20.0, 25.0),
]  # fmt: skip
"""Least number, least total length and greatest deviation of each rank. Calipers: Zoback, Reservoir Geomechanics,
table 6.1; images: Heidbach and others, Tectonophysics 482 (2010)."""


def ranked(count: int, length: float, deviation: float, scheme: str) -> str:
    """Return the rank of features at two axes, in equal numbers, whose standard deviation is ``deviation``."""
    a = math.degrees(math.acos(math.exp(-2 * math.radians(deviation) ** 2))) / 2
    axes = [30 + (a if each % 2 else -a) for each in range(count)]
    if count % 2:  # the odd one lies between, and the others are moved out
        kept = (count * math.exp(-2 * math.radians(deviation) ** 2) - 1) / (count - 1)
        a = math.degrees(math.acos(kept)) / 2
        axes = [30.0, *(30 + (a if each % 2 else -a) for each in range(count - 1))]
    return horizontal_stress(axes, np.full(count, length / count), scheme=scheme).rank


@pytest.mark.parametrize(("scheme", "rank", "number", "length", "deviation"), TABLE)
def test_the_rank_at_and_beside_each_limit(
    scheme: str, rank: str, number: int, length: float, deviation: float
) -> None:
    worse = chr(ord(rank) + 1)
    small = 1e-6
    assert ranked(number, length + small, deviation - small, scheme) == rank
    assert ranked(number - 1, length + small, deviation - small, scheme) == worse
    assert ranked(number, length - small, deviation - small, scheme) == worse
    assert ranked(number, length + small, deviation + small, scheme) == worse


@pytest.mark.parametrize("scheme", ["caliper", "image"])
@pytest.mark.parametrize(("deviation", "rank"), [(40 - 1e-6, "D"), (40 + 1e-6, "E")])
def test_the_rank_beside_the_greatest_deviation(scheme: str, deviation: float, rank: str) -> None:
    assert ranked(20, 1000.0, deviation, scheme) == rank


def test_a_breakout_has_one_azimuth_in_zones_summary_picks_and_stress() -> None:
    """At 15 and at 40 degrees, where an angle around the hole from north is not the azimuth of a direction."""
    toolface, depth = np.tile(np.arange(36) * 10.0, 400), 1000.0 + np.arange(400 * 36) / 3600
    broken = (np.abs((toolface - 50 + 90) % 180 - 90) < 15) & (np.abs(depth - 1002) < 0.8)
    for inclination in (15.0, 40.0):
        path = hb.Survey([0, 2000], [inclination] * 2, [63.0] * 2).path()
        caliper = hb.Caliper(depth, toolface, np.where(broken, 0.13, 0.1))
        wall = hb.reconstruct(caliper, bit_diameter=0.2, sectors=36, pitch=0.01)
        wall.path = path
        zones = wall.zones()
        (zone,) = zones.of("breakout")
        lean, towards, t = (math.radians(angle) for angle in (inclination, 63.0, zone.toolface))
        along = np.array([math.cos(towards), math.sin(towards)])  # level parts: of high side cos(lean) along, and right
        right = np.array([-math.sin(towards), math.cos(towards)])
        north, east = math.cos(t) * math.cos(lean) * along + math.sin(t) * right
        by_hand = math.degrees(math.atan2(east, north)) % 180
        assert zones.azimuths() == pytest.approx([by_hand])
        assert wall.summary().breakout_azimuth.mean == pytest.approx(by_hand)
        assert zones.table()["AXISAZI"].values == pytest.approx([by_hand])
        pick = Pick(kind="breakout", depth=1002.0, toolface=zone.toolface, height=1.6, opening=30.0)
        assert pick.axis(path) == pytest.approx(by_hand)
        assert float(next(csv.DictReader(hb.Picks([pick]).table(path).splitlines()))["AXIS_AZIMUTH (deg)"]) == (
            pytest.approx(by_hand)
        )
        found = stress_of_picks([pick], path)
        assert found.azimuth == pytest.approx((by_hand + 90) % 180) if inclination < 20 else found.left_out == 1
    assert math.isnan(wall.path.azimuth(3000.0, 10.0)), "beyond the path"
    wall.path = None
    assert np.isnan(wall.zones().azimuths()).all()
