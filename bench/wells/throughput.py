"""Compare a local Dask cluster of two workers with two plain processes that share the same wells.

    python -m bench.wells.throughput FOLDER [--wells 200] [--samples 500000] [--rounds 10]

Cluster and plain processes do the same work on the same files, from input to archive and logs, with one core thread in
each process. In each round they make the same share of the wells, one after the other; the cluster begins in every
second round. ``ratio`` is the speed of the cluster over that of the plain processes; the bar is 0.9. ``ratio of
processor times`` is the processor time of the plain processes over that of workers, scheduler and client; other
programs on the machine hardly change it.
FOLDER keeps the wells, 11 MB each, for the next run. On two quiet processors 200 wells take about three minutes, and
the first run takes one minute more to write the files.
"""

from __future__ import annotations

import argparse
import multiprocessing
import shutil
import statistics
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

from bench.wells.field import write_field
from helibore.runs.manifest import Job, read_jobs
from helibore.runs.reprocess import connected, reprocess
from helibore.runs.well import reprocess_well


def plain(jobs: list[Job]) -> float:
    """Make some wells in this process; return the seconds of processor time."""
    start = time.process_time()
    for job in jobs:
        reprocess_well(job)
    return time.process_time() - start


def peak(_: int = 0) -> float:
    """Return the largest memory of this process so far, MB."""
    text = Path("/proc/self/status").read_text()
    return int(text.split("VmHWM:")[1].split()[0]) / 1024


def by_plain(pool: Any, jobs: list[Job]) -> tuple[float, float]:
    """Make wells in two plain processes; return seconds and processor seconds."""
    start = time.perf_counter()
    used = sum(pool.map(plain, [jobs[::2], jobs[1::2]], chunksize=1))
    return time.perf_counter() - start, used


def by_dask(client: Any, jobs: list[Job]) -> tuple[float, float]:
    """Make wells on the cluster; return seconds, and processor seconds of workers, scheduler and client together."""

    def used() -> float:
        return time.process_time() + sum(client.run(time.process_time).values())

    before, start = used(), time.perf_counter()
    failed = reprocess(jobs, client).failed
    seconds = time.perf_counter() - start
    assert not failed, failed
    return seconds, used() - before


def main() -> None:
    """Print the seconds of cluster and plain processes in each round, and the ratios."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--wells", type=int, default=200)
    parser.add_argument("--samples", type=int, default=500_000)
    parser.add_argument("--rounds", type=int, default=10)
    given = parser.parse_args()
    jobs = read_jobs(write_field(given.folder, given.wells, given.samples, head='outputs = ["archive", "logs"]\n'))
    shares = [jobs[at :: given.rounds] for at in range(given.rounds)]
    ratios, processors = [], []
    with connected(None) as client, multiprocessing.get_context("spawn").Pool(2) as pool:
        for number, some in enumerate([jobs[:4], *shares]):  # the first round loads the libraries and is not counted
            ours, theirs = (
                [replace(job, output=f"{given.folder}/{name}") for job in some] for name in ("dask", "plain")
            )
            turns = [lambda of=theirs: by_plain(pool, of), lambda of=ours: by_dask(client, of)]
            first, second = (turns[at]() for at in ((0, 1) if number % 2 else (1, 0)))
            (one, one_used), (many, many_used) = (first, second) if number % 2 else (second, first)
            text = f"{len(some)} wells: plain {one:.2f} s ({one_used:.2f} of processors), dask {many:.2f} s"
            print(f"{text} ({many_used:.2f}), ratio {one / many:.3f}{'' if number else ', not counted'}", flush=True)
            if number:
                ratios.append(one / many)
                processors.append((one_used, many_used))
            for name in ("dask", "plain"):
                shutil.rmtree(given.folder / name)
        memory, alone = client.run(peak), pool.map(peak, range(2), chunksize=1)
    middle, low, high = statistics.median(ratios), min(ratios), max(ratios)
    print(f"ratio {middle:.3f} (median of {len(ratios)} rounds, {low:.3f} to {high:.3f}); the bar is 0.9")
    one_used, many_used = map(sum, zip(*processors, strict=True))
    each = [f"{1e3 * used / len(jobs):.0f}" for used in (one_used, many_used)]
    print(f"ratio of processor times {one_used / many_used:.3f}: {each[0]} ms a well plain, {each[1]} ms on Dask")
    print(f"peak memory, MB: workers {[round(of) for of in memory.values()]}, plain {[round(of) for of in alone]}")


if __name__ == "__main__":
    main()
