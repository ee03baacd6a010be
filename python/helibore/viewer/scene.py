"""What a viewer shows, as arrays ready to send: the wall in two levels, the path's frames, the state of the bit.

A wall is a helix, so neither depth nor toolface of a vertex is stored or sent: vertex k of a level lies at

    depth    = start_depth + k pitch / sectors          toolface = start_toolface + k 360 / sectors

Level 0 is the wall. Level 1 is its overview, a helix of eight sectors whose pitch is sixteen turns (overview.py).
`Scene` is the one implementation of `WallScene` here; another viewer's back-end implements the same three verbs.
Nothing in this file knows the network; `messages.py` knows the bytes and `client.py` what a page still lacks.
"""

from __future__ import annotations

import math
import secrets
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import numbers
from helibore.viewer import messages, overview
from helibore.viewer.history import History
from helibore.viewer.messages import Texels, Vertices

Floats = npt.NDArray[np.float64]
Floats32 = npt.NDArray[np.float32]

MAX_SECTORS = 2048  # the texture width that every WebGL 2 device must offer
MAX_ATTRIBUTES = 16  # the bits of the attribute mask in a message's head
TILE_VERTICES = 16384  # a grid of (sectors + 1)(rows + 1) vertices then fits 16-bit indices


@dataclass(frozen=True)
class Attribute:
    """One value per quad, drawn as a colour: name, unit, and how it is usually shown."""

    name: str
    unit: str = ""
    low: float | None = None
    high: float | None = None
    log: bool = False
    colours: str = ""


@dataclass(frozen=True)
class Helix:
    """Everything of a wall but its values. Lengths in metres, angles in degrees; `pitch` is signed."""

    sectors: int
    pitch: float
    start_depth: float
    bit_diameter: float
    start_toolface: float = 0.0
    well: str = ""
    attributes: tuple[Attribute, ...] = field(default_factory=tuple)

    def __post_init__(self) -> None:
        if not 3 <= self.sectors <= MAX_SECTORS:
            raise ValueError(f"sectors = {self.sectors}: the viewer draws 3 to {MAX_SECTORS} sectors")
        if not (math.isfinite(self.pitch) and self.pitch != 0):
            raise ValueError(f"pitch = {self.pitch}: must be finite and not zero")
        if not (math.isfinite(self.bit_diameter) and self.bit_diameter > 0):
            raise ValueError(f"bit_diameter = {self.bit_diameter}: must be finite and positive")
        if len(self.attributes) > MAX_ATTRIBUTES:
            raise ValueError(f"{len(self.attributes)} attributes: the viewer takes at most {MAX_ATTRIBUTES}")
        names = [attribute.name for attribute in self.attributes]
        if len(set(names)) != len(names):
            raise ValueError(f"attributes {names}: each name may appear once")

    @property
    def tile_rows(self) -> int:
        """Turns in a tile of the wall: the power of two that fits, 256 at 64 sectors."""
        return 1 << max(2, min(10, int(math.log2(TILE_VERTICES / self.sectors))))

    @property
    def radius_unit(self) -> float:
        """Metres per step of a packed radius: 10 um up to 655 mm, coarser for wider holes."""
        return 1e-5 if self.bit_diameter <= 0.8 else 1e-4


@dataclass(frozen=True)
class Frames:
    """Where the hole runs: one frame every `messages.FRAME_STEP` metres of depth, from start_depth on.

    centre (n, 3) is north, east, down in metres; high and right (n, 3) are the directions of toolface 0 and 90. Not
    `surveyed`: the hole is only drawn straight down, for want of a path.
    """

    centre: Floats
    high: Floats
    right: Floats
    surveyed: bool = True


class WallScene(Protocol):
    """The three verbs of any back-end that shows a growing wall."""

    def begin(self, helix: Helix) -> None:
        """Forget everything and start a wall of this shape."""

    def write(self, first: int, vertices: Vertices, attributes: Mapping[str, npt.ArrayLike]) -> None:
        """Set the vertices from `first` on, and the values of the quads with the same numbers.

        What is already so is not sent again.
        """

    def trajectory(self, first: int, frames: Frames) -> None:
        """Set the frames of the path from number `first` on."""


