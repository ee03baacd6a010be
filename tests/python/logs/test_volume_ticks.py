"""Ticks of integrated volume against the volumes of a stepped hole by hand."""

from __future__ import annotations

import copy
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command import run
from test_intervals import BIT, LOWER, STEP, UPPER, made

import helibore as hb
from helibore.base.arrays import Floats
from helibore.logs.volume_ticks import volume_ticks
from helibore.plot.content import Drawing, content_of

AREA = {diameter: math.pi / 4 * diameter**2 for diameter in (UPPER, LOWER)}
CASING = 0.15


def test_ticks_stand_where_the_volume_from_the_bottom_is_a_multiple() -> None:
    ticks = volume_ticks(made().logs(), 0.05)
    bottom = 1006.0
    for number, depth in enumerate(ticks.depth, 1):
        low, high = min(bottom, max(depth, STEP)), min(depth, STEP)
        by_hand = AREA[LOWER] * (bottom - low) + AREA[UPPER] * (STEP - high)
        assert by_hand == pytest.approx(0.05 * number, abs=0.003)
    assert ticks.depth.size == int(ticks.total / 0.05)
    assert ticks.total == pytest.approx(3 * (AREA[LOWER] + AREA[UPPER]), rel=0.01)


def test_ticks_of_the_annulus_leave_the_casing_out() -> None:
    hole, annulus = (volume_ticks(made().logs(), 0.01, casing) for casing in (None, CASING))
    assert hole.total - annulus.total == pytest.approx(math.pi / 4 * CASING**2 * 6)
    assert volume_ticks(made().logs(), 0.01, BIT * 2).total == 0  # no row lets it pass
    assert volume_ticks(made().logs(), 0.01, BIT * 2).depth.size == 0


def test_rows_without_a_volume_are_counted_and_give_no_tick() -> None:
    depth, k = np.linspace(1000, 1006, 1921), np.arange(1921)
    there = (depth < 1002) | (depth > 1004)
    caliper = hb.Caliper(depth[there], (k * 360 / 32 % 360)[there], np.full(there.sum(), 0.1))
    wall = hb.reconstruct(caliper, bit_diameter=BIT, sectors=32, max_distance=0.04)
    ticks = volume_ticks(wall.logs(), 0.01)
    assert 1.9 < ticks.missing < 2.2
    assert not ((ticks.depth > 1002.2) & (ticks.depth < 1003.8)).any()
    assert ticks.coverage < 0.7


def test_a_print_has_ticks_at_both_edges_and_says_what_they_are() -> None:
    content = content_of(made(), Drawing(ticks=0.05, casing=CASING, polar=(), body=()))
    text = content.ticks_text
    for part in ("each 0.05 m³ from", "hole, left: 0.25", "annulus of 5.906 in", "100.0 % measured"):
        assert part in text
    assert "±" not in text
    sure = copy.copy(made())
    sure.attributes["sigma"] = np.full(len(sure) - 33, 1e-4)
    assert re.search(r"hole, left: 0\.25\d ± 0\.0\d\d m³", content_of(sure, Drawing(ticks=0.05)).ticks_text)
    assert not content_of(made(), Drawing(polar=(), body=())).ticks_text


def test_a_page_and_a_log_have_the_totals(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    made().save("w.wall")
    options = ("-s", "print.ticks=0.05", "-s", "print.casing=150mm", "-s", "print.no_body=true")
    done = run("report", "w.wall", "-o", "r.html", "-s", "print.no_polar=true", *options, "-q")
    assert done.exit_code == 0, done.output
    assert "Ticks each 0.05 m³" in Path("r.html").read_text()
    assert run("logs", "w.wall", "-o", "l.csv", "--casing", "150mm", "--sigma", "-q").exit_code == 0
    with hb.open("l.csv") as file:
        log = file.set()
        up = np.argsort(log.numbers("DEPT (m)"))[::-1]
        ihv, sigma = log.numbers("IHV (m3)")[up], log.numbers("IHV_SIGMA (m3)")[up]
        assert np.all(np.diff(ihv) > 0)
        assert np.all(np.diff(sigma) >= 0)
        assert log.numbers("IHV_COVER").min() == pytest.approx(1.0)


def test_the_integrated_volume_has_no_sigma_above_a_turn_whose_volume_has_none() -> None:
    logs = made().logs()
    middle = len(logs) // 2
    unknown = np.arange(len(logs)) == middle
    below = logs.depth > logs.depth[middle]

    def integrated(**changed: Any) -> dict[str, Floats]:
        columns = replace(
            logs, diameter_sigma=np.where(unknown, np.nan, 1e-4), with_sigma=True, **changed
        ).integrated_columns()
        return {column.mnemonic: np.asarray(column.values) for column in columns}

    given = integrated()
    assert np.isfinite(given["IHV"]).all()
    assert np.isnan(given["IHV_SIGMA"][~below]).all()
    by_hand = 0.5 * math.pi * logs.height * 1e-4 * logs.equivalent_diameter[below].sum()
    assert given["IHV_SIGMA"][below].max() == pytest.approx(by_hand)
    given = integrated(volume=np.where(below, logs.volume, np.nan))  # turns without a volume add none
    assert given["IHV_SIGMA"].max() == pytest.approx(by_hand)
    assert np.isfinite(given["IHV_SIGMA"]).all()
