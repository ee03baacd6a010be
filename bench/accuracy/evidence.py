"""Measure the errors of walls, and whether `Wall.sigma` states these rightly; write docs/evidence.md and its figures.

    ./develop evidence [SEED ...]

Cases combine five kinds of hole whose true shape is known; six ways to measure it (three rotating tools, a tool with
four fixed arms, stick-slip, telemetry); three noises; and several seeds. Each hole is rebuilt by inverse distance, by
kriging, by tuned settings, and by other methods and libraries (`peers`) if they are installed. The page also has the
published experiment (`published`), passes of a real caliper, each predicted from the others, the classes of cases of
`automatic`, the least errors that two of them allow (`least_error`), and holes of a known process beside an oracle
(`known_process`). A ratio is the rms error of a method divided by that of inverse distance. Means of ratios are
geometric, with 95 % intervals by bootstrap over cases. helibore was not developed with these seeds.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np

import helibore as hb
from bench.accuracy import automatic, known_process, least_error, published
from bench.accuracy import leave_one_pass_out as f12
from bench.accuracy.known_holes import BIT, HOLES, LENGTH, OTHERS, ROTATING, Hole, measured
from bench.accuracy.peers import methods
from helibore.base.arrays import Floats
from helibore.preparation.shifts import find_shifts

SEEDS = (301, 302)
DOCS = Path(__file__).parents[2] / "docs"
LOST = 1.02, 1.08  # ratios over inverse distance and the tuned wall from which a case is listed
EDGE = 0.5  # metres at each end of the hole that are not compared


class Case(NamedTuple):
    """One hole measured by one tool: rms errors (m) by method, and what `_coverage` returns for the tuned wall."""

    hole: str
    tool: str
    noise: float
    seed: int
    errors: dict[str, float]
    covered: dict[str, float]
    width: float


def run(kind: str, tool: str, noise: float, seed: int, peers: bool, slow: bool) -> Case:
    """Rebuild one hole by the estimators of helibore, and return the errors.

    With ``peers``, other methods rebuild it too; with ``slow``, also those that take long.
    """
    hole, caliper = measured(kind, tool, noise, seed)
    tuned = hb.tune(caliper, bit_diameter=BIT, threads=1).settings
    walls = {
        "inverse distance": hb.reconstruct(caliper, bit_diameter=BIT, threads=1, estimator="inverse-distance"),
        "kriging": hb.reconstruct(caliper, bit_diameter=BIT, threads=1, estimator="kriging"),
        "tuned": hb.reconstruct(caliper, threads=1, **vars(tuned)),
    }
    depth, toolface = walls["inverse distance"].depth, walls["inverse distance"].toolface
    inside = (depth > EDGE) & (depth < LENGTH - EDGE)
    truth = hole.radius(depth, toolface)

    def rms(radius: Floats) -> float:
        return float(np.sqrt(np.nanmean((radius - truth)[inside] ** 2)))

    errors = {name: rms(wall.radius) for name, wall in walls.items()}
    if peers:
        for name, estimate in methods(slow=slow)[0].items():
            errors[name] = rms(estimate(caliper, depth, toolface))
    return Case(kind, tool, noise, seed, errors, *_coverage(hole, walls["tuned"], inside, truth))


def _coverage(hole: Hole, wall: hb.Wall, inside: np.ndarray, truth: Floats) -> tuple[dict[str, float], float]:
    """Return the share of vertices whose 95 % interval holds the true radius, and the mean sigma over the rms error.

    There is a share for each class of vertices, as in the last section of the page, if it has more than 100 vertices.
    """
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


def mean_ratio(cases: Iterable[Case], method: str) -> str:
    """Return as text the mean of a method's errors over inverse distance's, its 95 % interval, the worst case."""
    ratios = np.log([case.errors[method] / case.errors["inverse distance"] for case in cases if method in case.errors])
    if not ratios.size:
        return "-"
    if ratios.size == 1:
        return f"{np.exp(ratios[0]):.2f}"
    again = np.random.default_rng(1).choice(ratios, (2000, ratios.size)).mean(axis=1)
    low, high = np.exp(np.quantile(again, (0.025, 0.975)))
    return f"{np.exp(ratios.mean()):.2f} ({low:.2f} to {high:.2f}; worst {np.exp(ratios.max()):.2f})"


def between_arms() -> str:
    """Return as text the rms errors of two walls, by inverse distance and by tuned settings.

    A tool with four arms measures an ellipse; it makes one turn in 30 m and samples every 5 cm.
    """
    depth = np.repeat(np.arange(0, 60, 0.05), 4)
    toolface = (depth * 12 + np.tile([0, 90, 180, 270], depth.size // 4)) % 360

    def truth(toolface: Floats) -> Floats:
        return np.asarray(0.120 * 0.108 / np.hypot(*(np.array([[0.108], [0.120]]) * _unit(toolface - 30))))

    caliper = hb.Caliper(depth, toolface, truth(toolface))
    tuned = vars(hb.tune(caliper, bit_diameter=BIT).settings)
    errors = []
    for settings in ({"bit_diameter": BIT, "estimator": "inverse-distance"}, tuned):
        wall = hb.reconstruct(caliper, **settings)
        errors.append(1e3 * float(np.sqrt(np.mean((wall.radius - truth(wall.toolface)) ** 2))))
    return f"{errors[0]:.2f} mm rms by inverse distance, {errors[1]:.2f} mm by `hb.tune` alone"


def _unit(toolface: Floats) -> Floats:
    return np.array([np.cos(np.radians(toolface)), np.sin(np.radians(toolface))])


def left_out_passes() -> list[list[str]]:
    """Return a row for each pass of the F-12 caliper, predicted from the other passes, and a last row of the means.

    The columns are the pass, the mean of |error| and the rms error, mm, by inverse distance, and then the same two
    errors by tuned settings. Return [] if the caliper's file is not there.
    """
    if not f12.FILE.exists():
        return []
    depth, toolface, radius, passes, *_ = f12.read(f12.FILE)
    moved = depth + find_shifts(depth, toolface, radius, passes).at(passes, depth)
    settings = {"bit_diameter": 2 * float(np.median(radius)), "sectors": 32, "pitch": 0.1}
    rows, sums = [], []
    for number in np.unique(passes):
        mine = passes == number
        caliper = hb.Caliper(moved[~mine], toolface[~mine], radius[~mine])
        found = []
        for chosen in (settings | {"estimator": "inverse-distance"}, vars(hb.tune(caliper, **settings).settings)):
            off = 1e3 * (f12.evaluate(hb.reconstruct(caliper, **chosen), moved[mine], toolface[mine]) - radius[mine])
            found.append((np.nanmean(np.abs(off)), np.sqrt(np.nanmean(off**2))))
        sums.append(np.ravel(found))
        rows.append([str(number), *(f"{value:.3f}" for value in sums[-1])])
    return [*rows, ["mean", *(f"{value:.3f}" for value in np.mean(sums, axis=0))]]


def published_text(of: published.Published) -> str:
    """Return the results of the published experiment as Markdown."""
    distance, weight = 1e3 * np.median(of.distances, axis=0), 100 * np.median(of.contributions, axis=0)
    own = published.OWN_DIFFERENCES
    names = ("the wall and V1", "a constant 11 cm and V1", "the mean of V2 to V7 and V1")
    rows = [
        [f"points of {published.POINTS} that change by more than 0.01 mm after estimate 1, 2, 3",
         ", ".join(map(str, published.OWN_CHANGES)), ", ".join(map(str, of.changes))],
        ["difference by 4 and by 8 neighbours, within",
         f"{own[0]}, {own[1]} mm", f"{of.differences[0]:.1f}, {of.differences[1]:.1f} mm"],
        *([f"similarity of {name}", f"{its} %", f"{ours:.2f} %"]
          for name, its, ours in zip(names, published.OWN_SIMILARITY, of.with_nearest, strict=True)),
    ]  # fmt: skip
    true = "; ".join(f"{name} {value:.1f} %" for name, value in of.with_truth.items())
    constant, others = (100 - similar for similar in published.OWN_SIMILARITY[1:])
    close = int(np.sum(of.distances[:, 0] < published.CHANGED))
    return f"""\
