"""Measure the peak memory of a reconstruction beyond its input and output, in a separate process (Linux: /proc)."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from bench.speed.reconstruction import CASES, reconstruct, samples


def _status(name: str) -> float:
    """Return the value ``name`` of /proc/self/status, in bytes."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return 1024.0 * next(int(line.split()[1]) for line in lines if line.startswith(name + ":"))


def measure(count: int, vertices: int, order: str) -> float:
    """Return the peak bytes of a reconstruction in this process beyond its input and output, by Linux's account."""
    data = samples(count, vertices, order)
    depth, toolface, radius, stop = data
    reconstruct((depth[:1000], toolface[:1000], radius[:1000], stop))  # warms up code and allocator
    before = _status("VmRSS")
    Path("/proc/self/clear_refs").write_text("5")  # the peak counts from here
    wall = reconstruct(data)
    output = wall.radius
    return _status("VmHWM") - before - output.nbytes


def measure_apart(count: int, vertices: int, order: str) -> float:
    """Return the result of `measure` in a new process."""
    command = [sys.executable, "-m", "bench.speed.memory", str(count), str(vertices), order]
    run = subprocess.run(command, capture_output=True, text=True, check=True, timeout=300)
    return float(json.loads(run.stdout))


def cases() -> list[dict[str, Any]]:
    """Return the results of the large case, sorted and unsorted; 48 bytes a sample and 24 a vertex are allowed."""
    count, vertices = CASES["2.4 M samples, 256 k vertices"]
    found = []
    for order in ("as recorded", "in random order"):
        used = measure_apart(count, vertices, order)
        found.append(
            {
                "case": f"memory, {order}",
                "megabytes": used / 1e6,
                "of the allowance": used / (48 * count + 24 * vertices),
            }
        )
    return found


if __name__ == "__main__":
    print(json.dumps(measure(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3])))
