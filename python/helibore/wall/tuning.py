"""`hb.tune`: find the estimator and the settings that rebuild a hole best, by leaving samples out.

Each candidate estimates a part of the samples from the other samples, in two ways:

    alone   only the sample itself is left out; this shows what noise does where samples are dense
    box     all samples in a box around it are left out; this shows what gaps do

The box is as large as the empty box around a random place on the wall. Half its width is the angle from this place to
the nearest sample within half a pitch of its depth. Half its height is the distance in depth to the nearest sample
within half a sector of its toolface, at most 1 m.

If a tool leaves most of each turn unmeasured, there are no samples between its arms to leave out. In this case the
likelihood of the samples first decides whether the shape of the hole continues along it (`helibore.wall.continuation`).

If only single samples were left out, choices would be wrong where samples are clustered, because most vertices lie
between the clusters.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.errors import InputError
from helibore.base.notebook import card
from helibore.settings.wall_settings import Settings
from helibore.wall.continuation import LEAST_GAIN, find_continuation
from helibore.wall.estimates import (
    Boxes,
    Columns,
    choose_left_out,
    estimate_left_out,
    find_kriging_range,
)

TUNED = ("estimator", "neighbors", "angular_scale", "kriging_range", "nugget")
"""The settings that a candidate may change."""
TUNED_ALONG = frozenset((*TUNED, "max_distance"))
"""The settings that a candidate may change if the shape of the hole continues along it. If the caller fixes one of
them, `tune` does not try this candidate (`helibore.wall.continuation`)."""
ANGULAR_SCALES = (0.5, 1.0, 2.0, 4.0, 8.0)
NUGGETS = (0.003, 0.02, 0.1, 0.4)
_CLIP = 12.0
"""Errors are clipped to this many robust deviations, so that one wrong sample does not decide."""
_MEDIAN_SQUARE = 0.455
"""Median of the square of a normal deviate with variance 1."""
_STANDARD_ERRORS = 2.0
_MOST_OF_KRIGING = 64  # neighbours; kriging takes no more
_ROUNDING = 1e-9  # metres
FEW_TARGETS = 300


@dataclass(frozen=True)
class Candidate:
    """Settings that were tried, and the errors they make."""

    settings: Settings  # settings of the wall
    alone: float  # root mean square error of the samples left out alone, metres; their noise is included
    box: float  # root mean square error of the samples left out with their boxes, metres
    gain_alone: float = 0.0  # mean square error of the first candidate less that of this candidate, in standard errors
    gain_box: float = 0.0  # the same for samples left out with their boxes

    @property
    def name(self) -> str:
        """The values of those settings in which candidates differ, as text."""
        if self.settings.estimator == "near-and-far":
            return "kriging with near and far neighbours"
        scale = f"angular_scale {self.settings.angular_scale:g}"
        if self.settings.estimator == "kriging":
            return f"kriging, {scale}, nugget {self.settings.nugget:g}"
        return f"inverse distance, {scale}, neighbors {self.settings.neighbors}"


@dataclass(frozen=True)
class Tuning:
    """What `tune` found.

    Attributes
    ----------
    settings
        The chosen settings, for ``hb.reconstruct(caliper, **vars(tuning.settings))``.
    best
        The chosen candidate, which has these settings.
    candidates
        All candidates; the first has the settings without tuning.
    targets
        Number of samples that were left out.
    continuation
        For a tool that leaves most of each turn unmeasured: the log-likelihood of a shape that continues along the hole
        less that of a shape that does not, nats a block. NaN if they were not compared,
        also because the caller fixed one of `TUNED_ALONG`.
    """

    best: Candidate
    candidates: tuple[Candidate, ...]
    targets: int
    continuation: float = np.nan

    @property
    def settings(self) -> Settings:
        """The settings of the chosen candidate."""
        return self.best.settings

    @property
    def gain(self) -> float:
        """Share by which the chosen candidate reduces `Candidate.box`, at most 1; negative if its error is larger."""
        before = self.candidates[0].box
        return 1.0 - self.best.box / before if before > 0 else 0.0

    @property
    def table(self) -> list[dict[str, Any]]:
        """One row per candidate: its name, errors (m), gains and whether it was chosen."""
        rows = [{"candidate": each.name} | asdict(each) | {"chosen": each is self.best} for each in self.candidates]
        return [{name: value for name, value in row.items() if name != "settings"} for row in rows]

    @property
    def sentence(self) -> str:
        """The result in words."""
        first, best = self.candidates[0], self.best
        text = f"{first.name}: cross-validated error {_millimetres(first)}"
        if self.continuation > LEAST_GAIN:
            return f"{first.name}: {_millimetres(first)}; {best.name}, because the shape goes on along the hole"
        if len(self.candidates) == 1:
            return text
        if best is first:
            return f"{text}; none of {len(self.candidates) - 1} other settings is better for certain"
        return f"{text}; {best.name}: {_millimetres(best)}, {100 * self.gain:.0f} % less in gaps"

    def __str__(self) -> str:
        return self.sentence

    def __repr__(self) -> str:
        return f"Tuning({self.best.name}; {len(self.candidates)} candidates, {self.targets} samples left out)"

    def svg(self) -> str:
        """Return a picture of both errors of all candidates; the name of the chosen candidate is bold."""
        most = max(max(each.alone, each.box) for each in self.candidates) or 1.0
        marks = []
        for y, each in enumerate(self.candidates, 2):
            weight = "bold" if each is self.best else "normal"
            marks.append(f'<text x="300" y="{18 * y + 4}" text-anchor="end" font-weight="{weight}">{each.name}</text>')
            for error, color in ((each.alone, "#8a9aa8"), (each.box, "#1f5fa8")):
                marks.append(f'<circle cx="{310 + 300 * error / most:.1f}" cy="{18 * y}" r="4" fill="{color}"/>')
        title = f"Cross-validated error, 0 to {1e3 * most:.3g} mm: grey beside samples, blue in gaps"
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 640 {18 * len(self.candidates) + 36}" '
            f'font-family="sans-serif" font-size="11" fill="currentColor">'
            f'<text x="10" y="16">{title}</text>{"".join(marks)}</svg>'
        )

    def _repr_html_(self) -> str:
        first, best = self.candidates[0], self.best
        numbers = {
            "chosen": best.name if best is not first else f"{best.name}, as without tuning",
            "error beside samples": f"{1e3 * first.alone:.3g} mm, tuned {1e3 * best.alone:.3g} mm",
            "error in gaps": f"{1e3 * first.box:.3g} mm, tuned {1e3 * best.box:.3g} mm",
            "left out": f"{self.targets} samples",
        }
        picture = self.svg().replace(' xmlns="http://www.w3.org/2000/svg"', "")  # HTML needs none
        return card("Tuning", numbers, f'<div style="flex:0 1 30em">{picture}</div>')


def _millimetres(of: Candidate) -> str:
    return f"{1e3 * of.alone:.3g} mm beside samples and {1e3 * of.box:.3g} mm in gaps"


def tuning_with(
    samples: Columns, settings: Settings, fixed: dict[str, Any], targets: int, threads: int, seed: int, boxes: int,
    may_continue: bool = True,
) -> Tuning:  # fmt: skip
    """Find the settings that rebuild a hole best; ``may_continue`` is False if the tool measures most of each turn."""
    depth, _, radius = samples
    rows, around = choose_left_out(samples, settings, targets, seed, "to tune", boxes)
    kinds: tuple[Boxes | None, ...] = (None, around)
    if settings.estimator == "near-and-far":
        from helibore.wall.near_and_far import estimate_near_and_far

        own = [[estimate_near_and_far(samples, rows, settings, each)[:, 0] - radius[rows]] for each in kinds]
        candidates = compared([settings], own, depth[rows])
        return Tuning(candidates[0], candidates, rows.size)
    ranges: dict[float, float] = {}

    def ranged(settings: Settings) -> Settings:
        if settings.estimator != "kriging" or fixed.get("kriging_range") is not None:
            return settings
        scale = settings.angular_scale
        ranges[scale] = ranges.get(scale) or find_kriging_range(samples, settings)
        return replace(settings, kriging_range=ranges[scale])

    first = settings if settings.kriging_range is not None else ranged(settings)
    trials = [estimate_left_out(samples, rows, first, each, threads).radius for each in kinds]
    tried, errors = [first], [[trial - radius[rows]] for trial in trials]
    for family, nuggets in _grid(first, fixed):
        ready = ranged(family)
        tried += [replace(ready, nugget=nugget) for nugget in nuggets] or [ready]
        for each, trial, of_kind in zip(kinds, trials, errors, strict=True):
            found = estimate_left_out(samples, rows, ready, each, threads, trial, nuggets)
            of_kind += [of - radius[rows] for of in found.by_nugget or [found.radius]]
    along, gain = None, np.nan
    if may_continue and not TUNED_ALONG & fixed.keys():
        along, gain = find_continuation(samples, first, seed)
    if along:
        tried.append(along)
        for each, of_kind in zip(kinds, errors, strict=True):
            of_kind.append(estimate_left_out(samples, rows, along, each, threads).radius - radius[rows])
    candidates = compared(tried, errors, depth[rows])
    if along:  # leaving samples out does not test the wall between arms
        return Tuning(candidates[-1], candidates, rows.size, gain)
    passed = [each for each in candidates if min(each.gain_alone, each.gain_box) > _STANDARD_ERRORS]
    return Tuning(min(passed, key=lambda each: each.box, default=candidates[0]), candidates, rows.size, gain)


def _grid(first: Settings, fixed: dict[str, Any]) -> Iterator[tuple[Settings, tuple[float, ...]]]:
    """Yield the settings of candidates, each with the nuggets to try; inverse distance has no nuggets."""
    usual = "kriging" if (fixed.get("neighbors") or 0) <= _MOST_OF_KRIGING else "inverse-distance"
    kriging = fixed.get("estimator", usual) == "kriging"
    chosen: dict[str, Any] = {"estimator": "kriging"} if kriging else {}
    if kriging and "neighbors" not in fixed:
        chosen["neighbors"] = 16
    for scale in (fixed["angular_scale"],) if "angular_scale" in fixed else ANGULAR_SCALES:
        nuggets = ((fixed["nugget"],) if "nugget" in fixed else NUGGETS) if kriging else ()
        yield replace(first, **chosen, angular_scale=scale), nuggets


def compared(tried: list[Settings], errors: list[list[Floats]], depth: Floats) -> tuple[Candidate, ...]:
    """Compare each candidate with the first at the samples left out alone, and at those left out with their boxes."""
    (alone, gain_alone), (box, gain_box) = (errors_and_gains(of_kind, depth) for of_kind in errors)
    columns = (of.tolist() for of in (alone, box, gain_alone, gain_box))
    return tuple(Candidate(*row) for row in zip(tried, *columns, strict=True))


def errors_and_gains(errors: list[Floats], depth: Floats) -> tuple[Floats, Floats]:
    """Return the root mean square error of each candidate (m), and its gain over the first, in standard errors.

    They are compared sample by sample. Neighbouring errors are correlated. So the standard error counts all errors in
    one metre of hole as one error (in a short hole, all errors in a fortieth of its length).
    """
    squares = np.array(errors) ** 2
    squares[squares < _ROUNDING**2] = 0.0
    known = np.isfinite(squares).all(axis=0)
    if not known.any():
        rule = "too few samples to tune: no sample has another one outside its box and within max_distance"
        raise InputError("samples", rule)
    block = max(min(1.0, np.ptp(depth) / 40), 1e-6)
    squares, metre = squares[:, known], np.unique(np.floor(depth[known] / block), return_inverse=True)[1]
    some = squares[0][squares[0] > 0.0]  # radii in coarse steps leave most errors of a smooth hole at 0
    squares = np.minimum(squares, _CLIP**2 * (np.median(some) if some.size else 0.0) / _MEDIAN_SQUARE)
    gain = squares[0] - squares
    sums = np.array([np.bincount(metre, each - each.mean()) for each in gain])
    deviation = np.sqrt(np.sum(sums**2, axis=1)) / squares.shape[1]
    share: Floats = np.divide(gain.mean(axis=1), deviation, out=np.zeros(len(errors)), where=deviation > 0)
    return np.sqrt(squares.mean(axis=1)), share
