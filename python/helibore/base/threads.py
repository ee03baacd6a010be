"""Count the processors that this process may use (its affinity mask), not those of the machine."""

from __future__ import annotations

import operator
import os

from helibore.base.errors import InputError


def available_threads() -> int:
    """Return the number of processors this process may run on."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def thread_count(threads: int | None) -> int:
    """Return ``threads`` as an int, all available ones for None; InputError unless it is 1 to 1024."""
    if threads is None:
        return available_threads()
    try:
        count = operator.index(threads)
    except TypeError:
        raise InputError("threads", "must be an integer", repr(threads)) from None
    if not 1 <= count <= 1024:
        raise InputError("threads", "must lie in 1 to 1024", str(count))
    return count
