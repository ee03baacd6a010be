"""Where the tool was in the hole, turn by turn, and the samples as seen from the hole's own axis.

A sample of radius r at toolface a, taken by a tool whose centre lies at c = (x, y), sees the wall at c + r u(a)::

         toolface 0                 rho = |c + r u|     radius from the hole's axis
             | x                    phi = arg(c + r u)  its toolface
             |   . wall
             |  /r                  rho(phi) = R + sum over n = 2 .. H of (a_n cos n phi + b_n sin n phi) + noise
      axis   +-c---- y (toolface 90)

The hole's axis is where the first harmonic of its wall vanishes, so c is what makes rho(phi) free of one. This is exact
for any shape: no small-offset expansion, and for a circle the same as r = e cos psi + sqrt(R^2 - e^2 sin^2 psi).

Offset is the odd first harmonic; ovality and opposite breakouts are even. So even harmonics may be large (``even``),
odd ones are small (``odd``), and all are marginalised with these as Gaussian priors: with part of the circle missing
they become hard to tell from an offset and the stated covariance grows by itself. It has three parts:

- the posterior covariance at the noise found in the turn (Tukey's biweight keeps spikes out);
- the jackknife of the turn's own residuals ("HC3", MacKinnon and White 1985), for edges that no H harmonics follow;
- the one-sided wall: a washout on one side holds a first harmonic that no fit can tell from an offset, but it does not
  come alone. A box of width b has |a_1 / a_n| = n |sin(b/2) / sin(n b/2)|. Odd harmonics beyond their prior therefore
  count, fourfold, into the deviation of the centre.

Not here: which samples make a turn of a tool that does not rotate (any integers will do), and the wall itself.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from helibore.arrays import Floats, Integers, column
from helibore.harmonics import Complexes, evaluate, leverage, normal_equations, powers

__all__ = ["Centres", "Shape", "find_centres", "recentre", "turn_numbers"]

_SAMPLES_AT_ONCE = 1 << 16
_REJECT = 6.0  # biweight: samples beyond so many deviations have no weight; harmless to Gaussian noise
_NOISE_SAMPLES = 4.0  # how many samples the expected noise is worth beside those of the turn
_ONE_SIDED = 4.0  # |a_1 / a_3| of a box of 150 deg; three times this covers nearly any one-sided wall
_ROUNDS, _ROUNDS_TOGETHER = 32, 8
_CONVERGED = 2e-6  # m: a hundredth of the best standard deviation
_STATE = ("centre", "terms", "free", "noise")  # all that one round takes over from the last


@dataclass(frozen=True)
class Shape:
    """What may be expected of a hole and a tool, before any sample: standard deviations in metres.

    Parameters
    ----------
    even
        Of the second harmonic (ovality, breakouts); harmonic n has even * 2 / n. Two opposite boxes of depth D and
        width 60 deg hold a second harmonic of 0.55 D.
    odd
        Of the third harmonic (three-lobed hole); harmonic n has odd * 3 / n.
    reach
        Of each coordinate of the tool's centre: about the clearance between tool and wall.
    noise
        Expected noise of one sample. The noise of each turn is found from its samples; this weighs as four of them.
    harmonics
        The highest harmonic, at least 2.
    """

    even: float = 0.008
    odd: float = 0.0008
    reach: float = 0.02
    noise: float = 0.0005
    harmonics: int = 12

    def __post_init__(self) -> None:
        for name in ("even", "odd", "reach", "noise"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise ValueError(f"{name} = {value:g}: must be finite and larger than 0")
        if self.harmonics < 2:
            raise ValueError(f"harmonics = {self.harmonics}: must be at least 2")

    def deviations(self) -> Floats:
        """Prior standard deviation of each harmonic from 2 on, (harmonics - 1,)."""
        n = np.arange(2, self.harmonics + 1)
        return np.where(n % 2 == 0, self.even * 2.0 / n, self.odd * 3.0 / n)


@dataclass(frozen=True)
class Centres:
    """The tool's centre in each turn. One entry a turn, sorted by ``turn``; NaN where a turn has no radius at all.

    Attributes
    ----------
    turn
        Turn numbers, (t,) int64.
    x, y
        Centre of the tool from the hole's axis towards toolface 0 and toolface 90, (t,) m.
    covariance
        Of (x, y), (t, 2, 2) m^2.
    mean_radius
        Mean radius of the hole about its axis, (t,) m.
    noise
        Deviation of the samples from the fitted wall, (t,) m.
    inliers
        Share of the samples within three times that noise, (t,).
    samples
        Samples with a finite radius, (t,) int64.
    """

    turn: Integers
    x: Floats
    y: Floats
    covariance: Floats
    mean_radius: Floats
    noise: Floats
    inliers: Floats
    samples: Integers

    @property
    def sigma_x(self) -> Floats:
        """Standard deviation of x, (t,) m."""
        return np.sqrt(self.covariance[:, 0, 0])

    @property
    def sigma_y(self) -> Floats:
        """Standard deviation of y, (t,) m."""
        return np.sqrt(self.covariance[:, 1, 1])

    @property
    def eccentering(self) -> Floats:
        """Distance of the tool's centre from the hole's axis, (t,) m."""
        return np.hypot(self.x, self.y)

    @property
    def direction(self) -> Floats:
        """Toolface towards which the tool is off, (t,) degrees in [0, 360)."""
        return np.degrees(np.arctan2(self.y, self.x)) % 360.0

    def share(self, significance: float = 6.0) -> Floats:
        """Part of each centre that is worth correcting, (t,) in [0, 1]: max(0, 1 - (significance / c' cov^-1 c)^2).

        c' cov^-1 c of a centred tool follows chi-squared with two degrees of freedom and passes 6 in 5 % of turns, so
        noise is not taken for eccentering; at ten standard deviations the share is 0.996. ``significance=0`` corrects
        all. Turns without a centre get 0.
        """
        centre = np.stack([self.x, self.y], axis=1)
        found = np.isfinite(self.x)
        ratio = np.zeros(self.x.size)
        solved = np.linalg.solve(self.covariance[found], centre[found, :, None])[..., 0]
        ratio[found] = (centre[found] * solved).sum(axis=1)
        if significance <= 0:
            return found.astype(np.float64)
        known = ratio > significance
        share = np.zeros(self.x.size)
        share[known] = 1.0 - np.square(significance / ratio[known])
        return share


def turn_numbers(toolface: npt.ArrayLike) -> Integers:
    """Turn of every sample of a rotating tool, from its toolfaces in order of time.

    The steps between samples are taken the short way round and summed; a turn is 360 degrees of that sum, counted from
    toolface 0 of the first turn. A tool that turns back (stick-slip) returns into the turn it came from.

    Parameters
    ----------
    toolface
        Degrees, (n,), finite, less than 180 apart from one sample to the next.

    Returns
    -------
    ndarray
        (n,) int64, new; 0 for the first sample.
    """
    angle = _finite("toolface", toolface)
    if angle.size == 0:
        return np.empty(0, dtype=np.int64)
    unwrapped = np.unwrap(angle % 360.0, period=360.0)
    return np.floor(unwrapped / 360.0).astype(np.int64)


def find_centres(
    toolface: npt.ArrayLike, radius: npt.ArrayLike, turn: npt.ArrayLike, shape: Shape | None = None
) -> Centres:
    """Find the tool's centre in every turn, with its covariance.

    Parameters
    ----------
    toolface, radius
        As measured from the tool's centre: degrees and metres, (n,), in any order. NaN radii are left out.
    turn
        Whole numbers, (n,): samples of one number share one centre.
    shape
        What to expect; ``Shape()`` when not given.

    Returns
    -------
    Centres
        Sorted by turn. Each turn depends on its own samples only.

    Raises
    ------
    ValueError
        If lengths differ, a toolface or turn is not finite, a turn is not whole, or a radius is infinite or not
        positive.
    """
    shape = Shape() if shape is None else shape
    angle, distance, number = _samples(toolface, radius, turn)
    turns, row = np.unique(number, return_inverse=True)
    known = np.flatnonzero(np.isfinite(distance))
    order = known[np.argsort(row[known], kind="stable")]
    count = np.bincount(row[known], minlength=turns.size)
    blank = np.full((9, turns.size), np.nan)
    x, y, mean_radius, noise, inliers = blank[:5]
    result = Centres(turns, x, y, blank[5:].T.reshape(-1, 2, 2).copy(), mean_radius, noise, inliers, count)
    filled = np.flatnonzero(count)
    ends = np.cumsum(count[filled])
    seen = np.radians(angle[order])
    reach = distance[order] * (np.cos(seen) + 1j * np.sin(seen))
    first = 0
    while first < filled.size:
        begin = ends[first] - count[filled[first]]
        last = max(first + 1, int(np.searchsorted(ends, begin + _SAMPLES_AT_ONCE, side="right")))
        rows = filled[first:last]
        turns_fit = _Fit(reach[begin : ends[last - 1]], count[rows], shape)
        turns_fit.solve()
        turns_fit.write(result, rows)
        first = last
    return result


def recentre(
    toolface: npt.ArrayLike, radius: npt.ArrayLike, turn: npt.ArrayLike, centres: Centres, significance: float = 6.0
) -> tuple[Floats, Floats]:
    """Toolface and radius of every sample as seen from the hole's axis.

    Parameters
    ----------
    toolface, radius, turn
        As given to :func:`find_centres`.
    centres
        Of these turns.
    significance
        See :meth:`Centres.share`.

    Returns
    -------
    toolface, radius
        Degrees in [0, 360) and metres, (n,), new. Where a turn has no significant centre, the sample as it was; NaN
        radii stay NaN and keep their toolface.

    Raises
    ------
    ValueError
        As :func:`find_centres`, and if ``centres`` does not hold a turn.
    """
    angle, distance, number = _samples(toolface, radius, turn)
    row = np.minimum(np.searchsorted(centres.turn, number), max(centres.turn.size - 1, 0))
    if number.size and (centres.turn.size == 0 or np.any(centres.turn[row] != number)):
        missing = int(np.argmax(centres.turn[row] != number)) if centres.turn.size else 0
        raise ValueError(f"turn[{missing}] = {number[missing]}: not among the turns of centres")
    share = centres.share(significance)
    offset = np.where(share > 0, share, 0.0) * (np.nan_to_num(centres.x) + 1j * np.nan_to_num(centres.y))
    seen = np.radians(angle)
    wall = offset[row] + distance * (np.cos(seen) + 1j * np.sin(seen))
    moved = np.isfinite(distance) & (offset[row] != 0)
    turned = np.degrees(np.angle(wall, deg=False)) % 360.0
    turned[turned == 360.0] = 0.0
    return np.where(moved, turned, angle % 360.0), np.where(moved, np.abs(wall), distance)


class _Fit:
    """The turns of one chunk: Gauss-Newton on the centre, each round one linear fit of rho(phi) in the hole's frame.

    rho(c + dc) = rho(c) + u(phi) dc, so the first harmonic of the fit is -dc; at the solution it is zero.
    """

    def __init__(self, reach: Complexes, count: Integers, shape: Shape) -> None:
        self.reach, self.count, self.shape = reach, count, shape
        self.starts = np.cumsum(count) - count
        self.turn = np.repeat(np.arange(count.size), count)
        deviations = shape.deviations()
        self.precision = np.concatenate([[0.0], np.full(2, shape.reach**-2), np.repeat(deviations**-2, 2)])
        self.centre = np.zeros(count.size, dtype=np.complex128)
        self.terms = np.zeros((count.size, self.precision.size))
        self.terms[:, 0] = np.add.reduceat(np.abs(reach), self.starts) / count
        self.free = np.zeros(count.size)
        self.noise: Floats = np.full(count.size, 6.0 * shape.noise)
        self.inverse: Floats = np.empty((count.size, self.precision.size, self.precision.size))
        self.distance: Floats = np.empty(reach.size)
        self.residual: Floats = np.empty(reach.size)
        self.weight: Floats = np.ones(reach.size)
        self.table: Complexes = np.empty((0, reach.size), dtype=np.complex128)

    def solve(self, rounds: int = _ROUNDS) -> None:
        """Fit all turns for a few rounds, then only those that still move."""
        for _ in range(min(rounds, _ROUNDS_TOGETHER)):
            moving = self._step() > _CONVERGED
            if not moving.any():
                return
        if rounds > _ROUNDS_TOGETHER:
            rest = self._only(moving)
            rest.solve(rounds - _ROUNDS_TOGETHER)
            for name in _STATE:
                getattr(self, name)[moving] = getattr(rest, name)
            self._step()

    def _only(self, chosen: npt.NDArray[np.bool_]) -> _Fit:
        part = _Fit(self.reach[chosen[self.turn]], self.count[chosen], self.shape)
        for name in _STATE:
            setattr(part, name, getattr(self, name)[chosen])
        return part

    def _step(self) -> Floats:
        """One round: weights from the residuals, the linear fit, the centre moved; returns by how much, (t,) m."""
        self.distance = self._look()
        self.residual = self.distance - evaluate(self.terms, self.table, self.turn)
        self._weigh()
        matrix, side = normal_equations(self.weight, self.distance, self.table, self.starts)
        ridge = (self.noise**2)[:, None] * self.precision
        ridge[:, 0] = 1e-9  # the mean radius is free; this keeps a turn whose every sample is rejected solvable
        matrix[:, np.arange(self.precision.size), np.arange(self.precision.size)] += ridge
        side[:, 1] += ridge[:, 1] * self.centre.real
        side[:, 2] += ridge[:, 2] * self.centre.imag
        self.inverse = np.linalg.inv(matrix).astype(np.float64, copy=False)
        self.terms = (self.inverse @ side[:, :, None])[:, :, 0]
        self.free = self.precision.size - (np.einsum("tpp->tp", self.inverse) * ridge).sum(axis=1)
        step = self.terms[:, 1] + 1j * self.terms[:, 2]
        self.centre = self.centre - step
        self.terms[:, 1:3] = 0.0
        return np.abs(step)

    def _look(self) -> Floats:
        wall = self.centre[self.turn] + self.reach
        distance = np.abs(wall)
        self.table = powers(wall / distance, 2 * self.shape.harmonics)
        return distance

    def _weigh(self) -> None:
        """Biweights and noise: noise^2 = sum(w e^2) / (sum(w) - terms used), with the expected noise as four samples.

        1.25 makes sum(w e^2) / sum(w) of Gaussian noise, cut by a biweight of 6 deviations, come back as its variance.
        """
        for _ in range(2):
            ratio = np.square(self.residual / (_REJECT * self.noise[self.turn]))
            self.weight = np.square(np.clip(1.0 - ratio, 0.0, None))
            total = np.add.reduceat(self.weight, self.starts)
            squares = 1.25 * np.add.reduceat(self.weight * self.residual**2, self.starts)
            spare = np.maximum(total - self.free, 0.1 * total)
            variance: Floats = (_NOISE_SAMPLES * self.shape.noise**2 + squares) / (_NOISE_SAMPLES + spare)
            self.noise = variance**0.5

    def _covariance(self) -> Floats:
        covariance: Floats = self.inverse[:, 1:3, 1:3] * (self.noise**2)[:, None, None]
        hat = self.weight * leverage(self.inverse, self.table, self.turn)
        left_out = self.weight * self.residual / np.maximum(1.0 - hat, 0.05)
        pull = [left_out * evaluate(self.inverse[:, p], self.table, self.turn) for p in (1, 2)]
        for p in range(2):
            for q in range(2):
                covariance[:, p, q] += np.add.reduceat(pull[p] * pull[q], self.starts)
        odd = np.arange(2, self.shape.harmonics + 1) % 2 == 1
        amplitude = np.square(self.terms[:, 3::2]) + np.square(self.terms[:, 4::2])
        excess = amplitude[:, odd].sum(axis=1) - 2.0 * np.square(self.shape.deviations()[odd]).sum()
        one_sided = _ONE_SIDED**2 * np.maximum(excess, 0.0)
        covariance[:, [0, 1], [0, 1]] += one_sided[:, None]
        return covariance

    def write(self, result: Centres, rows: Integers) -> None:
        within = np.abs(self.residual) <= 3.0 * self.noise[self.turn]
        result.x[rows], result.y[rows] = self.centre.real, self.centre.imag
        result.covariance[rows] = self._covariance()
        result.mean_radius[rows] = self.terms[:, 0]
        result.noise[rows] = self.noise
        result.inliers[rows] = np.add.reduceat(within.astype(np.float64), self.starts) / self.count


def _samples(toolface: npt.ArrayLike, radius: npt.ArrayLike, turn: npt.ArrayLike) -> tuple[Floats, Floats, Integers]:
    angle = _finite("toolface", toolface)
    distance = column("radius", radius, angle.size, "toolface")
    bad = np.isinf(distance) | (distance <= 0)
    if bad.any():
        at = int(np.argmax(bad))
        raise ValueError(f"radius[{at}] = {distance[at]:g}: must be finite and larger than 0, or NaN where missing")
    number = _finite("turn", turn)
    if number.size != angle.size:
        raise ValueError(f"turn has {number.size} values, toolface has {angle.size}: must be equal")
    whole = np.floor(number)
    if np.any(whole != number):
        at = int(np.argmax(whole != number))
        raise ValueError(f"turn[{at}] = {number[at]:g}: must be a whole number")
    return angle, distance, number.astype(np.int64)


def _finite(name: str, values: npt.ArrayLike) -> Floats:
    array = column(name, values)
    bad = ~np.isfinite(array)
    if bad.any():
        at = int(np.argmax(bad))
        raise ValueError(f"{name}[{at}] = {array[at]:g}: must be finite")
    return array
