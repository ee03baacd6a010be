"""Run the benchmarks of `NAMES`: ``python -m bench``, or only those named: ``python -m bench reconstruction appends``.

The command prints one line for each figure, and writes all figures to bench-results.json and bench-results.html.
Compare ratios and their spread (``python -m bench compare BEFORE.json AFTER.json``), because absolute times depend on
the machine.
"""

from __future__ import annotations

import importlib
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from bench import compare
from bench.measure import machine
from bench.page import page

NAMES = (
    "reconstruction",
    "sizes",
    "scaling",
    "appends",
    "memory",
    "emission",
    "images",
    "logs",
    "mesh_writing",
    "cliffs",
    "kriging",
)


def _figures(prefix: str, value: Any) -> Iterator[tuple[str, str]]:
    if isinstance(value, dict) and value.keys() == {"median", "least", "greatest", "undisturbed"}:
        spread = f"{value['least']:.3g} to {value['greatest']:.3g}; least by least {value['undisturbed']:.3g}"
        yield prefix, f"{value['median']:.3g} ({spread})"
    elif isinstance(value, dict):
        for name, part in value.items():
            yield from _figures(f"{prefix}: {name}" if prefix else name, part)
    else:
        yield prefix, f"{value:.4g}" if isinstance(value, float) else str(value)


def main(names: list[str]) -> int:
    """Run the named benchmarks (all if none is named), or compare the results of two runs; return the exit code."""
    if names[:1] == ["compare"] and len(names) == 3:
        return compare.main(*names[1:])
    unknown = set(names) - set(NAMES)
    if unknown:
        print(f"no benchmark named {', '.join(sorted(unknown))}: there are {', '.join(NAMES)}", file=sys.stderr)
        return 2
    results: dict[str, Any] = {"machine": machine()}
    print("\n".join(f"{name}: {text}" for name, text in _figures("", results["machine"])))
    for name in names or NAMES:
        results[name] = importlib.import_module(f"bench.speed.{name}").cases()
        for result in results[name]:
            print(f"\n{result['case']}")
            for figure, text in _figures("", {k: v for k, v in result.items() if k != "case"}):
                print(f"  {figure:<34} {text}")
    Path("bench-results.json").write_text(json.dumps(results, indent=1) + "\n")
    Path("bench-results.html").write_text(page(results, _figures))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
