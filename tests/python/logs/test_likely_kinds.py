"""The chain of sections along a hole against transition matrices and least squares, section by section."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helibore import _core
from helibore.base.arrays import Floats
from helibore.base.errors import InputError
from helibore.logs.likely_kinds import ALONG_PRIOR, EFFECTIVE, OFFSET, PARTS, ROUGH, SCALES, TEMPER

STAYS, CHANGES = 0.7, 0.05
RULE = (STAYS, CHANGES, ROUGH, OFFSET, EFFECTIVE, TEMPER)


def evidence(window: Floats, section: Floats) -> float:
    """Return the log of the evidence of a window for a section, by least squares over the offset of the tool."""
    seen = np.flatnonzero(np.isfinite(window))
    if not seen.size:
        return 0.0
    count = min(seen.size, EFFECTIVE)
    root = np.sqrt(count / seen.size) / ROUGH
    angle = seen * 2 * np.pi / PARTS
    rows = np.vstack([root * np.column_stack([np.cos(angle), np.sin(angle)]), np.eye(2) / OFFSET])
    off = np.append(root * (window - section)[seen], [0.0, 0.0])
    left = off - rows @ np.linalg.lstsq(rows, off, rcond=None)[0]
    square = left @ left
    return max(np.log(share) - count * np.log(scale) - square / (2 * scale**2) for scale, share in SCALES.items())


def reference(windows: Floats, sections: Floats, kind: Floats, size: Floats) -> tuple[Floats, Floats]:
    """Return the probabilities of the kinds, and the mean size, by matrices of transition."""
    each = np.bincount(kind, minlength=5)
    prior = np.array(ALONG_PRIOR)[kind] / each[kind]
    alike = (kind[:, None] == kind) / each[kind]
    moves = STAYS * np.eye(len(kind)) + CHANGES * alike + (1 - STAYS - CHANGES) * prior
    logs = np.array([[evidence(window, section) for section in sections] for window in windows])
    given_ = np.exp(TEMPER * (logs - logs.max(axis=1, keepdims=True)))
    forward, backward = [prior * given_[0]], [np.ones(len(kind))]
    for row in given_[1:]:
        forward.append(row * (forward[-1] @ moves) / forward[-1].sum())
    for row in given_[:0:-1]:
        backward.append(moves @ (row * backward[-1]) / backward[-1].max())
    both = np.array(forward) * np.array(backward[::-1])
    both /= both.sum(axis=1, keepdims=True)
    return np.array([both[:, kind == code].sum(axis=1) for code in range(5)]).T, both @ size


def core(windows: Floats, sections: Floats, kind: Floats, size: Floats, threads: int = 1) -> tuple[Floats, ...]:
    a, b, c, d, e = np.bincount(kind, minlength=5).tolist()
    kinds, mean, square = _core.likely_along(
        windows.ravel(), sections.ravel(), (a, b, c, d, e), size, ALONG_PRIOR, RULE, list(SCALES.items()), threads
    )
    return kinds.reshape(-1, 5), mean, square


def made(seed: int, counts: tuple[int, ...], steps: int, seen: float) -> tuple[Floats, Floats, Floats, Floats]:
    rng = np.random.default_rng(seed)
    kind = np.repeat(np.arange(5), counts)
    sections = rng.normal(0, 4e-3, (kind.size, PARTS))
    windows = sections[rng.integers(0, kind.size, steps)] + rng.normal(0, 2e-3, (steps, PARTS))
    windows[rng.random(windows.shape) > seen] = np.nan
    return windows, sections, kind, rng.normal(0, 1e-3, kind.size)


@given(
    st.integers(0, 2**32), st.tuples(*[st.integers(0, 11)] * 5).filter(any), st.integers(1, 40), st.floats(0, 1)
)  # fmt: skip
def test_the_chain_equals_matrices_of_transition(seed, counts, steps, seen):
    windows, sections, kind, size = made(seed, counts, steps, seen)
    kinds, mean, square = core(windows, sections, kind, size)
    prior, sized = reference(windows, sections, kind, size)
    absent = np.array(counts) == 0
    np.testing.assert_allclose(kinds, prior, atol=1e-4)
    assert not kinds[:, absent].any()
    np.testing.assert_allclose(mean, sized, atol=1e-6)
    assert (square >= mean**2 - 1e-12).all()


def test_the_result_does_not_depend_on_threads_or_on_how_many_windows_follow_far_away():
    windows, sections, kind, size = made(1, (9, 5, 8, 7, 3), 300, 0.4)
    one = core(windows, sections, kind, size)
    for threads in (2, 3):
        for a, b in zip(one, core(windows, sections, kind, size, threads), strict=True):
            np.testing.assert_array_equal(a, b)


def test_what_cannot_be_compared_is_refused():
    windows, sections, kind, size = made(2, (2, 2, 2, 2, 2), 3, 1)
    sections[3, 4] = np.nan
    with pytest.raises(InputError) as error:
        core(windows, sections, kind, size)
    assert (error.value.place, error.value.rule) == (f"sections[{3 * PARTS + 4}]", "must be finite")
    with pytest.raises(InputError) as error:
        core(windows, np.zeros((0, PARTS)), kind[:0], size[:0])
    assert error.value.place == "counts"
    with pytest.raises(InputError):
        core(windows[:, :-1], sections[:3], kind[:3], size[:3])
