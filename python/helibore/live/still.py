"""A live wall as it was at one moment, for what takes longer to write than the next packet takes to come.

    live   ... append  append | append ...          everything is copied between two appends, at the speed of memory,
                              |
    still                     walls, images, stations, passes, events          and then read at leisure

Nothing is computed or written here (``snapshot.py``).
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
import numpy.typing as npt

from helibore.arrays import Floats
from helibore.caliper import Caliper
from helibore.live.events import Event
from helibore.live.live import Live
from helibore.live.pass_log import Pass
from helibore.sector_image import SectorImage
from helibore.survey import Path
from helibore.wall import Wall, _Moment


class StillWall(Wall):
    """A wall that keeps what another one was: it is saved, measured and meshed like that one, and takes no samples.

    Parameters
    ----------
    wall
        What is copied.
    path, images
        As `Wall.path` and `Wall.images`.
    """

    def __init__(self, wall: Wall, path: Path | None, images: dict[str, SectorImage]) -> None:
        super().__init__(basis=wall.basis, **asdict(wall.settings))
        self._samples, self._vertices, self._start = wall._state()
        size = len(self._vertices[0])
        self.stop_depth = float(wall.vertices(size - 1, size).depth[0]) if size else self._start
        self.path, self.images = path, images

    def _state(self) -> tuple[tuple[Floats, ...], tuple[npt.NDArray[np.generic], ...], float]:
        return self._samples, self._vertices, self._start

    def _moment(self) -> _Moment:
        return _Moment(self.settings, self._start, self.radius, self.basis, self.made_from, self.path)

    def __len__(self) -> int:
        """Return the number of vertices."""
        return len(self._vertices[0])

    @property
    def start_depth(self) -> float:
        """As `Wall.start_depth`."""
        return self._start

    @property
    def radius(self) -> Floats:
        """As `Wall.radius`; not a copy."""
        radius: Floats = self._vertices[0]
        return radius

    @property
    def nearest(self) -> Floats:
        """As `Wall.nearest`; not a copy."""
        nearest: Floats = self._vertices[1]
        return nearest

    @property
    def samples(self) -> Caliper:
        """As `Wall.samples`."""
        return Caliper(*self._samples, basis=self.basis)


@dataclass(frozen=True)
class Still:
    """What a live wall was at one moment.

    Attributes
    ----------
    wall_time
        When the last record that is in it was received, ns since 1970 (UTC).
    records
        The number of records of the journal that are in it.
    walls
        Of each layer that has vertices.
    images
        (depth, values) of each image that has rows.
    stations
        (n, 3): depth m, inclination and azimuth deg.
    passes, events
        As `Live.passes`, and one event for each rule of each source.
    """

    wall_time: int
    records: int
    walls: dict[str, StillWall]
    images: dict[str, tuple[Floats, Floats]]
    stations: Floats
    path: Path | None
    passes: list[Pass]
    events: list[Event]


def still(live: Live) -> Still:
    """Copy a live wall between two appends."""
    return live.at_one_moment(lambda: _copied(live))


def _copied(live: Live) -> Still:
    rows = {name: image.arrays() for name, image in live.images.items() if len(image)}
    laid = [live.image(name) for name, (depth, values) in rows.items()
            if name in live.model.layouts and len(depth) > 1 and not np.isnan(values).all()]  # fmt: skip
    walls = {}
    for name, wall in live.layers.items():
        if len(wall):
            meeting = {image.name: image for image in laid if _meets(image, wall)}
            walls[name] = StillWall(wall, live.path, meeting)
    model = live.model
    return Still(model.wall_time, model.records, walls, rows, model.stations.rows(), live.path, live.passes,
                 model.events.latest)  # fmt: skip


def _meets(image: SectorImage, wall: Wall) -> bool:
    """Whether they share a turn or more: elsewhere an image has no quad of the wall to lie on, and says so."""
    pitch = wall.settings.pitch
    ends = sorted((wall.start_depth, wall.start_depth + len(wall) / wall.settings.sectors * pitch))
    top, bottom = image.depth[0] - image.reach, image.depth[-1] + image.reach
    shared = min(ends[1] - abs(pitch), bottom) - max(ends[0] + abs(pitch), top)
    return bool(shared > abs(pitch))