The method and its parameters are those of Energies 2021, 14, 291: 8 neighbours of a window of 100 samples,
twice the arc, {published.POINTS} points; a point is settled when an estimate moves it by at most 0.01 mm, and a
sample nearer than that is taken alone (here {close} points have one). Its samples are not public: 10 samples
and 4 mm a turn of an oval, rough hole of 11 cm radius are our choice. V1 is the nearest sample, V2 the next.

{table(["", "published", "here"], rows)}

Similarity is 100 % less the mean of |difference| / radius. Judged by itself, the published table says that a
constant comes within {constant:.1f} % of V1, and the mean of its neighbours within {others:.1f} %: the wall
agrees with V1 because V1 has the greatest weight in it, not because it is right elsewhere. Only a comparison
with the true radius says that; here: {true}. The nearest of the 8 neighbours lies {distance[0]:.1f} mm away in
the median and has {weight[0]:.0f} % of the weight, the farthest {distance[-1]:.0f} mm and {weight[-1]:.0f} %."""


def table(head: list[str], rows: list[list[str]]) -> str:
    """Return a table in Markdown."""
    return "\n".join(f"| {' | '.join(row)} |" for row in (head, ["---"] * len(head), *rows))


def geometric(ratios: list[float]) -> str:
    """Return the geometric mean and the greatest of ratios."""
    known = np.array([each for each in ratios if np.isfinite(each)])
    return f"{np.exp(np.log(known).mean()):.2f} (worst {known.max():.2f})" if known.size else "-"


def percent(shares: list[float]) -> str:
    """Return the mean and the least of shares."""
    known = 100.0 * np.array([each for each in shares if np.isfinite(each)])
    return f"{known.mean():.0f} (worst {known.min():.0f})" if known.size else "-"


def without_option(found: dict[str, list[automatic.Measured]]) -> str:
    """Return the table of the classes of cases, and the list of cases that lose."""
    rows = [
        [
            name,
            str(len(of)),
            geometric([each.over_inverse for each in of]),
            geometric([each.over_tuned for each in of]),
            percent([each.holds for each in of]),
            percent([each.shape_holds for each in of]),
            percent([each.volume_holds for each in of]),
        ]
        for name, of in found.items()
    ]
    head = ["class", "cases", "over inverse distance", "over tuned", "interval", "C1 - C2", "volume"]
    lost = [
        f"- {name}, {each.name}: {each.over_inverse:.2f} of inverse distance"
        + (f", {each.over_tuned:.2f} of tuned" if np.isfinite(each.over_tuned) else "")
        for name, of in found.items()
        for each in of
        if each.over_inverse > LOST[0] or each.over_tuned > LOST[1]
    ]
    return table(head, rows) + "\n\nWhere it loses:\n\n" + ("\n".join(lost) or "- nowhere in these cases")


def beside_oracle(seed: int) -> str:
    """Return the table of holes drawn from a known process: the errors over those of the oracle."""
    found = list(known_process.cases(seed))
    rows = []
    for tool in dict.fromkeys(tool for tool, _, _ in found):
        of = [errors for at, _, errors in found if at == tool]
        rows.append([tool, *(geometric([each[name] / each["oracle"] for each in of])
                             for name in ("automatic", "tuned", "inverse distance"))])  # fmt: skip
    return table(["tool", "automatic", "tuned", "inverse distance"], rows)


def least_errors(seed: int) -> str:
    """Return as text the least errors that the classes telemetry and noisy allow, over those of the tuned wall."""
    texts = []
    for name in least_error.CLASSES:
        mean = least_error.means([of for _, of in least_error.ratios(name, seed)])
        texts.append(f"{name} {mean['linear']:.2f} and {mean['automatic']:.2f}")
    return "; ".join(texts)


def page(
    cases: list[Case],
    missing: list[str],
    redone: published.Published,
    classes: dict[str, list[automatic.Measured]],
) -> str:
    """Return the page docs/evidence.md; ``missing`` are libraries that are not installed."""
    usual = [case for case in cases if case.noise == 5e-4]
    names = list(dict.fromkeys(name for case in cases for name in case.errors if name != "inverse distance"))
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
    covers = [100 * case.covered["all"] for case in rotating if case.covered]
    first_seed = cases[0].seed
    seeds = ", ".join(map(str, sorted({case.seed for case in usual})))
    return f"""# Evidence: how good the wall is, and how sure

