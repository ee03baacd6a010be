"""Count the processors that this process may use (its affinity mask), not those of the machine.

How work is shared among threads is C++: ``cpp/src/base/threads.hpp``.
"""

from __future__ import annotations

import operator
import os

from helibore.base.errors import InputError


def thread_count(threads: int | None) -> int:
    """Return ``threads`` as an int, or for None the number of usable processors; InputError unless 1 to 1024."""
    if threads is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    try:
        count = operator.index(threads)
    except TypeError:
        raise InputError("threads", "must be an integer", repr(threads)) from None
    if not 1 <= count <= 1024:
        raise InputError("threads", "must lie in 1 to 1024", str(count))
    return count
