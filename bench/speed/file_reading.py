"""Compare the time to open field files with that of the libraries that read them.

    las()          P11-A-02 (7,361 rows, 52 columns, 24 of them sectors) or a file written like it; peer: lasio
    table()        a CSV of samples of 100 MB (depth, toolface, radius, time); peer: pyarrow.csv
    small_table()  such a CSV of 1.6 MB; peer: ``numpy.loadtxt``
    json_log()     a log in JSON Well Log Format, 20,000 rows of 20 curves; peer: json and a pandas data frame

Each function compares the values first; then helibore and its peer run in turn in one process. The results are the
milliseconds of helibore and peer, and the ratio of helibore's time to its peer's, with its spread. helibore loads every
value, with nulls replaced and counted.

    python -m bench.speed.file_reading [las file]
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import helibore as hb
from bench.measure import in_turn, milliseconds, ratio

REAL = Path(__file__).parents[3] / "shared" / "data" / "lwd-images" / "P11-A-02_Composite_MEM_Image_NF.las"


def las(path: Path | None = None, turns: int = 7) -> dict[str, Any]:
    """Compare opening a LAS 2.0 image file and loading every channel with ``lasio.read``; the bar is 1.2 times."""
    import lasio

    with tempfile.TemporaryDirectory() as folder:
        path = path or (REAL if REAL.exists() else written_las(Path(folder) / "like.las"))
        theirs = lasio.read(path)
        ours = hb.open(path).set()
        for curve in theirs.curves:
            np.testing.assert_array_equal(ours[curve.mnemonic].values, curve.data)
        return {"file": path.name} | alternately(lambda: load(path), lambda: lasio.read(path), turns)


def table(megabytes: int = 100, turns: int = 5) -> dict[str, Any]:
    """Compare opening a CSV and loading every column with ``pyarrow.csv.read_csv``; the bar is 1.5 times."""
    from pyarrow import csv

    with tempfile.TemporaryDirectory() as folder:
        path = written_table(Path(folder) / "samples.csv", megabytes)
        theirs = csv.read_csv(path)
        ours = hb.open(path).set()
        for name in theirs.column_names:
            np.testing.assert_array_equal(ours[name].values, theirs[name].to_numpy())
        del theirs, ours
        size = path.stat().st_size
        return {"bytes": size} | alternately(lambda: load(path), lambda: csv.read_csv(path), turns)


def small_table(turns: int = 9) -> dict[str, Any]:
    """Compare opening a CSV below 2 MiB and loading every column with ``numpy.loadtxt``; the bar is 1.0 times."""
    with tempfile.TemporaryDirectory() as folder:
        lines = written_table(Path(folder) / "all.csv", 1).read_text().splitlines(keepends=True)[:50_000]
        path = Path(folder) / "samples.csv"
        path.write_text("".join(lines))

        def theirs() -> np.ndarray:
            return np.loadtxt(path, delimiter=",", skiprows=1)

        ours = hb.open(path).set()
        for channel, values in zip(ours, theirs().T, strict=True):
            np.testing.assert_array_equal(channel.values, values)
        return {"bytes": path.stat().st_size} | alternately(lambda: load(path), theirs, turns)


def json_log(rows: int = 20_000, curves: int = 20, turns: int = 9) -> dict[str, Any]:
    """Compare a JSON log, every curve loaded, with ``json.load`` and a pandas data frame, whose time is the bar."""
    import pandas as pd

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.json"
        values = np.round(np.random.default_rng(4).normal(50, 10, (rows, curves)), 4)
        values[:, 0] = 1000 + 0.1524 * np.arange(rows)
        heads = [{"name": f"C{k}", "unit": "m", "valueType": "float", "dimensions": 1} for k in range(curves)]
        path.write_text(json.dumps([{"header": {"name": "log"}, "curves": heads, "data": values.tolist()}]))

        def theirs() -> pd.DataFrame:
            with path.open() as file:
                (log,) = json.load(file)
            return pd.DataFrame(log["data"], columns=[curve["name"] for curve in log["curves"]])

        ours, frame = hb.open(path).set(), theirs()
        for name in frame:
            np.testing.assert_array_equal(ours[name].values, frame[name])
        return {"bytes": path.stat().st_size} | alternately(lambda: load(path), theirs, turns)


def load(path: Path) -> None:
    """Open a file and load every value."""
    for channel in hb.open(path).set():
        _ = channel.values


def alternately(ours: Callable[[], object], theirs: Callable[[], object], turns: int) -> dict[str, Any]:
    """Time two functions in turn for ``turns`` rounds; return milliseconds and the ratio of the first to the second."""
    seconds = in_turn({"helibore": ours, "peer": theirs}, turns)
    times = {work: milliseconds(of) for work, of in seconds.items()}
    return {"milliseconds": times, "helibore / peer": ratio(seconds["helibore"], seconds["peer"])}


def written_table(path: Path, megabytes: int) -> Path:
    """Write samples of a turning tool to ``path`` until the file has ``megabytes`` MB or more; return ``path``."""
    random = np.random.default_rng(1)
    rows = 100_000
    with path.open("w") as file:
        file.write("depth_m,toolface_deg,radius_m,time_s\n")
        start = 0
        while file.tell() < megabytes * 1_000_000:
            count = np.arange(start, start + rows)
            columns = (1000 + count * 4e-5, count * 37.1 % 360, 0.108 + random.normal(0, 0.001, rows), count * 0.001)
            np.savetxt(file, np.column_stack(columns), fmt=["%.5f", "%.3f", "%.6f", "%.3f"], delimiter=",")
            start += rows
    return path


def written_las(path: Path, rows: int = 7361, columns: int = 52) -> Path:
    """Write a LAS 2.0 file with the rows and columns of P11-A-02, for machines without that file; return ``path``."""
    curves = "".join(f" C{number:02d}M .g/cc : curve\n" for number in range(1, columns))
    values = np.random.default_rng(2).normal(2.3, 0.1, (rows, columns))
    values[np.random.default_rng(3).random((rows, columns)) < 0.1] = -999.25
    values[:, 0] = 1950 + 0.1 * np.arange(rows)
    head = "~V\n VERS. 2.0 :\n WRAP. NO :\n~W\n STRT.m 1950 :\n STOP.m 2686 :\n STEP.m 0.1 :\n NULL. -999.25 :\n"
    with path.open("w") as file:
        file.write(f"{head}~C\n DEPT .m : depth\n{curves}~A\n")
        np.savetxt(file, values, fmt="%10.4f")
    return path


if __name__ == "__main__":
    print("las  ", las(Path(sys.argv[1]) if len(sys.argv) > 1 else None))
    print("json ", json_log())
    print("small", small_table())
    print("table", table())
