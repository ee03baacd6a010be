"""How good the wall is, and how sure: ``./develop evidence [SEED ...]`` writes docs/evidence.md and its figure.

Five kinds of hole of known truth, three rotating tools, a tool with four fixed arms, stick-slip and telemetry, three
noises, several seeds. Each wall by default settings, by kriging, by tuned settings, and by the methods of SciPy where
it is installed. Ratios are rms errors over those of the default; their means are geometric, with 95 % intervals by
bootstrap over cases. Seeds are not those that anything was built with.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np

import helibore as hb
from bench.accuracy.known_holes import BIT, HOLES, LENGTH, OTHERS, ROTATING, Hole, measured
from helibore.base.arrays import Floats

SEEDS = (101, 102)
DOCS = Path(__file__).parents[2] / "docs"
EDGE = 0.5  # metres at both ends that are not compared


class Case(NamedTuple):
    """One hole, one tool: rms errors (m) by method, and what sigma covers."""

    hole: str
    tool: str
    noise: float
    seed: int
    errors: dict[str, float]
    covered: dict[str, float]
    width: float


def run(kind: str, tool: str, noise: float, seed: int, *, peers: bool) -> Case:
    """Rebuild one hole by every method."""
    hole, caliper = measured(kind, tool, noise, seed)
    tuned = hb.tune(caliper, bit_diameter=BIT, threads=1).settings
    walls = {
        "default": hb.reconstruct(caliper, bit_diameter=BIT, threads=1),
        "kriging": hb.reconstruct(caliper, bit_diameter=BIT, threads=1, estimator="kriging"),
        "tuned": hb.reconstruct(caliper, threads=1, **vars(tuned)),
    }
    depth, toolface = walls["default"].depth, walls["default"].toolface
    inside = (depth > EDGE) & (depth < LENGTH - EDGE)
    truth = hole.radius(depth, toolface)

    def rms(radius: Floats) -> float:
        return float(np.sqrt(np.nanmean((radius - truth)[inside] ** 2)))

    errors = {name: rms(wall.radius) for name, wall in walls.items()}
    if peers:
        errors |= {name: rms(estimate(caliper, depth, toolface)) for name, estimate in scipy_methods().items()}
    return Case(kind, tool, noise, seed, errors, *_coverage(hole, walls["tuned"], inside, truth))


def _coverage(hole: Hole, wall: hb.Wall, inside: np.ndarray, truth: Floats) -> tuple[dict[str, float], float]:
    """Share of vertices whose 95 % interval holds the truth, by class; mean half-width over 1.96 rms."""
    sigma, off = wall.sigma, np.abs(wall.radius - truth)
    known = inside & np.isfinite(sigma)
    if not known.any():
        return {}, np.nan
    ledge = hole.at_ledge(wall.depth, wall.toolface)
    far = wall.nearest > np.quantile(wall.nearest[known], 0.9)
    enlarged = truth > BIT / 2 + 0.005
    classes = {"all": known, "gauge": known & ~enlarged & ~ledge, "enlarged": known & enlarged & ~ledge}
    classes |= {"ledge": known & ledge, "far": known & far}
    covered = {name: float(np.mean((off <= 1.96 * sigma)[of])) for name, of in classes.items() if of.sum() > 100}
    return covered, float(sigma[known].mean() / np.sqrt(np.mean(off[known] ** 2)))


def scipy_methods() -> dict[str, Callable[[hb.Caliper, Floats, Floats], Floats]]:
    """Peers on the unrolled wall, continued by a third of a turn on both sides; none without SciPy."""
    try:
        from scipy.interpolate import LinearNDInterpolator, RBFInterpolator
        from scipy.spatial import cKDTree
    except ImportError:
        print("SciPy is not installed: its methods are left out")
        return {}

    def plane(depth: Floats, toolface: Floats) -> Floats:
        return np.column_stack([np.radians(toolface) * BIT / 2, depth])

    def unrolled(caliper: hb.Caliper) -> tuple[Floats, Floats]:
        turns = [(caliper.toolface % 360.0) + turn for turn in (-360.0, 0.0, 360.0)]
        keep = [(turn > -120) & (turn < 480) for turn in turns]
        points = [plane(caliper.depth[some], turn[some]) for turn, some in zip(turns, keep, strict=True)]
        rng = np.random.default_rng(1)  # equal positions would leave a triangulation or a spline without a solution
        joined = np.concatenate(points)
        return joined + rng.normal(0, 1e-7, joined.shape), np.concatenate([caliper.radius[some] for some in keep])

    def tree(caliper: hb.Caliper, depth: Floats, toolface: Floats) -> Floats:
        points, radius = unrolled(caliper)
        distance, near = cKDTree(points).query(plane(depth, toolface), 8)
        return np.asarray(np.average(radius[near], weights=1 / distance, axis=1))

    def delaunay(caliper: hb.Caliper, depth: Floats, toolface: Floats) -> Floats:
        points, radius = unrolled(caliper)
        return np.asarray(LinearNDInterpolator(points, radius)(plane(depth, toolface)))

    def thin_plate(caliper: hb.Caliper, depth: Floats, toolface: Floats) -> Floats:
        points, radius = unrolled(caliper)
        return np.asarray(RBFInterpolator(points, radius, neighbors=16)(plane(depth, toolface)))

    return {"IDW on a tree": tree, "Delaunay": delaunay, "thin plate": thin_plate}


def mean_ratio(cases: Iterable[Case], method: str) -> str:
    """Geometric mean of a method's error over the default's, its interval, and the worst case."""
    ratios = np.log([case.errors[method] / case.errors["default"] for case in cases if method in case.errors])
    if not ratios.size:
        return "-"
    if ratios.size == 1:
        return f"{np.exp(ratios[0]):.2f}"
    again = np.random.default_rng(1).choice(ratios, (2000, ratios.size)).mean(axis=1)
    low, high = np.exp(np.quantile(again, (0.025, 0.975)))
    return f"{np.exp(ratios.mean()):.2f} ({low:.2f} to {high:.2f}; worst {np.exp(ratios.max()):.2f})"


def table(head: list[str], rows: list[list[str]]) -> str:
    """A table in Markdown."""
    return "\n".join(f"| {' | '.join(row)} |" for row in (head, ["---"] * len(head), *rows))


def page(cases: list[Case]) -> str:
    """The page of the evidence."""
    usual = [case for case in cases if case.noise == 5e-4]
    names = list(dict.fromkeys(name for case in cases for name in case.errors if name != "default"))
    by_tool = [
        [tool, *(mean_ratio([case for case in usual if case.tool == tool], name) for name in names)]
        for tool in (*ROTATING, *OTHERS)
    ]
    rotating = [case for case in usual if case.tool in ROTATING]
    by_hole = [
        [kind, *(mean_ratio([case for case in rotating if case.hole == kind], name) for name in names)]
        for kind in HOLES
    ]
    noises = sorted({case.noise for case in cases})
    by_noise = [
        [f"{1e3 * noise:g} mm", *(mean_ratio([c for c in cases if c.noise == noise and c.tool == "32 a turn"], name)
                                  for name in names)]
        for noise in noises
    ]  # fmt: skip
    covered = []
    for tool in (*ROTATING, *OTHERS):
        of = [case for case in usual if case.tool == tool]
        row = []
        for kind in ("all", "gauge", "enlarged", "ledge", "far"):
            found = [100 * case.covered[kind] for case in of if kind in case.covered]
            row.append(f"{np.mean(found):.0f} (worst {min(found):.0f})" if found else "-")
        covered.append([tool, *row, f"{np.nanmean([case.width for case in of]):.2f}"])
    seeds = ", ".join(map(str, sorted({case.seed for case in usual})))
    return f"""# Evidence: how good the wall is, and how sure

