"""Wells an hour on a local Dask cluster of two workers, beside two plain processes that share the same wells.

    python -m bench.wells.throughput FOLDER [--wells 200] [--samples 500000] [--rounds 5]

Both do the same work on the same files, input and output included (archive and logs, one thread of the core each), in
turn, a share of the wells a round. The bar: the cluster at least 0.9 of the processes. FOLDER holds the field, 14 MB a
well, for the next run.
"""

from __future__ import annotations

import argparse
import multiprocessing
import shutil
import statistics
import time
from dataclasses import replace
from pathlib import Path

from bench.wells.field import write_field
from helibore.runs.manifest import Job, read_jobs
from helibore.runs.reprocess import connected, reprocess
from helibore.runs.well import reprocess_well


def plain(jobs: list[Job]) -> float:
    """Make some wells in this process; return the processor time."""
    start = time.process_time()
    for job in jobs:
        reprocess_well(job)
    return time.process_time() - start


def peak(_: int = 0) -> float:
    """Return the largest memory of this process so far, MB."""
    text = Path("/proc/self/status").read_text()
    return int(text.split("VmHWM:")[1].split()[0]) / 1024


def main() -> None:
    """Print the wells a second of both in each round, and the median of the ratios."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--wells", type=int, default=200)
    parser.add_argument("--samples", type=int, default=500_000)
    parser.add_argument("--rounds", type=int, default=5)
    given = parser.parse_args()
    jobs = read_jobs(write_field(given.folder, given.wells, given.samples, head='outputs = ["archive", "logs"]\n'))
    share = len(jobs) // given.rounds
    ratios = []
    with connected(None) as client, multiprocessing.get_context("spawn").Pool(2) as pool:
        for some in ([jobs[0], jobs[1]], *(jobs[at * share : (at + 1) * share] for at in range(given.rounds))):
            ours, theirs = (
                [replace(job, output=f"{given.folder}/{name}") for job in some] for name in ("dask", "plain")
            )
            start = time.perf_counter()
            cpu = sum(pool.map(plain, [theirs[::2], theirs[1::2]], chunksize=1))
            middle = time.perf_counter()
            reprocess(ours, client)
            stop = time.perf_counter()
            ratios.append((middle - start) / (stop - middle))
            text = (
                f"plain {1e3 * (middle - start) / len(some):.1f} ms a well ({1e3 * cpu / len(some):.1f} of processors)"
            )
            print(f"{text}, dask {1e3 * (stop - middle) / len(some):.1f} ms, ratio {ratios[-1]:.3f}", flush=True)
            for name in ("dask", "plain"):
                shutil.rmtree(given.folder / name)
        memory = max(client.run(peak).values())
    print(f"median ratio {statistics.median(ratios[1:]):.3f}; a worker took {memory:.0f} MB at most")


if __name__ == "__main__":
    main()
