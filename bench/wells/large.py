"""One well larger than memory, in blocks: its memory, its time, and its bits beside those in one piece.

    python -m bench.wells.large FOLDER [--samples 200000000] [--whole]

Prints the largest memory of each worker. Then some stretches of the well are made in memory from the samples within
``reach`` and compared, bit for bit; ``--whole`` compares archive, logs and radii with the well made in one piece, for
one that fits. Bar: 1 GB a worker. FOLDER holds the well, 24 bytes a sample.
"""

from __future__ import annotations

import argparse
import shutil
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from pyarrow import parquet

import helibore as hb
from bench.wells.field import BIT, WHOLE, write_well
from bench.wells.throughput import peak
from helibore.runs.manifest import read_jobs
from helibore.runs.reprocess import connected, reprocess


def main() -> None:
    """Make the well, and compare."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--samples", type=int, default=200_000_000)
    parser.add_argument("--spacing", type=float, default=0.00002, help="metres from sample to sample")
    parser.add_argument("--upward", action="store_true")
    parser.add_argument("--whole", action="store_true")
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    file = given.folder / "large.parquet"
    if not file.exists():
        write_well(file, 1, given.samples, given.spacing, given.upward)
    pitch = -0.1 if given.upward else 0.1
    settings = {"bit_diameter": BIT, "pitch": pitch}
    text = f'output = "out"\n[defaults.wall]\nbit_diameter = {BIT}\npitch = {pitch}\n{WHOLE}'
    (given.folder / "m.toml").write_text(text + '[[well]]\nname = "L"\ncaliper = "large.parquet"\n')
    shutil.rmtree(given.folder / "out", ignore_errors=True)
    jobs = read_jobs(given.folder / "m.toml")
    with connected(None) as client:
        start = time.perf_counter()
        report = reprocess(jobs, client)
        print(f"{report.sentence()} {report.failed}; {time.perf_counter() - start:.0f} s", flush=True)
        print(f"memory of the workers, MB: {[round(of) for of in client.run(peak).values()]}", flush=True)
    parts = sorted((given.folder / "out/wells/L").glob("*.wall"))
    logs = parquet.ParquetFile(given.folder / "out/logs/well=L/logs-0.parquet").read()
    size = file.stat().st_size
    print(f"{given.samples:,} samples, {size / 1e9:.2f} GB of Parquet, {len(parts)} blocks, {logs.num_rows:,} turns")
    if given.whole:
        alone = [replace(job, output=f"{given.folder}/whole", block_samples=10**9) for job in jobs]
        shutil.rmtree(given.folder / "whole", ignore_errors=True)
        with connected(None) as client:
            print(reprocess(alone, client).sentence())
        whole = hb.load(given.folder / "whole/wells/L/L.wall")
        for part in map(hb.load, parts):
            first = part.settings.first_vertex
            same = zip(part.vertices(), whole.vertices(first, first + len(part)), strict=True)
            assert all(a.tobytes() == b.tobytes() for a, b in same), part
        for name in ("logs/well=L/logs-0.parquet", "zones/well=L/zones-0.parquet", "wells/L/L-overview.glb"):
            assert (given.folder / "out" / name).read_bytes() == (given.folder / "whole" / name).read_bytes(), name
        print("in one piece: the same vertices in every block, the same bytes of logs, zones and overview")
        return
    random, checked = np.random.default_rng(0), 0
    columns = np.stack([_column(file, name) for name in ("depth_m", "toolface_deg", "radius_m")])
    order = np.argsort(columns[0], kind="stable")
    columns = columns[:, order]
    start_depth = columns[0, -1 if given.upward else 0]
    for number in random.choice(len(parts), 5, replace=False):
        part = hb.load(parts[number])
        first = part.settings.first_vertex
        low, high = part.reach(first, first + len(part))
        rows = slice(*np.searchsorted(columns[0], [low, high + 1e-9]))
        again = hb.Wall(**settings, start_depth=float(start_depth), first_vertex=first, stop_vertex=first + len(part))
        again.append(*columns[:, rows])
        same = zip(part.vertices(), again.vertices(), strict=True)
        assert all(a.tobytes() == b.tobytes() for a, b in same), number
        checked += len(part)
    print(f"5 blocks, {checked:,} vertices: the same bits from all samples in memory")


def _column(file: Path, name: str) -> np.ndarray:
    return parquet.read_table(file, columns=[name]).column(0).to_numpy()


if __name__ == "__main__":
    main()
