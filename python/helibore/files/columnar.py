"""Read Parquet tables, each column at its first use, and NPZ archives, all arrays at once.

Parquet: a number column -> (n,); a list column of constant length K -> (n, K); unit from the field's metadata
         ("unit" or "uom"), else from the name
NPZ:     n is the most common first length of the images or, without images, of all arrays; arrays of this length
         are channels (n,) or (n, K); an array of length K beside an (n, K) image states the image's sector angles
"""

from __future__ import annotations

import zipfile
import zlib
from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np

from helibore.base.errors import needs
from helibore.files.headings import unit_in_name
from helibore.files.input_file import InputFile, refuse_zip_bomb
from helibore.files.raw_set import Array, Channel, RawFile, RawSet, SectorAxis, unique

OWN_UNITS = {
    "depth": "m", "toolface": "deg", "radius": "m", "diameter": "m", "time": "s", "inclination": "deg",
    "azimuth": "deg",
}  # fmt: skip
"""Units of columns that have the names of helibore's own arrays (``np.savez(depth=caliper.depth, ...)``)."""


def read_parquet(source: InputFile) -> RawFile:
    """Open a Parquet file; each column is read at its first use, and a list column here too, for its length."""
    with needs("pyarrow", "parquet"):
        import pyarrow as pa
        from pyarrow import parquet
    try:
        file = parquet.ParquetFile(source.path, page_checksum_verification=True)
        schema, rows = file.schema_arrow, file.metadata.num_rows
        names = unique(list(schema.names))
    except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
        raise source.error(f"truncated or damaged Parquet ({str(error).splitlines()[0]})") from error
    if not rows or not names:
        raise source.error("Parquet without rows" if names else "Parquet without columns")
    channels = []
    remarks = []
    stated = [(key.decode(errors="replace"), text) for key, text in (schema.metadata or {}).items()]
    header = {key: text.decode(errors="replace") for key, text in stated if key not in ("ARROW:schema", "pandas")}
    for position, name in enumerate(names):
        kind = schema.field(position).type
        load = _parquet_loader(source, file, schema.names[position])
        shape: tuple[int, ...] = (rows,)
        if pa.types.is_list(kind) or pa.types.is_large_list(kind) or pa.types.is_fixed_size_list(kind):
            shape = load().shape
            kind = kind.value_type
        number = pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_boolean(kind)
        if pa.types.is_nested(kind):
            remarks.append(f"{name}: a {kind} is not read")
            continue
        own = schema.field(position).metadata or {}
        unit = (own.get(b"unit") or own.get(b"uom") or b"").decode("utf-8", "replace")
        unit = unit or unit_in_name(name) or own_unit(name, remarks)
        is_text = not number and not pa.types.is_null(kind)
        channels.append(Channel(name, unit, "", load, source.nulls, None, shape, is_text, nan_is_missing=False))
    return RawFile("parquet", [RawSet(source.path, "table", channels, rows, None, header, remarks)], file.close)


def _parquet_loader(source: InputFile, file: Any, name: str) -> Callable[[], Array]:
    def load() -> Array:
        import pyarrow as pa

        try:
            column = file.read([name]).column(0).combine_chunks()
        except (pa.ArrowException, OSError, ValueError) as error:
            raise source.error(f"damaged Parquet ({str(error).splitlines()[0]})", column=name) from error
        if not pa.types.is_nested(column.type):
            return parquet_values(column)
        if column.null_count:
            raise source.error(f"{column.null_count} rows have no list: every row must have one", column=name)
        lengths = set(column.value_lengths().to_pylist()) if not pa.types.is_fixed_size_list(column.type) else {None}
        if len(lengths) != 1:
            raise source.error(f"lists have {len(lengths)} different lengths: must have one", column=name)
        return column.flatten().to_numpy(zero_copy_only=False).reshape(len(column), -1)  # type: ignore[no-any-return]

    return load


def parquet_values(column: Any) -> Array:
    """Return the values of a ``pyarrow.Array``, as a masked array if they are floats and some of them are null."""
    values: Array = column.to_numpy(zero_copy_only=False)
    empty = bool(column.null_count) and values.dtype.kind == "f"
    return np.ma.MaskedArray(values, column.is_null().to_numpy(zero_copy_only=False)) if empty else values


DAMAGED_NPZ = (ValueError, OSError, EOFError, KeyError, zipfile.BadZipFile, NotImplementedError, zlib.error)
"""The errors of `numpy.load` for an NPZ archive that is cut or damaged."""


def read_npz(source: InputFile) -> RawFile:
    """Read all arrays of an NPZ archive. An archive with a pickled array is refused."""
    refuse_zip_bomb(source)
    try:
        with np.load(source.path, allow_pickle=False) as archive:
            arrays = {name: _dates_as_text(archive[name]) for name in archive.files}
    except DAMAGED_NPZ as error:
        raise source.error(f"damaged archive of arrays ({error})") from error
    shapes = [array.shape for array in arrays.values() if array.ndim in (1, 2) and array.size]
    if not shapes:
        raise source.error("no array of one or two dimensions")
    images = [shape[0] for shape in shapes if len(shape) == 2]
    rows = Counter(images or [shape[0] for shape in shapes]).most_common(1)[0][0]
    channels = []
    remarks = []
    for name, array in arrays.items():
        axis = _axis_beside(array, rows, arrays)
        is_axis = array.ndim == 1 and any(other.shape == (rows, array.size) for other in arrays.values())
        if array.ndim not in (1, 2) or array.dtype.kind not in "fiuUSb" or not (len(array) == rows or is_axis):
            remarks.append(f"{name}: shape {array.shape} of {array.dtype} does not fit {rows} rows; left out")
            continue
        unit = unit_in_name(name) or ("" if array.dtype.kind in "US" else own_unit(name, remarks))
        channels.append(Channel(name, unit, "", array, source.nulls, axis, nan_is_missing=False))
    return RawFile("npz", [RawSet(source.path, "arrays", channels, rows, None, {}, remarks)])


def _dates_as_text(array: Array) -> Array:
    """Return dates as texts in ISO 8601, as the other formats have them; any other array as it is."""
    return np.datetime_as_string(array) if array.dtype.kind == "M" else array


def own_unit(name: str, remarks: list[str]) -> str:
    """Return the unit of a Parquet or NPZ column with a name of helibore's (``depth`` ...), with a remark; else ""."""
    unit = OWN_UNITS.get(name, "")
    if unit:
        remarks.append(f"{name}: no unit stated; a binary column of this name is taken as {unit}")
    return unit


def _axis_beside(array: Array, rows: int, arrays: dict[str, Array]) -> SectorAxis | None:
    """Return the sector axis of an (n, K) image from the first array of K numbers in the same archive; else None."""
    if array.ndim != 2 or array.shape[0] != rows:
        return None
    for name, other in arrays.items():
        if other.shape == (array.shape[1],) and array.shape[1] != rows and other.dtype.kind in "fiu" and other.size > 1:
            steps = np.diff(other.astype(np.float64))
            even = np.allclose(steps, steps[0], rtol=1e-6, atol=1e-9)
            return SectorAxis(float(other[0]), float(steps[0]) if even else float("nan"), unit_in_name(name))
    return None
