"""What the server knows of one page: the tiles it holds, and the values it has not received or not acknowledged.

    producer --mark--> pending ranges per tile --next_message--> page --acknowledge--> room for the next message

There is no queue: a message is packed from the latest values as soon as fewer than `MOST_UNACKNOWLEDGED` bytes wait for
an acknowledgement. The caller of every function in this file holds the scene's lock; no function waits.
"""

from __future__ import annotations

from helibore.base.ranges import Range, union
from helibore.viewer import protocol
from helibore.viewer.protocol import BadMessageError, Subscription
from helibore.viewer.scene import FRAMES_LEVEL, Scene

MOST_UNACKNOWLEDGED = 1 << 20  # bytes
MOST_PENDING = 4  # most pending ranges of a tile; if there are more, some are joined, with the gaps between them
OVERVIEW_PRIORITY = 4.5  # tiles: a tile nearer to the focus is sent before the overview, all other tiles after it
FRAMES_A_MESSAGE = 4096

Key = tuple[int, int]  # level, tile


class Client:
    """A connected page: what it asked for, and what it has not received or not acknowledged."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.session = scene.session
        self.subscription = Subscription((), 0, 0)
        self.pending: dict[Key, list[Range]] = {}
        self.requested: set[Key] = set()
        self.sequence = 0
        self.unacknowledged: dict[int, int] = {}
        self.mark(FRAMES_LEVEL, 0, len(scene.frames.centre))

    def mark(self, level: int, start: int, stop: int, measured: bool = True) -> None:
        """Note that vertices of the wall, cells of the overview or frames [start, stop) changed.

        Vertices of the wall are noted only if the page holds a tile that shows them; cells and frames are always noted.
        If nothing was ``measured``, but it became known how sure the vertices are, no page takes it for new data.
        """
        if stop <= start:
            return
        if level == FRAMES_LEVEL:
            self._add((FRAMES_LEVEL, 0), start, stop)
        else:
            for tile in self.scene.levels[level].tiles(start, stop):
                if level == 1 or self._holds(tile):
                    if not measured and (level, tile) not in self.pending:
                        self.requested.add((level, tile))
                    self._mark_tile((level, tile), start, stop)

    def subscribe(self, wanted: Subscription) -> None:
        """Replace the subscription.

        Each tile that the page did not have becomes pending as a whole; if an attribute is new, all tiles become
        pending. The overview becomes pending with the first subscription, and again if an attribute is new.
        """
        old, self.subscription = self.subscription, wanted
        more = bool(wanted.mask & ~old.mask)
        for key in [key for key in self.pending if key[0] == 0 and not self._holds(key[1])]:
            del self.pending[key]
            self.requested.discard(key)
        wall, over = self.scene.levels
        last = -(-wall.size // wall.tile_size)
        for start, stop in wanted.ranges:
            for tile in range(start, min(stop, last)):
                if more or not any(a <= tile < b for a, b in old.ranges):
                    self._request((0, tile))
        if more or not old.ranges:
            for tile in range(-(-over.size // over.tile_size)):
                self._request((1, tile))

    def acknowledge(self, sequence: int) -> None:
        """Note that the page has applied message ``sequence``; raise BadMessageError if no such message waits."""
        if self.unacknowledged.pop(sequence, None) is None:
            raise BadMessageError(f"ack {sequence}: no message with this number waits for an ack")

    def next_message(self) -> bytes | None:
        """Return the next message, packed from the latest values.

        None: nothing is pending, or too many bytes wait for an acknowledgement.
        """
        if not self.pending or sum(self.unacknowledged.values()) >= MOST_UNACKNOWLEDGED:
            return None
        key = min(self.pending, key=self._priority)
        start, stop = self.pending[key].pop(0)
        if key[0] == FRAMES_LEVEL and stop - start > FRAMES_A_MESSAGE:
            self.pending[key].insert(0, (start + FRAMES_A_MESSAGE, stop))
            stop = start + FRAMES_A_MESSAGE
        if not self.pending[key]:
            del self.pending[key]
        if key[0] == FRAMES_LEVEL:
            message = protocol.frames_message(self.scene, start, stop)
        else:
            live = key not in self.requested
            message = protocol.write_message(self.scene, *key, start, stop, self.subscription.mask, live)
        if key not in self.pending:
            self.requested.discard(key)
        self.sequence = (self.sequence + 1) & 0xFFFFFFFF
        self.unacknowledged[self.sequence] = len(message)
        return protocol.number(message, self.sequence)

    def _holds(self, tile: int) -> bool:
        return any(start <= tile < stop for start, stop in self.subscription.ranges)

    def _request(self, key: Key) -> None:
        level = self.scene.levels[key[0]]
        start = key[1] * level.tile_size
        self._mark_tile(key, start, min(start + level.tile_size + level.halo, level.size))
        self.requested.add(key)

    def _mark_tile(self, key: Key, start: int, stop: int) -> None:
        level = self.scene.levels[key[0]]
        origin = key[1] * level.tile_size
        self._add(key, max(0, start - origin), min(level.tile_size + level.halo, stop - origin))

    def _add(self, key: Key, start: int, stop: int) -> None:
        if stop > start:
            self.pending[key] = union([*self.pending.get(key, []), (start, stop)], MOST_PENDING)

    def _priority(self, key: Key) -> float:
        """Return the rank by which frames are sent first, then the tiles near the focus, the overview, other tiles."""
        if key[0] == FRAMES_LEVEL:
            return -1
        return OVERVIEW_PRIORITY if key[0] == 1 else abs(key[1] - self.subscription.focus)
