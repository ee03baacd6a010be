"""A wall with known values at every vertex, for the viewer's tests: washouts, breakouts, a gap, and a curved path.

Not reconstructed: a formula of depth and toolface, so that a test can say what any pixel or read-out must be.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

import helibore as hb

BIT = 0.216


class MadeWall:
    """Vertices of a helix with a radius by formula; grows by `grow`, is patched by `patch`."""

    def __init__(self, vertices: int, sectors: int = 64, pitch: float = 0.1, start: float = 1000.0) -> None:
        self.settings = SimpleNamespace(sectors=sectors, pitch=pitch, bit_diameter=BIT, start_toolface=0.0)
        self.start_depth = start
        self.depth = np.zeros(0)
        self.toolface, self.radius, self.nearest = np.zeros((3, 0))
        self.support, self.provisional = np.zeros(0, np.int32), np.zeros(0, bool)
        self.grow(vertices)

    def grow(self, vertices: int) -> SimpleNamespace:
        """Add vertices; return the change as an append would."""
        before, K = len(self), self.settings.sectors
        k = np.arange(before, before + vertices)
        depth, toolface = self.start_depth + k * self.settings.pitch / K, k % K * 360 / K
        wall = radius(depth, toolface)
        missing = np.isnan(wall)
        self.toolface = np.append(self.toolface, toolface)
        self.radius = np.append(self.radius, wall)
        self.nearest = np.append(self.nearest, np.where(missing, np.nan, 0.004 + 0.002 * np.cos(depth)))
        self.support = np.append(self.support, np.where(missing, 0, 8).astype(np.int32))
        self.provisional = np.append(self.provisional, np.zeros(vertices, bool))
        self.depth = np.append(self.depth, depth)  # last: it is what len() counts, and a viewer's thread may be reading
        return SimpleNamespace(ranges=[(before, len(self))], settled=len(self))

    def patch(self, start: int, stop: int, by: float) -> SimpleNamespace:
        """Scan [start, stop) again and find it wider by `by` metres."""
        self.radius[start:stop] += by
        return SimpleNamespace(ranges=[(start, stop)], settled=len(self))

    def vertices(self, start: int, stop: int) -> SimpleNamespace:
        """Return copies of [start, stop), as `Wall.vertices` does."""
        names = ("depth", "toolface", "radius", "nearest", "support", "provisional")
        return SimpleNamespace(**{name: getattr(self, name)[start:stop].copy() for name in names})

    @property
    def settled(self) -> int:
        return len(self)

    def __len__(self) -> int:
        return len(self.depth)


def radius(depth: np.ndarray, toolface: np.ndarray) -> np.ndarray:
    """Bit radius, layers, two breakouts, a washout every 40 m, and nothing at all between 1012.0 and 1012.6 m."""
    angle, r = np.radians(toolface), np.full(depth.shape, BIT / 2)
    r += 0.0008 * np.sin(depth * 9 + 2 * angle) + 0.0004 * np.sin(41 * depth) - 0.0006
    zone = np.clip(np.sin(depth / 3.1) * 2 - 0.8, 0, 1)
    for centre in (70.0, 250.0):
        away = (toolface - centre + 180) % 360 - 180
        r += zone * 0.014 * np.exp(-((away / 16) ** 2))
    r += 0.022 * np.exp(-(((depth - 1000) % 40 - 24) ** 2) / 1.3) * (1 + 0.25 * np.cos(3 * angle))
    r[(depth > 1012.0) & (depth < 1012.6)] = np.nan
    r[(depth > 1017.0) & (depth < 1017.8) & (np.abs(toolface - 200) < 50)] = np.nan
    return r


def gamma(depth: np.ndarray, toolface: np.ndarray) -> np.ndarray:
    """Beds that dip: a sinusoid on the image, in gAPI."""
    bed = depth + 0.6 * np.cos(np.radians(toolface - 40))
    return 75 + 45 * np.tanh(3 * np.sin(bed * 1.1)) + 8 * np.sin(bed * 17)


def resistivity(depth: np.ndarray, toolface: np.ndarray) -> np.ndarray:
    """Ohm metres over three decades."""
    bed = depth + 0.6 * np.cos(np.radians(toolface - 40))
    return 10 ** (1.2 + 1.1 * np.sin(bed * 0.37) + 0.2 * np.sin(bed * 5))


def curved_path(start: float = 1000.0, stop: float = 11000.0) -> hb.Path:
    """A hole that builds from 8 to 75 deg and turns."""
    stations = np.arange(start - 30, stop + 30, 30.0)
    build = np.clip((stations - start) / 300, 0, 1)
    return hb.Survey(stations, 8 + 67 * build, 40 + 30 * build).path(extend=100.0)


def gamma_and_resistivity(wall: MadeWall) -> dict[hb.viewer.Attribute, np.ndarray]:
    """Both images, as `hb.view` takes them."""
    from helibore.viewer import Attribute

    return {
        Attribute("GR", "gAPI", 20, 140): gamma(wall.depth, wall.toolface),
        Attribute("RES", "ohm.m", 0.5, 500, log=True): resistivity(wall.depth, wall.toolface),
    }
