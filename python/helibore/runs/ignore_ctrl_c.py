"""Make local workers ignore Ctrl-C, which a terminal sends to all processes; the main process ends the workers."""

import signal


def dask_setup(_: object) -> None:
    """Ignore Ctrl-C in this process; Dask calls this function in each worker that loads this module."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
