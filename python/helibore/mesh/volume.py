"""The rock around the wall: hexahedra between the wall and shells outside it, a frozen copy with attributes.

    volume = wall.volume(path, shells=[0.05, 0.20])           # two layers: 0 to 0.05 m and 0.05 to 0.20 m
    volume.hang("RT", [shallow.on(wall), deep.on(wall)], unit="ohm.m")

    axis |      wall    shells[0]        shells[1]
         |       |  layer 0  |   layer 1    |
         0 ----- r --------- r + 0.05 ----- r + 0.20

Where a shell has no radius there is no vertex, and no hexahedron touches the gap. Every hexahedron has positive volume;
shells that would give a zero or negative volume are refused.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path as FilePath
from typing import Any

import numpy as np
import numpy.typing as npt

from helibore import _core
from helibore.base.arrays import Floats, Integers, column
from helibore.base.cached import cached_property
from helibore.base.errors import InputError
from helibore.base.thread_count import thread_count
from helibore.mesh.attributes import Attributes
from helibore.mesh.mesh import Mesh, metadata_of
from helibore.mesh.mesh_files import save_volume
from helibore.mesh.vtkhdf import append_mesh
from helibore.samples.caliper import Basis
from helibore.samples.helix import Helix, WallLike, basis_of, expand_ranges, helix_of, numbered, vertex_range
from helibore.trajectory.survey import Path, core_path


class Volume(Mesh):
    """Hexahedra around the wall, made by `Wall.volume`. A volume is a frozen copy.

    Attributes
    ----------
    vertices
        (n, 3) float64, north, east and down in metres; first those of the wall, then those of each shell outwards;
        owned.
    hexes
        (h, 8) int64 rows of ``vertices``: the inner quad, then the outer quad over it (VTK's order, positive volume).
        The layer next to the wall comes first.
    hex_layer
        (h,) int64: for each hexahedron, the layer in which it lies, 0 = next to the wall.
    attributes
        `Attributes`: named values, one for each hexahedron.
    helix
        Where vertices lie along and around the hole.
    basis
        What the wall is made from, as in `Caliper`.
    metadata
        Texts by name for the files: what the wall is made from, and how it was placed. You can add texts.
    vertex_index, radius
        For each row of ``vertices``, the number of this vertex, or of the one under it, on the wall, (n,) int64, and
        the radius of the row, metres, (n,) float64.
    """

    def __init__(
        self,
        vertices: Floats,
        hexes: Integers,
        shell_ranges: Sequence[Integers],
        layer_ranges: Sequence[Integers],
        shells: Sequence[Floats],
        helix: Helix,
        basis: Basis = "azimuthal",
    ) -> None:
        self.hexes, self._layer_ranges, self._whole = hexes, layer_ranges, helix.quads(shells[0].size)
        rows = [expand_ranges(ranges) + layer * self._whole for layer, ranges in enumerate(layer_ranges)]
        index = np.concatenate(rows)
        attributes = Attributes("hexahedron", index, self._whole * len(layer_ranges))
        super().__init__(vertices, hexes, shells, shell_ranges, helix, basis, attributes)
        self.layer = self.hex_layer = numbered(layer_ranges)

    @property
    def layers(self) -> int:
        """Number of layers of hexahedra: one for each shell outside the wall."""
        return len(self._layer_ranges)

    @cached_property
    def vertex_shell(self) -> Integers:
        """For each row of ``vertices``, the shell on which it lies, 0 = the wall, (n,) int64."""
        return numbered(self._ranges)

    @cached_property
    def hex_index(self) -> Integers:
        """For each hexahedron, the vertex k of the wall on whose quad it stands, (h,) int64."""
        return np.concatenate([expand_ranges(ranges) for ranges in self._layer_ranges])

    def hang(self, name: str, layers: Sequence[npt.ArrayLike | float], unit: str = "") -> None:
        """Give every layer its own values of one attribute, for example shallow, medium and deep resistivity.

        Parameters
        ----------
        name, unit
            Name and unit of the attribute.
        layers
            One item for each layer, from the wall outwards: values for every quad that the whole wall has room for, as
            `SectorImage.on` gives them, or one number for the layer.

        Raises
        ------
        InputError
            On another number of layers (``GR has values for 2 layers: must be 3``) or of values in a layer.
        """
        if len(layers) != self.layers:
            raise InputError(f"{name} has values for {len(layers)} layers", f"must be {self.layers}")
        columns = [
            np.full(self._whole, values, np.float64)
            if np.ndim(values) == 0
            else column(f"{name}[{number}]", values, self._whole, "the whole wall's quads")
            for number, values in enumerate(layers)
        ]
        self.attributes[name] = np.concatenate(columns)[self.attributes.index]
        self.attributes.units[name] = unit

    def hex_volume(self, threads: int | None = None) -> Floats:
        """Return the volume of each hexahedron, cubic metres, (h,) float64, from ``threads`` threads (None: all cores).

        The volumes are exact if each face is the bilinear patch between its corners. Neighbours share these faces, so
        the volumes of a layer add up to the volume between its shells.
        """
        return _core.hexahedron_volumes(self.vertices, self.hexes, thread_count(threads))

    def save(self, filename: str | os.PathLike[str], origin: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> None:
        """Write the volume to a file, whole or not at all; the ending names the format.

        =======  ========================================================================================
        .vtu     VTK's XML for ParaView, PyVista, VisIt: hexahedra, float64, all attributes, uncompressed
        .vtkhdf  the same as HDF5; `append_to` adds further intervals. Needs the extra ``vtkhdf``
        =======  ========================================================================================

        Axes are (east, north, up). Vertices carry ``radius``, ``depth`` and ``toolface``; hexahedra the attributes and
        ``layer``. Missing values are NaN. `metadata` and units are in the field data.

        Parameters
        ----------
        filename
            Ends in .vtu or .vtkhdf; an existing file is replaced.
        origin
            North, east and down of the point that becomes (0, 0, 0) in the file, metres.

        Raises
        ------
        InputError
            On another ending, a volume without hexahedra, an origin that is not finite, or an attribute's name that the
            format cannot hold.
        OSError
            If the file cannot be written; an existing file then does not change.
        MissingExtraError
            If the extra that .vtkhdf needs is not installed.
        """
        save_volume(self, FilePath(filename), origin)

    def append_to(self, filename: str | os.PathLike[str], origin: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> None:
        """Add this volume as a part to ``filename``, a .vtkhdf file, or begin the file.

        ``filename`` and ``origin``, and the errors, are those of `Surface.append_to`.
        """
        append_mesh(self, FilePath(filename), origin)


def volume_of(
    wall: WallLike,
    path: Path | None = None,
    shells: Sequence[float | npt.ArrayLike | WallLike] = (0.05, 0.20),
    start: float | None = None,
    stop: float | None = None,
    threads: int | None = None,
) -> Volume:
    """Return hexahedra between the wall and each shell outside it; `Wall.volume` describes the arguments."""
    radius, helix = wall.radius, helix_of(wall)
    first, last = vertex_range(helix, radius.size, start, stop)
    stretch = slice(first, last + helix.sectors + 1)
    radii = [radius, *(_shell(number, shell, helix, radius) for number, shell in enumerate(shells))]
    stretches = [column("radius", values[stretch]) for values in radii]
    made = _core.volume(helix, first, stretches, core_path(path), thread_count(threads))
    volume = Volume(*made, radii, helix, basis_of(wall))
    volume.metadata = metadata_of(wall, path)
    return volume


def _shell(number: int, shell: Any, helix: Helix, radius: Floats) -> Floats:
    """Return the radius of a shell at every vertex of the wall; ``number`` names the shell in errors."""
    name = f"shells[{number}]"
    if hasattr(shell, "settings"):
        if helix_of(shell) != helix:
            raise InputError(name, "must be a wall on the same helix (start_depth, start_toolface, pitch, sectors)")
        beyond, second = np.full(radius.size, np.nan), shell.radius
        common = min(radius.size, second.size)
        beyond[:common] = second[:common]
        return beyond
    if np.ndim(shell) == 0 and not math.isfinite(shell):
        raise InputError(name, "must be finite", str(shell))
    return radius + (float(shell) if np.ndim(shell) == 0 else column(name, shell, radius.size, "radius"))
