"""Make a well that is larger than memory in blocks; measure memory and time; compare it with walls made in memory.

    python -m bench.wells.large FOLDER [--samples 200000000] [--pitch 0.1] [--whole]

The command prints the largest memory of each worker; the bar is 1 GB. Then it makes some blocks in memory, from the
samples within their ``reach``, and compares vertices and logs bit for bit. With ``--whole``, for a well that fits, it
compares vertices, logs, zones and overview with those of the well made in one piece. FOLDER holds the well, 24 bytes a
sample. ``--one-group`` writes the well as a single row group, by polars, which takes 40 bytes of memory a sample;
pyarrow writes 67 million rows at most.
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
from helibore.runs.blocks import AS_STREAM
from helibore.runs.manifest import read_jobs
from helibore.runs.reprocess import connected, reprocess


def main() -> None:
    """Make the well in blocks, and compare it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--samples", type=int, default=200_000_000)
    parser.add_argument("--spacing", type=float, default=0.00002, help="metres from sample to sample")
    parser.add_argument("--pitch", type=float, default=0.1, help="metres from turn to turn")
    parser.add_argument("--one-group", action="store_true", help="write the well as a single row group")
    parser.add_argument("--upward", action="store_true", help="write the samples as if they were logged upwards")
    parser.add_argument("--whole", action="store_true", help="compare with the well made in one piece")
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    file = given.folder / "large.parquet"
    if not file.exists():
        write_well(file, 1, given.samples, given.spacing, given.upward)
    if given.one_group and not (alone := given.folder / "one-group.parquet").exists():
        import polars

        rows = polars.scan_parquet(file)
        rows.sink_parquet(alone, compression="snappy", row_group_size=given.samples, data_page_size=1 << 20)
    file = given.folder / "one-group.parquet" if given.one_group else file
    groups = parquet.read_metadata(file).num_row_groups
    pitch = -given.pitch if given.upward else given.pitch
    text = f'output = "out"\n[defaults.wall]\nbit_diameter = {BIT}\npitch = {pitch}\n{WHOLE}'
    (given.folder / "m.toml").write_text(text + f'[[well]]\nname = "L"\ncaliper = "{file.name}"\n')
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
    text = f"{given.samples:,} samples, {size / 1e9:.2f} GB of Parquet in {groups} row groups"
    print(f"{text}, {len(parts)} blocks, {logs.num_rows:,} turns")
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
    chosen = [hb.load(parts[number]) for number in random.choice(len(parts), min(5, len(parts)), replace=False)]
    ends = [part.reach(part.settings.first_vertex, part.settings.first_vertex + len(part)) for part in chosen]
    for part, columns in zip(chosen, _between(file, ends), strict=True):
        again = hb.Wall(**vars(part.settings))
        again.append(*columns)
        same = zip(part.vertices(), again.vertices(), strict=True)
        assert all(a.tobytes() == b.tobytes() for a, b in same), part
        turn, mine = part.settings.first_vertex // part.settings.sectors, again.logs()
        for name, values in {"DEQ": mine.equivalent_diameter, "C1": mine.c1, "DINSC": mine.inscribed_diameter}.items():
            assert logs[name].to_numpy()[turn : turn + len(mine)].tobytes() == values.tobytes(), (part, name)
        checked += len(part)
    print(f"{len(chosen)} blocks, {checked:,} vertices and their turns in the logs: the same bits as in memory")


def _between(file: Path, ends: list[tuple[float, float]]) -> list[np.ndarray]:
    """Return, for each pair of depths, the columns of the file's samples between them, in the order of the file."""
    found: list[list[np.ndarray]] = [[] for _ in ends]
    with parquet.ParquetFile(file, **AS_STREAM) as opened:
        for batch in opened.iter_batches(1 << 18, columns=["depth_m", "toolface_deg", "radius_m"]):
            rows = np.stack([column.to_numpy() for column in batch.columns])
            for kept, (low, high) in zip(found, ends, strict=True):
                kept.append(rows[:, (rows[0] >= low) & (rows[0] <= high)])
    return [np.concatenate(kept, axis=1) for kept in found]


if __name__ == "__main__":
    main()
