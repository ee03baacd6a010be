"""Simulated wells as Parquet files, and a manifest of them: for the benchmarks and slow tests of many wells."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pyarrow
from pyarrow import parquet

BIT = 0.2159
WHOLE = "[defaults.preparation]\nsaturated = false\ndrop_closed = false\n"


def columns(seed: int, first: int, stop: int, spacing: float) -> dict[str, np.ndarray]:
    """Return samples [first, stop) of a tool, ten a turn, ``spacing`` metres apart; with equal depths and a gap."""
    random = np.random.default_rng([seed, first])
    k = np.arange(first, stop)
    depth = 1000.0 + k * spacing + random.uniform(-2, 2, k.size) * spacing
    depth[::50] = np.round(depth[::50], 2)  # equal depths
    depth[k * spacing > 60.0] += 2.5  # no sample in 2.5 m of hole
    toolface = (36.7 * k + random.uniform(-9, 9, k.size)) % 360.0
    phi, along = np.radians(toolface), depth / 3.0
    radius = (
        BIT / 2 + 0.006 * (1 + np.sin(along)) * (1 + np.cos(2 * phi + 0.1 * along)) + random.normal(0, 3e-4, k.size)
    )
    return {"depth_m": depth, "toolface_deg": toolface, "radius_m": radius}


def write_well(path: Path, seed: int, samples: int, spacing: float, upward: bool = False) -> None:
    """Write a well as one Parquet file, a million rows at a time; ``upward``: deepest sample first."""
    parts = [(first, min(first + 1_000_000, samples)) for first in range(0, samples, 1_000_000)]
    writer = None
    for first, stop in parts[::-1] if upward else parts:
        rows = columns(seed, first, stop, spacing)
        table = pyarrow.table({name: values[::-1] if upward else values for name, values in rows.items()})
        writer = writer or parquet.ParquetWriter(path, table.schema, write_page_checksum=True)
        writer.write_table(table)
    if writer is not None:
        writer.close()


def write_field(
    folder: Path, wells: int, samples: int, spacing: float = 0.0004, head: str = "", wall: str = ""
) -> Path:
    """Write wells that ``folder`` does not hold yet, and a manifest of all; return the manifest's file.

    ``head`` is added to the top of the manifest, ``wall`` to the settings of the wall.
    """
    folder.mkdir(parents=True, exist_ok=True)
    text = f'output = "out"\n{head}[defaults.wall]\nbit_diameter = {BIT}\n{wall}{WHOLE}'
    missing = [number for number in range(wells) if not (folder / f"{number}.parquet").exists()]
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        made = [pool.submit(write_well, folder / f"{number}.parquet", number, samples, spacing) for number in missing]
        for one in made:
            one.result()
    for number in range(wells):
        text += f'[[well]]\nname = "W{number:03}"\ncaliper = "{number}.parquet"\n'
    (folder / "manifest.toml").write_text(text)
    return folder / "manifest.toml"
