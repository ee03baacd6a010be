"""Measure what a second core gains: compare two threads with two processes, which share nothing but the machine.

On a machine that others also use, cores are not alike. A core that shares its arithmetic with a busy neighbour runs at
three quarters of its speed, for milliseconds or for minutes. At times our two cores are the two halves of one physical
core. Therefore

- the time of one core is the time at the mean speed of the two cores, each measured by itself;
- two processes, each on a core, do the same work, and two other processes only count, without memory. If the processes
  gain less than a factor of 2, threads cannot gain more than they do.
"""

from __future__ import annotations

import multiprocessing
import os
import statistics
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from bench.measure import milliseconds, ratio, repeated
from bench.speed.reconstruction import CASES, reconstruct, samples


@contextmanager
def on_cores(cores: set[int]) -> Iterator[None]:
    """Run the block on these cores, with one thread for each of them."""
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, cores)
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


def count() -> int:
    """Do arithmetic in registers for a few milliseconds; return the result."""
    total = 0
    for i in range(100_000):
        total += i & 7
    return total


def work_on(name: str, order: str) -> Callable[[], object]:
    """Return a function that rebuilds the radii of a wall from raw arrays."""
    data = samples(*CASES[name], order)
    return lambda: reconstruct(data).radius


class Neighbour:
    """Another process, on a separate core.

    While `beside` repeats a work here, this process repeats the same work, and then reports its mean seconds.
    """

    def __init__(self, core: int, name: str, order: str) -> None:
        context = multiprocessing.get_context("spawn")
        self._here, there = context.Pipe()
        self._stop = context.Event()
        self._process = context.Process(target=_serve, args=(there, self._stop, core, name, order), daemon=True)
        self._process.start()
        self._here.recv()

    def beside(self, what: str, work: Callable[[], object]) -> tuple[float, float]:
        """Return the seconds of a work here and in the other process, while both run."""
        self._stop.clear()
        self._here.send(what)
        self._here.recv()
        here = repeated(work)
        self._stop.set()
        return here, self._here.recv()

    def __enter__(self) -> Neighbour:
        return self

    def __exit__(self, *_: object) -> None:
        self._here.send(None)
        self._process.join()


def _serve(there: Any, stop: Any, core: int, name: str, order: str) -> None:
    works = {"wall": work_on(name, order), "count": count}
    os.sched_setaffinity(0, {core})
    there.send("ready")
    while what := there.recv():
        there.send("at it")
        there.send(repeated(works[what], until=stop.is_set))


def at_mean_speed(seconds: list[float]) -> float:
    """Return the seconds that a work would take at the mean speed of some cores, on which it took ``seconds``."""
    return statistics.harmonic_mean(seconds)


def on(core: int, work: Callable[[], object]) -> float:
    """Return the seconds of a work on one core."""
    with on_cores({core}):
        return repeated(work)


def case(name: str, order: str, rounds: int) -> dict[str, Any]:
    """Return how many times as fast two threads and two processes are as one core, on one set of samples."""
    first, second = sorted(os.sched_getaffinity(0))[:2]
    works = {"wall": work_on(name, order), "count": count}
    one: dict[str, list[float]] = {what: [] for what in works}
    processes: dict[str, list[float]] = {what: [] for what in works}
    threads: list[float] = []
    with Neighbour(second, name, order) as neighbour:
        for _ in range(rounds):
            with on_cores({first, second}):
                threads.append(repeated(works["wall"]))
            for what, work in works.items():
                one[what].append(at_mean_speed([on(first, work), on(second, work)]))
                with on_cores({first}):
                    both = neighbour.beside(what, work)
                processes[what].append(at_mean_speed(list(both)) / 2)  # both works are done in this time
    return {
        "case": f"{name}, {order}",
        "two threads": ratio(one["wall"], threads),
        "two processes": ratio(one["wall"], processes["wall"]),
        "two that only count": ratio(one["count"], processes["count"]),
        "two threads / two processes": ratio(processes["wall"], threads),
        "milliseconds": {"one": milliseconds(one["wall"]), "threads": milliseconds(threads)},
    }


def cases(rounds: int = 31) -> list[dict[str, Any]]:
    """Return the results of both sizes, as recorded (by depth) and in random order; [] on a machine with one core."""
    if len(os.sched_getaffinity(0)) < 2:
        return []
    return [case(name, order, rounds) for name in CASES for order in ("as recorded", "in random order")]
