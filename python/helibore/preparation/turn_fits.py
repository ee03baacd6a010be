"""The fits behind ``eccentering``: three models of the wall in a turn are fitted to many turns at once, then mixed.

    rho(phi) = |c + r u| = R + sum over n = 2 .. H of (a_n cos n phi + b_n sin n phi) + steps + noise

    smooth      twelve harmonics, the even ones as large as ovality and breakouts make them
    pair        an oval with two opposite steps that have upright edges
    single      an oval with one such step: a washout on one side, a key seat

Each model is fitted by robust Gauss-Newton, then fitted again with a wall that may be enlarged on one side. The two
fits are mixed; the second counts more, the less the samples exclude such a wall. Then the three models are mixed by
their evidence. The centre is the weighted mean of the models' centres; the covariance is the weighted mean of their
covariances, plus the covariance of their centres.

Samples lie turn by turn; ``starts`` holds the first sample of each turn and ``turn`` the row of each sample. A series
of order H has P = 2 H + 1 terms, x = (1, cos a, sin a, ..., cos H a, sin H a). With z = exp(i a) every product of two
terms is a sum of powers of z, so the P x P normal matrix sum(w x x') of a turn holds only the 2 H + 1 moments
sum(w z^m). For H = 12 they take 25 sums a sample; the matrix itself would take 625. ``eccentering`` is the public
module.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from helibore.base.arrays import Complexes, Floats, Integers, Mask
from helibore.base.errors import InputError

_REJECT = 6.0  # biweight: samples beyond this many deviations have no weight, which hardly affects Gaussian noise
_NOISE_SAMPLES = 4.0  # the expected noise counts like this many samples beside those of the turn
_ONE_SIDED = 4.0  # |a_1 / a_3| of a box of 150 deg; three times this covers nearly any one-sided wall
_STRANGE = 3.0  # half of what a rejected sample adds to the loss: such a sample has a chance of 1 in 20, over 0.1 m
_SMOOTH = 8  # harmonics of a wall beside its steps
_ROUNDS, _ROUNDS_TOGETHER = 32, 8
_CONVERGED = 5e-7  # m: far below the best standard deviation
_STEP_DEPTHS = np.array([0.03, 0.003])  # m: expected depth of a step; expected difference of two opposite steps
_STATE = ("centre", "terms", "free", "noise")  # state that one round passes on to the next

_CLOSED, _OPEN = 0.64, 0.72  # values of `TurnFits.left_open` from which a one-sided wall counts, and counts fully
# Steps are searched if the residuals of an oval, or its ovality, exceed this many times the expected noise.
_ROUGH, _OVAL = 1.5, 2.0
_ODDS = 8.0  # logarithm of the prior odds against steps, to which the logarithm of the number of sectors is added
_LIKELY = 1e-6  # a model whose weight is not above this is left out

_CELLS = 240  # number of cells around the hole in the search for steps
_PAIR_WIDTHS = range(10, 61, 2)  # cells that each of two opposite steps may take
_SINGLE_WIDTHS = range(20, 141, 4)  # cells that a single step may take
_SEARCH_HARMONICS = 4
_SAME = 1e-9  # relative difference up to which two gains count as equal: their sectors hold the same samples


@dataclass(frozen=True)
class Shape:
    """Prior expectations of a hole and a tool: standard deviations in metres.

    Two opposite boxes of depth D and width 60 deg hold a second harmonic of 0.55 D; a box of width 120 to 150 deg on
    one side holds a third harmonic of 0 to 0.15 D.
    """

    even: float = 0.008  # of the second harmonic (ovality, breakouts); harmonic n has even * 2 / n
    odd: float = 0.0008  # of the third harmonic (three-lobed hole); harmonic n has odd * 3 / n
    reach: float = 0.02  # of each coordinate of the tool's centre: about the clearance between tool and wall
    noise: float = 0.0005  # of one sample; counts like four samples where the noise of a turn is found from its samples
    harmonics: int = 12  # number of the highest harmonic, at least 2
    one_sided: float = 0.005  # of the third harmonic of a wall enlarged on one side; harmonic n has one_sided * 3 / n
    lobed: bool = True  # even harmonics as above, for breakouts; False: the second has even, n > 2 has odd * (3 / n)^2

    def __post_init__(self) -> None:
        for name in ("even", "odd", "reach", "noise", "one_sided"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise InputError(name, "must be finite and above 0", f"{value:g}")
        if self.harmonics < 2:
            raise InputError("harmonics", "must be at least 2", str(self.harmonics))

    def deviations(self, highest: int | None = None) -> Floats:
        """Return the prior standard deviation, metres, of each harmonic from 2 to ``highest``; None: ``harmonics``."""
        n = np.arange(2, (highest or self.harmonics) + 1)
        if self.lobed:
            return np.where(n % 2 == 0, self.even * 2.0 / n, self.odd * 3.0 / n)
        return np.where(n == 2, self.even, self.odd * np.square(3.0 / n))

    def plain(self) -> Shape:
        """Return the expectations for a wall outside its steps, which is oval and otherwise smooth."""
        return replace(self, lobed=False, harmonics=min(self.harmonics, _SMOOTH))

    def widened(self) -> Shape:
        """Return the expectations for a wall that is enlarged on one side."""
        return replace(self, odd=max(self.odd, self.one_sided), harmonics=max(self.harmonics, 3))


# --- Fourier series of many turns -----------------------------------------------------------------------------------


def powers(z: Complexes, order: int) -> Complexes:
    """Return the powers z^0 to z^order, (order + 1, n)."""
    table = np.empty((order + 1, z.size), dtype=np.complex128)
    table[0] = 1.0
    for k in range(1, order + 1):
        np.multiply(table[k - 1], z, out=table[k])
    return table


def normal_equations(weight: Floats, value: Floats, table: Complexes, starts: Integers) -> tuple[Floats, Floats]:
    """Return sum(w x x'), (t, P, P), and sum(w x v), (t, P), over the samples of every turn.

    w is the weight, v the value; ``table`` is ``powers(z, 2 H)``.
    """
    order = (len(table) - 1) // 2
    moments = np.add.reduceat(weight * table, starts, axis=1)
    matrix = np.empty((starts.size, 2 * order + 1, 2 * order + 1))
    matrix[:, 0, 0] = moments[0].real
    for j in range(1, order + 1):
        cos_j, sin_j = 2 * j - 1, 2 * j
        matrix[:, 0, cos_j] = matrix[:, cos_j, 0] = moments[j].real
        matrix[:, 0, sin_j] = matrix[:, sin_j, 0] = moments[j].imag
        for k in range(1, j + 1):
            cos_k, sin_k = 2 * k - 1, 2 * k
            total, difference = 0.5 * moments[j + k], 0.5 * moments[j - k]
            matrix[:, cos_j, cos_k] = matrix[:, cos_k, cos_j] = difference.real + total.real
            matrix[:, sin_j, sin_k] = matrix[:, sin_k, sin_j] = difference.real - total.real
            matrix[:, sin_j, cos_k] = matrix[:, cos_k, sin_j] = total.imag + difference.imag
            matrix[:, cos_j, sin_k] = matrix[:, sin_k, cos_j] = total.imag - difference.imag
    return matrix, projections(weight * value, table[: order + 1], starts)


def projections(value: Floats, table: Complexes, starts: Integers) -> Floats:
    """Return sum(x v), (t, 2 H + 1), over the samples of every turn; v is the value, ``table`` is ``powers(z, H)``."""
    sums = np.add.reduceat(value * table, starts, axis=1)
    side = np.empty((starts.size, 2 * len(table) - 1))
    side[:, 0] = sums[0].real
    side[:, 1::2], side[:, 2::2] = sums[1:].real.T, sums[1:].imag.T
    return side


def evaluate(terms: Floats, table: Complexes, turn: Integers) -> Floats:
    """Return the value of each turn's series, x' ``terms``, at the samples of that turn, (n,); terms are (t, P)."""
    values: Floats = terms[turn, 0]
    coefficients = terms[:, 1::2] - 1j * terms[:, 2::2]
    for k in range(coefficients.shape[1]):
        values += (coefficients[turn, k] * table[k + 1]).real
    return values


def leverage(matrix: Floats, table: Complexes, turn: Integers) -> Floats:
    """Return x' B x at every sample, (n,); ``matrix`` is one symmetric matrix B per turn, (t, P, P).

    With v = (z^-H ... z^H) and x = U v the result is v' (U' B U) v, a Fourier series of order 2 H. All terms with the
    same power of z lie on one antidiagonal of U' B U.
    """
    order = (matrix.shape[1] - 1) // 2
    change = np.zeros((2 * order + 1, 2 * order + 1), dtype=np.complex128)
    change[0, order] = 1.0
    for k in range(1, order + 1):
        change[2 * k - 1, [order + k, order - k]] = 0.5
        change[2 * k, [order + k, order - k]] = -0.5j, 0.5j
    mirrored = np.flip(change.T @ matrix @ change, axis=2)
    series = np.empty((len(matrix), 4 * order + 1))
    series[:, 0] = np.trace(mirrored, offset=0, axis1=1, axis2=2).real
    for m in range(1, 2 * order + 1):
        coefficient = 2.0 * np.trace(mirrored, offset=-m, axis1=1, axis2=2)
        series[:, 2 * m - 1], series[:, 2 * m] = coefficient.real, -coefficient.imag
    return evaluate(series, table, turn)


# --- one model of the wall, fitted ----------------------------------------------------------------------------------


class TurnFits:
    """One model, fitted to all turns of a chunk by Gauss-Newton on the centre.

    Each round is one linear fit of rho(phi) in the hole's frame. rho(c + dc) = rho(c) + u(phi) dc, so the first
    harmonic of the fit is -dc; at the solution it is zero. ``steps`` are further terms of the fit, (steps, samples).
    """

    def __init__(self, reach: Complexes, count: Integers, shape: Shape, steps: Floats | None = None) -> None:
        self.reach, self.count, self.shape = reach, count, shape
        self.steps: Floats = np.empty((0, reach.size)) if steps is None else steps
        self.starts = np.cumsum(count) - count
        self.turn = np.repeat(np.arange(count.size), count)
        self.waves = 1 + 2 * shape.harmonics
        deviations = np.repeat(shape.deviations(), 2)
        step_deviations = _STEP_DEPTHS[: len(self.steps)]
        self.precision = np.concatenate([[0.0], np.full(2, shape.reach**-2), deviations**-2, step_deviations**-2])
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
        """Fit for at most ``rounds`` rounds: in the first 8 all turns, then those whose centres still move."""
        for _ in range(min(rounds, _ROUNDS_TOGETHER)):
            moving = self._move() > _CONVERGED
            if not moving.any():
                return
        if rounds > _ROUNDS_TOGETHER:
            rest = self.only(moving)
            rest.solve(rounds - _ROUNDS_TOGETHER)
            for name in _STATE:
                getattr(self, name)[moving] = getattr(rest, name)
            self._move()

    def only(self, chosen: Mask) -> TurnFits:
        """Return the fits of the ``chosen`` turns in their present state; they can be solved again."""
        kept = chosen[self.turn]
        part = TurnFits(self.reach[kept], self.count[chosen], self.shape, self.steps[:, kept])
        for name in (*_STATE, "inverse"):
            setattr(part, name, getattr(self, name)[chosen])
        part.distance, part.residual, part.weight = self.distance[kept], self.residual[kept], self.weight[kept]
        part.table = self.table[:, kept]
        return part

    def plain(self, steps: Floats | None = None) -> TurnFits:
        """Return a fit of the same turns, from their present centres, with an oval wall, and ``steps`` if given.

        It rejects no sample in the first rounds, because samples in a step would have weight 0 before the step is
        fitted.
        """
        oval = TurnFits(self.reach, self.count, self.shape.plain(), steps)
        oval.centre, oval.terms[:, 0] = self.centre.copy(), self.terms[:, 0]
        oval.noise[:] = _STEP_DEPTHS[0]
        oval.solve()
        return oval

    def widened(self) -> TurnFits:
        """Return a fit of the same turns, from their present state, with a wall that may be enlarged on one side."""
        wide = TurnFits(self.reach, self.count, self.shape.widened(), self.steps)
        for name in _STATE:
            setattr(wide, name, getattr(self, name).copy())
        wide.terms = np.insert(wide.terms, [self.waves] * (wide.waves - self.waves), 0.0, axis=1)
        wide.solve()
        return wide

    def look(self) -> None:
        """Compute each sample's distance from the hole's axis and powers of its direction, with the present centres."""
        wall = self.centre[self.turn] + self.reach
        self.distance = np.abs(wall)
        self.table = powers(wall / self.distance, 2 * self.shape.harmonics)

    def _move(self) -> Floats:
        """Do one round: compute weights, fit, move the centres; return the distances moved, (t,) metres."""
        self.look()
        self.residual = self.distance - self._wall(self.terms)
        self._weigh()
        matrix, side = self.normal_equations()
        ridge = (self.noise**2)[:, None] * self.precision
        ridge[:, 0] = 1e-9  # the mean radius is free; with 0, a turn without any weight could not be solved
        matrix[:, np.arange(self.precision.size), np.arange(self.precision.size)] += ridge
        side[:, 1] += ridge[:, 1] * self.centre.real
        side[:, 2] += ridge[:, 2] * self.centre.imag
        self.inverse = np.linalg.inv(matrix).astype(np.float64, copy=False)
        self.terms = (self.inverse @ side[:, :, None])[:, :, 0]
        self.free = self.precision.size - (np.einsum("tpp->tp", self.inverse) * ridge).sum(axis=1)
        move = self.terms[:, 1] + 1j * self.terms[:, 2]
        self.centre = self.centre - move
        self.terms[:, 1:3] = 0.0
        return np.abs(move)

    def normal_equations(self) -> tuple[Floats, Floats]:
        """Return the matrix and the right-hand side of the normal equations, for harmonics and steps together."""
        waves, side = normal_equations(self.weight, self.distance, self.table, self.starts)
        if not len(self.steps):
            return waves, side
        size, first = self.precision.size, self.waves
        matrix = np.empty((self.count.size, size, size))
        matrix[:, :first, :first] = waves
        sides = [side]
        for k, step in enumerate(self.steps):
            value = self.weight * step
            across = projections(value, self.table[: self.shape.harmonics + 1], self.starts)
            matrix[:, first + k, :first] = matrix[:, :first, first + k] = across
            for j, other in enumerate(self.steps):
                matrix[:, first + k, first + j] = np.add.reduceat(value * other, self.starts)
            sides.append(np.add.reduceat(value * self.distance, self.starts)[:, None])
        return matrix, np.concatenate(sides, axis=1)

    def _wall(self, terms: Floats) -> Floats:
        """Return the sum of harmonics and steps at every sample, computed from the ``terms`` of its turn."""
        values = evaluate(terms[:, : self.waves], self.table, self.turn)
        for k, step in enumerate(self.steps):
            values += terms[self.turn, self.waves + k] * step
        return values

    def leverage(self) -> Floats:
        """Return x' B x at every sample: x are its harmonics and steps, B is the inverse normal matrix of its turn."""
        first = self.waves
        hat = leverage(self.inverse[:, :first, :first], self.table, self.turn)
        for k, step in enumerate(self.steps):
            row = self.inverse[:, first + k].copy()
            row[:, :first] *= 2.0
            hat += step * self._wall(row)
        return hat

    def _weigh(self) -> None:
        """Set biweights and noise: noise^2 = sum(w e^2) / (sum(w) - terms used); the expected noise adds four samples.

        The factor 1.25 turns sum(w e^2) / sum(w) of Gaussian noise with a biweight of 6 deviations into its variance.
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
        """Return the covariance of each centre, (t, 2, 2): posterior, jackknife and excess of odd harmonics, added."""
        covariance: Floats = self.inverse[:, 1:3, 1:3] * (self.noise**2)[:, None, None]
        hat = self.weight * self.leverage()
        left_out = self.weight * self.residual / np.maximum(1.0 - hat, 0.05)
        pull = [left_out * self._wall(self.inverse[:, p]) for p in (1, 2)]
        for p in range(2):
            for q in range(2):
                covariance[:, p, q] += np.add.reduceat(pull[p] * pull[q], self.starts)
        odd = np.arange(2, self.shape.harmonics + 1) % 2 == 1
        amplitude = np.square(self.terms[:, 3 : self.waves : 2]) + np.square(self.terms[:, 4 : self.waves : 2])
        excess = amplitude[:, odd].sum(axis=1) - 2.0 * np.square(self.shape.deviations()[odd]).sum()
        covariance[:, [0, 1], [0, 1]] += _ONE_SIDED**2 * np.maximum(excess, 0.0)[:, None]
        return covariance

    def left_open(self) -> Floats:
        """Return the posterior root mean square of the third harmonic, divided by its prior root mean square, (t,).

        It includes the estimate and its uncertainty, so it is large if the harmonic is large, or if samples that would
        show the harmonic are missing. Every washout on one side has a third harmonic.
        """
        variance = np.einsum("tpp->tp", self.inverse)[:, 5:7] * (self.noise**2)[:, None]
        found = (np.square(self.terms[:, 5:7]) + variance).sum(axis=1)
        share: Floats = np.sqrt(found / (2.0 * self.shape.odd**2))
        return share

    def one_sided(self) -> tuple[Complexes, Floats]:
        """Return centre and covariance for a wall that also has a first harmonic; the fit found the sum of centre and
        harmonic.

        With deviations s of the wall's harmonic and r of the centre, the centre is r^2 / (r^2 + s^2) of the sum.
        """
        own, reach = 3.0 * self.shape.odd, self.shape.reach
        part = reach**2 / (reach**2 + own**2)
        covariance = self.inverse[:, 1:3, 1:3] * (self.noise**2)[:, None, None] * part**2
        covariance[:, [0, 1], [0, 1]] += own**2 * part
        return self.centre * part, covariance

    def evidence(self) -> Floats:
        """Return the logarithm of the probability of each turn's samples under this model, (t,), less a constant.

        The constant is the same for all models. By Laplace's approximation, the probability depends on the bounded loss
        of the residuals, the prior of the terms, and the volume of the posterior.
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
        """Return the root mean square of all residuals, including those of rejected samples, (t,) metres."""
        spread: Floats = np.sqrt(np.add.reduceat(np.square(self.residual), self.starts) / self.count)
        return spread

    def inliers(self) -> Floats:
        """Return the share of the samples within three times the noise, (t,)."""
        within = np.abs(self.residual) <= 3.0 * self.noise[self.turn]
        share: Floats = np.add.reduceat(within.astype(np.float64), self.starts) / self.count
        return share


