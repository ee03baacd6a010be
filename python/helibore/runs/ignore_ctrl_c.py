"""Let a worker of this machine ignore Ctrl-C, which a terminal sends to all: the process that was started ends it."""

import signal


def dask_setup(_: object) -> None:
    """Dask calls this in each worker that loads this module."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
