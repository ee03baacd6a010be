"""How long a test waits before it takes what it waits for to be hung: the one limit by the clock of all tests.

A wait ends at once where a thread of the test process died meanwhile, such as that of a server: what it waits for would
not come.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

PATIENCE = 600.0
"""Seconds. A wait ends when its condition holds, so this costs time only in a test that fails anyway; the slowest wait
takes some 10 s on two idle processors, and a machine of a quarter of the speed, or one beside other work, must pass."""

DEAD: list[str] = []
"""What each thread that an exception ended said, since the module of tests began."""


def _note_the_dead() -> None:
    usual = threading.excepthook

    def note(args: threading.ExceptHookArgs) -> None:
        name = args.thread.name if args.thread else "a thread"
        DEAD.append(f"{name} ended: {args.exc_type.__name__}: {args.exc_value}")
        usual(args)

    threading.excepthook = note


_note_the_dead()


def wait(condition: Callable[[], object], said: Callable[[], str], pause: float, seconds: float = PATIENCE) -> None:
    """Wait until ``condition`` is true; raise AssertionError with what was ``said`` after ``seconds``.

    It is raised at once where a thread died since the module of tests began.
    """
    end = time.monotonic() + seconds
    while not condition():
        assert not DEAD, f"{said()}; {'; '.join(DEAD)}"
        assert time.monotonic() < end, said()
        time.sleep(pause)
