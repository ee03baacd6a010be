"""One page's side of the server: what it holds, what it lacks, how much is on its way to it.

    producer --mark--> dirty intervals per tile --take--> one message --send--> page --ack--> room for the next

There is no queue: a message is packed from the latest values at the moment there is room for it (less than `ROOM`
bytes sent and not yet acknowledged). Everything here is called with the scene's lock held; nothing here waits.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from helibore.viewer import dirty, messages
from helibore.viewer.messages import FRAMES_LEVEL
from helibore.viewer.scene import Scene

ROOM = 1 << 20
MOST_RANGES = 64  # ranges of tiles in one subscription
OVERVIEW_TURN = 4.5  # the overview is sent after the tiles this near to the focus, before all others
FRAMES_A_MESSAGE = 4096

Key = tuple[int, int]  # level, tile


class BadMessageError(ValueError):
    """A message from the page that breaks the protocol; the text says which rule."""


@dataclass(frozen=True)
class Subscription:
    """What a page asks for: ranges of tiles of the wall, the tile it looks at, the attributes it draws."""

    ranges: tuple[tuple[int, int], ...]
    focus: int
    mask: int


class Client:
    """A connected page, seen from the scene."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.session = scene.session
        self.ranges: tuple[tuple[int, int], ...] = ()
        self.focus, self.mask = 0, 0
        self.dirty: dict[Key, list[dirty.Interval]] = {}
        self.asked: set[Key] = set()
        self.sequence = 0
        self.on_the_way: dict[int, int] = {}
        self.mark(FRAMES_LEVEL, 0, len(scene.frames.centre))

    def mark(self, level: int, start: int, stop: int) -> None:
        """Note that [start, stop) of a level changed; kept only for tiles that the page holds."""
        if stop <= start:
            return
        if level == FRAMES_LEVEL:
            key = (FRAMES_LEVEL, 0)
            self.dirty[key] = dirty.add(self.dirty.get(key, []), start, stop)
            return
        store = self.scene.levels[level]
        for tile in store.tiles(start, stop):
            if level == 1 or self._holds(tile):
                self._mark_tile((level, tile), start, stop)

    def subscribe(self, wanted: Subscription) -> None:
        """Take over what the page holds and lacks: tiles that are new to it are dirty as a whole."""
        old_ranges, old_mask = self.ranges, self.mask
        self.ranges, self.focus, self.mask = wanted.ranges, wanted.focus, wanted.mask
        first_time = not old_ranges
        more = bool(wanted.mask & ~old_mask)
        for key in [key for key in self.dirty if key[0] == 0 and not self._holds(key[1])]:
            del self.dirty[key]
            self.asked.discard(key)
        store = self.scene.levels[0]
        last = -(-store.size // store.tile_size)
        for start, stop in wanted.ranges:
            for tile in range(start, min(stop, last)):
                if more or not any(a <= tile < b for a, b in old_ranges):
                    self._ask((0, tile))
        if first_time or more:
            over = self.scene.levels[1]
            for tile in range(-(-over.size // over.tile_size)):
                self._ask((1, tile))

    def acknowledge(self, sequence: int) -> None:
        """Note that the page has applied a message."""
        if self.on_the_way.pop(sequence, None) is None:
            raise BadMessageError(f"ack {sequence}: no such message is on its way")

    @property
    def room(self) -> bool:
        return sum(self.on_the_way.values()) < ROOM

    def take(self) -> bytes | None:
        """Return the next message, packed from the latest values, or None: nothing to say, or no room."""
        if not self.dirty or not self.room:
            return None
        key = min(self.dirty, key=self._turn)
        start, stop = self.dirty[key].pop(0)
        if key[0] == FRAMES_LEVEL and stop - start > FRAMES_A_MESSAGE:
            self.dirty[key].insert(0, (start + FRAMES_A_MESSAGE, stop))
            stop = start + FRAMES_A_MESSAGE
        if not self.dirty[key]:
            del self.dirty[key]
        message = self._frames(start, stop) if key[0] == FRAMES_LEVEL else self._write(key, start, stop)
        if key not in self.dirty:
            self.asked.discard(key)
        self.sequence = (self.sequence + 1) & 0xFFFFFFFF
        self.on_the_way[self.sequence] = len(message)
        return messages.number(message, self.sequence)

    def _holds(self, tile: int) -> bool:
        return any(start <= tile < stop for start, stop in self.ranges)

    def _ask(self, key: Key) -> None:
        store = self.scene.levels[key[0]]
        start = key[1] * store.tile_size
        self._mark_tile(key, start, min(start + store.tile_size + store.halo, store.size))
        self.asked.add(key)

    def _mark_tile(self, key: Key, start: int, stop: int) -> None:
        store = self.scene.levels[key[0]]
        origin = key[1] * store.tile_size
        first, last = max(0, start - origin), min(store.tile_size + store.halo, stop - origin)
        if last > first:
            self.dirty[key] = dirty.add(self.dirty.get(key, []), first, last)

    def _turn(self, key: Key) -> float:
        """Whose turn it is: frames, the tile looked at and its neighbours, the overview, the rest."""
        if key[0] == FRAMES_LEVEL:
            return -1
        return OVERVIEW_TURN if key[0] == 1 else abs(key[1] - self.focus)

    def _write(self, key: Key, first: int, stop: int) -> bytearray:
        level, tile = key
        store = self.scene.levels[level]
        part = slice(tile * store.tile_size + first, tile * store.tile_size + stop)
        kind = messages.WRITE | (0 if key in self.asked else messages.LIVE)
        message = messages.head(kind, level, self.mask, tile, first, stop - first, store.size, time.time())
        message += store.texels[part].astype("<u2", copy=False).tobytes()
        for bit, column in enumerate(store.columns):
            if self.mask >> bit & 1:
                message += column[part].astype("<f4", copy=False).tobytes()
        return message

    def _frames(self, first: int, stop: int) -> bytearray:
        frames = self.scene.frames
        mask = messages.SURVEYED if frames.surveyed else 0
        message = messages.head(
            messages.FRAMES, FRAMES_LEVEL, mask, 0, first, stop - first, len(frames.centre), time.time()
        )
        message += frames.centre[first:stop].astype("<f8", copy=False).tobytes()
        message += np.hstack([frames.high[first:stop], frames.right[first:stop]]).astype("<f4").tobytes()
        return message


def read_subscription(wanted: Any, attributes: int) -> Subscription:
    """Check what a page asks for.

    Raises
    ------
    BadMessageError
        If it is not ``{"tiles": [[start, stop], ...], "focus": tile, "mask": bits}`` within its bounds.
    """
    if not isinstance(wanted, dict):
        raise BadMessageError("subscribe: must be an object")
    ranges, focus, mask = wanted.get("tiles"), wanted.get("focus"), wanted.get("mask")
    if not isinstance(ranges, list) or len(ranges) > MOST_RANGES:
        raise BadMessageError(f"subscribe.tiles: must be a list of at most {MOST_RANGES} ranges")
    for part in ranges:
        whole = isinstance(part, list) and len(part) == 2 and all(type(number) is int for number in part)
        if not whole or not 0 <= part[0] < part[1] <= 1 << 31:
            raise BadMessageError(f"subscribe.tiles: {str(part)[:40]} is not a range [start, stop) of tiles")
    if type(focus) is not int or not 0 <= focus <= 1 << 31:
        raise BadMessageError(f"subscribe.focus = {str(focus)[:40]}: must be a tile's number")
    if type(mask) is not int or not 0 <= mask < 1 << attributes:
        raise BadMessageError(f"subscribe.mask = {str(mask)[:40]}: there are {attributes} attributes")
    return Subscription(tuple((start, stop) for start, stop in ranges), focus, mask)
