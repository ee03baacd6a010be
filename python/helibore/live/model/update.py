"""Updates: the vertices, image rows, path and events that a call changed, and how two updates are joined.

    first  [0, 40) [90, 120)     then  [30, 95)     both  [0, 120)

Joined ranges cover every change. If there were more than MOST_RANGES, the narrowest gaps between them are covered, too,
so that a host that never polls uses little memory.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from helibore.base.arrays import Integers
from helibore.base.ranges import union
from helibore.live.model.events import Event, gather
from helibore.wall.append_result import Change

MOST_RANGES = 1024


@dataclass(slots=True)
class Update:
    """What one call, or all calls since a poll, changed.

    Attributes
    ----------
    changes
        The `Change` of each layer that took samples; its ``ranges`` are those of the new or changed vertices.
    images
        For each image that grew, the range [start, stop) of its new rows, as for ``ImageRows.rows``.
    path_from
        Depth in metres below which the path moved; None if the path did not move.
    events
        Events, at most eight of one rule of one source; the last of the eight counts all later events.
    """

    changes: dict[str, Change] = field(default_factory=dict)
    images: dict[str, tuple[int, int]] = field(default_factory=dict)
    path_from: float | None = None
    events: list[Event] = field(default_factory=list)

    def quads(self, layer: str, sectors: int) -> Integers:
        """Return (m, 2) ranges [start, stop) that cover all quads of ``layer`` with a new or changed vertex.

        With K = ``sectors``, quad k has the vertices k, k + 1, k + 1 + K and k + K. The ranges may contain quads past
        the end of the wall; the caller must remove them.
        """
        if layer not in self.changes:
            return np.empty((0, 2), np.int64)
        ranges = self.changes[layer].ranges.copy()
        ranges[:, 0] = np.maximum(ranges[:, 0] - sectors - 1, 0)
        return joined_ranges(ranges)


def joined_ranges(ranges: Integers) -> Integers:
    """Return the (n, 2) ranges sorted, and joined where they touch or overlap.

    If more than MOST_RANGES remain, the narrowest gaps between them are covered, too.
    """
    return np.array(union(ranges.tolist(), MOST_RANGES), np.int64).reshape(-1, 2)


def joined(first: Change | None, second: Change) -> Change:
    """Return one Change for two consecutive appends to a wall; return ``second`` if ``first`` is None."""
    if first is None:
        return second
    return Change(
        joined_ranges(np.concatenate([first.ranges, second.ranges])),
        second.settled,
        first.accepted + second.accepted,
        first.redundant + second.redundant,
    )


def merge(update: Update, more: Update) -> None:
    """Join the later update ``more`` into ``update``."""
    for name, change in more.changes.items():
        update.changes[name] = joined(update.changes.get(name), change)
    for name, (start, stop) in more.images.items():
        update.images[name] = (update.images.get(name, (start, 0))[0], stop)
    if more.path_from is not None:
        update.path_from = more.path_from if update.path_from is None else min(update.path_from, more.path_from)
    gather(update.events, more.events)
