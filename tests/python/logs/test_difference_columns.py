"""Columns of the difference from earlier passes: a hole that grew on one side, between two depths."""

from __future__ import annotations

from pathlib import Path

import lasio
import numpy as np
import pytest
from command import run

import helibore as hb
from helibore.logs.difference_columns import difference_columns

BIT = 0.2159


def turns(grown: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """64 samples in each turn of 0.1 m; the later pass is 4 mm larger below 1005 m, towards toolfaces 0 to 180."""
    k = np.arange(64 * 100)
    depth, toolface = 1000 + k * 0.1 / 64, (k * 360 / 64) % 360
    radius = np.full(k.size, BIT / 2)
    return depth, toolface, radius + (0.004 * ((depth > 1005) & (toolface < 180)) if grown else 0.0)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    passes = [np.column_stack([*turns(grown), np.full(6400, number)]) for number, grown in enumerate((False, True), 1)]
    rows = "".join(f"{a:.6f},{b:.4f},{c:.6f},{d:.0f}\n" for a, b, c, d in np.concatenate(passes))
    (tmp_path / "two.csv").write_text(f"md_m,tf_deg,radius_m,pass\n{rows}")
    return tmp_path / "two.csv"


def test_the_logs_of_a_compared_wall_have_the_differences(file: Path) -> None:
    done = run("logs", file, "--bit-diameter", f"{BIT}m", "-s", "preparation.earlier=1", "-o", file.with_name("w.las"))
    assert done.exit_code == 0, done.output
    log = lasio.read(file.with_name("w.las"))
    depth, mean, least, most = (log[name] for name in ("DEPT", "DIFF_MEAN", "DIFF_MIN", "DIFF_MAX"))
    above, below = (depth > 1001) & (depth < 1004), (depth > 1006) & (depth < 1009)
    assert np.abs(np.concatenate([mean[above], least[above], most[above]])).max() < 1e-4
    np.testing.assert_allclose(mean[below], 0.002, atol=1.5e-4)
    np.testing.assert_allclose(least[below], 0.0, atol=1e-4)
    np.testing.assert_allclose(most[below], 0.004, atol=1e-4)


def test_the_rows_of_steps_and_of_a_wall_logged_upwards() -> None:
    for pitch in (0.1, -0.1):
        depth, toolface, radius = turns(True)
        wall = hb.reconstruct(hb.Caliper(depth, toolface, radius), bit_diameter=BIT, pitch=pitch)
        assert difference_columns(wall.logs(), wall) == []
        quads = wall.radius.size - 65
        centre = wall.start_depth + (np.arange(quads) + 32.5) * pitch / 64
        wall.attributes["difference"] = np.where(centre > 1005, 0.003, np.nan)
        for logs in (wall.logs(), wall.logs().by_step(0.5)):
            mean, least, most = (each.values for each in difference_columns(logs, wall))
            deep, shallow = logs.depth > 1005.5, logs.depth < 1004.5
            reached = logs.depth + 0.5 * logs.height < centre.max() - 0.1
            for column in (mean, least, most):
                np.testing.assert_allclose(column[deep & reached], 0.003)
                assert np.isnan(column[shallow]).all()
