"""The wall in space: a surface of quads, or a volume of hexahedra, each a snapshot with attributes.

    surface = wall.surface(path)                   # the wall along a survey's path
    surface.attributes["GR"] = image.on(wall)      # one value a quad
    surface.save("well.glb", color_by="GR")

Vertices are (north, east, down). Where the wall has no radius there is no vertex, and no quad or hexahedron touches the
gap: a mesh never holds NaN. ``vertex_index`` and ``quad_index`` tell which vertex of the wall each row belongs to.
"""

from __future__ import annotations

import math
import os
from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import numpy.typing as npt

from helibore import _core
from helibore.arrays import Floats, Integers, column
from helibore.attributes import Attributes
from helibore.caliper import Basis
from helibore.survey import Path
from helibore.threads import thread_count

if TYPE_CHECKING:
    import trimesh


class HelixSettings(Protocol):
    """What a wall must tell about its helix."""

    @property
    def sectors(self) -> int: ...
    @property
    def pitch(self) -> float: ...
    @property
    def start_toolface(self) -> float: ...


class WallLike(Protocol):
    """What a surface needs of a wall; `helibore.Wall` is one."""

    @property
    def settings(self) -> HelixSettings: ...
    @property
    def start_depth(self) -> float: ...
    @property
    def radius(self) -> Floats: ...


class Surface:
    """Quads of the wall; made by `Wall.surface`. A snapshot: a wall that grows does not change it.

    Attributes
    ----------
    vertices
        (n, 3) float64, north, east and down in metres; owned.
    quads
        (q, 4) int64 rows of ``vertices``, counter-clockwise seen from the formation: normals point away from the axis.
        (k, k+1, k+1+K, k+K) for vertex k of a helix with K sectors that grows downwards; (k, k+K, k+1+K, k+1) for one
        that grows upwards.
    attributes
        `Attributes`, one value a quad.
    basis
        What the wall is made from, as in `Caliper`; files say it.
    """

    def __init__(
        self,
        vertices: Floats,
        quads: Integers,
        vertex_ranges: Integers,
        quad_ranges: Integers,
        wall_radius: Floats,
        sectors: int,
        basis: Basis = "azimuthal",
    ) -> None:
        self.basis: Basis = basis
        self.vertices = vertices
        self.quads = quads
        self._vertex_ranges, self._quad_ranges = vertex_ranges, quad_ranges
        self._wall_radius = wall_radius
        self.attributes = Attributes("quad", _spread_if_gapped(quad_ranges), max(wall_radius.size - sectors - 1, 0))

    @cached_property
    def vertex_index(self) -> Integers:
        """The vertex of the wall that each row of ``vertices`` is, (n,) int64."""
        return _spread(self._vertex_ranges)

    @cached_property
    def quad_index(self) -> Integers:
        """The vertex k of the wall that each quad belongs to, its corner nearest to k = 0, (q,) int64."""
        return _spread(self._quad_ranges)

    @cached_property
    def radius(self) -> Floats:
        """The radius at each row of ``vertices``, metres, (n,) float64."""
        return self._wall_radius[self.vertex_index]

    def quad_radius(self) -> Floats:
        """The mean radius of the corners of each quad, metres, (q,) float64."""
        corners = self.radius[self.quads]
        return (corners[:, 0] + corners[:, 1] + corners[:, 2] + corners[:, 3]) / 4

    def triangles(self) -> Integers:
        """Two triangles a quad, (2 q, 3) int64, both cut from the quad's first corner to its third: quad i gives 2 i
        and 2 i + 1, facing outwards.
        """
        return self.quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)

    def to_trimesh(self) -> trimesh.Trimesh:
        """Return a `trimesh.Trimesh` of the triangles in (north, east, down).

        Vertices stay as they are (``process=False``), and each attribute becomes a face attribute, repeated for the two
        triangles of a quad.
        """
        import trimesh

        return trimesh.Trimesh(
            self.vertices,
            self.triangles(),
            face_attributes={name: np.repeat(values, 2) for name, values in self.attributes.items()},
            process=False,
        )

    def save(
        self,
        filename: str | os.PathLike[str],
        color_by: str | None = None,
        limits: tuple[float, float] | None = None,
        origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
        color_map: str = "viridis",
        log: bool = False,
    ) -> None:
        """Write the surface to a file, whole or not at all; the ending tells the format.

        ======  ===============  ===========  ==========================================================================
        ending  axes             numbers      holds
        ======  ===============  ===========  ==========================================================================
        .glb    (east, up,       float32 on   triangles, a colour for every quad, attributes (``_GR`` for GR; -999.25
                -north)          a local      for missing values). Positions are local to a node whose translation is
                                 origin       in full precision, so map coordinates keep their millimetres
        .ply    (east, north,    float64      quads, with ``radius`` and all attributes by name; colours at vertices,
                up)                           the mean of the quads around
        .obj    (east, north,    text, 1e-8   triangles
                up)
        .stl    (east, north,    float32      triangles; refused where float32 would move a vertex by over a millimetre
                up)
        ======  ===============  ===========  ==========================================================================

        Each says what the wall is made from: the mesh's extras in .glb (``basis``), a comment or the header elsewhere.

        Parameters
        ----------
        filename
            Ends in .glb, .ply, .obj or .stl; replaced if it is there.
        color_by
            The attribute that colours .glb and .ply; by default the radius. Missing values are grey.
        limits
            Values at the two ends of the colours; by default the least and the greatest.
        origin
            North, east and down of the point that becomes (0, 0, 0) in the file, metres.
        color_map, log
            The colours and whether they follow the logarithm: `helibore.colors.ColorScale`.

        Raises
        ------
        ValueError
            On an ending, attribute or map that is not known, a surface without quads, and for .stl as above.
        """
        from helibore.mesh_files import save_surface

        save_surface(self, filename, color_by, limits, origin, color_map, log)

    def __repr__(self) -> str:
        return f"Surface({len(self.vertices)} vertices, {len(self.quads)} quads, {self.attributes!r})"


