"""The samples that readings stand for, one after another in plain Python: the slow reference of the tests."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass
class WallSamples:
    depth: np.ndarray
    toolface: np.ndarray
    radius: np.ndarray
    time: np.ndarray | None
    row: np.ndarray
    rows: int
    dropped: dict[str, int]
    notes: tuple[str, ...]


def wall_samples(source: Any, *given: Any, **named: Any) -> WallSamples:
    """Every sensor's radius in every row of a log file or set, where depth, toolface, radius and time are there."""
    found = source.readings(*given, **named)
    kept = []
    for row in range(found.rows):
        for sensor, radius in zip(found.sensors, found.radii, strict=True):
            time = 0.0 if found.time is None else found.time[row]
            toolface = (found.toolface[row] + sensor.mounting) % 360.0 % 360.0  # -1e-313 % 360.0 is 360.0
            sample = (found.depth[row], toolface, radius[row], time, row)
            if not np.isnan(sample).any():
                kept.append(sample)
    depth, toolface, radius, time, row = np.array(kept).reshape(-1, 5).T
    seconds = None if found.time is None else time
    return WallSamples(depth, toolface, radius, seconds, row.astype(int), found.rows, found.missing, found.notes)