# --- steps with upright edges ---------------------------------------------------------------------------------------


def fit_steps(smooth: TurnFits, opposite: bool) -> tuple[TurnFits, Floats]:
    """Fit the turns with the best sector of each as a step; if ``opposite``, the opposite sector is also a step.

    No series of a few harmonics follows an upright edge, and the part it misses moves the centre. A wall that is smooth
    except for one sector, or two opposite sectors, is linear in everything but the two edges, so all edges are tried::

          D .-----.                   .-----.          e       residuals of the smooth fit
            |     |                   |     |          b       1 in the sector, 0 outside; weights W
        ----'     '-------------------'     '----      gain    (b' W e)^2 / (b' W b - b' W X (X' W X + ridge)^-1 X' W b)
          from    to                from+180

    The gain of a sector is how much the weighted sum of squared residuals falls when the depth D is fitted together
    with all other terms. With sums over cells of 1.5 degrees, added up around the hole, the gains take as many passes
    over the cells as the fit has terms. The cells begin at the direction of the turn's second harmonic, so that rotated
    samples give rotated sectors. Opposite steps have one depth, except for a small difference, which is also fitted.

    Returns
    -------
    The fits, and what the steps add to the mean radius, (t,) m.
    """
    cells = _CELLS // 2 if opposite else _CELLS
    widths = _PAIR_WIDTHS if opposite else _SINGLE_WIDTHS
    where = np.angle(smooth.centre[smooth.turn] + smooth.reach)
    laid = 0.5 * np.arctan2(smooth.terms[:, 4], smooth.terms[:, 3])
    around = (where - laid[smooth.turn]) / (2.0 * np.pi) * _CELLS % _CELLS
    cell = np.minimum(around.astype(np.int64), _CELLS - 1)
    least = float(np.square(smooth.shape.noise / _STEP_DEPTHS[0]))
    first, width, widest = best_sectors(cell_sums(smooth, where, cell % cells, cells), widths, least)
    off = (cell - first[smooth.turn]) % _CELLS
    inside = off % cells < width[smooth.turn]
    columns = [inside.astype(np.float64)]
    if opposite:
        columns.append(np.where(inside, np.where(off >= cells, -1.0, 1.0), 0.0))
    fits = smooth.plain(np.stack(columns))
    return fits, fits.terms[:, fits.waves] * 0.5 * (width + widest) / cells


