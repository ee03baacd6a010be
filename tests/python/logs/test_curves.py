"""Curves along the hole: the ends of their scales, and those of the logs."""

from __future__ import annotations

import numpy as np
import pytest
from golden_texts import Golden

import helibore as hb
from helibore.base.errors import InputError
from helibore.logs.curves import ScalarCurve, curves_of

DEPTH = np.arange(5.0)


def curve(values: list[float], **more: object) -> ScalarCurve:
    return ScalarCurve("GR", "gAPI", DEPTH, np.array(values), **more)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("values", "more", "ends"),
    [
        ([20.0, 80.0, np.nan, 40.0, 60.0], {}, (20.0, 80.0)),
        ([20.0] * 5, {"limits": (150.0, 0.0)}, (150.0, 0.0)),
        ([0.3, 40.0, -1.0, np.nan, 9.0], {"log": True}, (0.1, 100.0)),
        ([7.0] * 5, {}, (6.96, 7.04)),
    ],
)
def test_a_scale_has_round_ends_around_all_values(
    values: list[float], more: dict[str, object], ends: tuple[float, float]
) -> None:
    assert curve(values, **more).ends() == pytest.approx(ends)


def test_the_ends_of_a_scale_are_round_numbers_of_any_size() -> None:
    for size in (1e-15, 1e-9, 1.0, 1e15):  # a permeability in m2, a time in ns
        ends = curve([size * value for value in (1, 2, 3, 4, 5)]).ends()
        assert ends == pytest.approx((size, 5 * size), rel=1e-12, abs=0)


def test_outliers_lie_beyond_a_logarithmic_scale() -> None:
    values = np.append(np.geomspace(2.0, 60.0, 995), [1e-3, 1e5, 1e5, 1e5, 1e5])
    assert ScalarCurve("RES", "ohm.m", np.arange(1000.0), values, log=True).ends() == (1.0, 100.0)


def test_a_logarithm_needs_something_above_zero(golden: Golden) -> None:
    with golden.raises():
        curve([-1.0] * 5, log=True).ends()
    with golden.raises():
        curve([1.0] * 5, log=True, limits=(0.0, 9.0)).ends()


@pytest.mark.parametrize(
    ("depth", "more"),
    [
        (DEPTH[::-1], {}),
        (DEPTH * np.nan, {}),
        (DEPTH[1:], {}),
        (DEPTH, {"limits": (5.0, 5.0)}),
        (DEPTH, {"limits": (0.0, np.inf)}),
    ],
)
def test_a_curve_that_no_track_can_show_is_refused(depth: np.ndarray, more: dict[str, object], golden: Golden) -> None:
    with pytest.raises(InputError) as error:
        ScalarCurve("GR", "gAPI", depth, np.arange(5.0), **more)  # type: ignore[arg-type]
    golden(str(error.value))


def test_the_logs_of_a_wall_are_curves_by_their_mnemonics_shallow_end_first() -> None:
    wall = hb.reconstruct(hb.Caliper.gauge(0.0, 5.0, 0.2), bit_diameter=0.2, sectors=16, pitch=-0.1)
    logs = wall.logs()
    found = {one.name: one for one in curves_of(logs)}
    assert np.all(np.diff(found["DEQ"].depth) > 0)
    assert found["DEQ"].unit == "m"
    np.testing.assert_array_equal(np.sort(found["DEQ"].values), np.sort(logs.equivalent_diameter))
