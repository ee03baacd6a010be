"""Annular volumes: a round hole by hand, gaps that are not filled, casings that do not pass, error texts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from golden_texts import Golden

import helibore as hb
from helibore.logs.turn_logs import Logs

OD = 0.2445  # 9 5/8 in


@pytest.fixture(scope="module")
def logs() -> Logs:
    """20 m of 12 1/4 in hole at gauge, the deepest 3 m of them after a gap of 4 m."""
    diameter = np.full(241, 0.31115)
    depth = np.arange(241) * 0.1
    diameter[(depth > 17) & (depth < 21)] = np.nan
    return hb.reconstruct(hb.Caliper.from_average(depth, diameter), bit_diameter=0.31115, max_distance=0.3).logs()


def test_the_volume_between_two_cylinders(logs: Logs) -> None:
    space = logs.annulus(OD)
    per_metre = math.pi / 4 * (0.31115**2 - OD**2)
    there = ~np.isnan(space.volume)
    np.testing.assert_allclose(space.volume[there], per_metre * 0.1)
    assert space.total == pytest.approx(per_metre * 0.1 * there.sum())
    assert space.unmeasured == pytest.approx(0.1 * (~there).sum())
    assert 3 < space.unmeasured < 4.2
    np.testing.assert_allclose(space.clearance[there], 0.31115 - OD)
    assert space.cement(2, 12) == pytest.approx(per_metre * 10)
    assert space.cement(2, 12, excess=0.25) == pytest.approx(per_metre * 12.5)


def test_volume_adds_up_from_the_bottom_as_cement_rises(logs: Logs) -> None:
    for one in (logs, logs.by_step(0.5)):
        space = one.annulus(OD)
        assert space.from_bottom[0] == pytest.approx(space.total)
        assert (np.diff(space.from_bottom) <= 1e-15).all()
        gap = np.isnan(space.volume)
        assert np.ptp(space.from_bottom[gap]) == 0


def test_a_gap_is_never_filled(logs: Logs, golden: Golden) -> None:
    with golden.raises():
        logs.annulus(OD).cement(15, 22)


def test_columns_name_the_casing(logs: Logs, golden: Golden) -> None:
    table = logs.table(logs.annulus(OD).columns())
    assert table["AVOL_244"].unit == "m3"
    golden(table["CLEAR_244"].description)


def test_a_casing_that_does_not_pass_has_no_annulus_there(golden: Golden) -> None:
    """1 m of 9 1/2 in in 10 m of 12 1/4 in hole: the other rows keep their volumes."""
    depth = np.arange(101) * 0.1
    diameter = np.where((depth > 4) & (depth < 5), 0.2413, 0.31115)
    logs = hb.reconstruct(hb.Caliper.from_average(depth, diameter), bit_diameter=0.31115).logs()
    space = logs.annulus(OD)
    narrow = logs.equivalent_diameter < OD
    np.testing.assert_array_equal(np.isnan(space.volume), narrow)
    assert space.narrower == pytest.approx(0.1 * narrow.sum())
    assert 0.5 < space.narrower < 1.5
    assert space.unmeasured == 0
    assert space.clearance.min() == pytest.approx(0.2413 - OD, abs=1e-4)
    assert space.from_bottom[0] == pytest.approx(np.nansum(space.volume))
    with golden.raises():
        space.cement()
    assert space.cement(6, 9) > 0


@pytest.mark.parametrize(
    ("call", "place"),
    [
        (lambda logs: logs.annulus(0), "casing"),
        (lambda logs: logs.annulus(OD).cement(100, 200), "cement"),
        (lambda logs: logs.annulus(OD).cement(top=100), "cement"),
        (lambda logs: logs.between(100, 200).annulus(OD).cement(), "cement"),
        (lambda logs: logs.annulus(OD).cement(excess=-0.1), "excess"),
    ],
)
def test_bad_input_is_named(logs: Logs, call, place: str, golden: Golden) -> None:
    with golden.raises(place):
        call(logs)
