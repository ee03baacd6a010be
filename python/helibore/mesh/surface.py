"""The wall in space: a surface of quads along the path, which is a frozen copy with attributes.

    surface = wall.surface(path)                   # the wall along a survey's path
    surface.attributes["GR"] = image.on(wall)      # one value for each quad
    surface.save("well.glb", color_by="GR")

Vertices are (north, east, down). Where the wall has no radius there is no vertex, and no quad touches the gap, so no
vertex is NaN. ``vertex_index`` and ``quad_index`` tell which vertex of the wall each row belongs to.
"""

from __future__ import annotations

import os
from pathlib import Path as FilePath
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from helibore import _core
from helibore.base.arrays import Floats, Integers, column
from helibore.base.cached import cached_property
from helibore.base.thread_count import thread_count
from helibore.mesh.attributes import Attributes
from helibore.mesh.mesh import Mesh, metadata_of, quad_radius, triangles
from helibore.mesh.mesh_files import save_surface
from helibore.mesh.vtkhdf import append_mesh
from helibore.samples.caliper import Basis
from helibore.samples.helix import Helix, WallLike, basis_of, expand_ranges, helix_of, vertex_range
from helibore.trajectory.survey import Path, core_path

if TYPE_CHECKING:
    import trimesh

Point = tuple[float, float, float]


