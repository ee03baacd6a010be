"""Compare the benchmarks of two revisions: ``python -m bench compare BEFORE.json AFTER.json``.

``python -m bench`` wrote each file at one revision. Several files of each revision, made alternately, are more
reliable: ``compare before1.json,before2.json after1.json,after2.json``. Every ratio to a peer or a copy was measured in
rounds, so its spread is known. A ratio has changed if its spreads before and after do not overlap; other differences
are noise.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

Spread = tuple[float, float, float]  # least, median, greatest


def spreads(files: str) -> dict[str, Spread]:
    """Return the spread of every ratio in the files, by benchmark, case and name; ``files`` are separated by commas.

    Over several files, a spread is the least value of all, the median of the medians, and the greatest value of all.
    """
    found: dict[str, list[Spread]] = {}
    for file in files.split(","):
        for name, spread in _ratios("", json.loads(Path(file).read_text())):
            found.setdefault(name, []).append(spread)
    return {
        name: (min(each[0] for each in of), sorted(each[1] for each in of)[len(of) // 2], max(each[2] for each in of))
        for name, of in found.items()
    }


def _ratios(place: str, value: Any) -> Iterator[tuple[str, Spread]]:
    if isinstance(value, list):
        for each in value:
            yield from _ratios(f"{place}, {each['case']}", each)
    elif isinstance(value, dict) and {"median", "least", "greatest"} <= value.keys():
        yield place, (value["least"], value["median"], value["greatest"])
    elif isinstance(value, dict):
        for name, part in value.items():
            yield from _ratios(f"{place}: {name}" if place else name, part)


def compare(before: str, after: str) -> list[tuple[str, Spread, Spread]]:
    """Return the ratios whose spreads do not overlap: name, spread before, spread after."""
    old, new = spreads(before), spreads(after)
    both = [name for name in new if name in old]
    return [(name, old[name], new[name]) for name in both if old[name][2] < new[name][0] or new[name][2] < old[name][0]]


def main(before: str, after: str) -> int:
    """Print the ratios that changed by more than their spread; return the exit code, 0."""
    changed = compare(before, after)
    for name, old, new in changed:
        texts = [f"{median:.3g} ({least:.3g} to {most:.3g})" for least, median, most in (old, new)]
        print(f"{name}\n  {texts[0]} -> {texts[1]}, x {new[1] / old[1]:.2f}")
    print(f"{len(changed)} of {len(spreads(after))} ratios changed by more than their spread")
    return 0
