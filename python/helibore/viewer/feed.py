"""From a wall to the scene: which vertices changed, read once, by a thread of its own.

The producer's `update` only notes ranges. The feed's thread reads those ranges of the wall when it gets to it, so ten
appends between two reads cost one read, and a producer in a hurry is never held up. A read copies what changed and no
more, a `PIECE` at a time; after it the thread rests as long as the read took, which leaves the producer half of a core.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import numbers
from helibore.viewer import dirty, frames
from helibore.viewer.messages import Vertices
from helibore.viewer.scene import Attribute, Helix, Scene

PIECE = 1 << 17  # vertices written at a time: pages may send in between


class Columns(Protocol):
    """Values of some vertices, all of one moment."""

    @property
    def depth(self) -> npt.NDArray[np.float64]: ...
    @property
    def toolface(self) -> npt.NDArray[np.float64]: ...
    @property
    def radius(self) -> npt.NDArray[np.float64]: ...
    @property
    def nearest(self) -> npt.NDArray[np.float64]: ...
    @property
    def support(self) -> npt.NDArray[np.int32]: ...
    @property
    def provisional(self) -> npt.NDArray[np.bool_]: ...


class WallLike(Protocol):
    """What the viewer reads of a wall: its shape once, and copies of the ranges that changed."""

    @property
    def settings(self) -> Any: ...
    @property
    def settled(self) -> int: ...
    def vertices(self, start: int, stop: int) -> Columns: ...
    def __len__(self) -> int: ...


class Feed:
    """Keeps a scene equal to a wall."""

    def __init__(
        self,
        wall: WallLike,
        *,
        path: Any | None,
        attributes: Mapping[str | Attribute, npt.ArrayLike],
        well: str,
        scene: Scene | None = None,
    ) -> None:
        self.scene = scene or Scene()  # one that is served already: its pages wait for the wall to begin
        self.path = path
        self._wall = wall
        if len(wall) == 0:
            raise ValueError("the wall has no vertex yet: append samples first")
        named = {_attribute(key): numbers(values) for key, values in attributes.items()}
        self._helix = _helix(wall, tuple(named), well)
        self._values = {attribute.name: values for attribute, values in named.items()}
        for name, values in self._values.items():
            self._check(name, values)
        self._check_path(path)
        self._changed = threading.Condition()
        self._ranges: list[dirty.Interval] = []
        self._settled = 0
        self._new_path = False
        self._closed = False
        self._thread: threading.Thread | None = None
        self.scene.begin(self._helix)
        self._extend_path()
        self._read([(0, len(wall))], wall.settled)

    def start(self) -> None:
        """Start the thread that reads what `update` notes."""
        self._thread = threading.Thread(target=self._run, name="helibore-view-feed", daemon=True)
        self._thread.start()

    def update(self, change: Any = None, attributes: Mapping[str, npt.ArrayLike] | None = None) -> None:
        """Note what an append changed; None: anything may have. With it come whole columns of values, read there."""
        taken = {name: self._column(name, values) for name, values in (attributes or {}).items()}
        ranges = [(0, len(self._wall))] if change is None else [tuple(part) for part in change.ranges]
        ahead = self._helix.sectors + 1 if taken else 0  # a quad waits for its last vertex, a turn and one further on
        with self._changed:
            self._values |= taken
            for start, stop in ranges:
                self._ranges = dirty.add(self._ranges, max(0, int(start) - ahead), int(stop))
            self._settled = self._wall.settled if change is None else int(change.settled)
            self._changed.notify()

    def set_path(self, path: Any | None) -> None:
        """Take another path; only frames are sent."""
        self._check_path(path)
        with self._changed:
            self.path = path
            self._new_path = True
            self._changed.notify()

    def set_attribute(self, name: str, values: npt.ArrayLike) -> None:
        """Take new values of a named attribute."""
        taken = self._column(name, values)
        with self._changed:
            self._values[name] = taken
            self._ranges = dirty.add(self._ranges, 0, len(self._wall))
            self._changed.notify()

    def close(self) -> None:
        """Stop the thread."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        if self._thread is not None:
            self._thread.join()
            self._thread = None

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._ranges or self._new_path or self._closed)
                if self._closed:
                    return
                ranges, self._ranges = self._ranges, []
                settled, new_path, self._new_path = self._settled, self._new_path, False
            began = time.monotonic()
            if new_path:
                self._extend_path(again=True)
            if ranges:
                self._extend_path()
                self._read(ranges, settled)
            time.sleep(time.monotonic() - began)

    def _read(self, ranges: list[dirty.Interval], settled: int) -> None:
        for start, stop in ranges:
            for first in range(start, min(stop, len(self._wall)), PIECE):
                last = min(first + PIECE, stop, len(self._wall))
                read = self._wall.vertices(first, last)
                values = {name: column[first:last] for name, column in self._values.items()}
                self.scene.write(first, Vertices(read.radius, read.nearest, read.support, read.provisional), values)
        self.scene.settle(settled)

    def _extend_path(self, *, again: bool = False) -> None:
        level = self.scene.levels[0]
        have = 0 if again else len(self.scene.frames.centre)
        need = frames.count_for(self._helix, max(len(self._wall), level.size), level.rows)
        if need > have:
            self.scene.trajectory(have, frames.on_path(self._helix, self.path, have, need))

    def _column(self, name: str, values: npt.ArrayLike) -> npt.NDArray[np.float64]:
        if name not in self._values:
            raise ValueError(f"attribute {name}: was not named when the viewer was made")
        taken = numbers(values)
        self._check(name, taken)
        return taken

    def _check(self, name: str, values: npt.NDArray[np.float64]) -> None:
        n, K = len(self._wall), self._helix.sectors
        if values.ndim != 1 or len(values) not in (n, max(0, n - K - 1)):
            raise ValueError(
                f"attribute {name} has shape {values.shape}: must be one value for each of {n} vertices "
                f"or {max(0, n - K - 1)} quads"
            )

    def _check_path(self, path: Any | None) -> None:
        if path is None:
            return
        end = self._helix.start_depth + (len(self._wall) - 1) * self._helix.pitch / self._helix.sectors
        top, bottom = sorted((self._helix.start_depth, end))
        if top < path.start_depth - 1e-9 or bottom > path.stop_depth + 1e-9:
            raise ValueError(
                f"the wall lies from {top:.2f} to {bottom:.2f} m, the path from {path.start_depth:.2f} to "
                f"{path.stop_depth:.2f} m: give the survey's path extend= metres, or a longer survey"
            )


def _attribute(key: str | Attribute) -> Attribute:
    return key if isinstance(key, Attribute) else Attribute(key)


def _helix(wall: WallLike, attributes: tuple[Attribute, ...], well: str) -> Helix:
    settings, top = wall.settings, wall.vertices(0, 1)
    return Helix(
        sectors=int(settings.sectors),
        pitch=float(settings.pitch),
        start_depth=float(top.depth[0]),
        start_toolface=float(top.toolface[0]),
        bit_diameter=float(settings.bit_diameter),
        well=well,
        attributes=attributes,
    )
