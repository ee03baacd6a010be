"""Write meshes as VTKHDF (VTK's HDF5), whole or part by part as the hole grows. Needs the extra ``vtkhdf``.

    /VTKHDF  Version, Type = "UnstructuredGrid"
      NumberOfPoints, NumberOfCells, NumberOfConnectivityIds    (parts,)
      Points, Connectivity, Offsets, Types                      all parts, one behind the other
      PointData/radius ...   CellData/GR ...   FieldData/basis ...

Connectivity and Offsets count from 0 in each part. HDF5 writes to memory, and the result then replaces the file: a
reader sees the file before or after the new part. HDF5 never writes to the disk, because it can end the program if the
disk is full.
Layout: "VTKHDF file format" (Kitware), 2.2.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from helibore.base.arrays import Array
from helibore.base.atomic_file import write_whole
from helibore.base.errors import InputError, needs
from helibore.mesh.mesh import Mesh
from helibore.mesh.vtk_mesh import VtkMesh, check_origin, vtk_mesh

if TYPE_CHECKING:
    import h5py

ENDING = ".vtkhdf"
_FRAME = ("axes", "origin", "helix", "toolface 0")  # the metadata that must be equal in all parts of a file


def save_vtkhdf(path: Path, mesh: VtkMesh) -> None:
    """Write a mesh as a file of one part."""
    for place, names in (("attributes", mesh.cell_values), ("metadata", mesh.metadata)):
        for name in names:
            if "/" in name or name == ".":
                raise InputError(f"{place}[{name!r}]", "a name in a VTKHDF file must not be '.' or contain '/'")
    _write(path, _columns(mesh), mesh.metadata)


def append_mesh(mesh: Mesh, path: Path, origin: tuple[float, float, float]) -> None:
    """Add a mesh to a file as a part, or create the file with it, as `Surface.append_to` describes."""
    if path.suffix.lower() != ENDING:
        raise InputError(str(path), f"only {ENDING} files take further parts")
    check_origin(origin)
    part = vtk_mesh(mesh, origin)
    if len(part.corners) == 0:
        raise InputError(str(path), "the mesh has no cells to save")
    if not path.exists():
        save_vtkhdf(path, part)
        return
    try:
        opened = _h5py().File(path, "r")
    except OSError as error:
        if error.errno is not None:  # an error of the file system, for example because it is a folder
            raise
        raise InputError(str(path), "not an HDF5 file, or a damaged one") from error
    with opened as file:
        if "VTKHDF" not in file:
            raise InputError(str(path), "an HDF5 file, but not VTKHDF")
        group = file["VTKHDF"]
        needed = {"FieldData", *(name.partition("/")[0] for name in _columns(part))}
        if missing := needed - set(group):
            raise InputError(str(path), f"not a file that helibore wrote: it has no {', '.join(sorted(missing))}")
        _require_alike(path, group, part)
        columns = {name: np.concatenate([group[name], of]) for name, of in _columns(part).items()}
        metadata = {name: text[0].decode() for name, text in group["FieldData"].items()}
    _write(path, columns, metadata)


def _h5py() -> Any:
    with needs("h5py", "vtkhdf"):
        import h5py
    return h5py


def _columns(mesh: VtkMesh) -> dict[str, Array]:
    """Return the arrays of a part by name. In a file, the arrays of all parts stand one behind the other."""
    count, corners = mesh.corners.shape
    return {
        "NumberOfPoints": np.array([len(mesh.points)]),
        "NumberOfCells": np.array([count]),
        "NumberOfConnectivityIds": np.array([count * corners]),
        "Points": mesh.points,
        "Connectivity": mesh.corners.reshape(-1),
        "Offsets": np.arange(0, count * corners + 1, corners),
        "Types": np.full(count, mesh.cell_type, "u1"),
        **{f"PointData/{name}": of for name, of in mesh.point_values.items()},
        **{f"CellData/{name}": of for name, of in mesh.cell_values.items()},
    }


def _write(path: Path, columns: Mapping[str, Array], metadata: Mapping[str, str]) -> None:
    content = io.BytesIO()
    with _h5py().File(content, "w", libver="v110") as file:
        group = file.create_group("VTKHDF")
        group.attrs["Version"] = np.array([2, 2], dtype="i8")
        group.attrs["Type"] = np.bytes_("UnstructuredGrid")
        for name, of in columns.items():
            group.create_dataset(name, data=of)
        for name, text in metadata.items():
            group.create_dataset(f"FieldData/{name}", data=[text.encode()])
    write_whole(path, lambda file: file.write(content.getbuffer()))


def _require_alike(path: Path, group: h5py.Group, part: VtkMesh) -> None:
    """Refuse a part whose cells, attributes, axes, origin, helix or toolface 0 are not those of the earlier parts."""
    kind = {int(each) for each in group["Types"][:1]}
    if kind - {part.cell_type}:
        raise InputError(str(path), f"holds cells of VTK type {kind.pop()}, the part has type {part.cell_type}")
    there = {f"{of}/{name}" for of in ("PointData", "CellData") for name in group[of]}
    own = {name for name in _columns(part) if "/" in name}
    if there != own:
        differ = ", ".join(sorted(name.partition("/")[2] for name in there ^ own))
        raise InputError(str(path), f"every part must have the same attributes; these are not in every part: {differ}")
    for name in _FRAME:
        before, now = group["FieldData"].get(name), part.metadata.get(name, "none")
        written = "none" if before is None else before[0].decode()
        if written != now:
            raise InputError(str(path), f"was written with {name} = {written}, the part has {now}")