class Surface(Mesh):
    """Quads of the wall, made by `Wall.surface`. A surface is a frozen copy; a wall that grows does not change it.

    Attributes
    ----------
    vertices
        (n, 3) float64, north, east and down in metres; owned.
    quads
        (q, 4) int64 rows of ``vertices``, counter-clockwise seen from the formation: normals point away from the axis.
        (k, k+1, k+1+K, k+K) for vertex k of a helix with K sectors that grows downwards; (k, k+K, k+1+K, k+1) for a
        helix that grows upwards.
    attributes
        `Attributes`: named values, one for each quad.
    basis
        What the wall is made from, as in `Caliper`; files state it.
    helix
        Where vertices lie along and around the hole.
    metadata
        Texts by name for the files: what the wall is made from, and how it was placed. You can add texts.
    vertex_index, radius
        For each row of ``vertices``, the number of this vertex on the wall, (n,) int64, and its radius, metres, (n,)
        float64.
    """

    def __init__(
        self,
        vertices: Floats,
        quads: Integers,
        vertex_ranges: Integers,
        quad_ranges: Integers,
        wall_radius: Floats,
        helix: Helix,
        basis: Basis = "azimuthal",
    ) -> None:
        index = range(*quad_ranges[0].tolist()) if len(quad_ranges) == 1 else expand_ranges(quad_ranges)
        attributes = Attributes("quad", index, helix.quads(wall_radius.size))
        super().__init__(vertices, quads, [wall_radius], [vertex_ranges], helix, basis, attributes)
        self.quads, self._quad_ranges = quads, quad_ranges

    @cached_property
    def quad_index(self) -> Integers:
        """The vertex k of the wall that each quad belongs to, which is its corner with the least k, (q,) int64."""
        return expand_ranges(self._quad_ranges)

    def quad_radius(self) -> Floats:
        """Return the mean radius of the corners of each quad, metres, (q,) float64."""
        return quad_radius(self)

    def triangles(self) -> Integers:
        """Return two triangles for each quad, (2 q, 3) int64; the cut goes from the quad's first corner to its third.

        Quad i gives the triangles 2 i and 2 i + 1, which face outwards.
        """
        return triangles(self)

    def to_trimesh(self) -> trimesh.Trimesh:
        """Return a `trimesh.Trimesh` of the triangles in (north, east, down).

        Vertices stay as they are (``process=False``), and each attribute becomes a face attribute, repeated for the two
        triangles of a quad.
        """
        import trimesh

        values: dict[str, npt.ArrayLike] = {name: np.repeat(of, 2) for name, of in self.attributes.items()}
        return trimesh.Trimesh(self.vertices, self.triangles(), face_attributes=values, process=False)

    def save(
        self,
        filename: str | os.PathLike[str],
        color_by: str | None = None,
        limits: tuple[float, float] | None = None,
        origin: Point = (0.0, 0.0, 0.0),
        color_map: str = "viridis",
        log: bool = False,
    ) -> None:
        """Write the surface to a file, whole or not at all; the ending names the format.

        =======  ===============  ===========  =========================================================================
        ending   axes             numbers      holds
        =======  ===============  ===========  =========================================================================
        .glb     (east, up,       float32 on   triangles, a colour for every quad, attributes (``_GR`` for GR; -999.25
                 -north)          a local      for missing values). Positions are local to a node whose translation is
                                  origin       in full precision, so map coordinates keep their millimetres
        .ply     (east, north,    float64      quads, with ``radius`` and all attributes by name; colours at vertices,
                 up)                           the mean of the quads around
        .obj     (east, north,    text, 1e-8   triangles
                 up)
        .stl     (east, north,    float32      triangles; refused where float32 would move a vertex by over a millimetre
                 up)
        .vtu     (east, north,    float64      quads, all attributes, ``radius``, ``depth``, ``toolface`` at vertices;
                 up)                           missing values are NaN; for ParaView, PyVista, VisIt
        .vtp     as .vtu                       the same as polygons
        .vtkhdf  as .vtu                       the same in HDF5; `append_to` adds parts. Needs the extra ``vtkhdf``
        =======  ===============  ===========  =========================================================================

        Each format that holds texts states the units and what the wall is made from. `metadata` are in the mesh's
        extras (.glb), in comments (.ply, .obj) and in the field data (VTK); .stl has room for the basis only.

        Parameters
        ----------
        filename
            Ends in one of the endings above; an existing file is replaced.
        color_by
            The attribute, or ``"radius"``, that colours .glb and .ply, and that programs show first of a .vtu or .vtp;
            by default the radius. Other formats do not hold the choice. Missing values are grey.
        limits
            Values at the two ends of the colours; by default the least and the greatest value.
        origin
            North, east and down of the point that becomes (0, 0, 0) in the file, metres.
        color_map, log
            The colours of .glb and .ply, one of `helibore.plot.COLOR_MAPS`, and whether they follow the logarithm.

        Raises
        ------
        InputError
            On an ending, attribute or colour map that is not known; a surface without quads; limits that are not two
            finite numbers in order; with ``log``, limits or values that are not above 0; an origin that is not finite;
            for .stl as above; for .glb, above 4.3 GB; an attribute's name that the format cannot hold.
        OSError
            If the file cannot be written; an existing file then does not change.
        MissingExtraError
            If the extra that .vtkhdf needs is not installed.
        """
        save_surface(self, FilePath(filename), color_by, limits, origin, color_map, log)

    def append_to(self, filename: str | os.PathLike[str], origin: Point = (0.0, 0.0, 0.0)) -> None:
        """Add this surface as a further part to a .vtkhdf file, or begin the file.

        Surfaces of neighbouring intervals meet without overlap or gap, so a file with the surfaces of all intervals
        holds the whole wall. The part is added to a copy, which then replaces the file; a reader never sees half a
        part. The file keeps the metadata of its first part.

        Parameters
        ----------
        filename
            Ends in .vtkhdf; a new file, or one that `save` or `append_to` wrote with the same attributes, origin, helix
            and reference of the toolface.
        origin
            As for `save`.

        Raises
        ------
        InputError
            On another ending, a surface without quads, a part that does not fit the earlier parts, and files of
            other programs.
        OSError, MissingExtraError
            As `save`.
        """
        append_mesh(self, FilePath(filename), origin)


def surface_of(
    wall: WallLike,
    path: Path | None = None,
    start: float | None = None,
    stop: float | None = None,
    threads: int | None = None,
) -> Surface:
    """Return the radii of a helix as quads along ``path``; `Wall.surface` describes the arguments."""
    radius, helix = wall.radius, helix_of(wall)
    first, last = vertex_range(helix, radius.size, start, stop)
    stretch = column("radius", radius[first : last + helix.sectors + 1])
    made = _core.surface(helix, first, stretch, core_path(path), thread_count(threads))
    surface = Surface(*made, radius, helix, basis_of(wall))
    surface.metadata = metadata_of(wall, path)
    return surface
