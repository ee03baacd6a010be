"""Choose how many threads or processes to use: by default one for each processor that this process may use.

The limit of a number of threads, and how they share work, is C++: ``cpp/src/base/threads.hpp``.
"""

from __future__ import annotations

import operator
import os

from helibore import _core
from helibore.base.errors import InputError


def thread_count(count: int | None, name: str = "threads") -> int:
    """Return ``count`` as an int, or for None the number of usable processors (of the affinity mask).

    Raises InputError that names the argument unless it lies in 1 to the core's limit.
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