def cell_sums(fits: TurnFits, where: Floats, cell: Integers, cells: int) -> Floats:
    """Return the sums over each cell of the P whitened terms, the residuals and the weights, (t, cells, P + 2).

    The terms are whitened by the Cholesky factor L of the normal matrix: L^-1 X'. Let b be 1 in a sector and 0 outside,
    as in `fit_steps`. The squares of the sector's summed terms add up to b' W X (X' W X + ridge)^-1 X' W b of the gain.
    """
    shape, turns = fits.shape.plain(), fits.count.size
    table = powers(np.exp(1j * where), 2 * _SEARCH_HARMONICS)
    distance = np.abs(fits.centre[fits.turn] + fits.reach)
    matrix, side = normal_equations(np.ones(distance.size), distance, table, fits.starts)
    deviations = np.repeat(shape.deviations(_SEARCH_HARMONICS), 2)
    deviations = np.concatenate([[10.0, shape.reach, shape.reach], deviations])
    terms = np.arange(deviations.size)
    matrix[:, terms, terms] += np.square(shape.noise / deviations)
    whiten = np.linalg.inv(np.linalg.cholesky(matrix))
    fitted = (np.swapaxes(whiten, 1, 2) @ (whiten @ side[:, :, None]))[:, :, 0]
    at = fits.turn * cells + cell
    residual = distance - evaluate(fitted, table, fits.turn)
    order = np.argsort(at, kind="stable")
    filled, starts, count = np.unique(at[order], return_index=True, return_counts=True)
    sums = np.zeros((turns * cells, deviations.size + 2))
    sums[filled, :-2] = projections(np.ones(order.size), table[: _SEARCH_HARMONICS + 1, order], starts)
    sums[filled, -2] = np.add.reduceat(residual[order], starts)
    sums[filled, -1] = count
    table_of_sums = sums.reshape(turns, cells, -1)
    table_of_sums[:, :, :-2] = table_of_sums[:, :, :-2] @ np.swapaxes(whiten, 1, 2)
    return table_of_sums


