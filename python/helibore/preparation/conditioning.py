"""What to leave out, and why: each step looks at the samples, changes nothing, and answers with a :class:`Step`.

    steps = [in_range(radius, 0.05, 0.5), spikes(toolface, radius, turn)]
    kept, counts = combine(steps)          # counts: {"range: below": 3, ..., "kept": 9881}; they add up to the samples

A step is a name, its settings, a mask of what it drops and a count for each reason. Steps do not see each other: apply
one, select, apply the next where order matters. Also here: travel time to radius. Not here: any repair of a value.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, column

__all__ = ["Echo", "Step", "closed", "combine", "in_range", "radius_of_travel_time", "repeated_rows", "spikes", "stuck"]

Mask = npt.NDArray[np.bool_]
_SAMPLES_AT_ONCE = 1 << 17


@dataclass(frozen=True)
class Step:
    """What one step found.

    Attributes
    ----------
    name
        Of the step.
    settings
        All that, with the samples, decides the result.
    dropped
        True where the sample is to be left out; of the shape of what was judged.
    counts
        Dropped samples for each reason; they add up to the dropped.
    unjudged
        Samples the step could not judge (too few neighbours); they are kept.
    """

    name: str
    settings: Mapping[str, float | int]
    dropped: Mask
    counts: Mapping[str, int] = field(default_factory=dict)
    unjudged: int = 0

    @property
    def kept(self) -> Mask:
        """The samples to go on with: not ``dropped``, a new array."""
        return ~self.dropped


def combine(steps: Sequence[Step]) -> tuple[Mask, dict[str, int]]:
    """Samples that no step drops, and a count for each step; a sample dropped by several counts for the first.

    Parameters
    ----------
    steps
        One or more, of one shape.

    Returns
    -------
    kept
        Mask of that shape, new.
    counts
        Step name to samples, and ``"kept"``; they add up to the number of samples. Steps of one name add up.

    Raises
    ------
    ValueError
        If there is no step, or the shapes differ.
    """
    if not steps:
        raise ValueError("steps: must have at least one")
    kept = np.ones(steps[0].dropped.shape, dtype=bool)
    counts: dict[str, int] = {}
    for step in steps:
        if step.dropped.shape != kept.shape:
            raise ValueError(f"step {step.name} has shape {step.dropped.shape}, {steps[0].name} has {kept.shape}")
        counts[step.name] = counts.get(step.name, 0) + int(np.count_nonzero(kept & step.dropped))
        kept &= ~step.dropped
    counts["kept"] = int(np.count_nonzero(kept))
    return kept, counts


def in_range(values: npt.ArrayLike, low: float, high: float) -> Step:
    """Drop what is missing (NaN), below ``low`` or above ``high`` (both inclusive limits), each counted.

    Parameters
    ----------
    values
        (n,), any unit; NaN is missing.
    low, high
        Of the same unit.

    Raises
    ------
    ValueError
        If low > high or either is NaN.
    """
    array = column("values", values)
    if not low <= high:
        raise ValueError(f"low = {low:g}, high = {high:g}: low must not be larger than high")
    missing, below, above = np.isnan(array), array < low, array > high
    counts = {name: int(np.count_nonzero(m)) for name, m in (("missing", missing), ("below", below), ("above", above))}
    return Step("range", {"low": low, "high": high}, missing | below | above, counts)


def spikes(
    toolface: npt.ArrayLike,
    radius: npt.ArrayLike,
    turn: npt.ArrayLike,
    *,
    neighbors: int = 4,
    threshold: float = 6.0,
    floor: float = 0.0005,
) -> Step:
    """Drop samples that stand out from those around them in their own turn (Hampel's identifier).

    In each turn the samples stand in a ring, by toolface. A sample is compared with the median of the 2 * neighbors + 1
    around it, itself among them, and dropped when it is farther off than ``threshold`` deviations, deviation = 1.4826
    times the median distance from that median. The edge of a breakout, seen by half of the ring's window or more,
    stays; a feature narrower than half the window does not.

    Parameters
    ----------
    toolface, radius, turn
        Degrees, metres (NaN: left alone, not counted), whole numbers; (n,).
    neighbors
        To each side, at least 1. Turns with fewer than 2 * neighbors + 1 radii are not judged.
    threshold
        In deviations.
    floor
        Least deviation, m: what noise alone may do. Quantised radii need about one step, for their median distance is
        often 0.

    Notes
    -----
    Hampel, J. Am. Stat. Assoc. 69 (1974) 383; 1.4826 = 1 / 0.6745, the quartile of the normal distribution.
    """
    angle = column("toolface", toolface)
    distance = column("radius", radius, angle.size, "toolface")
    number = column("turn", turn, angle.size, "toolface")
    if neighbors < 1:
        raise ValueError(f"neighbors = {neighbors}: must be at least 1")
    if not (threshold > 0 and floor > 0):
        raise ValueError(f"threshold = {threshold:g}, floor = {floor:g}: must be larger than 0")
    present = np.flatnonzero(np.isfinite(distance))
    order = present[np.lexsort((angle[present] % 360.0, number[present]))]
    _, first, count = np.unique(number[order], return_index=True, return_counts=True)
    first, count = np.repeat(first, count), np.repeat(count, count)
    judged = np.flatnonzero(count >= 2 * neighbors + 1)
    ring, offsets = distance[order], np.arange(-neighbors, neighbors + 1)
    dropped = np.zeros(angle.size, dtype=bool)
    for start in range(0, judged.size, _SAMPLES_AT_ONCE):
        at = judged[start : start + _SAMPLES_AT_ONCE]
        around = ring[first[at, None] + ((at - first[at])[:, None] + offsets) % count[at, None]]
        middle = np.median(around, axis=1)
        deviation = 1.4826 * np.median(np.abs(around - middle[:, None]), axis=1)
        dropped[order[at]] = np.abs(ring[at] - middle) > threshold * np.maximum(deviation, floor)
    settings = {"neighbors": neighbors, "threshold": threshold, "floor": floor}
    return Step("spikes", settings, dropped, {"spike": int(np.count_nonzero(dropped))}, order.size - judged.size)


def stuck(arms: Sequence[npt.ArrayLike], *, rows: int = 50, moving: float = 0.5) -> Step:
    """Drop stretches in which one arm (or sector) stands still, or is silent, while the others move.

    Parameters
    ----------
    arms
        Two or more columns of readings in the order they were taken, (n,) each; NaN is missing.
    rows
        Shortest stretch of one and the same reading.
    moving
        The others' mean share of rows in which their reading changed, within the stretch, from which on standing still
        is a fault: in a smooth pipe all arms rest together, and none is to blame.

    Returns
    -------
    Step
        ``dropped`` is (arms, n). Reasons ``stuck`` (one value) and ``dead`` (missing throughout).
    """
    if len(arms) < 2:
        raise ValueError(f"arms has {len(arms)} columns: must have at least 2, to compare")
    if rows < 2 or not 0 < moving <= 1:
        raise ValueError(f"rows = {rows}, moving = {moving:g}: rows must be at least 2, moving in (0, 1]")
    values = _table("arms", arms)
    count = values.shape[1]
    changed = np.ones(values.shape, dtype=bool)
    changed[:, 1:] = (values[:, 1:] != values[:, :-1]) & ~(np.isnan(values[:, 1:]) & np.isnan(values[:, :-1]))
    moves = np.zeros((len(values), count + 1), dtype=np.int64)
    np.cumsum(changed, axis=1, out=moves[:, 1:])
    total = moves.sum(axis=0)
    dropped, counts = np.zeros(values.shape, dtype=bool), {"stuck": 0, "dead": 0}
    for arm in range(len(values)):
        first = np.flatnonzero(changed[arm])
        last = np.append(first[1:], count)
        others = total - moves[arm]
        share = (others[last] - others[np.minimum(first + 1, last)]) / (
            (len(values) - 1) * np.maximum(last - first - 1, 1)
        )
        fault = (last - first >= rows) & (share >= moving)
        dropped[arm] = np.repeat(fault, last - first)
        silent = int(np.count_nonzero(dropped[arm] & np.isnan(values[arm])))
        counts["dead"] += silent
        counts["stuck"] += int(np.count_nonzero(dropped[arm])) - silent
    return Step("stuck", {"rows": rows, "moving": moving}, dropped, counts)


def repeated_rows(*columns: npt.ArrayLike) -> Step:
    """Drop rows that equal an earlier row in every column given; the first of them stays. NaN equals NaN.

    Parameters
    ----------
    *columns
        One or more, (n,). Leave out what may differ between copies, such as a time of arrival.
    """
    if not columns:
        raise ValueError("columns: must have at least one")
    values = _table("columns", columns)
    order = np.lexsort(values)  # stable: among equals the earliest comes first
    ahead, behind = values[:, order[1:]], values[:, order[:-1]]
    same = np.all((ahead == behind) | (np.isnan(ahead) & np.isnan(behind)), axis=0)
    dropped = np.zeros(values.shape[1], dtype=bool)
    dropped[order[1:]] = same
    return Step("repeated rows", {"columns": len(columns)}, dropped, {"repeated": int(np.count_nonzero(same))})


def closed(arms: Sequence[npt.ArrayLike], radius: float, *, tolerance: float = 0.002, margin: int = 0) -> Step:
    """Drop rows taken with the caliper closed: no arm reads more than the closed radius plus a tolerance.

    Parameters
    ----------
    arms
        One or more columns of readings, (n,), in the order they were taken; NaN is missing. A row without any reading
        is not judged.
    radius
        Of the closed tool, in the unit of the readings.
    tolerance
        What a closed arm may read more, same unit.
    margin
        Rows before and after a closed stretch that go with it, while the arms open and close.

    Returns
    -------
    Step
        ``dropped`` is (n,), of rows. Reasons ``closed`` and ``margin``.
    """
    if not radius > 0 or not tolerance >= 0 or margin < 0:
        raise ValueError(
            f"radius = {radius:g}, tolerance = {tolerance:g}, margin = {margin}: radius must be larger than 0, "
            "the others not negative"
        )
    if not len(arms):
        raise ValueError("arms: must have at least one column")
    values = _table("arms", arms)
    silent = np.all(np.isnan(values), axis=0)
    shut = ~np.any(values > radius + tolerance, axis=0) & ~silent
    before = np.concatenate([[0], np.cumsum(shut)])
    at = np.arange(shut.size)
    low, high = np.maximum(at - margin, 0), np.minimum(at + margin + 1, shut.size)
    near = before[high] > before[low]
    counts = {"closed": int(np.count_nonzero(shut)), "margin": int(np.count_nonzero(near & ~shut))}
    settings = {"radius": radius, "tolerance": tolerance, "margin": margin}
    return Step("closed", settings, near, counts, int(np.count_nonzero(silent)))


def radius_of_travel_time(
    travel_time: npt.ArrayLike, tool_radius: float, velocity: float, window: float = 0.0
) -> Floats:
    """Radius from an echo: tool_radius + velocity * (travel_time - window) / 2, there and back through the mud.

    Parameters
    ----------
    travel_time
        Two-way time, seconds, (n,); NaN stays NaN.
    tool_radius
        From the tool's axis to the face of its transducer, m.
    velocity
        Of sound in the mud, m/s; about 1500 in water.
    window
        What the echo spends inside the tool, behind the window of the transducer, there and back, seconds.

    Returns
    -------
    ndarray
        Metres from the tool's axis, (n,) float64, new.

    Raises
    ------
    ValueError
        If tool_radius < 0, velocity <= 0 or window < 0, or a time is infinite or shorter than the window.
    """
    if not (tool_radius >= 0 and velocity > 0 and window >= 0 and np.isfinite(tool_radius + velocity + window)):
        raise ValueError(
            f"tool_radius = {tool_radius:g}, velocity = {velocity:g}, window = {window:g}: "
            "velocity must be larger than 0, the others not negative, all finite"
        )
    time = column("travel_time", travel_time)
    bad = np.isinf(time) | (time < window)
    if bad.any():
        at = int(np.argmax(bad))
        raise ValueError(
            f"travel_time[{at}] = {time[at]:g}: must be finite and not shorter than the window, {window:g}"
        )
    return tool_radius + 0.5 * velocity * (time - window)


@dataclass(frozen=True)
class Echo:
    """How a travel time becomes a radius; see :func:`radius_of_travel_time`.

    Attributes
    ----------
    velocity
        Of sound in the mud, m/s.
    tool_radius
        From the tool's axis to the face of its transducer, m.
    window
        What the echo spends inside the tool, seconds.
    """

    velocity: float
    tool_radius: float
    window: float = 0.0

    def __post_init__(self) -> None:
        radius_of_travel_time([], self.tool_radius, self.velocity, self.window)

    def radius(self, travel_time: Floats) -> Floats:
        """Radii of travel times of any shape, m; a time shorter than the window is no echo: NaN."""
        late = np.where(travel_time >= self.window, travel_time, np.nan)
        flat = radius_of_travel_time(late.ravel(), self.tool_radius, self.velocity, self.window)
        return flat.reshape(travel_time.shape)


def _table(name: str, columns: Sequence[npt.ArrayLike]) -> Floats:
    """Columns of one length as the rows of an array."""
    first = column(f"{name}[0]", columns[0])
    rest = [column(f"{name}[{i}]", columns[i], first.size, f"{name}[0]") for i in range(1, len(columns))]
    return np.stack([first, *rest])
