"""Zones take the logs that somebody holds of the same wall; a wall that changed is measured again."""

from __future__ import annotations

import gc
import pickle
import weakref
from dataclasses import replace

import numpy as np
import pytest

import helibore as hb
from helibore.logs.summary import summarize
from helibore.logs.turn_logs import Logs, turn_logs
from helibore.logs.zones import classify


def made(sigma: bool = False) -> hb.Wall:
    rng = np.random.default_rng(2)
    depth, toolface = np.sort(rng.uniform(0, 6, 3000)), rng.uniform(0, 360, 3000)
    radius = 0.108 + 0.02 * (np.abs(depth - 3) < 1) + rng.normal(0, 0.0005, 3000)
    return hb.reconstruct(hb.Caliper(depth, toolface, radius), bit_diameter=0.216, sigma=sigma)


def same(one: Logs, other: Logs) -> None:
    for name, values in vars(one).items():
        if isinstance(values, np.ndarray) and name in vars(other):
            np.testing.assert_array_equal(values, getattr(other, name), err_msg=name)


def test_zones_and_summary_take_the_logs_that_are_held(monkeypatch: pytest.MonkeyPatch) -> None:
    wall = made()
    logs = wall.logs()
    same(logs, turn_logs(wall))
    monkeypatch.setattr("helibore.logs.zones.turn_logs", None)  # a call of it would fail
    monkeypatch.setattr("helibore.logs.turn_logs.turn_logs", None)
    found = wall.zones()
    assert [zone.kind for zone in found.zones] == ["washout"]
    assert found.logs is logs
    assert wall.logs() is logs
    assert classify(wall).logs is logs
    assert summarize(wall).volume == wall.summary().volume


def test_logs_that_nobody_holds_are_freed() -> None:
    wall = made()
    logs = weakref.ref(wall.logs())
    gc.collect()
    assert logs() is None
    held = wall.zones()
    assert wall.logs() is held.logs


def test_a_changed_wall_is_measured_again() -> None:
    wall = made()
    logs = wall.logs()
    wall.append([6.5], [10.0], [0.12])
    assert wall.zones().logs is not logs
    same(wall.logs(), turn_logs(wall))
    logs = wall.logs()
    wall.path = hb.Survey([0, 10], [0, 10], [0, 0]).path()
    placed = wall.zones().logs
    assert placed is not logs
    assert (placed.reference, placed.path) == ("high-side", wall.path)
    assert wall.logs(rugosity_window=2.0).rugosity_window == pytest.approx(2.1)
    assert wall.logs().rugosity_window == pytest.approx(0.9)


def test_logs_with_an_uncertainty_serve_for_zones_without_it() -> None:
    wall = made(sigma=True)
    with_sigma = wall.logs(sigma=True, caliper_accuracy=0.001)
    plain = wall.zones().logs
    assert with_sigma.with_sigma
    assert np.shares_memory(plain.c1, with_sigma.c1)
    same(plain, turn_logs(wall))
    assert (plain.with_sigma, plain.caliper_accuracy) == (False, 0.0)
    again = wall.logs(sigma=True)
    assert not np.array_equal(again.diameter_sigma, with_sigma.diameter_sigma)
    assert wall.logs(sigma=True) is again


def test_logs_that_others_may_get_cannot_be_written() -> None:
    logs = made().logs()
    with pytest.raises(ValueError, match="read-only"):
        logs.c1[0] = 9.0
    with pytest.raises(ValueError, match="read-only"):
        logs.section[0] = 9.0
    assert logs.by_step(1.0).c1.flags.writeable


def test_a_copy_of_a_wall_keeps_its_own() -> None:
    wall = made()
    logs = wall.logs()
    copy = pickle.loads(pickle.dumps(wall))
    assert copy.logs() is not logs
    same(copy.logs(), logs)
    state = pickle.loads(pickle.dumps(wall._state()))
    same(state.zones().logs, logs)
    np.testing.assert_array_equal(state.measured, wall.measured)


def test_a_part_of_a_wall_has_its_own_marks_and_logs() -> None:
    state = made()._state()
    whole, logs = state.measured, state.logs()
    half = state.radius.size // 2 // state.settings.sectors * state.settings.sectors
    part = replace(state, radius=state.radius[:half], nearest=state.nearest[:half])
    assert part.measured.size == half < whole.size
    assert len(part.logs()) < len(logs)
