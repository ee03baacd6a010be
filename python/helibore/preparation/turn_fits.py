"""The fit behind ``eccentering``: offset and harmonics of many turns at once, by robust Gauss-Newton.

    rho(phi) = |c + r u| = R + sum over n = 2 .. H of (a_n cos n phi + b_n sin n phi) + noise

Every turn is fitted twice: with a wall whose odd harmonics are small, and with one that may be enlarged on one side.
What the second leaves open decides how far the first is believed. Not public: ``eccentering`` is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, Integers
from helibore.preparation.harmonics import Complexes, evaluate, leverage, normal_equations, powers, projections

_REJECT = 6.0  # biweight: samples beyond so many deviations have no weight; harmless to Gaussian noise
_NOISE_SAMPLES = 4.0  # how many samples the expected noise is worth beside those of the turn
_ONE_SIDED = 4.0  # |a_1 / a_3| of a box of 150 deg; three times this covers nearly any one-sided wall
_STRANGE = 3.0  # what a rejected sample costs beside the bounded loss: its chance is one in twenty over 0.1 m
_SMOOTH = 8  # harmonics of a wall beside its lobes
_ROUNDS, _ROUNDS_TOGETHER = 32, 8
_CONVERGED = 2e-6  # m: a hundredth of the best standard deviation
LOBE_DEPTHS = np.array([0.03, 0.003])  # m: expected of a lobe, and of how two opposite ones differ
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
    one_sided
        Of the third harmonic of a wall that is enlarged on one side; harmonic n has one_sided * 3 / n, its first too. A
        box of depth D and width 120 to 150 deg holds a third harmonic of 0 to 0.15 D.
    lobed
        Whether the harmonics are to follow breakouts. If not, only the second is ``even`` and harmonic n > 2 has
        odd * (3 / n)^2.
    """

    even: float = 0.008
    odd: float = 0.0008
    reach: float = 0.02
    noise: float = 0.0005
    harmonics: int = 12
    one_sided: float = 0.005
    lobed: bool = True

    def __post_init__(self) -> None:
        for name in ("even", "odd", "reach", "noise", "one_sided"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise ValueError(f"{name} = {value:g}: must be finite and larger than 0")
        if self.harmonics < 2:
            raise ValueError(f"harmonics = {self.harmonics}: must be at least 2")

    def deviations(self, highest: int | None = None) -> Floats:
        """Prior standard deviation of each harmonic from 2 to ``harmonics`` or ``highest``."""
        n = np.arange(2, (highest or self.harmonics) + 1)
        if self.lobed:
            return np.where(n % 2 == 0, self.even * 2.0 / n, self.odd * 3.0 / n)
        return np.where(n == 2, self.even, self.odd * np.square(3.0 / n))

    def plain(self) -> Shape:
        """Return what may be expected of a wall beside its lobes: oval, and else smooth."""
        return replace(self, lobed=False, harmonics=min(self.harmonics, _SMOOTH))

    def widened(self) -> Shape:
        """Return what may be expected of a wall that is enlarged on one side."""
        return replace(self, odd=max(self.odd, self.one_sided), harmonics=max(self.harmonics, 3))


class TurnFits:
    """The turns of one chunk: Gauss-Newton on the centre, each round one linear fit of rho(phi) in the hole's frame.

    rho(c + dc) = rho(c) + u(phi) dc, so the first harmonic of the fit is -dc; at the solution it is zero.
    """

    def __init__(self, reach: Complexes, count: Integers, shape: Shape, lobes: Floats | None = None) -> None:
        self.reach, self.count, self.shape = reach, count, shape
        self.lobes: Floats = np.empty((0, reach.size)) if lobes is None else lobes
        self.starts = np.cumsum(count) - count
        self.turn = np.repeat(np.arange(count.size), count)
        deviations = shape.deviations()
        self.waves = 1 + 2 * shape.harmonics
        self.precision = np.concatenate(
            [[0.0], np.full(2, shape.reach**-2), np.repeat(deviations**-2, 2), LOBE_DEPTHS[: len(self.lobes)] ** -2]
        )
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
            rest = self.only(moving)
            rest.solve(rounds - _ROUNDS_TOGETHER)
            for name in _STATE:
                getattr(self, name)[moving] = getattr(rest, name)
            self._step()

    def only(self, chosen: npt.NDArray[np.bool_]) -> TurnFits:
        """Some of the turns, to be solved again or as they are."""
        kept = chosen[self.turn]
        part = TurnFits(self.reach[kept], self.count[chosen], self.shape, self.lobes[:, kept])
        for name in (*_STATE, "inverse"):
            setattr(part, name, getattr(self, name)[chosen])
        part.distance, part.residual, part.weight = self.distance[kept], self.residual[kept], self.weight[kept]
        part.table = self.table[:, kept]
        return part

    def _step(self) -> Floats:
        """One round: weights from the residuals, the linear fit, the centre moved; returns by how much, (t,) m."""
        self.distance = self._look()
        self.residual = self.distance - self._wall(self.terms)
        self._weigh()
        matrix, side = self._normal_equations()
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

    def _normal_equations(self) -> tuple[Floats, Floats]:
        """The matrix and the side of the waves, and beside them those of the lobes."""
        waves, side = normal_equations(self.weight, self.distance, self.table, self.starts)
        if not len(self.lobes):
            return waves, side
        size, first = self.precision.size, self.waves
        matrix = np.empty((self.count.size, size, size))
        matrix[:, :first, :first] = waves
        sides = [side]
        for k, lobe in enumerate(self.lobes):
            value = self.weight * lobe
            across = projections(value, self.table[: self.shape.harmonics + 1], self.starts)
            matrix[:, first + k, :first] = matrix[:, :first, first + k] = across
            for j, other in enumerate(self.lobes):
                matrix[:, first + k, first + j] = np.add.reduceat(value * other, self.starts)
            sides.append(np.add.reduceat(value * self.distance, self.starts)[:, None])
        return matrix, np.concatenate(sides, axis=1)

    def _wall(self, terms: Floats) -> Floats:
        """Value of waves and lobes at every sample."""
        values = evaluate(terms[:, : self.waves], self.table, self.turn)
        for k, lobe in enumerate(self.lobes):
            values += terms[self.turn, self.waves + k] * lobe
        return values

    def _leverage(self) -> Floats:
        """x' B x of every sample's waves and lobes."""
        first = self.waves
        hat = leverage(self.inverse[:, :first, :first], self.table, self.turn)
        for k, lobe in enumerate(self.lobes):
            row = self.inverse[:, first + k].copy()
            row[:, :first] *= 2.0
            hat += lobe * self._wall(row)
        return hat

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

    def covariance(self) -> Floats:
        """Covariance of (x, y): the posterior, the jackknife and the odd excess."""
        covariance: Floats = self.inverse[:, 1:3, 1:3] * (self.noise**2)[:, None, None]
        hat = self.weight * self._leverage()
        left_out = self.weight * self.residual / np.maximum(1.0 - hat, 0.05)
        pull = [left_out * self._wall(self.inverse[:, p]) for p in (1, 2)]
        for p in range(2):
            for q in range(2):
                covariance[:, p, q] += np.add.reduceat(pull[p] * pull[q], self.starts)
        odd = np.arange(2, self.shape.harmonics + 1) % 2 == 1
        waves = self.terms[:, : self.waves]
        amplitude = np.square(waves[:, 3::2]) + np.square(waves[:, 4::2])
        excess = amplitude[:, odd].sum(axis=1) - 2.0 * np.square(self.shape.deviations()[odd]).sum()
        one_sided = _ONE_SIDED**2 * np.maximum(excess, 0.0)
        covariance[:, [0, 1], [0, 1]] += one_sided[:, None]
        return covariance

    def plain(self, lobes: Floats | None = None) -> TurnFits:
        """The same turns where the wall is an oval, and perhaps with lobes, from where the centre is now.

        No sample is left out at first: one in a lobe must have the time to find that it is.
        """
        oval = TurnFits(self.reach, self.count, self.shape.plain(), lobes)
        oval.centre, oval.terms[:, 0] = self.centre.copy(), self.terms[:, 0]
        oval.noise[:] = LOBE_DEPTHS[0]
        oval.solve()
        return oval

    def widened(self) -> TurnFits:
        """The same turns, started from here, where the wall may be enlarged on one side."""
        wide = TurnFits(self.reach, self.count, self.shape.widened(), self.lobes)
        for name in _STATE:
            setattr(wide, name, getattr(self, name).copy())
        wide.solve()
        return wide

    def left_open(self) -> Floats:
        """Root mean square that the third harmonic may have after these samples, in units of what it may have before.

        The posterior expectation, found and not known alike: large where it is seen to be large, and where samples are
        missing that would show it. The third is the one that a washout on one side cannot do without.
        """
        variance = np.einsum("tpp->tp", self.inverse)[:, 5:7] * (self.noise**2)[:, None]
        found = (np.square(self.terms[:, 5:7]) + variance).sum(axis=1)
        share: Floats = np.sqrt(found / (2.0 * self.shape.odd**2))
        return share

    def one_sided(self) -> tuple[Complexes, Floats]:
        """Centre and covariance where the wall has a first harmonic of its own: only their sum was measured.

        With deviations s of the wall's and r of the centre's, the centre is r^2 / (r^2 + s^2) of the sum.
        """
        own, reach = 3.0 * self.shape.odd, self.shape.reach
        part = reach**2 / (reach**2 + own**2)
        covariance = self.inverse[:, 1:3, 1:3] * (self.noise**2)[:, None, None] * part**2
        covariance[:, [0, 1], [0, 1]] += own**2 * part
        return self.centre * part, covariance

    def evidence(self) -> Floats:
        """Logarithm of the probability of the samples under this model, (t,), but for a constant common to all models.

        Laplace's: the biweight's bounded loss, the prior of the terms, and the volume of what is left open.
        """
        noise, expected = self.noise, self.shape.noise
        outside = np.clip(1.0 - np.square(self.residual / (_REJECT * noise[self.turn])), 0.0, None)
        rejected = 2.0 * _STRANGE * (outside == 0.0)
        loss = np.add.reduceat(_REJECT**2 / 3.0 * (1.0 - outside**3) + rejected, self.starts)
        prior = np.concatenate([[1.0], self.precision[1:]])
        terms = self.terms.copy()
        terms[:, 0] = 0.0
        terms[:, 1], terms[:, 2] = self.centre.real, self.centre.imag
        loss += (np.square(terms) * prior).sum(axis=1) + _NOISE_SAMPLES * np.square(expected / noise)
        volume = np.linalg.slogdet(self.inverse * np.square(noise)[:, None, None])[1] + np.log(prior).sum()
        value: Floats = 0.5 * (volume - loss) - (self.count + _NOISE_SAMPLES) * np.log(noise)
        return value

    def spread(self) -> Floats:
        """Root mean square of all residuals, of samples left out too, (t,) m."""
        spread: Floats = np.sqrt(np.add.reduceat(np.square(self.residual), self.starts) / self.count)
        return spread

    def inliers(self) -> Floats:
        """Share of the samples within three times the noise."""
        within = np.abs(self.residual) <= 3.0 * self.noise[self.turn]
        share: Floats = np.add.reduceat(within.astype(np.float64), self.starts) / self.count
        return share
