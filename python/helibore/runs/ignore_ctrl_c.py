"""Let local workers ignore Ctrl-C, which a terminal sends to all processes; the main process ends the workers."""

import signal


def dask_setup(_: object) -> None:
    """Dask calls this in each worker that loads this module."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
