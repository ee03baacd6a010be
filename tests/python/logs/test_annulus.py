"""Annular volumes: a round hole by hand, gaps that are not filled, casings that do not pass, error texts."""

from __future__ import annotations

import math

import numpy as np
import pytest

import helibore as hb
from helibore.logs.annulus import annulus
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
    space = annulus(logs, OD)
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
        space = annulus(one, OD)
        assert space.from_bottom[0] == pytest.approx(space.total)
        assert (np.diff(space.from_bottom) <= 1e-15).all()
        gap = np.isnan(space.volume)
        assert np.ptp(space.from_bottom[gap]) == 0


def test_a_gap_is_never_filled(logs: Logs) -> None:
    text = r"^cement: [34](.\d)? m between 15 and 22 m are unmeasured; choose an interval without gaps, or take `total`"
    with pytest.raises(ValueError, match=text):
        annulus(logs, OD).cement(15, 22)


def test_columns_name_the_casing(logs: Logs) -> None:
    table = logs.table(annulus(logs, OD).columns())
    assert table["AVOL_244"].unit == "m3"
    assert table["CLEAR_244"].description == "Inscribed circle less casing of 0.2445 m"


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda logs: annulus(logs, 0), "outer_diameter = 0: must be finite and above 0"),
        (
            lambda logs: annulus(logs, 0.34),
            r"outer_diameter = 0.34: a casing of 13.39 in is larger than the hole at 0.0492\d* m, 12.2\d* in",
        ),
        (lambda logs: annulus(logs, OD).cement(100, 200), "cement: no row between 100 and 200 m"),
        (lambda logs: annulus(logs, OD).cement(excess=-0.1), "excess = -0.1: must be finite and not negative"),
    ],
)
def test_bad_input_is_named(logs: Logs, call, text: str) -> None:
    with pytest.raises(ValueError, match=f"^{text}$"):
        call(logs)
