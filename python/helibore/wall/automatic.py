"""``estimator="automatic"``: the cheapest estimator whose expected error is near the best.

A covariance is fitted to the samples (`helibore.wall.covariance`). The expected errors of inverse distance, of kriging
with several settings, and of kriging with near and far neighbours are compared. Where a tool measures all around the
hole, samples that are left out show the errors, whatever the hole is like: the choice is that of
`helibore.wall.tuning`, unless near and far neighbours are certainly better. Between the arms of a tool there are no
such samples. There the covariance gives the expected error, at random places of the wall, of any weighted mean of
samples; the cheapest estimator within 3 % of the best is taken.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from helibore.base.arrays import Floats, Integers
from helibore.base.errors import InputError
from helibore.base.thread_count import thread_count
from helibore.samples.caliper import Caliper
from helibore.settings.wall_settings import Settings
from helibore.wall.continuation import leaves_most_unmeasured
from helibore.wall.covariance import FEWEST, Covariance, Term, content_seed, fit_covariance
from helibore.wall.estimates import (
    Columns,
    choose_left_out,
    estimate_left_out,
    find_kriging_range,
    in_depth_order,
)
from helibore.wall.near_and_far import Place, Places, estimate_near_and_far
from helibore.wall.tuning import errors_and_gains, tuning_with

NEAR_BEST = 1.03
"""An estimator whose expected error is at most this multiple of the best may be taken."""
CERTAIN = 2.0
"""Standard errors by which near and far neighbours must be better at samples that are left out."""
NEIGHBORS = 16
"""Neighbours of kriging, and of each of the three sets of near and far neighbours."""
_ANGULAR_SCALES, _NUGGETS = (1.0, 2.0, 4.0, 8.0), (0.003, 0.02, 0.1, 0.4, 4.0)
_PLACES = 80
_TUNED, _LEFT_OUT = 2000, 1000
_LONGEST = 60.0  # metres: the greatest distance that is found
LABELS = {
    "inverse-distance": "inverse distance",
    "kriging": "kriging",
    "near-and-far": "kriging with near and far neighbours",
}


@dataclass(frozen=True)
class Choice:
    """What `choose` found.

    Attributes
    ----------
    settings
        The settings of the wall, which repeat it bit for bit.
    errors
        The expected rms error of each estimator, metres, cheapest estimator first; {} if no covariance was fitted.
    reason
        Why there are no errors; "" if there are.
    """

    settings: Settings
    errors: dict[str, float]
    reason: str = ""

    @property
    def sentence(self) -> str:
        """The result in words."""
        if self.reason:
            return f"inverse distance, because {self.reason}"
        chosen = self.settings.estimator
        others = [f"{LABELS[name]} {1e3 * of:.3g} mm" for name, of in self.errors.items() if name != chosen]
        return f"{LABELS[chosen]}: expected error {1e3 * self.errors[chosen]:.3g} mm; {', '.join(others)}"


def choose(caliper: Caliper, settings: Settings) -> Choice:
    """Choose the estimator for the samples of a hole, and its settings.

    Of ``settings``, whose estimator is 'automatic', ``angular_scale``, ``kriging_range``, ``nugget``, ``covariance``
    and ``neighbors`` are replaced as the chosen estimator needs, and ``max_distance`` if it has its default.
    """
    simple = replace(settings, estimator="inverse-distance")
    if caliper.basis != "azimuthal":
        return Choice(simple, {}, "no caliper measured around the hole")
    if settings.window is not None:
        return Choice(simple, {}, "the settings have a window")
    samples = in_depth_order(caliper)
    if samples[0].size < FEWEST:
        return Choice(simple, {}, f"{samples[0].size} samples are too few for a fit: at least {FEWEST}")
    covariance = fit_covariance(samples)
    if covariance is None:
        return Choice(simple, {}, "all radii are equal")
    full = near_and_far(covariance, settings)
    if not leaves_most_unmeasured(samples, simple):
        with suppress(InputError):  # too few samples, or none has another one within max_distance
            return _by_samples_left_out(samples, simple, full, covariance.noise)
    depth = samples[0]
    rng = np.random.default_rng(content_seed(samples))
    places = list(
        zip(rng.uniform(depth[0], depth[-1], _PLACES).tolist(), rng.uniform(0.0, 360.0, _PLACES).tolist(), strict=True)
    )
    kriged, of_kriging = _best_kriging(samples, covariance, simple, places)
    of_full = Places(samples, covariance, NEIGHBORS, _limit(full))
    errors = {
        "inverse-distance": _expected(_inverse_distance(samples, covariance, simple, places)),
        "kriging": of_kriging,
        "near-and-far": _expected(of_full.estimates(places)[:, 1]),
    }
    best = min(errors.values())
    chosen = next(name for name, error in errors.items() if error <= NEAR_BEST * best)
    return Choice({"inverse-distance": simple, "kriging": kriged, "near-and-far": full}[chosen], errors)


def _by_samples_left_out(samples: Columns, simple: Settings, full: Settings, noise: float) -> Choice:
    """Choose as `helibore.wall.tune` does, then near and far neighbours if they are certainly better.

    The errors are those at samples that are left out with an empty box around them, less the variance of noise.
    """
    seed, threads = content_seed(samples), thread_count(None)
    tuned = tuning_with(samples, simple, {}, _TUNED, threads, seed, _TUNED, may_continue=False).best.settings
    rows, boxes = choose_left_out(samples, simple, _LEFT_OUT, seed, "to choose")
    found = [estimate_left_out(samples, rows, of, boxes, threads).radius for of in (tuned, simple)]
    found.append(estimate_near_and_far(samples, rows, full, boxes)[:, 0])
    off, gain = errors_and_gains([of - samples[2][rows] for of in found], samples[0][rows])
    names = ("inverse-distance", tuned.estimator, "near-and-far")
    expected = np.sqrt(np.maximum(off[[1, 0, 2]] ** 2 - noise, 0.01 * noise))
    return Choice(full if gain[2] > CERTAIN else tuned, dict(zip(names, expected.tolist(), strict=True)))


def near_and_far(covariance: Covariance, settings: Settings) -> Settings:
    """Return the settings of kriging with near and far neighbours."""
    values = [covariance.radius, covariance.noise, *(value for term in covariance.terms for value in term)]
    values += [covariance.turn] if covariance.turn else []
    reach = settings.max_distance
    if reach == Settings.max_distance:
        longest = max(term.along for term in covariance.terms)
        reach = float(np.clip(2.0 * longest, Settings.max_distance or 1.0, _LONGEST))
    return replace(
        settings, estimator="near-and-far", covariance=tuple(values), neighbors=NEIGHBORS, max_distance=reach
    )


def _limit(settings: Settings) -> float:
    return np.inf if settings.max_distance is None else settings.max_distance


def _expected(squares: Iterator[float] | Any) -> float:
    """Return the root mean square of expected errors; places without a sample in reach do not count."""
    known = np.array([square for square in squares if np.isfinite(square)])
    return float(np.sqrt(known.mean())) if known.size else np.inf


def _metric(settings: Settings) -> Term:
    return Term(1.0, 1.0 / settings.angular_scale, 1.0)


def _inverse_distance(
    samples: Columns, covariance: Covariance, settings: Settings, places: list[Place]
) -> Iterator[float]:
    among = Places(samples, covariance, settings.neighbors, _limit(settings))
    for place, rows in zip(places, among.nearest(places, _metric(settings), settings.neighbors), strict=True):
        if rows.size:
            distance = np.maximum(_distances(among, rows, place, settings.angular_scale), 1e-9)
            weights = (distance.min() / distance) ** settings.power
            yield among.square_error(rows, weights / weights.sum(), place)


def _distances(among: Places, rows: Integers, place: Place, scale: float) -> Floats:
    depth, toolface, _ = among.samples
    return np.hypot(scale * among.across(toolface[rows], place[1]), depth[rows] - place[0])


def _best_kriging(
    samples: Columns, covariance: Covariance, settings: Settings, places: list[Place]
) -> tuple[Settings, float]:
    """Return the settings of kriging that have the least expected error, and this error."""
    tried = []
    for scale in _ANGULAR_SCALES:
        each = replace(settings, estimator="kriging", neighbors=NEIGHBORS, angular_scale=scale)
        reach = settings.kriging_range or find_kriging_range(samples, each)
        squares = np.array(list(_kriging(samples, covariance, replace(each, kriging_range=reach), places)))
        for nugget, of in zip(_NUGGETS, squares.T, strict=True):
            tried.append((_expected(of), scale, nugget, reach))
    error, scale, nugget, reach = min(tried)
    found = replace(
        settings, estimator="kriging", neighbors=NEIGHBORS, angular_scale=scale, nugget=nugget, kriging_range=reach
    )
    return found, error


def _kriging(
    samples: Columns, covariance: Covariance, settings: Settings, places: list[Place]
) -> Iterator[list[float]]:
    """Yield for each place the expected square of the error with each of the nuggets."""
    among = Places(samples, covariance, NEIGHBORS, _limit(settings))
    depth, toolface, _ = samples
    scale, half_turn = settings.angular_scale, np.pi * covariance.radius * settings.angular_scale
    reach = min(settings.kriging_range or half_turn, half_turn)

    def wendland(distance: Floats) -> Floats:
        part = np.minimum(distance / reach, 1.0)
        found: Floats = (1.0 - part) ** 4 * (1.0 + 4.0 * part)
        return found

    for place, rows in zip(places, among.nearest(places, _metric(settings), NEIGHBORS), strict=True):
        if not rows.size:
            yield [np.nan] * len(_NUGGETS)
            continue
        turn = np.abs(toolface[rows][:, None] - toolface[rows])
        across = np.radians(np.minimum(turn, 360.0 - turn)) * covariance.radius * scale
        between = wendland(np.hypot(across, depth[rows][:, None] - depth[rows]))
        toward = wendland(_distances(among, rows, place, scale))
        real, real_toward = among.between(rows), among.toward(rows, place)
        errors = []
        for nugget in _NUGGETS:
            sides = np.stack([np.ones(rows.size), toward], axis=1)
            one, of_place = np.linalg.solve(between + nugget * np.eye(rows.size), sides).T
            weights = of_place + one * ((1.0 - of_place.sum()) / one.sum())
            errors.append(max(covariance.variance + weights @ real @ weights - 2.0 * weights @ real_toward, 0.0))
        yield errors
