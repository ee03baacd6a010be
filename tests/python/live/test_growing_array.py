"""A growing array is a list that appends at its end and deletes at its start."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from helibore.live.growing_array import GrowingArray


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