class Level:
    """One level's growable columns: packed texels and a float32 column for each attribute."""

    def __init__(self, sectors: int, rows: int, columns: int) -> None:
        self.sectors, self.rows, self.size = sectors, rows, 0
        self.texels: Texels = np.zeros((0, messages.TEXEL), np.uint16)
        self.columns: list[Floats32] = [np.full(0, np.nan, np.float32) for _ in range(columns)]

    @property
    def tile_size(self) -> int:
        return self.rows * self.sectors

    @property
    def halo(self) -> int:
        """Vertices of the next tile that this tile's last quads touch."""
        return self.sectors + 1

    def tiles(self, start: int, stop: int) -> range:
        """Tiles that show a vertex of [start, stop), their halo included."""
        return range(max(0, (start - self.halo) // self.tile_size), (max(start, stop - 1)) // self.tile_size + 1)

    def still(self, start: int, stop: int) -> Level:
        """Return a copy that holds [start, stop) as they are now; the rest is empty, and costs no memory."""
        kept = Level(self.sectors, self.rows, 0)
        first = max(0, min(start, self.size))
        kept.size, part = self.size, slice(first, max(first, min(stop, self.size)))
        kept.texels = np.zeros((self.size, messages.TEXEL), np.uint16)
        kept.texels[part] = self.texels[part]
        for column in self.columns:
            kept.columns.append(np.zeros(self.size, np.float32))
            kept.columns[-1][part] = column[part]
        return kept

    def reserve(self, size: int) -> None:
        """Grow to `size` vertices. What is not written is a gap: radius 0, attribute NaN."""
        capacity = len(self.texels)
        if size > capacity:
            more = max(size, 2 * capacity, self.tile_size) - capacity
            self.texels = np.concatenate([self.texels, np.zeros((more, messages.TEXEL), np.uint16)])
            empty = np.full(more, np.nan, np.float32)
            self.columns = [np.concatenate([column, empty]) for column in self.columns]
        self.size = max(self.size, size)


class Scene:
    """The wall as the server holds it. Every method may be called from any thread."""

    def __init__(self) -> None:
        self.lock = threading.RLock()
        self.on_change: Callable[[], None] = lambda: None
        self.marks: list[Callable[[int, int, int], None]] = []
        self.begun = False
        self.newest = math.nan  # seconds since 1970 of the newest sample, by the producer's clock
        self.bit_depth = math.nan
        self.ended = False
        self.feed = ""  # what the sources are doing, in words

    def begin(self, helix: Helix) -> None:
        with self.lock:
            self.helix = helix
            self.session = secrets.token_hex(8)
            count = len(helix.attributes)
            self.levels = (
                Level(helix.sectors, helix.tile_rows, count),
                Level(overview.sectors(helix.sectors), overview.TILE_ROWS, count),
            )
            self.frames = Frames(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3)), surveyed=False)
            self.settled = 0
            self.history = History()
            self.begun = True
        self.on_change()

    def write(self, first: int, vertices: Vertices, attributes: Mapping[str, npt.ArrayLike]) -> None:
        if first < 0:
            raise ValueError(f"first = {first}: must not be negative")
        unknown = sorted(set(attributes) - {attribute.name for attribute in self.helix.attributes})
        if unknown:
            raise ValueError(f"attribute {unknown[0]}: was not named when the scene began")
        texels = messages.pack_vertices(vertices, self.helix.radius_unit)
        stop = first + len(texels)
        if stop == first:
            return
        with self.lock:
            level = self.levels[0]
            before = level.size
            level.reserve(stop)
            self._keep_first_pass(level.texels[first:stop], texels, first)
            differs = _put(level.texels[first:stop], texels, np.uint64)
            for column, attribute in zip(level.columns, self.helix.attributes, strict=True):
                if attribute.name in attributes:
                    values = numbers(attributes[attribute.name], np.float32)[: stop - first]
                    differs[: len(values)] |= _put(column[first : first + len(values)], values, np.uint32)
            changed = np.flatnonzero(differs)
            if stop > before:
                start = min(before, first + int(changed[0]) if len(changed) else first)
            elif len(changed):
                start, stop = first + int(changed[0]), first + int(changed[-1]) + 1
            else:
                return
            self.history.note(time.time(), level.size, self.bit_depth)
            self._mark(0, start, stop)
            self._mark(1, *overview.refresh(self.levels[1], level, start, stop))
        self.on_change()

    def trajectory(self, first: int, frames: Frames) -> None:
        with self.lock:
            old = self.frames
            if first > len(old.centre):
                raise ValueError(f"first = {first}: the scene holds {len(old.centre)} frames, none may be left out")
            pairs = ((old.centre, frames.centre), (old.high, frames.high), (old.right, frames.right))
            joined = [np.concatenate([kept[:first], new, kept[first + len(new) :]]) for kept, new in pairs]
            self.frames = Frames(joined[0], joined[1], joined[2], surveyed=frames.surveyed)
            self._mark(messages.FRAMES_LEVEL, first, first + len(frames.centre))
        self.on_change()

    def state(
        self,
        *,
        bit_depth: float | None = None,
        newest: float | None = None,
        ended: bool | None = None,
        feed: str | None = None,
    ) -> None:
        """Say where the bit is (metres), when the newest sample was taken (seconds since 1970), that the run ended.

        `feed` is what the sources are doing, in words. May be called before `begin`: pages that are open then show it.
        """
        with self.lock:
            self.bit_depth = self.bit_depth if bit_depth is None else bit_depth
            self.newest = self.newest if newest is None else newest
            self.ended = self.ended if ended is None else ended
            self.feed = self.feed if feed is None else feed
        self.on_change()

    def settle(self, below: int) -> None:
        """Say that vertices under `below` no longer change while the hole deepens: later changes are re-scans."""
        with self.lock:
            self.settled = max(self.settled, min(below, self.levels[0].size))

    def rename(self, well: str) -> None:
        """Change the well's name on the page."""
        with self.lock:
            self.helix = replace(self.helix, well=well)

    def still(self, start: int, stop: int) -> Scene:
        """Return a scene of its own that stays as this one is now: vertices [start, stop) and all of the overview.

        For what takes long to write: this scene is held up for a copy of the section, not for the writing.
        """
        kept = Scene()
        with self.lock:
            wall, over = self.levels
            kept.levels = wall.still(start, stop), over.still(0, over.size)
            kept.helix, kept.session, kept.frames, kept.settled = self.helix, self.session, self.frames, self.settled
            kept.history = self.history.copy()
            kept.newest, kept.bit_depth, kept.ended, kept.feed = self.newest, self.bit_depth, self.ended, self.feed
        kept.begun = True
        return kept

    def _keep_first_pass(self, old: Texels, new: Texels, first: int) -> None:
        """Carry the first pass over where it had settled, and mark what changed since as re-scanned."""
        known = max(0, min(self.settled - first, len(new)))
        was, now = old[:known], new[:known]
        scanned = was[:, messages.FIRST] != 0
        now[:, messages.FIRST] = np.where(scanned, was[:, messages.FIRST], now[:, messages.FIRST])
        changed = scanned & (now[:, messages.RADIUS] != was[:, messages.RADIUS])
        now[:, messages.STATE] |= was[:, messages.STATE] & messages.RESCANNED
        now[:, messages.STATE] |= np.where(changed, messages.RESCANNED, 0).astype(np.uint16)

    def _mark(self, level: int, start: int, stop: int) -> None:
        for mark in self.marks:
            mark(level, start, stop)


def _put(target: npt.NDArray[Any], values: npt.NDArray[Any], word: npt.DTypeLike) -> npt.NDArray[np.bool_]:
    """Set `target` to `values`, whose rows are one `word` each; return where their bits differed."""
    new = np.require(values, requirements="C")
    differs: npt.NDArray[np.bool_] = target.view(word).ravel() != new.view(word).ravel()
    target[...] = new
    return differs
