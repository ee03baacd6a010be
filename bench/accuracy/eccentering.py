"""Measure how well the tool's centre is found, and which errors remain in the wall.

    python -m bench.accuracy.eccentering [centres] [whirls] [walls]

"centres": 300 turns of a simulated tool 10 mm off centre (tests/python/preparation/test_eccentering.py), each case with
two seeds. Unless a case is "one hole", each turn has random toolfaces and its own shape, so that a turn says nothing
about other turns.

    error    rms over the samples of corrected minus true radius, without each sample's own noise, mm
    bound    least rms of an unbiased fit (Cramer and Rao) that knows shape and place of oval and lobes but not their
             size; only for cases whose samples miss a random half
    covered  turns whose true centre lies within three standard deviations on both axes, %; the bar is 99
    sigma    stated standard deviation of the centre, median of turns, mm
    doubt    turns in which a wall enlarged on one side counts fully (``Centres.one_sided``), %

"whirls": the share of turns that are covered (as above) or refused (no centre is found). The bit size is known. A tool
whirls at 30 to 330 degrees a turn in each of `HOLES`, or rests centred. The least and the mean share over the rates are
printed, each with two seeds that no test uses.

"walls": the rms error of a wall that ``hb.reconstruct`` makes from half of the samples, and its causes:

    points   samples at their true places, centred and without noise; the error is that of interpolation
    noise    the same samples with their noise
    found    samples as measured, recentred by the library
    left     sqrt(found^2 - noise^2), the error that the correction adds
    along    as "found", with ``angular_scale=4``, which takes neighbours from above and below first
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import helibore as hb
from helibore.preparation.eccentering import find_centres, recentre

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "python" / "preparation"))
from test_eccentering import BELL_WASHOUT, WASHOUT, Simulated, lobe

HALF = {"missing": "half circle"}
CASES = {
    "bar, 64 a turn": {}, "bar, 128 a turn": {"samples": 128}, "bowl-shaped lobes, 64": {"edge": "bowl"},
    "box-edged lobes, 64": {"edge": "box"},
    "box, 64, one hole": {"edge": "box", "steady": True},
    "box-edged lobes, 128": {"edge": "box", "samples": 128},
    "centred tool": {"eccentering": 0.0}, "centred, round hole": {"eccentering": 0.0, "lobes": 0.0, "ovality": 0.0},
    "half circle missing": HALF, "half, box-edged lobes": HALF | {"edge": "box"},
    "half, washout 30 mm": HALF | WASHOUT, "half, washout 20 mm": HALF | BELL_WASHOUT,
    "half, washout and lobes": HALF | {"washout": 0.015, "edge": "bowl"},
    "washout 30 mm, box": WASHOUT, "washout 20 mm": BELL_WASHOUT,
}  # fmt: skip


def bound(tool: Simulated) -> float:
    """Return the bound that the module's docstring defines, metres.

    It comes from the Fisher matrix of centre, mean radius, oval and lobe depth.
    """
    reach = (tool.radius - tool.noise) * np.exp(1j * np.radians(tool.toolface))
    phi = np.angle((tool.x + 1j * tool.y)[tool.turn] + reach).reshape(tool.x.size, -1)
    terms = [np.cos(phi), np.sin(phi), np.ones_like(phi), np.cos(2 * phi), np.sin(2 * phi)]
    shape = tool.shape(phi) - 0.108
    if np.ptp(shape) > 0.01:
        terms.append(shape / 0.01)
    design = np.stack(terms, axis=2)
    covariance = np.linalg.inv(np.swapaxes(design, 1, 2) @ design) * np.std(tool.noise) ** 2
    return float(np.sqrt(0.5 * np.mean(covariance[:, 0, 0] + covariance[:, 1, 1])))


def centres() -> None:
    print(f"{'case':26s} {'error':>7s} {'bound':>7s} {'covered':>8s} {'sigma':>7s} {'doubt':>6s}")
    for name, case in CASES.items():
        rows = []
        for seed in (1, 2):
            tool = Simulated(seed, **case)
            found = tool.centres()
            sigma = np.median(np.hypot(found.sigma_x, found.sigma_y))
            least = np.nan if "missing" in case else 1e3 * bound(tool)
            rows.append((1e3 * tool.error(found), least, 100 * tool.inside(found), 1e3 * sigma,
                         100 * np.mean(found.one_sided > 0.99)))  # fmt: skip
        error, least, covered, sigma, doubt = np.mean(rows, axis=0)
        print(f"{name:26s} {error:7.3f} {least:7.3f} {covered:8.2f} {sigma:7.2f} {doubt:6.1f}")


HOLES = {
    "breakouts": ((0, 60, 0.012, "bell"), (180, 60, 0.012, "bell")),
    "uneven breakouts": ((0, 60, 0.020, "bell"), (170, 45, 0.010, "box")),
    "wide key seat": ((0, 120, 0.025, "bowl"),),
    "washout on one side": ((0, 200, 0.020, "bell"),),
    "round": (),
}
RATES = (30, 60, 84, 100, 120, 150, 180, 200, 230, 250, 270, 300, 330, -30, -84, -150, -200, -270, -300)


def whirling(seed: int, hole: str, rate: float, far: float, turns: int = 63, samples: int = 64) -> tuple[float, float]:
    """Return the share of turns whose centre is covered at three standard deviations or refused, and the share refused.

    ``far`` is the distance of the tool from the axis of the bit, metres; ``rate`` is the whirl in degrees a turn.
    Centres are measured from this axis. A wall enlarged on one side does not show where the axis is.
    """
    rng = np.random.default_rng(seed)
    position = (np.arange(turns * samples) + 0.8 * rng.random(turns * samples)) / samples
    angle, (at, oval, begin) = 2 * np.pi * position, 2 * np.pi * rng.random(3)
    centre = far * np.exp(1j * (np.radians(rate) * position + begin))

    def wall(phi: np.ndarray) -> np.ndarray:
        radius = 0.108 + 0.002 * (1 + np.cos(2 * (phi - oval)))
        for where, width, depth, edge in HOLES[hole]:
            radius = radius + lobe(phi, at + np.radians(where), width, depth, edge)
        return radius

    inner, outer = np.full(angle.size, 0.02), np.full(angle.size, 0.3)
    for _ in range(40):
        middle = 0.5 * (inner + outer)
        point = centre + middle * np.exp(1j * angle)
        inside = np.abs(point) < wall(np.angle(point))
        inner, outer = np.where(inside, middle, inner), np.where(inside, outer, middle)
    radius = inner + rng.normal(0, 0.0005, angle.size)
    toolface = np.degrees(angle)
    found = find_centres(toolface, radius, np.floor(position), bit_diameter=0.216, position=position)
    truth = far * np.exp(1j * (np.radians(rate) * (found.turn + 0.5) + begin))
    refused = np.isnan(found.x)
    near = (np.abs(found.x - truth.real) <= 3 * found.sigma_x) & (np.abs(found.y - truth.imag) <= 3 * found.sigma_y)
    return float(np.mean(near | refused)), float(np.mean(refused))


def whirls() -> None:
    print(f"\n{'whirl: covered or refused, %':28s} offset   least    mean  refused   worst rate")
    for hole in HOLES:
        for far in (0.0, 0.003, 0.010):
            found = np.array([
                [np.mean([whirling(seed, hole, rate, far) for seed in (7001, 7002)], axis=0)]
                for rate in (RATES if far else (0,))
            ])[:, 0]  # fmt: skip
            worst = int(np.argmin(found[:, 0]))
            least, mean, refused = 100 * found[worst, 0], *(100 * found.mean(axis=0))
            at = RATES[worst] if far else "at rest"
            print(f"{hole:28s} {1e3 * far:6.0f} {least:7.1f} {mean:7.1f} {refused:8.1f}   {at}")


def walls() -> None:
    heads = "".join(f" {name:>7s}" for name in ("points", "noise", "found", "left", "along"))
    print(f"\n{'wall, half of the samples':26s}{heads}   mm rms")
    for samples in (64, 128, 256):
        for edge in ("bell", "box"):
            tool = Simulated(10, samples=samples, steady=True, edge=edge)
            depth = 0.02 * (tool.turn + tool.toolface / 360)
            centre = (tool.x + 1j * tool.y)[tool.turn]
            turned = np.degrees(np.angle(centre + (tool.radius - tool.noise) * np.exp(1j * np.radians(tool.toolface))))
            found = find_centres(tool.toolface, tool.radius, tool.turn)
            recentred = recentre(tool.toolface, tool.radius, tool.turn, found)
            errors = []
            seen = ((turned, tool.wall), (turned, tool.wall + tool.noise), recentred, recentred)
            for (toolface, radius), scale in zip(seen, (1.0, 1.0, 1.0, 4.0), strict=True):
                caliper = hb.Caliper(depth, toolface, radius)
                wall = hb.reconstruct(
                    caliper,
                    bit_diameter=0.216,
                    sectors=samples,
                    pitch=0.02,
                    angular_scale=scale,
                    estimator="inverse-distance",
                )
                truth = tool.shape(np.radians(wall.toolface)).ravel()
                errors.append(1e3 * np.sqrt(np.mean((wall.radius - truth) ** 2)))
            left = np.sqrt(max(errors[2] ** 2 - errors[1] ** 2, 0.0))
            name = f"{samples} a turn, {edge} lobes"
            print(f"{name:26s} {errors[0]:7.3f} {errors[1]:7.3f} {errors[2]:7.3f} {left:7.3f} {errors[3]:7.3f}")


if __name__ == "__main__":
    for part in sys.argv[1:] or ("centres", "whirls", "walls"):
        {"centres": centres, "whirls": whirls, "walls": walls}[part]()
