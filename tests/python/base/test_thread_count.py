"""Numbers of threads and processes: the limit is the core's, and an error names the caller's argument."""

from __future__ import annotations

import re

import pytest

from helibore import InputError, _core
from helibore.base.thread_count import thread_count


@pytest.mark.parametrize(
    ("count", "value", "rule"),
    [
        (0, "0", "must lie in 1 to 1024"),
        (10**30, f"{10**30}", "must lie in 1 to 1024"),
        (1.5, "1.5", "must be an integer"),
    ],
)
def test_a_number_outside_the_limit_is_refused_by_the_name_of_its_argument(
    count: object, value: str, rule: str
) -> None:
    with pytest.raises(InputError, match=re.escape(f"workers = {value}: {rule}")):
        thread_count(count, "workers")  # type: ignore[arg-type]


def test_the_core_accepts_the_largest_number() -> None:
    assert thread_count(_core.most_threads) == _core.most_threads
