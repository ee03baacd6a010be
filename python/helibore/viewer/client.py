"""The server's side of one page: what the page holds, what it has not received yet, what it has not acknowledged.

    producer --mark--> pending ranges per tile --next_message--> page --acknowledge--> room for the next message

There is no queue: a message is packed from the latest values when fewer than `MOST_UNACKNOWLEDGED` bytes wait for an
acknowledgement. Everything here is called with the scene's lock held; nothing here waits.
"""

from __future__ import annotations

import math
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from helibore.base.ranges import Range, union
from helibore.viewer import protocol
from helibore.viewer.levels import TURNS
from helibore.viewer.protocol import FRAMES_LEVEL
from helibore.viewer.scene import Scene

MOST_UNACKNOWLEDGED = 1 << 20  # bytes
MOST_PENDING = 4  # most pending ranges of a tile; more are joined, and the gaps between them are sent again
MOST_RANGES = 64  # ranges of tiles in one subscription
OVERVIEW_PRIORITY = 4.5  # the tiles this near to the focus come before the overview, all others after it
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
    """A connected page, as the scene sees it."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.session = scene.session
        self.subscription = Subscription((), 0, 0)
        self.pending: dict[Key, list[Range]] = {}
        self.requested: set[Key] = set()
        self.sequence = 0
        self.unacknowledged: dict[int, int] = {}
        self.mark(FRAMES_LEVEL, 0, len(scene.frames.centre))

    def mark(self, level: int, start: int, stop: int) -> None:
        """Note that [start, stop) of a level changed; kept only for the tiles that the page holds."""
        if stop <= start:
            return
        if level == FRAMES_LEVEL:
            self._add((FRAMES_LEVEL, 0), start, stop)
        else:
            for tile in self.scene.levels[level].tiles(start, stop):
                if level == 1 or self._holds(tile):
                    self._mark_tile((level, tile), start, stop)

    def subscribe(self, wanted: Subscription) -> None:
        """Replace the subscription; each new tile becomes pending as a whole, or every tile if an attribute is new."""
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
        """Note that the page has applied a message."""
        if self.unacknowledged.pop(sequence, None) is None:
            raise BadMessageError(f"ack {sequence}: no such message is waiting for one")

    def next_message(self) -> bytes | None:
        """Return the next message, packed from the latest values; None: nothing is pending, or the page is behind."""
        if not self.pending or sum(self.unacknowledged.values()) >= MOST_UNACKNOWLEDGED:
            return None
        key = min(self.pending, key=self._priority)
        start, stop = self.pending[key].pop(0)
        if key[0] == FRAMES_LEVEL and stop - start > FRAMES_A_MESSAGE:
            self.pending[key].insert(0, (start + FRAMES_A_MESSAGE, stop))
            stop = start + FRAMES_A_MESSAGE
        if not self.pending[key]:
            del self.pending[key]
        message = self._frames(start, stop) if key[0] == FRAMES_LEVEL else self._write(key, start, stop)
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
        """Send frames first, then the tiles near the focus, the overview, the other tiles."""
        if key[0] == FRAMES_LEVEL:
            return -1
        return OVERVIEW_PRIORITY if key[0] == 1 else abs(key[1] - self.subscription.focus)

    def _write(self, key: Key, first: int, stop: int) -> bytearray:
        level, tile = key
        store, mask = self.scene.levels[level], self.subscription.mask
        part = slice(tile * store.tile_size + first, tile * store.tile_size + stop)
        kind = protocol.WRITE | (0 if key in self.requested else protocol.LIVE)
        texels = store.texels[part].astype("<u2", copy=False)
        if first_pass := bool((texels[:, protocol.FIRST] == texels[:, protocol.RADIUS]).all()):
            level, texels = level | protocol.NO_FIRST, np.delete(texels, protocol.FIRST, axis=1)
        message = protocol.head(kind, level, mask, tile, first, stop - first, store.size, time.time())
        message += texels.tobytes() + bytes(2 * (first_pass and (stop - first) % 2))
        for bit, column in enumerate(store.columns):
            if mask >> bit & 1:
                message += column[part].astype("<f4", copy=False).tobytes()
        return message

    def _frames(self, first: int, stop: int) -> bytearray:
        frames = self.scene.frames
        mask, total = protocol.SURVEYED if frames.surveyed else 0, len(frames.centre)
        message = protocol.head(protocol.FRAMES, FRAMES_LEVEL, mask, 0, first, stop - first, total, time.time())
        message += frames.centre[first:stop].astype("<f8", copy=False).tobytes()
        message += np.hstack([frames.high[first:stop], frames.right[first:stop]]).astype("<f4").tobytes()
        return message


def handshake(scene: Scene) -> dict[str, Any]:
    """Return what a page must know before it receives values."""
    shape = scene.shape
    wall, over = scene.levels
    return {
        "type": "handshake",
        "version": 2,
        "session": scene.session,
        "well": shape.well,
        "basis": shape.basis,
        "basis_text": shape.basis_text,
        "reference": shape.reference,
        "assumed": shape.assumed,
        "bit_diameter": shape.bit_diameter,
        "start_depth": shape.start_depth,
        "start_toolface": shape.start_toolface,
        "vertices": wall.size,
        "radius_unit": shape.radius_unit,
        "nearest_unit": protocol.NEAREST_UNIT,
        "levels": [
            {"sectors": wall.sectors, "rows": wall.rows, "pitch": shape.pitch, "rings": False},
            {"sectors": over.sectors, "rows": over.rows, "pitch": shape.pitch * TURNS, "rings": True},
        ],
        "frame_step": math.copysign(protocol.FRAME_STEP, shape.pitch),
        "template": None if scene.template is None else asdict(scene.template),
        "attributes": [asdict(attribute) for attribute in shape.attributes],
        "picks_file": None if scene.picks_file is None else Path(scene.picks_file).name,
        "saves_picks": scene.saves_picks,
        "curves": [row["name"] for row in scene.state.curves if row["version"] == 0],  # given; logs have other ones
    }


def state_message(scene: Scene) -> dict[str, Any]:
    """Return the `RunState` for a page, with the server's clock."""
    state = {name: None if value != value else value for name, value in vars(scene.state).items()}  # NaN is not JSON
    now = None if state["newest"] is None else round(time.time(), 1)
    rows = [list(row.values()) for row in scene.state.curves]  # name, unit, low, high, log, version
    curves = {"curves": [row[:-1] for row in rows], "curves_version": max((row[-1] for row in rows), default=0)}
    return {"type": "state", "begun": scene.begun, **state, **curves, "now": now}


def picks_message(scene: Scene) -> dict[str, Any]:
    """Return the picks for a page."""
    return {"type": "picks", "picks": [asdict(pick) for pick in scene.picks]}


def read_subscription(wanted: Any, attributes: int) -> Subscription:
    """Check what a page asks for: ``{"tiles": [[start, stop], ...], "focus": tile, "mask": bits}``, each in bounds."""
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
