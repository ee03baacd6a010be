"""Logs of 2.5 M vertices, beside a NumPy copy of their radii: at most 20 x.

python -m bench logs
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from bench.measure import in_turn, milliseconds, ratio
from helibore.logs import turn_logs

SECTORS, VERTICES = 64, 2_500_000


def cases(rounds: int = 15) -> list[dict[str, Any]]:
    """Whole turns and, every tenth, one with a gap."""
    radius = np.random.default_rng(1).uniform(0.1, 0.13, VERTICES)
    radius[:: 10 * SECTORS] = np.nan
    settings = SimpleNamespace(sectors=SECTORS, pitch=0.1, start_toolface=0.0)
    wall = SimpleNamespace(settings=settings, start_depth=0.0, radius=radius)
    logs = turn_logs(wall, 0.216)
    assert np.isnan(logs.mean).sum() == np.isnan(radius[: logs.mean.size * SECTORS]).sum()
    seconds = in_turn({"logs": lambda: turn_logs(wall, 0.216), "copy": lambda: np.copy(radius)}, rounds)
    return [
        {
            "case": f"logs of {VERTICES} vertices",
            "logs ms": milliseconds(seconds["logs"]),
            "over a copy": ratio(seconds["logs"], seconds["copy"]),
            "over a copy at most": 20,
        }
    ]
