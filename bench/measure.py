"""Measure the time of several functions, here called works, alternately in one run on the same machine."""

from __future__ import annotations

import platform
import statistics
import time
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

import helibore as hb
from helibore import _core
from helibore.base.thread_count import thread_count

A_ROUND = 0.1  # seconds
PEERS = ("pykdtree", "scipy")
"""Libraries to compare with. The extra `bench` fixes their versions, so that only helibore changes a ratio."""


def repeated(work: Callable[[], object], until: Callable[[], bool] | None = None) -> float:
    """Return the mean seconds of a work, repeated for `A_ROUND`, or until ``until`` is true, without keeping results.

    The work runs once before it is measured, so that the caches and pages that another work left behind do not count. A
    round of less than `A_ROUND` would not do: a machine shared with others is fast in one moment and slow in the next.
    """
    work()
    took: list[float] = []
    while not took or (sum(took) < A_ROUND if until is None else not until()):
        start = time.perf_counter()
        result = work()
        took.append(time.perf_counter() - start)
        del result
    return statistics.mean(took)


def in_turn(works: dict[str, Callable[[], object]], rounds: int) -> dict[str, list[float]]:
    """Return, by name of work, the seconds in each round, as `repeated` measures them; a round measures every work."""
    seconds: dict[str, list[float]] = {name: [] for name in works}
    for _ in range(rounds):
        for name, work in works.items():
            seconds[name].append(repeated(work))
    return seconds


def ratio(above: list[float], below: list[float]) -> dict[str, float]:
    """Return median, least and greatest of the ratios of the rounds, and the ratio of the least times, "undisturbed".

    On an undisturbed machine, all ratios would be near this last ratio, because other programs can only add to a time.
    """
    ratios = [a / b for a, b in zip(above, below, strict=True)]
    least = min(above) / min(below)
    return {"median": statistics.median(ratios), "least": min(ratios), "greatest": max(ratios), "undisturbed": least}


def milliseconds(seconds: list[float]) -> float:
    """Return the median of times in seconds, in milliseconds."""
    return 1000 * statistics.median(seconds)


def machine() -> dict[str, Any]:
    """Return the machine on which the figures were measured: processor, cores, versions."""
    processor = "unknown"
    names = Path("/proc/cpuinfo")
    if names.exists():
        processor = next(
            (line.split(":")[1].strip() for line in names.open() if line.startswith("model name")), processor
        )
    return {
        "processor": processor,
        "cores": thread_count(None),
        "instruction_set": _core.instruction_set_in_use(),
        "helibore": hb.__version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
        **{name: metadata.version(name) for name in PEERS},
    }
