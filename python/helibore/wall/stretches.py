"""Stretches of a hole that are unlike each other: where a hole changes along it, and the covariance of each stretch.

    depth -->   | part  | part  | part  | part   | part   | part  |     each a metre or more, with `_FEWEST` samples
                  quiet   quiet   quiet   washed   washed   quiet

Each part of the hole has blocks of samples, and the covariance that is likeliest by them. Those of all parts, and that
of the whole hole, are candidates: each has a likelihood in each part. The hole is cut into the stretches that are
likeliest, each with one candidate; each further stretch must gain so many nats. Stretches that one candidate suits
about as well are alike: they share the covariance that is likeliest by the samples of all of them. Each border is then
moved to where it is likeliest within the two parts beside it, by slices of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats, Integers, distinct
from helibore.base.thread_count import thread_count
from helibore.wall.covariance import (
    BLOCK_SIZE,
    Covariance,
    CovarianceFrom,
    choose_blocks,
    content_seed,
    covariance_of,
    typical_spacing,
    values_without_spikes,
)
from helibore.wall.estimates import Columns

_MOST_PARTS, _SHORTEST, _FEWEST = 32, 1.0, 128
_OF_PART, _OF_STRETCH = 2, 12
"""Blocks of each kind, of a part and of stretches that are alike."""
_MOST_BLOCKS = 4
"""A part counts as so many blocks, at most: the likelihood of many samples of one metre says too little of the rest."""
_SLICES, _OF_SLICE = 16, 8
"""Of the two parts beside a border, and samples of a slice, at least."""
_GAIN, _GAIN_BETWEEN_ARMS = 40.0, 150.0
"""Nats that one more stretch must gain. With half as many, a hole with a breakout in every other metre has a stretch
for each of them, and a worse wall. Arms look at a few toolfaces only: where none meets a breakout that turns, the hole
looks quiet. Such parts gain up to 110 nats; ledges and strong breakouts 700 or more, weak ones by four arms only 90."""

Cut = tuple[list[int], list[int]]
"""The parts at which stretches begin, and the candidate of each stretch."""


def find_stretches(
    samples: Columns, whole: Covariance, dense: bool, robust: bool, threads: int | None
) -> list[CovarianceFrom]:
    """Return the stretches of a hole, whose samples are in order of depth; [] if it is alike all along.

    ``whole``: the covariance of the whole hole, of several likely ones that without turns. It counts again below the
    samples. ``dense``: whether the tool measured all around the hole.
    """
    edges, rng = _edges(samples[0]), np.random.default_rng(content_seed(samples))
    if edges.size < 3:
        return []
    workers, spacing = thread_count(threads), typical_spacing(samples, whole.radius)

    def blocks_of(each: Sequence[Integers], number: int) -> tuple[Columns, int]:
        """Return the samples of blocks of parts of the hole, whose rows are given, and the number of blocks of one."""
        rows = [of[choose_blocks(samples[0][of], samples[1][of], whole.radius, rng, number)] for of in each]
        return values_without_spikes(samples, np.concatenate(rows).ravel(), robust), rows[0].shape[0]

    parts = [np.arange(low, high) for low, high in pairwise(edges.tolist())]
    columns, blocks = blocks_of(parts, _OF_PART)
    starts = [whole.values] * len(parts)
    candidates = [
        whole.values,
        *map(tuple, _core.covariances_near(columns, BLOCK_SIZE, blocks, starts, spacing, workers)),
    ]
    likelihoods = _core.covariance_likelihoods(columns, BLOCK_SIZE, blocks, candidates, workers)
    weights = np.minimum(np.diff(edges) / BLOCK_SIZE, _MOST_BLOCKS)
    likelihoods, gain = weights[:, None] * likelihoods, _GAIN if dense else _GAIN_BETWEEN_ARMS
    cuts, chosen = _join_alike(likelihoods, _cut(likelihoods, gain), gain)
    if len(cuts) == 1:
        return []
    kinds = distinct(np.array(chosen)).tolist()
    of_part = np.repeat(chosen, np.diff([*cuts, len(parts)]))
    alike = [np.concatenate([parts[n] for n in np.flatnonzero(of_part == kind)]) for kind in kinds]
    columns, blocks = blocks_of(alike, _OF_STRETCH)
    starts = [candidates[kind] for kind in kinds]
    fitted = _core.covariances_near(columns, BLOCK_SIZE, blocks, starts, spacing, workers)
    covariances = {
        kind: covariance_of((float(f"{np.median(samples[2][rows]):.5g}"), *of[1:]))
        for kind, rows, of in zip(kinds, alike, fitted, strict=True)
    }
    begins = edges[cuts]
    for border in range(1, len(cuts)):
        low, high = max(begins[border - 1], edges[cuts[border] - 1]), edges[cuts[border] + 1]
        slices = np.linspace(low, high, _SLICES + 1).astype(np.int64)
        size = min(int(np.diff(slices).min()), BLOCK_SIZE)
        if size >= _OF_SLICE:
            some = [np.sort(rng.choice(np.arange(*of), size, replace=False)) for of in pairwise(slices.tolist())]
            columns = values_without_spikes(samples, np.concatenate(some), robust)
            sides = [covariances[kind].values for kind in chosen[border - 1 : border + 1]]
            of_sides = _core.covariance_likelihoods(columns, size, 1, sides, workers)
            begins[border] = slices[_likeliest_border(of_sides)]
    found = [
        CovarianceFrom(start, covariances[kind])
        for start, kind in zip(samples[0][begins].tolist(), chosen, strict=True)
    ]
    return [*found, CovarianceFrom(float(np.nextafter(samples[0][-1], np.inf)), whole)]  # of what is drilled later


def _edges(depth: Floats) -> Integers:
    """Return the rows at which the parts begin, and the number of samples."""
    count = int(np.clip(np.ptp(depth) / _SHORTEST, 1, _MOST_PARTS))
    edges = [0]
    for row in np.searchsorted(depth, np.linspace(depth[0], depth[-1], count + 1)[1:-1]).tolist():
        if min(row - edges[-1], depth.size - row) >= _FEWEST:
            edges.append(row)
    return np.array([*edges, depth.size])


def _cut(likelihoods: Floats, gain: float) -> Cut:
    """Return the likeliest stretches, (parts, candidates) nats: of each number of parts, from those of fewer parts."""
    parts, candidates = likelihoods.shape
    sums = np.vstack([np.zeros(candidates), np.cumsum(likelihoods, axis=0)])
    best = np.zeros(parts + 1)
    last: list[tuple[int, int]] = [(0, 0)]  # of the first parts: where the last stretch begins, and its candidate
    for stop in range(1, parts + 1):
        of_last = sums[stop] - sums[:stop]
        gains = best[:stop] + of_last.max(axis=1) - gain * (np.arange(stop) > 0)
        start = int(np.argmax(gains))
        best[stop] = gains[start]
        last.append((start, int(np.argmax(of_last[start]))))
    cuts: list[int] = []
    chosen: list[int] = []
    stop = parts
    while stop > 0:
        stop, candidate = last[stop]
        cuts.insert(0, stop)
        chosen.insert(0, candidate)
    return cuts, chosen


def _likeliest_border(likelihoods: Floats) -> int:
    """Return the slice at which the lower of two stretches begins, (slices, 2) nats; each has one slice or more."""
    above, below = likelihoods.T
    return 1 + int(np.argmax(np.cumsum(above)[:-1] + np.cumsum(below[::-1])[-2::-1]))


def _join_alike(likelihoods: Floats, cut: Cut, gain: float) -> Cut:
    """Give one candidate to stretches that it suits about as well as their own, and join those side by side."""
    cuts, chosen = cut
    of_part = np.repeat(chosen, np.diff([*cuts, len(likelihoods)]))
    while True:
        kinds = distinct(of_part).tolist()
        sums = {kind: likelihoods[of_part == kind].sum(axis=0) for kind in kinds}
        pairs = [(one, other) for one in kinds for other in kinds if one < other]
        losses = [sums[one][one] + sums[other][other] - np.max(sums[one] + sums[other]) for one, other in pairs]
        if not losses or min(losses) >= gain:
            break
        one, other = pairs[int(np.argmin(losses))]
        of_part[(of_part == one) | (of_part == other)] = int(np.argmax(sums[one] + sums[other]))
    begins = np.flatnonzero(np.diff(of_part, prepend=-1)).tolist()
    return begins, of_part[begins].tolist()
