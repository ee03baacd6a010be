"""A cement sheet against volumes by hand, in a hole of stepped diameters and with parts that were not measured."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from golden_texts import Golden
from hypothesis import given
from hypothesis import strategies as st

import helibore as hb
from helibore.cli import cli
from helibore.logs.cement_sheet import LAP, OPEN_HOLE, RAT_HOLE, SHOE_TRACK, CementSheet
from helibore.settings.cement_settings import CementJob

BIT, TOP, STOP, STEP = 0.31, 1000.0, 1030.0, 1015.0
UPPER, LOWER = 0.32, 0.34


def area(diameter: float) -> float:
    return math.pi / 4 * diameter**2


@cache
def wall(gap: bool = False) -> hb.Wall:
    """A round hole, wider below STEP; with a gap, nothing was measured from 1005 to 1008 m."""
    k = np.arange(64 * 300 + 1)
    depth = TOP + k * 0.1 / 64
    kept = ~((depth > 1005) & (depth < 1008)) if gap else np.ones(depth.size, dtype=bool)
    radius = np.where(depth < STEP, UPPER, LOWER) / 2
    caliper = hb.Caliper(depth[kept], (k * 360 / 64 % 360)[kept], radius[kept])
    return hb.reconstruct(caliper, bit_diameter=BIT, max_distance=0.05)


@cache
def logs_of(gap: bool) -> hb.Logs:
    return wall(gap).logs()


def sheet(gap: bool = False, **more: float) -> CementSheet:
    return logs_of(gap).cement_sheet(CementJob(**{"casing": 0.2445, "shoe": 1025.0} | more))  # type: ignore[arg-type]


def volumes(found: CementSheet) -> dict[str, float]:
    return {each.name: each.volume for each in found.sections}


def test_every_section_by_hand() -> None:
    found = sheet(
        inner_diameter=0.2205, shoe_track=12.0, previous_shoe=1004.0, previous_inner=0.3153, top=990.0, excess=0.2
    )
    hole = area(UPPER) * (STEP - 1004) + area(LOWER) * (1025 - STEP) - area(0.2445) * 21
    expected = {
        RAT_HOLE: 1.2 * area(LOWER) * 5,
        SHOE_TRACK: area(0.2205) * 12,
        OPEN_HOLE: 1.2 * hole,
        LAP: (area(0.3153) - area(0.2445)) * 14,
    }
    assert volumes(found) == pytest.approx(expected, rel=4e-3)  # the step takes a turn, and the ends half of one
    assert found.total == pytest.approx(sum(volumes(found).values()))
    assert found.displacement == pytest.approx(area(0.2205) * 1013)
    assert all(each.measured == pytest.approx(1.0) for each in found.sections)


def test_a_stab_in_job_leaves_no_shoe_track() -> None:
    found = sheet(inner_diameter=0.2205, shoe_track=12.0, stab_in=0.1086)
    assert SHOE_TRACK not in volumes(found)
    assert found.displacement == pytest.approx(area(0.1086) * 1025)


def test_what_was_not_measured_takes_the_mean_of_its_section(golden: Golden) -> None:
    found = next(each for each in sheet(gap=True, top=1001.0, shoe=1012.0).sections if each.name == OPEN_HOLE)
    assert found.volume == pytest.approx((area(UPPER) - area(0.2445)) * 11, rel=1e-6)
    assert found.measured == pytest.approx(1 - 3 / 11, abs=0.02)
    with golden.raises():
        sheet(gap=True, top=1006.0, shoe=1007.0)


def test_a_tool_with_few_arms_did_not_measure_what_lies_between_them() -> None:
    k = np.arange(2000)
    arms = hb.Caliper(1000 + (k // 4) * 0.02, (90.0 * (k % 4) + 20) % 360, np.full(k.size, UPPER / 2))
    logs = hb.reconstruct(arms, bit_diameter=BIT).logs()
    hole = logs.cement_sheet(CementJob(casing=0.2445, shoe=1008.0, top=1002.0)).sections[-1]
    assert hole.name == OPEN_HOLE
    assert hole.measured == pytest.approx(logs.coverage[(logs.depth > 1002) & (logs.depth < 1008)].mean(), abs=0.01)
    assert hole.measured < 0.5


@given(tail_top=st.floats(995, 1020), top=st.floats(990, 1010))
def test_lead_and_tail_are_all(tail_top: float, top: float) -> None:
    more = {"previous_shoe": 1004.0, "previous_inner": 0.3153, "top": top}
    found, one = sheet(tail_top=tail_top, **more), sheet(**more)
    assert found.slurry("lead") + found.slurry("tail") == pytest.approx(one.total)
    assert found.slurry("tail") >= one.sections[0].volume  # the rat hole


def test_a_tail_that_ends_in_the_lap_by_hand() -> None:
    found = sheet(tail_top=1000.0, previous_shoe=1004.0, previous_inner=0.3153, top=990.0)
    assert found.slurry("lead") == pytest.approx((area(0.3153) - area(0.2445)) * 10)


def test_the_integrated_volume_counts_from_the_bottom() -> None:
    logs = logs_of(True)
    slow = [np.nansum(logs.volume[logs.depth >= depth]) for depth in logs.depth]
    np.testing.assert_allclose(logs.integrated_volume, slow)
    assert np.isnan(logs.volume).any()


def test_sigma_of_a_common_error_is_that_of_the_area() -> None:
    logs = wall().logs(sigma=True, caliper_accuracy=0.001)
    found = logs.cement_sheet(CementJob(casing=0.2445, shoe=1012.0, top=1002.0))
    hole = next(each for each in found.sections if each.name == OPEN_HOLE)
    assert hole.sigma >= math.pi * UPPER * 0.001 * 10 * 0.99
    assert math.isnan(sheet().sigma)


@pytest.mark.parametrize(
    "more",
    [
        {"shoe": 1031.0},
        {"shoe": 900.0, "previous_shoe": None, "previous_inner": None, "top": None},
        {"excess": 10.0},
        {"top": 990.0},
        {"top": 1026.0},
        {"previous_shoe": 1004.0},
        {"inner_diameter": 0.3},
        {"shoe_track": 5.0},
        {"casing": 0.33},
    ],
)
def test_refused(more: dict[str, float], golden: Golden) -> None:
    with golden.raises():
        sheet(**more)


def test_the_logs_of_a_casing_have_the_volume_of_the_hole_from_the_bottom(tmp_path: Path) -> None:
    wall().save(tmp_path / "w.wall")
    words = ["logs", str(tmp_path / "w.wall"), "-o", str(tmp_path / "w.csv"), "--casing", "9.625in"]
    done = CliRunner().invoke(cli, words)
    assert done.exit_code == 0, done.output
    with hb.open(tmp_path / "w.csv") as file:
        found = file.set().numbers("IHV (m3)")
    np.testing.assert_allclose(found, logs_of(False).integrated_volume, atol=1e-6)


def test_the_command(tmp_path: Path) -> None:
    wall().save(tmp_path / "w.wall")
    words = ["--casing", "9.625in", "--shoe", "1025m", "--previous-shoe", "1004m", "--previous-inner", "12.415in"]
    words += ["--top", "990m", "--excess", "0.1", "--inner-diameter", "8.681in", "--shoe-track", "12m"]
    done = CliRunner().invoke(cli, ["cement", str(tmp_path / "w.wall"), "-o", str(tmp_path / "c.csv"), *words])
    assert done.exit_code == 0, done.output
    rows = [line.split(",") for line in (tmp_path / "c.csv").read_text().splitlines()]
    assert [row[0] for row in rows[1:]] == [RAT_HOLE, SHOE_TRACK, OPEN_HOLE, LAP, "total", "displacement"]
    assert float(rows[5][4]) == pytest.approx(sum(float(row[4]) for row in rows[1:5]), abs=0.003)
    assert "with 10 % excess" in " ".join(done.output.split())
    done = CliRunner().invoke(cli, ["cement", str(tmp_path / "w.wall"), "-o", str(tmp_path / "c.csv")])
    assert "Missing option '--casing'" in done.output
