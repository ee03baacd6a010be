"""Gather the diameters along the hole for the caliper track: a row for each turn, or for several turns.

A row of several turns has the least of their least diameters, and the greatest of their greatest diameters, C1 and C2,
so that a washout of a single turn stays visible. Its other columns are means. Logs for files are in
``helibore.logs.turn_logs``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from helibore.base.arrays import Floats, distinct
from helibore.logs.turn_logs import Logs
from helibore.samples.helix import WallLike


@dataclass(frozen=True)
class Diameters:
    """One row per turn from the shallowest to the deepest, each (rows,) float64, metres; NaN where missing.

    ``area`` and ``c1`` to ``d90`` are `Logs.equivalent_diameter`, ``c1``, ``c2``, ``diameter_0`` and ``diameter_90``.
    """

    depth: Floats  # middle of the turn
    area: Floats
    c1: Floats
    c2: Floats
    d0: Floats
    d90: Floats
    least: Floats  # smallest diameter through the axis, from the known radii; for a tool with few arms, from its arms
    greatest: Floats  # largest diameter through the axis, from the same source
    coverage: Floats  # share of the turn that has a radius, measured or interpolated


def diameters(wall: WallLike, logs: Logs) -> Diameters:
    """Return the diameters of every full turn of a wall, from the shallowest; ``logs`` are the logs of these turns."""
    K = wall.settings.sectors
    by_turn = wall.radius[: logs.depth.size * K].reshape(-1, K)
    half = K // 2  # if K is odd, the far side is the mean of two vertices
    far = 0.5 * (np.roll(by_turn, -half, axis=1) + np.roll(by_turn, -((K + 1) // 2), axis=1))
    across = by_turn + far
    whole = (logs.depth, logs.equivalent_diameter, logs.c1, logs.c2, logs.diameter_0, logs.diameter_90)
    ends = np.fmin.reduce(across, axis=1), np.fmax.reduce(across, axis=1)
    if logs.shape == "arms":  # the wall between the arms is rounder than the hole
        ends = logs.least_diameter, logs.c1
    order = slice(None) if wall.settings.pitch > 0 else slice(None, None, -1)
    return Diameters(*(column[order] for column in (*whole, *ends, np.isfinite(by_turn).mean(axis=1))))


def thinned(turns: Diameters, top: float, bottom: float, rows: int) -> Diameters:
    """Return the turns between two depths in at most ``rows`` rows; if there are more turns, a row joins several."""
    inside = slice(np.searchsorted(turns.depth, top), np.searchsorted(turns.depth, bottom, side="right"))
    columns = {name: column[inside] for name, column in vars(turns).items()}
    count = columns["depth"].size
    if count <= rows:
        return Diameters(**columns)
    first = distinct(np.arange(rows) * count // rows)
    sizes = np.diff(np.append(first, count))
    found = {name: np.add.reduceat(columns[name], first) / sizes for name in ("depth", "coverage")}
    found["least"] = np.fmin.reduceat(columns["least"], first)
    found |= {name: np.fmax.reduceat(columns[name], first) for name in ("greatest", "c1", "c2")}
    for name in ("area", "d0", "d90"):  # only in rows in which at least half of the turns are whole
        there = np.isfinite(columns[name])
        total = np.add.reduceat(np.where(there, columns[name], 0.0), first)
        known = np.add.reduceat(there.astype(np.float64), first)
        found[name] = np.where(2 * known >= sizes, total / np.maximum(known, 1), np.nan)
    return Diameters(**found)