def best_sectors(sums: Floats, widths: range, least: float) -> tuple[Integers, Integers, Integers]:
    """Return first cell and width of the narrowest sector with the greatest gain, and the width of the widest such
    sector, (t,) each.

    Sectors that hold the same samples have the same gain; widths are in cells.
    """
    turns, cells, _ = sums.shape
    around = np.concatenate([np.zeros((turns, 1, sums.shape[2])), sums, sums[:, : widths.stop]], axis=1)
    running = np.cumsum(around, axis=1)
    gain: Floats = np.zeros(turns)
    first, width, widest = np.zeros((3, turns), dtype=np.int64)
    for wide in widths:
        sector = running[:, wide : wide + cells] - running[:, :cells]
        left = sector[:, :, -1] - np.square(sector[:, :, :-2]).sum(axis=2)
        gains = np.square(np.maximum(sector[:, :, -2], 0.0)) / (np.maximum(left, 0.0) + least)
        at = np.argmax(gains, axis=1)
        top = gains[np.arange(turns), at]
        better = top > gain * (1.0 + _SAME)
        gain[better] = top[better]
        first[better], width[better] = at[better], wide
        widest[top >= gain * (1.0 - _SAME)] = wide
    return first, width, widest


# --- the models mixed -----------------------------------------------------------------------------------------------


