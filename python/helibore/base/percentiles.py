"""Percentiles of more numbers than fit in memory: the numbers come in parts, and all parts are read several times.

Float64 numbers that are not negative have the same order as their bits. So a count of the numbers by their first 16
bits gives the first 16 bits of the percentile. Then only the numbers that begin with these bits are sorted or, if they
are too many, counted by their next 16 bits.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np

from helibore.base.arrays import Floats, Integers, Unsigned64, distinct

FEW = 1 << 20
"""Largest number of numbers that are sorted at once."""
DIGITS = 16
"""Bits counted at a time."""

Parts = Callable[[], Iterable[Floats]]
"""A function that yields all numbers, part by part, each time it is called."""


def percentiles(parts: Parts, shares: Sequence[float]) -> list[float]:
    """Return percentiles of numbers, interpolated linearly between two numbers as `numpy.percentile` does.

    The numbers must be finite and not negative (-0.0 is negative). ``shares`` are from 0 to 100. If there is no number,
    all percentiles are NaN.
    """
    count = sum(part.size for part in parts())
    if not count:
        return [math.nan] * len(shares)
    places = [share / 100 * (count - 1) for share in shares]
    ranks = sorted({rank for place in places for rank in (math.floor(place), math.ceil(place))})
    found = dict(zip(ranks, _of_ranks(parts, np.array(ranks), count, 64, 0).tolist(), strict=True))
    ends = [(found[math.floor(place)], found[math.ceil(place)], place % 1) for place in places]
    return [low + (high - low) * share for low, high, share in ends]


def _of_ranks(parts: Parts, ranks: Integers, count: int, bits: int, begin: int) -> Floats:
    """Return the numbers that have these ``ranks``, sorted, among the ``count`` numbers whose first bits are ``begin``.

    The least number has rank 0. ``bits`` is how many bits follow the first bits.
    """

    def those() -> Iterator[Unsigned64]:
        for part in parts():
            keys = part.view(np.uint64)
            yield keys if bits == 64 else keys[keys >> np.uint64(bits) == begin]

    if not bits:
        return np.full(ranks.size, np.array([begin], dtype=np.uint64).view(np.float64))
    if count <= FEW:
        return np.sort(np.concatenate(list(those()))).view(np.float64)[ranks]
    rest, counts = bits - DIGITS, np.zeros(1 << DIGITS, dtype=np.int64)
    for keys in those():
        counts += np.bincount((keys >> np.uint64(rest)).astype(np.int64) & (counts.size - 1), minlength=counts.size)
    stops = np.cumsum(counts)
    bucket, found = np.searchsorted(stops, ranks, side="right"), np.empty(ranks.size)
    for at in distinct(bucket).tolist():
        mine, own = bucket == at, int(counts[at])
        found[mine] = _of_ranks(parts, ranks[mine] - (stops[at] - own), own, rest, (begin << DIGITS) + at)
    return found
