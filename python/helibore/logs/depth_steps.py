"""Combine logs with one row per turn into logs with one row per step of depth.

    |--o----o----o--|--o----o----o----o--|      a turn belongs to the step that holds its middle
       step i              step i + 1           ``log_columns`` has the rule of each log

Areas are averaged, not diameters; the volume of a step is its mean area times its height, whatever the pitch. A step
has a row only if its turns reach within half a pitch of both ends of the step.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from helibore.base.angles import wrapped
from helibore.base.arrays import Floats, Integers
from helibore.base.errors import InputError
from helibore.logs.late_columns import LateColumns
from helibore.logs.log_columns import CIRCLE, COLUMNS, INNER, LOBES, SHAPE_SIGMA, WORN

_EXTREMES = {"least": np.minimum, "greatest": np.maximum, "least there": np.fmin, "greatest there": np.fmax}

ALIKE_ALONG = 0.22
"""Metres along the hole over which the errors of a wall are alike (``python -m bench.accuracy.amounts``)."""
MEASURED = 0.9
"""Least share of each turn with samples near where errors along the hole are independent."""


def by_step(columns: Mapping[str, Any], pitch: float, bit_diameter: float, step: float) -> dict[str, Any]:
    """Return, by name, the columns of `Logs.by_step` from the columns of turns."""
    if not (math.isfinite(step) and step >= abs(pitch) * (1 - 1e-9)):
        raise InputError("step", f"must be at least the pitch, {abs(pitch):g} m", f"{step:g}", "logs.step")
    order = slice(None) if pitch > 0 else slice(None, None, -1)
    number, turns, starts = _steps(columns["depth"][order], abs(pitch), step)

    def gather(values: Floats, rule: str) -> Floats:
        return _gather(values[order][turns], starts, rule)

    def worn() -> dict[str, Floats]:
        of_turns = columns["worn"]
        highest = _greatest(of_turns["lobe1_height"][order][turns], starts)
        lobes = {name: of_turns[name][order][turns][highest] for name in LOBES}
        return {name: gather(of_turns[name], "mean") for name in CIRCLE} | lobes

    def uncertain() -> dict[str, Floats]:
        return {name: gather(of, "mean") for name, of in columns["uncertain"].items()}

    inside = columns["depth"][order][turns].size
    rules = {of.name: of.by_step for of in COLUMNS} | dict.fromkeys(INNER, "mean")
    square = gather((columns["equivalent_diameter"] / 2) ** 2, "mean")
    return {
        **{name: gather(columns[name], rule) for name, rule in rules.items() if rule != "own"},
        "worn": LateColumns(WORN, worn),
        "uncertain": None if columns["uncertain"] is None else LateColumns(tuple(SHAPE_SIGMA), uncertain),
        "arm_diameter": tuple(gather(of, "mean") for of in columns["arm_diameter"]),
        "depth": (number.astype(np.float64) + 0.5) * float(step),
        "equivalent_diameter": 2 * np.sqrt(square),
        "diameter_sigma": _sigma(
            gather(columns["diameter_sigma"] ** 2, "mean"),
            gather(columns["sampled"], "least"),
            np.diff(starts, append=inside) * abs(pitch) / (ALIKE_ALONG * gather(columns["alike"], "mean")),
            2 * np.hypot(columns["caliper_accuracy"], gather(columns["shared_sigma"], "mean")),
        ),
        "c1_toolface": _axis(columns["c1_toolface"][order][turns], starts),
        "volume": np.pi * square * step,
        "excess": square / (bit_diameter / 2) ** 2 - 1,
    }


def _sigma(square: Floats, sampled: Floats, independent: Floats, shared: Floats) -> Floats:
    """Return the uncertainty of the mean of a step from the mean square of its turns' and the number of their errors.

    Where the hole is interpolated, its errors are those of a shape that goes on along it, and all turns have one error;
    ``shared`` is the part that the errors of all turns always share.
    """
    count = np.where(sampled >= MEASURED, np.maximum(independent, 1.0), 1.0)
    found: Floats = np.sqrt(np.maximum(square - shared**2, 0.0) / count + shared**2)
    return found


def _steps(depth: Floats, pitch: float, step: float) -> tuple[Integers, slice, Integers]:
    """Return the numbers of the steps that have a row, the slice of the turns in these steps, and the first turn of
    each step, counted in that slice.
    """
    if not depth.size:
        return np.empty(0, np.int64), slice(0, 0), np.empty(0, np.int64)
    number = np.floor(depth / step + 1e-9).astype(np.int64)
    reach = pitch * (0.5 + 1e-6)
    first = number[0] if depth[0] - pitch / 2 <= number[0] * step + reach else number[0] + 1
    last = number[-1] if depth[-1] + pitch / 2 >= (number[-1] + 1) * step - reach else number[-1] - 1
    turns = slice(*np.searchsorted(number, (first, max(first, last + 1))).tolist())
    inside = number[turns]
    starts = np.flatnonzero(np.diff(inside, prepend=first - 1)).astype(np.int64)
    return inside[starts], turns, starts


def _gather(values: Floats, starts: Integers, rule: str) -> Floats:
    if not values.size:
        return values.copy()
    if rule == "mean":
        mean: Floats = np.add.reduceat(values, starts) / np.diff(starts, append=values.size)
        return mean
    extreme: Floats = _EXTREMES[rule].reduceat(values, starts)
    return extreme


def _greatest(values: Floats, starts: Integers) -> Integers:
    """Return where each step has its greatest value, or its first place if all values are NaN, (steps,)."""
    if not values.size:
        return np.empty(0, np.int64)
    known = np.where(np.isnan(values), -math.inf, values)
    most = np.repeat(np.maximum.reduceat(known, starts), np.diff(starts, append=values.size))
    places = np.where(known == most, np.arange(values.size), values.size)
    return np.minimum.reduceat(places, starts)


def _axis(toolface: Floats, starts: Integers) -> Floats:
    """Return the mean axis of each step, degrees in [0, 180).

    It is half the direction of the mean of doubled angles, because axes of 1 and 179 degrees are near each other.
    """
    if not toolface.size:
        return toolface.copy()
    mean = np.add.reduceat(np.exp(2j * np.radians(toolface)), starts)
    return wrapped(np.degrees(np.angle(mean)) / 2, 180.0)