`./develop evidence` writes this page. Holes of known truth: {", ".join(HOLES)}; seed {seeds}; {LENGTH:g} m;
bit {1e3 * BIT:g} mm; 64 sectors, pitch 0.1 m. Ratio = rms error of a method over that of inverse distance;
geometric mean, 95 % interval by bootstrap over cases, worst case. Other methods: 32 a turn and the first seed only;
PyKrige with 0.5 mm of noise only. Not installed, and left out: {", ".join(missing) or "none"}.

## By tool, 0.5 mm of noise

{table(["tool", *names], by_tool)}

## By hole, rotating tools, 0.5 mm of noise

{table(["hole", *names], by_hole)}

## By noise, 32 a turn

{table(["noise", *names], by_noise)}

![Error of tuned walls over that of inverse distance, by hole and tool](evidence.png)

## Without an option: `estimator="automatic"`

Arms: 2 to 12 arms, 1 to 8 passes, turning or not, in ovals, breakouts and turning breakouts, with biases of 0.3
mm. Tails: 3 % of the samples are off by some 3 mm. Noisy: noise of twice the shape. Changing: a hole that is
quiet, then has ledges, then breakouts. Quantised: steps of 0.1 inch. Doubled: arms with 1, 2, 4 and 8 passes.
Interval, C1 - C2, volume: share of vertices and turns with a known uncertainty whose interval of 1.96 sigma
holds the truth, %. Seed {first_seed}.

{without_option(classes)}

