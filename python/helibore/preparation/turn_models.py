"""Which wall a turn was in, and what each says of the tool's centre: the models of ``turn_fits``, weighed and mixed.

    smooth      twelve harmonics, the even ones as large as ovality and breakouts make them
    pair        an oval with two opposite lobes that have upright edges (``lobes``)
    single      an oval with one such lobe: a washout on one side, a key seat

Each is fitted again with a wall that may be enlarged on one side, and mixed with that as far as the samples leave it
open. Then the three are mixed by their evidence: of models with weights w, the mean is that of their centres, and the
covariance the mean of theirs plus that of the centres about it. Not public: ``eccentering`` is.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from helibore.base.arrays import Floats, Integers
from helibore.preparation.harmonics import Complexes
from helibore.preparation.step_model import lobed
from helibore.preparation.turn_fits import TurnFits

_SHUT, _OPEN = 0.64, 0.72  # of the third harmonic of a washout left open: it counts from here on, and fully
_ROUGH, _OVAL = 1.5, 2.0  # expected deviations: lobes are looked for where an oval leaves more, or is more oval
_ODDS = 8.0  # logarithm of the odds that lobes have to overcome, beside the number of their sectors
_LIKELY = 1e-6  # a model of less weight is left out


@dataclass
class Estimate:
    """What one model says of every turn: as in ``Centres``, with x and y as one complex number."""

    centre: Complexes
    covariance: Floats
    within: Floats
    one_sided: Floats
    mean_radius: Floats
    noise: Floats
    inliers: Floats

    def blend(self, turns: Integers, other: Estimate, weight: Floats) -> None:
        """Mix the other's turns, all of it, into these ``turns`` of this one, with a ``weight`` each."""
        w = weight[:, None, None]
        apart = other.centre - self.centre[turns]
        between = w * (1.0 - w) * _squares(apart)
        for field in fields(self):
            mine, theirs = getattr(self, field.name), getattr(other, field.name)
            share = w if mine.ndim == 3 else weight
            mine[turns] += share * (theirs - mine[turns])
        self.covariance[turns] += between
        self.within[turns] += between


def estimate(fits: TurnFits) -> Estimate:
    """The centre of every turn, from all models that are worth trying."""
    best = _estimate(fits, np.zeros(fits.count.size))
    plain = fits.plain()
    oval = np.hypot(plain.terms[:, 3], plain.terms[:, 4])
    rough = (plain.spread() > _ROUGH * fits.shape.noise) | (oval > _OVAL * fits.shape.noise)
    if not rough.any():
        return best
    turns, some = np.flatnonzero(rough), fits.only(rough)
    known = np.maximum(some.evidence(), plain.only(rough).evidence())
    for opposite in (True, False):
        model = lobed(some, opposite)
        sectors = np.square(some.count) / (4.0 if opposite else 2.0)  # that hold different samples
        evidence = model.fits.evidence() - np.log(sectors) - _ODDS
        known = np.logaddexp(known, evidence)
        weight = np.exp(evidence - known)
        likely = weight > _LIKELY
        if likely.any():
            best.blend(turns[likely], _estimate(model.fits.only(likely), model.added[likely]), weight[likely])
    return best


def _estimate(fits: TurnFits, added: Floats) -> Estimate:
    """Mix one model with its like that may be enlarged on one side. ``added``: what lobes add to the mean radius."""
    wide = fits.widened()
    weight = np.clip((wide.left_open() - _SHUT) / (_OPEN - _SHUT), 0.0, 1.0)
    other, spread = wide.one_sided()
    w = weight[:, None, None]
    apart = other - fits.centre
    within = fits.covariance()
    covariance = (1.0 - w) * within + w * spread + w * (1.0 - w) * _squares(apart)
    centre = fits.centre + weight * apart
    return Estimate(centre, covariance, within, weight, fits.terms[:, 0] + added, fits.noise.copy(), fits.inliers())


def _squares(apart: Complexes) -> Floats:
    """d d' of every turn, (t, 2, 2)."""
    vector = np.stack([apart.real, apart.imag], axis=1)
    squares: Floats = vector[:, :, None] * vector[:, None, :]
    return squares
