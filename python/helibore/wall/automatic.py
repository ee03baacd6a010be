"""``estimator="automatic"``: the estimator that suits the samples of a hole.

A covariance is fitted to the samples (`helibore.wall.covariance`), or one to each of the stretches that are unlike
(`helibore.wall.stretches`). Where a tool measures all around the hole, samples that are left out show the errors,
whatever the hole is like: the choice is that of `helibore.wall.tuning`, unless near and far neighbours are certainly
better. Between the arms of a tool, and between the samples of slow telemetry, there are no such samples: near and far
neighbours are taken. The errors that are expected are those by which the chosen wall states its sigma: at samples left
out, or, of near and far neighbours, by the covariance at random places of the wall. Where no arm saw the wall, no error
can be known (as for `Wall.sigma`); the share is stated.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from helibore.base.arrays import Floats, Integers, distinct
from helibore.base.errors import InputError
from helibore.base.thread_count import thread_count
from helibore.samples.caliper import Caliper
from helibore.settings.wall_settings import Settings
from helibore.wall.arm_biases import follow_the_shape, found_biases, without_biases
from helibore.wall.continuation import leaves_most_unmeasured, spread_gaps
from helibore.wall.covariance import (
    FEWEST,
    CovarianceFrom,
    Likely,
    content_seed,
    likely_covariances,
    noise_at,
    other_turns,
    stretch_of,
    stretch_values,
    stretches_of,
)
from helibore.wall.estimates import (
    MOST_BOX_DEPTH,
    Boxes,
    Columns,
    choose_left_out,
    estimate_left_out,
    estimate_places,
    in_depth_order,
)
from helibore.wall.near_and_far import Place, estimate_near_and_far, estimates_at
from helibore.wall.spikes import has_spikes
from helibore.wall.stretches import find_stretches
from helibore.wall.tuning import errors_and_gains, tuning_with
from helibore.wall.uncertainty import shows_events, with_gaps_of_shape

CERTAIN = 1.0
"""Standard errors by which near and far neighbours must be better at samples that are left out."""
MOST_OPEN = 0.4
"""Share of the places in the turns of samples that may have no sample near their toolface, up to `MOST_BOX_DEPTH` above
and below: of more, samples that are left out do not show the errors."""
NEIGHBORS = 16
"""Neighbours of each of the three sets of near and far neighbours."""
_PLACES = 100
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
        The expected rms error of each estimator that was compared, metres, cheapest estimator first; {} if none can be
        known.
    known
        Share of the wall where the errors can be known; the rest lies in gaps that no arm saw.
    reason
        Why no covariance was fitted; "" if one was.
    """

    settings: Settings
    errors: dict[str, float]
    known: float = 1.0
    reason: str = ""

    @property
    def sentence(self) -> str:
        """The result in words."""
        if self.reason:
            return f"inverse distance, because {self.reason}"
        chosen = self.settings.estimator
        if not self.errors:
            return f"{LABELS[chosen]}; its error so far from samples cannot be known{self._notes}"
        others = ", ".join(f"{LABELS[name]} {1e3 * of:.3g} mm" for name, of in self.errors.items() if name != chosen)
        expected = f"expected error {1e3 * self.errors[chosen]:.3g} mm{self.where}"
        return f"{LABELS[chosen]}: {expected}; {others}{self._notes}"

    @property
    def _notes(self) -> str:
        greatest = 1e3 * max(map(abs, self.settings.arm_biases or ()), default=0.0)
        notes = [f"; subtracts biases of arms, up to {greatest:.2g} mm"] if greatest else []
        if self.settings.estimator == "near-and-far" and self.settings.stretches:
            notes.append(f"; the hole changes along it: {len(stretches_of(self.settings)) - 2} stretches")
        return "".join([*notes, "; spikes hardly count"] if self.settings.robust else notes)

    @property
    def where(self) -> str:
        """The part of the wall where the errors can be known, in words; "" if it is the whole wall."""
        return "" if self.known > 0.995 else f" where it can be known, on {100 * self.known:.0f} % of the wall"


def choose(caliper: Caliper, settings: Settings, threads: int | None = None) -> Choice:
    """Choose the estimator for the samples of a hole, and its settings.

    Of ``settings``, whose estimator is 'automatic', ``angular_scale``, ``kriging_range``, ``nugget``, ``covariance``
    and ``neighbors`` are replaced as the chosen estimator needs, ``max_distance`` if it has its default, and
    ``arm_biases`` if they are not given; the covariance is then that of the samples without these biases.
    """
    simple = replace(settings, estimator="inverse-distance")
    if caliper.basis != "azimuthal":
        return Choice(simple, {}, reason="no caliper measured around the hole")
    if settings.window is not None:
        return Choice(simple, {}, reason="the settings have a window")
    seeks = settings.arm_biases is None
    if seeks:
        settings = replace(settings, arm_biases=found_biases(caliper, threads=threads))
    samples = in_depth_order(without_biases(caliper, settings))
    if samples[0].size < FEWEST:
        return Choice(simple, {}, reason=f"{samples[0].size} samples are too few for a fit: at least {FEWEST}")
    dense = not leaves_most_unmeasured(samples, settings)
    settings = replace(settings, robust=dense and has_spikes(samples))
    likely = likely_covariances(samples, robust=settings.robust, threads=threads)
    if not likely:
        return Choice(simple, {}, reason="all radii are equal")
    if seeks and settings.arm_biases:
        likely = follow_the_shape(caliper, settings.arm_biases, likely[0][0], threads) or likely
        settings = replace(settings, arm_biases=found_biases(caliper, likely[0][0]))
        samples = in_depth_order(without_biases(caliper, settings))
    if dense:  # near samples decide, whatever the turn is
        likely = [(likely[0][0], 1.0)]
    plain = min((of for of, _ in likely), key=lambda of: (of.half_turns, abs(of.turn)))
    stretches = find_stretches(samples, plain, dense, settings.robust, threads)
    full, seed = near_and_far(likely[:1] if stretches else likely, settings, stretches), content_seed(samples)
    with suppress(InputError):  # too few samples, or none has another one within max_distance
        rows, boxes = choose_left_out(samples, simple, _LEFT_OUT, seed, "to choose")
        near = _open_share(boxes) <= MOST_OPEN
        if near and (cheaper := _as_good(samples, rows, boxes, simple, full, seed, thread_count(threads))):
            return cheaper
    places, known = _known_places(samples, full)
    return Choice(full, _expected(samples, places, full, simple), known)


