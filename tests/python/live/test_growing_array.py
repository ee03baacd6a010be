"""A growing array is a list that appends at its end and deletes at its start."""

from __future__ import annotations

import sys

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from helibore.live.model import growing_array
from helibore.live.model.growing_array import GrowingArray


@given(st.lists(st.tuples(st.lists(st.integers(-9, 9), max_size=9), st.integers(0, 5), st.booleans())))
def test_it_holds_what_a_list_holds(steps: list[tuple[list[int], int, bool]]) -> None:
    grown, wanted = GrowingArray(np.int64), list[int]()
    for added, forgotten, restored in steps:
        earlier, before = grown.values, list(wanted)
        grown.append(np.array(added, np.int64))
        wanted += added
        assert earlier.tolist() == before  # what was read does not change
        count = min(forgotten, len(wanted))
        grown.forget(count)
        del wanted[:count]
        if restored:  # as by a checkpoint
            grown.values = grown.values.copy()
        assert grown.values.tolist() == wanted
        assert grown.values.dtype == np.int64


def test_another_thread_sees_the_entries_before_or_after_a_change_and_nothing_else():
    """A reader runs before each line that changes the array, as another thread may."""
    grown, seen = GrowingArray(np.float64), list[list[float]]()
    grown.append(np.arange(10.0))

    def trace(frame, *_):
        if frame.f_code.co_filename == growing_array.__file__ and frame.f_code.co_name in ("append", "forget"):
            seen.append(grown.values.tolist())
            return trace
        return None

    wanted, before = list(range(10)), sys.gettrace()
    for change, after in (
        (lambda: grown.forget(4), wanted[4:]),
        (lambda: grown.append(np.arange(10.0, 40.0)), list(range(4, 40))),
    ):
        start = grown.values.tolist()
        sys.settrace(trace)
        try:
            change()
        finally:
            sys.settrace(before)
        assert len(seen) > 2
        assert all(one in (start, after) for one in seen)
        seen.clear()