@dataclass
class Estimate:
    """The result of one model for every turn. Names are those of ``Centres``, and ``centre`` is x + i y.

    ``smooth_radius`` is the mean radius without steps.
    """

    centre: Complexes
    covariance: Floats
    within: Floats
    one_sided: Floats
    mean_radius: Floats
    smooth_radius: Floats
    noise: Floats
    inliers: Floats

    def blend(self, turns: Integers, other: Estimate, weight: Floats) -> None:
        """Mix ``other``, which has one row for each of ``turns``, into the rows of these turns in this estimate.

        ``weight`` is the weight of ``other`` in each of these turns, 0 to 1.
        """
        w = weight[:, None, None]
        between = w * (1.0 - w) * _squares(other.centre - self.centre[turns])
        for field in fields(self):
            mine, theirs = getattr(self, field.name), getattr(other, field.name)
            mine[turns] += (w if mine.ndim == 3 else weight) * (theirs - mine[turns])
        self.covariance[turns] += between
        self.within[turns] += between


def estimate(fits: TurnFits) -> Estimate:
    """Solve the smooth model, and return the centre of every turn from all models that are worth trying."""
    fits.solve()
    best = _estimate(fits, np.zeros(fits.count.size))
    plain = fits.plain()
    oval = np.hypot(plain.terms[:, 3], plain.terms[:, 4])
    rough = (plain.spread() > _ROUGH * fits.shape.noise) | (oval > _OVAL * fits.shape.noise)
    if not rough.any():
        return best
    turns, some = np.flatnonzero(rough), fits.only(rough)
    known = np.maximum(some.evidence(), plain.only(rough).evidence())
    for opposite in (True, False):
        model, added = fit_steps(some, opposite)
        sectors = np.square(some.count) / (4.0 if opposite else 2.0)  # number of sectors that hold different samples
        evidence = model.evidence() - np.log(sectors) - _ODDS
        known = np.logaddexp(known, evidence)
        weight = np.exp(evidence - known)
        likely = weight > _LIKELY
        if likely.any():
            best.blend(turns[likely], _estimate(model.only(likely), added[likely]), weight[likely])
    return best


def _estimate(fits: TurnFits, added: Floats) -> Estimate:
    """Return a mix of a model and the same model with a wall that may be enlarged on one side.

    ``added`` is what steps add to the mean radius, (t,) m.
    """
    wide = fits.widened()
    weight = np.clip((wide.left_open() - _CLOSED) / (_OPEN - _CLOSED), 0.0, 1.0)
    other, spread = wide.one_sided()
    w = weight[:, None, None]
    apart = other - fits.centre
    within = fits.covariance()
    covariance = (1.0 - w) * within + w * spread + w * (1.0 - w) * _squares(apart)
    centre = fits.centre + weight * apart
    smooth = fits.terms[:, 0]
    return Estimate(
        centre, covariance, within, weight, smooth + added, smooth.copy(), fits.noise.copy(), fits.inliers()
    )


def _squares(apart: Complexes) -> Floats:
    """Return d d' of every turn's vector d = (x, y), given as x + i y, (t, 2, 2)."""
    vector = np.stack([apart.real, apart.imag], axis=1)
    squares: Floats = vector[:, :, None] * vector[:, None, :]
    return squares