def _open_share(boxes: Boxes) -> float:
    """Return the share of the boxes that reach `MOST_BOX_DEPTH`, of those at whose depth there are samples."""
    height, width = boxes
    beside = height[width < 180.0]
    return float(np.mean(beside >= MOST_BOX_DEPTH)) if beside.size else 1.0


def _as_good(
    samples: Columns, rows: Integers, boxes: Boxes, simple: Settings, full: Settings, seed: int, threads: int
) -> Choice | None:
    """Choose as `helibore.wall.tune` does; None if near and far neighbours are certainly better.

    They also are if they are robust: samples that are left out, which may be spikes too, do not show how far an
    estimator follows spikes. The errors are those at samples that are left out with an empty box around them, less the
    variance of noise.
    """
    if full.robust:
        return None
    tuned = tuning_with(samples, simple, {}, _TUNED, threads, seed, _TUNED, may_continue=False).best.settings
    found = [estimate_left_out(samples, rows, of, boxes, threads).radius for of in (tuned, simple)]
    found.append(estimate_near_and_far(samples, rows, full, boxes)[:, 0])
    off, gain = errors_and_gains([of - samples[2][rows] for of in found], samples[0][rows])
    if gain[2] > CERTAIN:
        return None
    names = ("inverse-distance", tuned.estimator, "near-and-far")
    noise = float(noise_at(full, samples[0][rows]).mean())
    expected = np.sqrt(np.maximum(off[[1, 0, 2]] ** 2 - noise, 0.01 * noise))
    return Choice(tuned, dict(zip(names, expected.tolist(), strict=True)))


def near_and_far(likely: Likely, settings: Settings, stretches: Sequence[CovarianceFrom] = ()) -> Settings:
    """Return the settings of kriging with near and far neighbours by likely covariances, or those of stretches."""
    reach = settings.max_distance
    if reach == Settings.max_distance:
        covariances = [of.covariance for of in stretches] or [of for of, _ in likely]
        longest = max(term.along for covariance in covariances for term in covariance.terms)
        reach = float(np.clip(2.0 * longest, Settings.max_distance or 1.0, _LONGEST))
    turns = other_turns(likely)
    return replace(
        settings, estimator="near-and-far", neighbors=NEIGHBORS, covariance=likely[0][0].values, other_turns=turns,
        stretches=stretch_values(stretches), max_distance=reach,
    )  # fmt: skip


def _root(squares: Floats) -> float:
    """Return the root of the mean of expected squares; places without a sample in reach do not count."""
    known = squares[np.isfinite(squares)]
    return float(np.sqrt(known.mean())) if known.size else np.inf


def _known_places(samples: Columns, settings: Settings) -> tuple[list[Place], float]:
    """Return random places of the wall where an arm saw it, and their share of all places."""
    events = shows_events(samples, settings, thread_count(None))
    stretches = stretches_of(settings)
    seen: list[Integers] = []
    for number in distinct(stretch_of(stretches, samples[0])).tolist():
        covariance = stretches[number].covariance
        rules = with_gaps_of_shape(samples, settings, covariance, events)
        spread, gaps = spread_gaps(samples, settings, rules.gap_reach)
        chosen = np.random.default_rng(content_seed(samples)).choice(gaps.size, min(_PLACES, gaps.size), replace=False)
        there = stretch_of(stretches, spread.depth(chosen)) == number
        seen.append(chosen[there & (gaps[chosen] <= rules.largest_gap)])
    known = np.concatenate(seen)
    places = zip(spread.depth(known).tolist(), spread.toolface(known).tolist(), strict=True)
    return list(places), known.size / chosen.size


def _expected(samples: Columns, places: list[Place], full: Settings, simple: Settings) -> dict[str, float]:
    """Return the expected errors at places by the covariances of ``full``, metres; {} if there is no place.

    Near and far neighbours give the mean and the variance of the radius there; another estimator is also off by its
    difference from the mean.
    """
    if not places:
        return {}
    mean, variance = estimates_at(samples, places, full).T
    other = estimate_places(samples, places, simple)
    found = {"inverse-distance": _root(variance + (other - mean) ** 2), "near-and-far": _root(variance)}
    return found if np.isfinite(list(found.values())).all() else {}
