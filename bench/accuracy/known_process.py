"""Compare the automatic and the tuned wall with the best that samples allow, in holes drawn from a known process.

    python -m bench.accuracy.known_process [SEED]

A hole is one draw of a Gaussian process of known covariance, at the samples of a tool and at places of the wall. The
oracle knows the covariance and the noise: its estimate, the mean of the process given all samples, has the least error
that any estimate can have in the mean. A ratio is the rms error of a wall over that of the oracle.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Any

import numpy as np

import helibore as hb
from bench.accuracy.known_holes import BIT, ROTATING
from helibore.base.arrays import Floats
from helibore.wall.covariance import Covariance, Term

PROCESSES = {
    "smooth": Covariance((Term(4e-6, 0.15, 0.4),), 2.5e-7, BIT / 2),
    "rough": Covariance((Term(2e-6, 0.04, 0.04),), 2.5e-7, BIT / 2),
    "long": Covariance((Term(6e-6, 0.06, 2.0), Term(4e-7, 0.04, 0.05)), 2.5e-7, BIT / 2),
    "noisy": Covariance((Term(2e-6, 0.08, 0.15),), 4e-6, BIT / 2),
}
SPARSE = ("six arms", "telemetry")
PLACES = 300
EDGE = 0.15  # metres


def positions(tool: str, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return depths (m) and toolfaces (deg) of some 1,500 samples."""
    if tool == "six arms":
        depth = np.repeat(np.arange(0.0, 10.0, 0.04), 6)
        return depth, (3.0 * depth + np.tile(60.0 * np.arange(6), depth.size // 6)) % 360.0
    if tool == "telemetry":
        depth = np.arange(0.0, 40.0, 0.1)
        return depth, rng.uniform(0.0, 360.0, depth.size)
    per_turn = int(tool.split()[0])
    number = np.arange(1500)
    turned = (number + rng.uniform(-0.25, 0.25, number.size)) * 360.0 / per_turn
    return number * (0.05 if per_turn == 16 else 0.02) / per_turn, turned % 360.0


def drawn(process: Covariance, tool: str, seed: int) -> dict[str, float]:
    """Return the rms errors (m) of the oracle and of walls at vertices, for one hole and the samples of a tool."""
    rng = np.random.default_rng([seed, 17])
    depth, toolface = positions(tool, rng)
    ends: dict[str, Any] = {"start_depth": float(depth[0]) + EDGE, "stop_depth": float(depth[-1]) - EDGE}
    grid = hb.reconstruct(
        hb.Caliper(depth, toolface, np.full(depth.size, BIT / 2)),
        bit_diameter=BIT,
        estimator="inverse-distance",
        **ends,
    )
    rows = np.sort(rng.choice(grid.depth.size, min(PLACES, grid.depth.size), replace=False))
    at = np.concatenate([depth, grid.depth[rows]]), np.concatenate([toolface, grid.toolface[rows]])
    matrix = process.at(at[1][:, None] - at[1], at[0][:, None] - at[0])
    shape = np.linalg.cholesky(matrix + 1e-13 * np.eye(matrix.shape[0])) @ rng.normal(size=matrix.shape[0])
    n = depth.size
    off = rng.normal(0.0, np.sqrt(process.noise), n)
    among = matrix[:n, :n] + process.noise * np.eye(n)
    errors = {"oracle": matrix[n:, :n] @ np.linalg.solve(among, shape[:n] + off) - shape[n:]}
    caliper = hb.Caliper(depth, toolface, BIT / 2 + shape[:n] + off)
    tuned = vars(hb.tune(caliper, bit_diameter=BIT, threads=1).settings) | ends
    for name, given in (
        ("automatic", {"estimator": "automatic", "bit_diameter": BIT} | ends),
        ("tuned", tuned),
        ("inverse distance", {"bit_diameter": BIT, "estimator": "inverse-distance"} | ends),
    ):
        wall = hb.reconstruct(caliper, threads=1, **given)
        errors[name] = wall.radius[rows] - BIT / 2 - shape[n:]
    return {name: float(np.sqrt(np.nanmean(off**2))) for name, off in errors.items()}


def cases(seed: int) -> Iterator[tuple[str, str, dict[str, float]]]:
    """Yield the tool, the process, and the errors of each case."""
    for tool in (*ROTATING, *SPARSE):
        for name, process in PROCESSES.items():
            yield tool, name, drawn(process, tool, seed)


def main(seed: int) -> None:
    """Print the errors of each case, and the mean ratios."""
    found = []
    for tool, name, errors in cases(seed):
        ratios = {key: errors[key] / errors["oracle"] for key in ("automatic", "tuned", "inverse distance")}
        found.append((tool in ROTATING, ratios["automatic"]))
        text = ", ".join(f"{key} {value:.3f}" for key, value in ratios.items())
        print(f"{tool}, {name}: oracle {1e3 * errors['oracle']:.3f} mm; {text} of it", flush=True)
    dense = np.array([ratio for rotates, ratio in found if rotates])
    print(f"rotating tools: automatic over the oracle {np.exp(np.log(dense).mean()):.3f}, worst {dense.max():.3f}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 301)
