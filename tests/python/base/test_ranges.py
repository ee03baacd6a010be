"""Unions of ranges against sets of numbers."""

from __future__ import annotations

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from helibore.base.ranges import union

RANGES = st.lists(st.tuples(st.integers(0, 40), st.integers(0, 8)).map(lambda of: (of[0], of[0] + of[1])))


@given(RANGES)
def test_a_union_holds_the_same_numbers_in_as_few_ranges_as_there_can_be(ranges: list[tuple[int, int]]) -> None:
    found = union(ranges)
    assert {k for start, stop in found for k in range(start, stop)} == {
        k for start, stop in ranges for k in range(start, stop)
    }
    assert all(start < stop for start, stop in found)
    assert all(before[1] < after[0] for before, after in pairwise(found))


@given(RANGES, st.integers(1, 5))
def test_a_bound_covers_the_narrowest_gaps(ranges: list[tuple[int, int]], most: int) -> None:
    whole = union(ranges)
    found = union(ranges, most)
    assert len(found) == min(len(whole), most)
    gaps = sorted(after[0] - before[1] for before, after in pairwise(whole))
    covered = sum(stop - start for start, stop in found) - sum(stop - start for start, stop in whole)
    assert covered == sum(gaps[: len(whole) - len(found)])


def test_of_equal_gaps_the_first_is_covered() -> None:
    assert union([(0, 1), (3, 4), (6, 7)], 2) == [(0, 4), (6, 7)]
