"""Choose how many threads or processes to use: by default one for each processor that this process may use.

The largest number that is allowed, and how threads share work, are defined in C++: ``cpp/src/base/threads.hpp``.
"""

from __future__ import annotations

import operator
import os

from helibore import _core
from helibore.base.errors import InputError


def thread_count(count: int | None, name: str = "threads") -> int:
    """Return ``count`` as an int; None: the number of processors that this process may use, by its affinity mask.

    Raises an InputError with the place ``name`` if ``count`` is not an integer from 1 to the core's limit.
    """
    if count is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    try:
        count = operator.index(count)
    except TypeError:
        raise InputError(name, "must be an integer", repr(count)) from None
    if not 1 <= count <= _core.most_threads:
        raise InputError(name, f"must lie in 1 to {_core.most_threads}", str(count))
    return count
