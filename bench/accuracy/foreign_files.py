"""Open every LAS, DLIS and LIS file of a folder, and compare the values with those of lasio and dlisio.

    python -m bench.accuracy.foreign_files FOLDER

The test files of these two libraries are a good folder: they hold what people really send, damage included. A file is
"equal" if every channel that both readers have as numbers has the same values, "different" if one has not, and "open"
if only helibore reads it. Else it is "refused", with the reason; "without rows": there is nothing to read. lasio comes
from a package index; dlisio with the extra ``files``. They run in a process of their own, because some damaged files
end it.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import logging
import warnings
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

import helibore as hb
from helibore.base.arrays import Floats

Channels = dict[str, Floats]


def _by_lasio(path: Path) -> list[Channels]:
    import lasio

    log = lasio.read(path)
    found = {}
    for number, curve in enumerate(log.curves):
        with contextlib.suppress(ValueError, TypeError):
            found[f"{number}"] = np.array(curve.data, dtype=np.float64)
    return [found]


def _by_dlisio(path: Path) -> list[Channels]:
    import dlisio

    found = []
    module = dlisio.dlis if path.suffix.lower() == ".dlis" else dlisio.lis
    with module.load(str(path)) as files:
        for one in files:
            if module is dlisio.dlis:
                curves = [frame.curves() for frame in one.frames]
            else:
                curves = [dlisio.lis.curves(one, spec) for spec in one.data_format_specs()]
            for table in curves:
                plain = [name for name in table.dtype.names or () if name != "FRAMENO"]
                numeric = [name for name in plain if table[name].dtype.kind in "fiu"]
                found.append({name: np.array(table[name], dtype=np.float64) for name in numeric})
    return found


def _own(path: Path) -> list[Channels]:
    found = []
    with hb.open(path) as file:
        for one in file.sets:
            columns, number = {}, 0
            for channel in one.channels:
                with contextlib.suppress(hb.InputError):
                    columns[f"{number}" if path.suffix.lower() == ".las" else channel.name] = one.numbers(channel.name)
                number += max(1, len(channel.member_names))
            found.append(columns)
    return found


def _difference(own: Channels, other: Channels) -> str:
    by_number = "0" in own
    for name in own.keys() & other.keys():
        a, b = own[name], other[name]
        if b.size == 0 or (by_number and a.ndim == 2):  # lasio has a curve for each element of an array
            continue
        if a.size != b.size:
            return f"channel {name}: {a.shape} for {b.shape}"
        b = b.reshape(a.shape)  # dlisio keeps axes of one element
        known = np.isfinite(a) & np.isfinite(b)
        if not np.allclose(a[known], b[known], rtol=1e-12, atol=0):
            return f"channel {name}: values differ"
    return ""


def _by_other(path: Path) -> list[Channels] | str:
    """Return the channels of each set as the other library reads them, or its error."""
    with ProcessPoolExecutor(1, get_context("fork")) as child:
        try:
            return child.submit(_by_lasio if path.suffix.lower() == ".las" else _by_dlisio, path).result()
        except Exception as error:  # what another library raises is not ours to know
            return type(error).__name__


def judge(path: Path) -> tuple[str, str]:
    """Return what became of a file, and why."""
    other = _by_other(path)
    try:
        own = _own(path)
    except hb.InputError as error:
        without = not isinstance(other, str) and not any(of.size for one in other for of in one.values())
        return "refused" + (" by both" if isinstance(other, str) else ", without rows" if without else ""), str(error)
    if isinstance(other, str):
        return "open", f"the other reader: {other}"
    for one in other:  # lasio has one of the sets
        wrong = [_difference(of, one) for of in own]
        if all(wrong):
            return "different", wrong[0]
    return "equal", ""


def files(folder: Path) -> Iterator[Path]:
    """Yield the files of a folder and of its folders, by name."""
    yield from (path for path in sorted(folder.rglob("*")) if path.suffix.lower() in (".las", ".dlis", ".lis"))


def main(given: Any = None) -> None:
    """Print each file that is not equal, and the counts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args(given).folder
    logging.disable(logging.CRITICAL)
    warnings.simplefilter("ignore")
    counts: Counter[str] = Counter()
    for path in files(folder):
        with contextlib.redirect_stderr(io.StringIO()):
            found, why = judge(path)
        counts[found] += 1
        if found != "equal":
            print(f"{found}: {path.relative_to(folder)}: {why[:300]}")
    print(", ".join(f"{count} {found}" for found, count in counts.most_common()))


if __name__ == "__main__":
    main()
