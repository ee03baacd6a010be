"""Compare all logs of 2.5 M vertices with a NumPy copy of their radii; the bar is 20 x.

    python -m bench logs

One wall is a rough oval with a gap in every tenth turn. The other has radii without any order around the hole, for
which the search of the inscribed and the enclosing circle takes most steps.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from bench.measure import in_turn, milliseconds, ratio
from helibore.logs.turn_logs import turn_logs

SECTORS, VERTICES = 64, 2_500_000


def _wall(radius: np.ndarray) -> Any:
    radius[:: 10 * SECTORS] = np.nan
    settings = SimpleNamespace(sectors=SECTORS, pitch=0.1, start_toolface=0.0)
    return SimpleNamespace(settings=settings, start_depth=0.0, radius=radius)


def cases(rounds: int = 15) -> list[dict[str, Any]]:
    """Return the results of both walls; every tenth turn of a wall has a gap, the other turns have no gap."""
    random = np.random.default_rng(1)
    angle = np.arange(VERTICES) * (2 * np.pi / SECTORS)
    hole = _wall(0.108 + 0.003 * np.cos(2 * angle) + 0.002 * np.cos(angle) + random.normal(0, 0.0005, VERTICES))
    noise = _wall(random.uniform(0.1, 0.13, VERTICES))
    logs = turn_logs(hole, 0.216)
    assert np.isnan(logs.mean).sum() == np.isnan(hole.radius[: len(logs) * SECTORS]).sum()
    assert np.nanmax(abs(logs.equivalent_diameter / 0.21608 - 1)) < 0.005
    seconds = in_turn(
        {
            "logs": lambda: turn_logs(hole, 0.216),
            "one thread": lambda: turn_logs(hole, 0.216, threads=1),
            "noise": lambda: turn_logs(noise, 0.216),
            "copy": lambda: np.copy(hole.radius),
        },
        rounds,
    )
    return [
        {
            "case": f"all logs of {VERTICES} vertices",
            "logs ms": milliseconds(seconds["logs"]),
            "over a copy": ratio(seconds["logs"], seconds["copy"]),
            "over a copy at most": 20,
            "one thread over a copy": ratio(seconds["one thread"], seconds["copy"]),
            "radii without order over a copy": ratio(seconds["noise"], seconds["copy"]),
            "copy ms": milliseconds(seconds["copy"]),
        }
    ]
