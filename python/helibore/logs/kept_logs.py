"""What is measured once of a wall at one moment, so that its logs and zones do not measure it again.

wall.logs() -> held by the caller --.
                                    |--> wall.zones() takes them, while the caller holds them and the wall is the same
KeptLogs (weak reference) ----------'
"""

from __future__ import annotations

import weakref
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from helibore.base.arrays import Bytes
from helibore.trajectory.references import reference_assumed, reference_of

if TYPE_CHECKING:
    from helibore.logs.turn_logs import Logs

Measured = tuple[float, bool, float]
"""How logs were measured: window of rugosity, whether with sigma, accuracy of the caliper."""


class KeptLogs:
    """The last logs of a wall while its samples stay the same, as long as somebody holds them; and its marks.

    ``marks`` has the marks of ``MeasuredRule`` for the vertices; None: nobody has asked for them yet.
    """

    def __init__(self) -> None:
        self.marks: Bytes | None = None
        self._logs: weakref.ref[Logs] | None = None
        self._how: Measured | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        return KeptLogs, ()

    def keep(self, logs: Logs, how: Measured) -> Logs:
        """Return ``logs``, whose arrays can no longer be written, because others may get the same logs."""
        arrays = [getattr(logs, field.name) for field in fields(logs)]
        for array in (*arrays, *logs.arm_diameter):
            if isinstance(array, np.ndarray):
                array.flags.writeable = False
        self._logs, self._how = weakref.ref(logs), how
        return logs

    def find(self, wall: Any, how: Measured) -> Logs | None:
        """Return the logs of ``wall``, measured in this way, if they are held; None: they must be measured.

        Logs with an uncertainty also serve for those without it, if all else is the same.
        """
        logs, kept = (None if self._logs is None else self._logs()), self._how
        if logs is None or kept is None or kept[0] != how[0] or not _is_placed(logs, wall):
            return None
        if kept == how:
            return logs
        return self.keep(_without_sigma(logs), how) if how[1:] == (False, 0.0) else None


def _is_placed(logs: Logs, wall: Any) -> bool:
    """Return whether the path and the reference of a wall are still those of its logs."""
    same_path: bool = logs.path is wall.path
    return same_path and (logs.reference, logs.reference_assumed) == (reference_of(wall) or "", reference_assumed(wall))


def _without_sigma(logs: Logs) -> Logs:
    nothing = np.full(len(logs), np.nan)
    plain = replace(logs, diameter_sigma=nothing, with_sigma=False, uncertain=None, caliper_accuracy=0.0)
    vars(plain).update({name: vars(logs)[name] for name in ("sparse", "_along") if name in vars(logs)})
    return plain
