"""Meshes as VTK XML: .vtu (unstructured grid: quads or hexahedra) and .vtp (polygons: quads).

    <VTKFile type="UnstructuredGrid" ...>
      ... <DataArray type="Float64" Name="GR" format="appended" offset="1234"/> ...
      <AppendedData encoding="raw">_| bytes of array 0 (uint64) | array 0 | bytes of array 1 | array 1 | ...

No library is used, because meshio and pyvista take 4 to 30 times as long, and VTK reports a full disk on stderr only.
The layout follows "VTK File Formats" (Kitware); the tests read every file with PyVista.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import BinaryIO

import numpy as np

from helibore.base.arrays import Array
from helibore.base.harmless import in_html
from helibore.mesh.vtk_mesh import VtkMesh

_TYPES = {"f8": "Float64", "f4": "Float32", "i8": "Int64", "i4": "Int32", "u1": "UInt8"}
_CHUNK = 1 << 24  # bytes written at a time


def _quoted(text: str) -> str:
    return f'"{in_html(text)}"'


class _Appended:
    """The arrays that follow the XML in a file; `element` adds an array and returns the XML that says where it lies."""

    def __init__(self) -> None:
        self.arrays: list[Array] = []
        self._offset = 0

    def element(self, name: str, array: Array) -> str:
        little = np.require(array, array.dtype.newbyteorder("<"), "C")
        offset, self._offset = self._offset, self._offset + 8 + little.nbytes
        self.arrays.append(little)
        kind = f"{little.dtype.kind}{little.dtype.itemsize}"
        components = ' NumberOfComponents="3"' if little.ndim == 2 else ""
        layout = f'{components} format="appended" offset="{offset}"'
        return f'<DataArray type="{_TYPES[kind]}" Name={_quoted(name)}{layout}/>'


def write_vtk_xml(file: BinaryIO, mesh: VtkMesh, polygons: bool) -> None:
    """Write a mesh as an unstructured grid (.vtu) or, with ``polygons``, as polygons (.vtp)."""
    appended = _Appended()
    cells = _connectivity(appended, mesh)
    kind, element, counts = "UnstructuredGrid", "Cells", f'NumberOfCells="{len(mesh.corners)}"'
    if polygons:
        kind, element = "PolyData", "Polys"
        counts = f'NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="{len(mesh.corners)}"'
    else:
        cells.append(appended.element("types", np.full(len(mesh.corners), mesh.cell_type, "u1")))
    lines = [
        '<?xml version="1.0"?>',
        f'<VTKFile type="{kind}" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
        f"<{kind}>",
        "<FieldData>",
        *(_text_array(name, text) for name, text in mesh.metadata.items()),
        "</FieldData>",
        f'<Piece NumberOfPoints="{len(mesh.points)}" {counts}>',
        *_values(appended, mesh),
        f"<{element}>",
        *cells,
        f"</{element}>",
        "</Piece>",
        f"</{kind}>",
        '<AppendedData encoding="raw">',
        "_",
    ]
    file.write("\n".join(lines).encode())
    for array in appended.arrays:
        file.write(np.uint64(array.nbytes).astype("<u8").tobytes())
        content = array.reshape(-1).view(np.uint8).data
        for start in range(0, len(content), _CHUNK):
            file.write(content[start : start + _CHUNK])
    file.write(b"\n</AppendedData>\n</VTKFile>\n")


def _connectivity(appended: _Appended, mesh: VtkMesh) -> list[str]:
    count, corners = mesh.corners.shape
    kind = "<i4" if max(len(mesh.points), mesh.corners.size) < 2**31 else "<i8"
    rows = mesh.corners.reshape(-1).astype(kind, copy=False)
    ends = np.arange(corners, count * corners + 1, corners, dtype=kind)
    return [appended.element("connectivity", rows), appended.element("offsets", ends)]


def _values(appended: _Appended, mesh: VtkMesh) -> Iterable[str]:
    yield "<PointData>"
    yield from (appended.element(name, of) for name, of in mesh.point_values.items())
    yield "</PointData>"
    yield f"<CellData Scalars={_quoted(mesh.active)}>"
    yield from (appended.element(name, of) for name, of in mesh.cell_values.items())
    yield "</CellData>"
    yield f"<Points>{appended.element('Points', mesh.points)}</Points>"


def _text_array(name: str, text: str) -> str:
    """Return the XML of a text in the field data: the codes of its bytes, and a final 0."""
    codes = " ".join(map(str, [*text.encode(), 0]))
    return f'<DataArray type="String" Name={_quoted(name)} NumberOfTuples="1" format="ascii">{codes}</DataArray>'