class Volume:
    """Hexahedra around the wall; made by `Wall.volume`. A snapshot.

    Attributes
    ----------
    vertices
        (n, 3) float64, north, east and down in metres: the wall's, then those of each shell outwards; owned.
    hexes
        (h, 8) int64 rows of ``vertices``: inner quad, then the outer quad over it (VTK's order, positive volume); the
        layer next to the wall first.
    attributes
        `Attributes`, one value a hexahedron.
    basis
        What the wall is made from, as in `Caliper`.
    """

    def __init__(
        self,
        vertices: Floats,
        hexes: Integers,
        shell_ranges: Sequence[Integers],
        layer_ranges: Sequence[Integers],
        whole: int,
        basis: Basis = "azimuthal",
    ) -> None:
        self.basis: Basis = basis
        self.vertices = vertices
        self.hexes = hexes
        self._shell_ranges, self._layer_ranges = shell_ranges, layer_ranges
        index = np.concatenate([_spread(ranges) + layer * whole for layer, ranges in enumerate(layer_ranges)])
        self.attributes = Attributes("hexahedron", index, whole * len(layer_ranges))

    @cached_property
    def vertex_index(self) -> Integers:
        """The vertex of the wall that each row of ``vertices`` lies on or over, (n,) int64."""
        return np.concatenate([_spread(ranges) for ranges in self._shell_ranges])

    @cached_property
    def vertex_shell(self) -> Integers:
        """The shell each row of ``vertices`` lies on, 0 = the wall, (n,) int64."""
        return _numbered(self._shell_ranges)

    @cached_property
    def hex_index(self) -> Integers:
        """The vertex k of the wall whose quad each hexahedron stands on, (h,) int64."""
        return np.concatenate([_spread(ranges) for ranges in self._layer_ranges])

    @cached_property
    def hex_layer(self) -> Integers:
        """The layer each hexahedron lies in, 0 = next to the wall, (h,) int64."""
        return _numbered(self._layer_ranges)

    def save(self, filename: str | os.PathLike[str]) -> None:
        """Refuse: the formats of `Surface.save` hold no hexahedra.

        Raises
        ------
        ValueError
            Always, naming what to do instead.
        """
        raise ValueError(
            f"{os.fspath(filename)}: no format for hexahedra yet; .vtu and .vtkhdf are to come. "
            "Surfaces save to .glb, .ply, .obj and .stl"
        )

    def __repr__(self) -> str:
        return f"Volume({len(self.vertices)} vertices, {len(self.hexes)} hexes, {self.attributes!r})"


def surface_of(
    wall: WallLike,
    path: Path | None = None,
    start: float | None = None,
    stop: float | None = None,
    threads: int | None = None,
) -> Surface:
    """Place the wall along ``path`` and join it into quads: `Wall.surface`.

    Parameters
    ----------
    wall
        Radii on a helix.
    path
        Where the hole goes; None: straight down from (0, 0, 0), toolface 0 to the north.
    start, stop
        Depths, metres; None: the ends of the wall. The surface holds the quads of the vertices from ``start`` up to,
        but without, ``stop``, so that surfaces of neighbouring intervals meet without overlap or gap. It reaches one
        turn beyond ``stop``.
    threads
        None: all cores. The result does not depend on it.

    Raises
    ------
    ValueError
        If the path does not reach a vertex, or its reference is undefined there (``vertex 7 at depth 12: ...``), or the
        wall has nothing between ``start`` and ``stop``.
    """
    radius = wall.radius
    first, last = _vertices_between(wall, radius.size, start, stop)
    stretch = column("radius", radius[first : last + wall.settings.sectors + 1])
    vertices, quads, vertex_ranges, quad_ranges = _core.surface(
        _helix(wall), first, stretch, _core.Path() if path is None else path._core, thread_count(threads)
    )
    return Surface(vertices, quads, vertex_ranges, quad_ranges, radius, wall.settings.sectors, basis_of(wall))


