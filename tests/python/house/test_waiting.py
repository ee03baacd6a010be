"""A test that waits for a server ends where the server's thread has died."""

from __future__ import annotations

import threading

import pytest
from live_servers import until
from patience import DEAD


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_wait_ends_where_a_thread_died_and_says_why() -> None:
    def serve() -> None:
        raise RuntimeError("the port is in use")

    thread = threading.Thread(target=serve, name="server")
    thread.start()
    thread.join()
    try:
        with pytest.raises(AssertionError, match="it did not come; server ended: RuntimeError: the port is in use"):
            until(lambda: False)
    finally:
        DEAD.clear()
    until(lambda: True)
