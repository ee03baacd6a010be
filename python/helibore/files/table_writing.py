"""Write columns to a CSV, gzipped CSV or NPZ file, whole or not at all. The same columns give the same bytes."""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import IO, Any

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.atomic_file import write_whole


def write_table(path: Path, columns: dict[str, tuple[Floats, int]]) -> None:
    """Write columns, each with its number of decimals; the ending decides the format. NPZ keeps every digit."""
    arrays: dict[str, Any] = {name: values for name, (values, _) in columns.items()}

    def write(file: IO[bytes]) -> None:
        if path.suffix == ".npz":
            np.savez(file, **arrays)
        elif path.suffix == ".gz":
            with gzip.GzipFile(fileobj=file, mode="wb", filename="", mtime=0, compresslevel=6) as zipped:
                _write_csv(zipped, columns)
        else:
            _write_csv(file, columns)

    write_whole(path, write)


def _write_csv(file: IO[bytes] | gzip.GzipFile, columns: dict[str, tuple[Floats, int]]) -> None:
    file.write((",".join(columns) + "\n").encode())
    row = ",".join(f"%.{decimals}f" for _, decimals in columns.values()) + "\n"
    values = [column for column, _ in columns.values()]
    for start in range(0, values[0].size, 4096):
        block = np.column_stack([column[start : start + 4096] for column in values])
        file.write((row * len(block) % tuple(block.ravel().tolist())).encode())
