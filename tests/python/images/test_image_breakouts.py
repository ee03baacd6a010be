"""Breakouts in images: by hand, in noise, with gaps and all ways of counting sectors; the televiewer's picks."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import given, settings
from hypothesis import strategies as st
from locations import SHARED

import helibore as hb
from bench.accuracy import televiewer
from helibore.files.facts import read_facts
from helibore.files.log_writing import save_table
from helibore.logs.zone_criteria import Criteria
from helibore.settings.zone_settings import ImageCriteria

CALIPERS = SHARED / "calipers"
S, STEP = 72, 0.01
ANGLE = np.arange(S) * 5.0


def off(toolface: float) -> np.ndarray:
    return np.abs((ANGLE - toolface + 180) % 360 - 180)


def rows_of(*stretches: tuple[int, tuple[float, ...]], width: float = 30.0, dark: float = 20.0) -> np.ndarray:
    """Rows of 100, ``dark`` within half a ``width`` of each toolface of their stretch."""
    rows = []
    for count, lobes in stretches:
        row = np.full(S, 100.0)
        for lobe in lobes:
            row[off(lobe) <= width / 2] = dark
        rows += [row] * count
    return np.array(rows)


def image_of(values: np.ndarray, **how: object) -> hb.SectorImage:
    how = {"origin": "centre", "reference": "north", **how}
    return hb.SectorImage(500 + np.arange(len(values)) * STEP, values, "AMP", **how)  # type: ignore[arg-type]


def test_opposite_dark_sectors_are_a_breakout_and_one_alone_is_not() -> None:
    values = rows_of((20, ()), (30, (100, 280)), (20, ()), (30, (100,)), (20, ()), (30, (100, 200)), (20, ()))
    found = image_of(values).breakouts()
    (zone,) = found.zones
    assert (zone.start, zone.stop) == pytest.approx((500.195, 500.495))
    assert zone.toolface == pytest.approx(100)
    assert zone.deviation == pytest.approx(0, abs=1e-5)
    assert [side.toolface for side in zone.lobes] == pytest.approx([100, 280])
    assert [side.relative for side in zone.lobes] == pytest.approx([0.2, 0.2])
    # Seven sectors of 20 among 100: 0.6 is crossed half a sector beyond each end.
    assert [side.opening for side in zone.lobes] == pytest.approx([35, 35])
    assert found.axis().mean == pytest.approx(100)


@pytest.mark.parametrize("origin", ["centre", "edge"])
@pytest.mark.parametrize("direction", ["clockwise", "counterclockwise"])
@pytest.mark.parametrize("offset", [0.0, 33.0, -90.0])
def test_toolfaces_are_those_of_the_sectors_centres(origin: str, direction: str, offset: float) -> None:
    values = rows_of((10, ()), (20, (5, 190)), (10, ()))
    found = image_of(values, origin=origin, direction=direction, offset=offset).breakouts()
    way, half = (1 if direction == "clockwise" else -1), (2.5 if origin == "edge" else 0)
    truth = {(offset + way * (lobe + half)) % 360 for lobe in (5, 190)}
    (zone,) = found.zones
    assert {round(side.toolface, 6) % 360 for side in zone.lobes} == {round(one, 6) for one in truth}
    # Its own mapping on quads says the same: the darkest quads lie at those toolfaces.
    wall = hb.reconstruct(hb.Caliper.gauge(500, 500.4, 0.1, step=0.01), bit_diameter=0.1, sectors=360, pitch=0.01)
    on_wall = found.image.on(wall)
    dark = wall.toolface[: on_wall.size][on_wall < 60] + 0.5
    assert {min(abs((one - toolface + 180) % 360 - 180) for toolface in truth) <= 17.5 for one in dark} == {True}


@settings(deadline=None, max_examples=25)
@given(st.integers(0, S - 1), st.integers(0, 2**32 - 1))
def test_turning_the_image_turns_what_is_found(by: int, seed: int) -> None:
    random = np.random.default_rng(seed)
    values = rows_of((20, ()), (20, (80, 265)), (20, ())) * random.uniform(0.8, 1.2, (60, S))
    still, turned = image_of(values).breakouts(), image_of(np.roll(values, by, axis=1)).breakouts()
    (one,), (other,) = still.zones, turned.zones
    assert (one.start, one.stop) == (other.start, other.stop)
    assert abs((other.toolface - one.toolface - 5 * by + 90) % 180 - 90) < 1e-6


@pytest.mark.parametrize("seed", range(5))
def test_a_noisy_layered_image_without_breakouts_has_none(seed: int) -> None:
    random = np.random.default_rng(seed)
    beds = 50 + 100 * random.random((40, 1)).repeat(10, axis=0)
    tilted = 1 + 0.2 * np.cos(np.radians(ANGLE - 40))  # a decentred tool
    image = image_of(beds * tilted * random.normal(1, 0.12, (400, S)))
    assert image.breakouts().zones == ()
    assert image.breakouts().table().rows == 0


def test_specks_wide_shadows_and_short_stretches_are_none() -> None:
    assert image_of(rows_of((9, ()), (20, (90, 270)), (9, ()), width=4)).breakouts().zones == ()
    assert image_of(rows_of((9, ()), (20, (90, 270)), (9, ()), width=125, dark=50)).breakouts().zones == ()
    assert image_of(rows_of((9, ()), (4, (90, 270)), (9, ()))).breakouts().zones == ()
    assert len(image_of(rows_of((9, ()), (5, (90, 270)), (9, ()))).breakouts().zones) == 1


def test_a_breakout_has_two_rows_however_high_a_row_is() -> None:
    def found(rows: int, criteria: ImageCriteria | None = None) -> int:
        values = rows_of((9, ()), (rows, (90, 270)), (9, ()))
        depth = 500 + 0.2 * np.arange(len(values))  # one row is longer than the least length
        image = hb.SectorImage(depth, values, "AMP", origin="centre", reference="north")
        return len(image.breakouts(criteria).zones)

    assert [found(rows) for rows in (1, 2)] == [0, 1]
    assert found(1, ImageCriteria(least_rows=1)) == 1
    assert found(1, ImageCriteria(least_rows=np.int64(1))) == 1
    assert found(2, ImageCriteria(least_rows=3)) == 0


def test_an_axis_that_turns_from_row_to_row_leaves_no_opening_of_the_mean_row() -> None:
    (zone,) = (
        image_of(rows_of(*((1, (at, at + 180)) for at in (90, 120, 150, 180)), dark=55.0))
        .breakouts(ImageCriteria(least_length=0.0))
        .zones
    )
    assert [lobe.opening for lobe in zone.lobes] == [0.0, 0.0]
    assert [lobe.relative for lobe in zone.lobes] == pytest.approx([0.775, 0.775])


def test_every_criterion_can_be_set() -> None:
    faint = image_of(rows_of((9, ()), (9, (90, 270)), (9, ()), dark=70))
    assert not faint.breakouts().zones
    assert faint.breakouts(ImageCriteria(dark=0.8)).zones
    narrow = image_of(rows_of((9, ()), (9, (90, 270)), (9, ()), width=4))
    assert narrow.breakouts(ImageCriteria(least_opening=5)).zones
    wide = image_of(rows_of((9, ()), (9, (90, 270)), (9, ())))
    assert not wide.breakouts(ImageCriteria(most_opening=30)).zones
    bent = image_of(rows_of((9, ()), (9, (90, 230)), (9, ())))
    assert not bent.breakouts().zones
    assert bent.breakouts(ImageCriteria(opposite=45)).zones
    two = image_of(rows_of((9, ()), (9, (90, 270)), (3, ()), (9, (90, 270)), (9, ())))
    assert len(two.breakouts().zones) == 2
    assert len(two.breakouts(ImageCriteria(join=0.04)).zones) == 1
    assert not two.breakouts(ImageCriteria(least_length=0.1)).zones
    turned = image_of(rows_of((9, ()), (9, (90, 270)), (9, (140, 320)), (9, ())))
    assert [round(zone.toolface) for zone in turned.breakouts().zones] == [90, 140]


def test_missing_values_are_not_dark_and_split_no_lobe() -> None:
    values = rows_of((9, ()), (20, (90, 270)), (9, ()))
    whole = image_of(values).breakouts().zones[0]
    holes = values.copy()
    holes[15] = np.nan  # a row that is not there
    holes[20:24, 30] = np.nan
    found = image_of(holes).breakouts().zones
    assert len(found) == 1
    assert found[0].toolface == pytest.approx(whole.toolface)
    absent = rows_of((9, ()), (20, (90,)), (9, ()))
    absent[9:29, off(270) <= 15] = np.nan
    assert image_of(absent).breakouts().zones == ()


def test_bad_criteria_and_values_are_named(golden: Golden) -> None:
    for bad, text in (
        ({"dark": 1.0}, r"^dark = 1: must be in \(0, 1\)$"),
        ({"join": math.nan}, "^join = nan: must be finite and not negative$"),
        ({"opposite": 91.0}, "^opposite = 91: must be at most 90$"),
        ({"least_opening": 120.0}, "^least_opening = 120.0, most_opening = 100.0: the first must be less than the "),
    ):
        with pytest.raises(ValueError, match=text):
            ImageCriteria(**bad)
    values = rows_of((9, ()))
    values[3, 4] = -1
    with golden.raises():
        image_of(values).breakouts()
    with golden.raises():
        Criteria.scaled(0)


def test_the_table_states_image_and_criteria(tmp_path: Path) -> None:
    found = image_of(rows_of((9, ()), (20, (100, 280)), (9, ()))).breakouts(ImageCriteria(dark=0.5))
    table = found.table()
    assert table["AXIS"].values == pytest.approx([100])
    assert [table[f"LOBE{side}"].values[0] for side in (1, 2)] == pytest.approx([100, 280])
    save_table(table, tmp_path / "zones.csv")
    text = " ".join(read_facts(tmp_path / "zones.csv")[0].values())
    assert "0.5 of the row's median" in text
    assert "north" in text


def test_criteria_scale_with_the_bit() -> None:
    usual, small = Criteria(), Criteria.scaled(0.104)
    for name in ("elongation", "washout", "key_seat", "undergauge"):
        assert getattr(small, name) == pytest.approx(getattr(usual, name) * 0.104 / 0.2159)
    assert (small.symmetry, small.least_length) == (usual.symmetry, usual.least_length)
    assert Criteria.scaled(0.2159).facts() == usual.facts()
    assert Criteria.scaled(0.104, least_length=0.1).least_length == 0.1


@pytest.mark.skipif(not CALIPERS.is_dir(), reason="needs ../shared/data/calipers")
def test_the_televiewers_picks_are_found_and_no_others() -> None:
    picks, wall = televiewer.read_picks(CALIPERS), televiewer.read_wall(CALIPERS)
    found = wall.images["Amplitude"].breakouts()
    matches = televiewer.match(picks, found)
    picked = [one for one in matches if one.pick.kind == televiewer.BREAKOUT]
    assert len(picks) == 14
    assert len(picked) == 10
    assert all(one.lobe is not None for one in picked)
    assert max(abs(one.off) for one in picked) <= 5.5  # measured: 5.0
    assert all(one.lobe is None for one in matches if one.pick.kind != televiewer.BREAKOUT)
    assert televiewer.false_ones(found, picks) == []
    for one in picked:
        assert one.zone is not None
        assert one.zone.start - 0.05 < one.pick.depth < one.zone.stop + 0.05
    # The mean caliper has no shape, and never reaches a washout.
    assert wall.zones().zones == ()
    assert wall.zones(Criteria.scaled(televiewer.GAUGE)).zones == ()
    # The lobes of the picks stay under the inch of the trade but for one depth; scaled, the two largest pairs reach it.
    reached = {
        limit: sum(most >= limit for most, _ in televiewer.enlargements(CALIPERS, [one.pick for one in picked]))
        for limit in (Criteria().elongation, Criteria.scaled(televiewer.GAUGE).elongation)
    }
    assert list(reached.values()) == [2, 4]