def volume_of(
    wall: WallLike,
    path: Path | None = None,
    shells: Sequence[float | npt.ArrayLike | WallLike] = (0.05, 0.20),
    start: float | None = None,
    stop: float | None = None,
    threads: int | None = None,
) -> Volume:
    """Thicken the wall outwards, shell by shell, into hexahedra: `Wall.volume`.

    Parameters
    ----------
    wall, path, start, stop, threads
        As for `surface_of`.
    shells
        From the wall outwards, one or more, each one of: a thickness in metres; thicknesses, one for every vertex of
        the wall (NaN: nothing there); or a second wall on the same helix, taken as it is. Thicknesses all count from
        the wall itself, not from the shell before: ``[0.05, 0.20]`` gives layers of 0.05 and 0.15 m.

    Raises
    ------
    ValueError
        As `surface_of`; if a shell does not lie beyond the one before wherever both are there; if a second wall has
        another helix.
    """
    radius = wall.radius
    first, last = _vertices_between(wall, radius.size, start, stop)
    stretch = slice(first, last + wall.settings.sectors + 1)
    outer = [_shell(number, shell, wall, radius) for number, shell in enumerate(shells)]
    vertices, hexes, shell_ranges, layer_ranges = _core.volume(
        _helix(wall),
        first,
        [column("radius", values[stretch]) for values in (radius, *outer)],
        _core.Path() if path is None else path._core,
        thread_count(threads),
    )
    whole = max(radius.size - wall.settings.sectors - 1, 0)
    return Volume(vertices, hexes, shell_ranges, layer_ranges, whole, basis_of(wall))


def basis_of(wall: WallLike) -> Basis:
    """Return what a wall is made from; one that does not say is taken to be measured around the hole."""
    basis: Basis = getattr(wall, "basis", "azimuthal")
    return basis


def _helix(wall: WallLike) -> tuple[float, float, float, int]:
    settings = wall.settings
    start = float(wall.start_depth)  # NaN for a wall without a sample: it starts nowhere yet
    return (
        0.0 if math.isnan(start) else start,
        float(settings.start_toolface),
        float(settings.pitch),
        int(settings.sectors),
    )


def _vertices_between(wall: WallLike, count: int, start: float | None, stop: float | None) -> tuple[int, int]:
    """The half-open range of vertices whose depth lies in [start, stop), whichever way the helix grows."""
    for name, bound in (("start", start), ("stop", stop)):
        if bound is not None and not math.isfinite(bound):
            raise ValueError(f"{name} = {bound}: must be finite")
    if start is not None and stop is not None and start >= stop:
        raise ValueError(f"stop = {stop:g}: must be greater than start = {start:g}")
    start_depth, _, pitch, sectors = _helix(wall)

    def depth(k: int) -> float:
        return start_depth + k * pitch / sectors

    if pitch > 0:
        first = 0 if start is None else bisect_left(range(count), start, key=depth)
        last = count if stop is None else bisect_left(range(count), stop, key=depth)
    else:
        first = 0 if stop is None else bisect_right(range(count), -stop, key=lambda k: -depth(k))
        last = count if start is None else bisect_right(range(count), -start, key=lambda k: -depth(k))
    if first >= last and not (start is None and stop is None):
        reach = f"reaches from {depth(0):g} to {depth(count - 1):g} m" if count else "is empty"
        raise ValueError(f"start = {start}, stop = {stop}: the wall {reach}, no vertex lies between")
    return first, last


def _shell(number: int, shell: Any, wall: WallLike, radius: Floats) -> Floats:
    """The radii of a shell at every vertex of the wall."""
    name = f"shells[{number}]"
    if hasattr(shell, "settings"):
        if _helix(shell) != _helix(wall):
            raise ValueError(f"{name}: must be a wall on the same helix (start_depth, start_toolface, pitch, sectors)")
        beyond = np.full(radius.size, np.nan)
        common = min(radius.size, shell.radius.size)
        beyond[:common] = shell.radius[:common]
        return beyond
    if np.ndim(shell) == 0:
        if not math.isfinite(shell):
            raise ValueError(f"{name} = {shell}: must be finite")
        thicker: Floats = radius + float(shell)
        return thicker
    return radius + column(name, shell, radius.size, "radius")


def _spread(ranges: Integers) -> Integers:
    """All the numbers in half-open ranges, in order."""
    return np.concatenate([np.arange(start, stop) for start, stop in ranges] or [np.arange(0)])


def _spread_if_gapped(ranges: Integers) -> Integers | range:
    return range(*ranges[0].tolist()) if len(ranges) == 1 else _spread(ranges)


def _numbered(ranges: Sequence[Integers]) -> Integers:
    counts = [int((of[:, 1] - of[:, 0]).sum()) for of in ranges]
    return np.repeat(np.arange(len(counts)), counts)