Arms that never cross leave open how a shape turns along the hole: four arms see a breakout that turns by 5
degrees a metre as one that turns the other way. The wall is then the mean of those that are likely. Where a hole
changes along it, its stretches are found to a metre or two: four arms have 0.49 to 0.71 of the error of inverse
distance, and five tools have up to 1.4 in single windows of 200 samples beside a change (seeds 7002, 7003, 9201,
9202). Where a breakout begins to turn, or turns back, arms do not show it: intervals held the truth in 57 to 87 % of
eight such holes. No method wins in every case; inverse distance, as published, is there by name.

The least error of a linear estimate that knows the covariance of all such holes, and that of automatic, over tuned:
{least_errors(first_seed)}.

## Beside an oracle

Holes drawn from a Gaussian process: smooth, rough, long along the hole, and noisy. The oracle knows its
covariance and takes all samples: no estimate has less error in the mean. Rms error over that of the oracle;
geometric mean, worst.

{beside_oracle(first_seed)}

## Four arms in an ellipse of 216 x 240 mm, one turn in 30 m, every 5 cm

{between_arms()}.

## Passes of a real caliper, each predicted from the others

Volve F-12, 2010, depth shifts found; mean of |error| and rms, mm. One step of the file is 0.38 mm.

{table(["pass", "inverse distance, mean", "inverse distance, rms", "tuned, mean", "tuned, rms"], left_out_passes())}

## The published experiment

{published_text(redone)}

![Distances and weights of the 8 neighbours](evidence-published.png)

## How sure: share of vertices whose interval of 1.96 sigma holds the truth, %, tuned walls, 0.5 mm of noise

{table(["tool", "all", "gauge", "enlarged", "ledge", "far", "width"], covered)}

Gauge: at most 5 mm over the bit; enlarged: more; ledge: within 5 cm of a change by more than 2 mm; far: the tenth of
the vertices that lies farthest from samples. Width: mean sigma over the rms error. Vertices without a sigma (not
sampled) do not count: with four arms that is all between the arms. All cases of rotating tools: mean
{np.mean(covers):.1f} %, worst case {min(covers):.0f} %.
"""


def draw(cases: list[Case], file: Path) -> None:
    """Draw the error of the tuned wall over that of inverse distance for each case with 0.5 mm of noise."""
    import matplotlib.pyplot as plt

    tools = (*ROTATING, *OTHERS)
    figure, axes = plt.subplots(figsize=(8, 3.6), layout="constrained")
    for number, kind in enumerate(HOLES):
        of = [case for case in cases if case.hole == kind and case.noise == 5e-4]
        x = [tools.index(case.tool) + (number - 2) * 0.13 for case in of]
        axes.plot(x, [case.errors["tuned"] / case.errors["inverse distance"] for case in of], "o", ms=4, label=kind)
    axes.axhline(1.0, color="grey", lw=0.8)
    axes.set_xticks(range(len(tools)), tools)
    axes.set_ylabel("rms error, tuned over inverse distance")
    axes.set_ylim(0, None)
    axes.legend(ncols=5, fontsize=8)
    figure.savefig(file, dpi=110, metadata={"Software": None})
    plt.close(figure)


def main(*seeds: int, docs: Path = DOCS) -> None:
    """Run every case, and write the page and its figures to ``docs``."""
    work = [(kind, tool, 5e-4, seed) for seed in seeds for kind in HOLES for tool in (*ROTATING, *OTHERS)]
    work += [(kind, "32 a turn", noise, seeds[0]) for kind in HOLES for noise in (1e-4, 2e-3)]
    work += [(kind, tool, 1e-4, seeds[0]) for kind in HOLES for tool in ("64 a turn", "16 a turn")]
    peers = [tool == "32 a turn" and seed == seeds[0] for _, tool, _, seed in work]
    slow = [of and work[i][2] == 5e-4 for i, of in enumerate(peers)]
    cases = []
    with ProcessPoolExecutor(2) as pool:
        for number, case in enumerate(pool.map(run, *zip(*work, strict=True), peers, slow), 1):
            cases.append(case)
            errors = ", ".join(f"{name} {1e3 * error:.3f}" for name, error in case.errors.items())
            text = f"{case.hole}, {case.tool}, {1e3 * case.noise:g} mm, seed {case.seed}: {errors} mm"
            print(f"{number}/{len(work)} {text}", flush=True)
    classes: dict[str, list[automatic.Measured]] = {}
    for name, (make, tuned) in automatic.CLASSES.items():
        classes[name] = []
        for each in make(seeds[0]):
            print(f"automatic, {name}, {each.name}", flush=True)
            classes[name].append(automatic.measure(each, tuned))
    redone = published.experiment(seeds[0])
    (docs / "evidence.md").write_text(page(cases, methods(slow=True)[1], redone, classes))
    draw(cases, docs / "evidence.png")
    published.draw(redone, docs / "evidence-published.png")


if __name__ == "__main__":
    main(*([int(seed) for seed in sys.argv[1:]] or SEEDS))
