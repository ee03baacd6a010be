"""Angles in one turn: never the period itself, which the remainder of a tiny negative angle rounds to."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import helibore as hb
from helibore.base.angles import wrapped
from helibore.preparation.eccentering import Centres
from helibore.wall.interpolation import canonical_order


@pytest.mark.parametrize("period", [180.0, 360.0])
@given(angle=st.lists(st.floats(-1e6, 1e6) | st.sampled_from([-1e-20, -0.0, 360.0, -360.0, math.nan])))
def test_an_angle_stays_where_it_points_and_lies_below_the_period(period: float, angle: list[float]) -> None:
    found = wrapped(np.array(angle, dtype=np.float64), period)
    known = found[~np.isnan(found)]
    assert np.array_equal(np.isnan(found), np.isnan(angle))
    assert ((known >= 0) & (known < period)).all()
    for before, after in zip(angle, found.tolist(), strict=True):
        assert math.isnan(before) or abs(math.remainder(before - after, period)) <= 1e-9


def test_a_sample_a_hair_before_the_reference_is_the_one_at_it() -> None:
    """The core takes -1e-20 for 0, so two such rows are one sample: values carried by the rows must know."""
    rows = hb.Caliper([1.0, 1.0, 1.1], [0.0, -1e-20, 90.0], [0.1, 0.1, 0.1], time=[5.0, 5.0, 6.0])
    wall = hb.reconstruct(rows, bit_diameter=0.2, sectors=4)
    assert wall.sample_count == 2
    assert canonical_order(rows).tolist() == [0, 2]


def test_a_tool_a_hair_left_of_the_reference_is_off_towards_it() -> None:
    spread, none = np.zeros((1, 2, 2)), np.zeros(1)
    names = Centres.__dataclass_fields__
    values = dict.fromkeys(names, none) | {"x": np.array([0.01]), "y": np.array([-1e-24]), "covariance": spread}
    assert Centres(**values).direction.tolist() == [0.0]