`./develop evidence` writes this page. Holes of known truth: {", ".join(HOLES)}; seed {seeds}; {LENGTH:g} m;
bit {1e3 * BIT:g} mm; 64 sectors, pitch 0.1 m. Ratio = rms error of a method over that of the default settings;
geometric mean, 95 % interval by bootstrap over cases, worst case. Methods of SciPy: 32 a turn and the first seed only.

## By tool, 0.5 mm of noise

{table(["tool", *names], by_tool)}

## By hole, rotating tools, 0.5 mm of noise

{table(["hole", *names], by_hole)}

## By noise, 32 a turn

{table(["noise", *names], by_noise)}

![Error of tuned walls over that of the default, by hole and tool](evidence.png)

## How sure: share of vertices whose interval of 1.96 sigma holds the truth, %, tuned walls, 0.5 mm of noise

{table(["tool", "all", "gauge", "enlarged", "ledge", "far", "width"], covered)}

Gauge: at most 5 mm over the bit; enlarged: more; ledge: within 5 cm of a change by more than 2 mm; far: the tenth of
the vertices that lies farthest from samples. Width: mean sigma over the rms error. Vertices without a sigma (not
sampled) do not count: with four arms that is all between the arms. With arms, stick-slip and telemetry the interval is
not promised.
"""


def draw(cases: list[Case], file: Path) -> None:
    """Draw tuned over default for each case."""
    import matplotlib.pyplot as plt

    tools = (*ROTATING, *OTHERS)
    figure, axes = plt.subplots(figsize=(8, 3.6), layout="constrained")
    for number, kind in enumerate(HOLES):
        of = [case for case in cases if case.hole == kind and case.noise == 5e-4]
        x = [tools.index(case.tool) + (number - 2) * 0.13 for case in of]
        axes.plot(x, [case.errors["tuned"] / case.errors["default"] for case in of], "o", ms=4, label=kind)
    axes.axhline(1.0, color="grey", lw=0.8)
    axes.set_xticks(range(len(tools)), tools)
    axes.set_ylabel("rms error, tuned over default")
    axes.set_ylim(0, None)
    axes.legend(ncols=5, fontsize=8)
    figure.savefig(file, dpi=110, metadata={"Software": None})
    plt.close(figure)


def main(*seeds: int, docs: Path = DOCS) -> None:
    """Run every case and write the page."""
    work = [(kind, tool, 5e-4, seed) for seed in seeds for kind in HOLES for tool in (*ROTATING, *OTHERS)]
    work += [(kind, "32 a turn", noise, seeds[0]) for kind in HOLES for noise in (1e-4, 2e-3)]
    cases = []
    for number, of in enumerate(work, 1):
        cases.append(run(*of, peers=of[1] == "32 a turn" and of[3] == seeds[0]))
        errors = ", ".join(f"{name} {1e3 * error:.3f}" for name, error in cases[-1].errors.items())
        print(f"{number}/{len(work)} {of[0]}, {of[1]}, {1e3 * of[2]:g} mm, seed {of[3]}: {errors} mm", flush=True)
    (docs / "evidence.md").write_text(page(cases))
    draw(cases, docs / "evidence.png")


if __name__ == "__main__":
    main(*([int(seed) for seed in sys.argv[1:]] or SEEDS))
