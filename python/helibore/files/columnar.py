"""Read Parquet tables (each column at its first use) and NPZ archives (all arrays at once).

Parquet: a number column -> (n,); a list column of constant length K -> (n, K); unit from the field's metadata
         ("unit" or "uom"), else from the name, else from OWN_UNITS
NPZ:     n is the most common first length of the images or, without images, of all arrays; arrays of this length
         are channels (n,) or (n, K); an array of length K beside an (n, K) image states the image's sector angles
"""

from __future__ import annotations

import math
import zipfile
from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np

from helibore.base.arrays import Array
from helibore.base.errors import InputError, needs
from helibore.base.limits import check_limit, check_unpacked
from helibore.base.zip_errors import DAMAGED_ZIP
from helibore.files.headings import unit_in_name
from helibore.files.input_file import InputFile
from helibore.files.raw_set import Channel, Loss, RawFile, RawSet, SectorAxis, unique

OWN_UNITS = {
    "depth": "m", "toolface": "deg", "radius": "m", "diameter": "m", "time": "s", "inclination": "deg",
    "azimuth": "deg",
}  # fmt: skip
"""Units of columns that have the names of helibore's own arrays (``np.savez(depth=caliper.depth, ...)``)."""


def read_parquet(source: InputFile) -> RawFile:
    """Open a Parquet file. Each column is read at its first use; a list column is also read now, for its length."""
    with needs("pyarrow", "parquet"):
        import pyarrow as pa
        from pyarrow import parquet
    try:
        file = parquet.ParquetFile(source.path, page_checksum_verification=True)
        schema, rows = file.schema_arrow, file.metadata.num_rows
        names = unique(list(schema.names))
        # A page of a few bytes can repeat a value a million times. pyarrow reads as many rows as the footer states.
        check_limit(source.path.name, "columns", file.metadata.num_columns)
        check_unpacked(source.path.name, 8 * _value_count(file), source.path.stat().st_size)
    except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
        raise source.damaged("truncated or damaged Parquet", error) from error
    if not rows or not names:
        raise source.error("Parquet without rows" if names else "Parquet without columns")
    channels = []
    remarks: list[str] = []
    stated = [(key.decode(errors="replace"), text) for key, text in (schema.metadata or {}).items()]
    header = {key: text.decode(errors="replace") for key, text in stated if key not in ("ARROW:schema", "pandas")}
    for position, name in enumerate(names):
        kind = schema.field(position).type
        load = _parquet_loader(source, file, position)
        shape: tuple[int, ...] = (rows,)
        if pa.types.is_list(kind) or pa.types.is_large_list(kind) or pa.types.is_fixed_size_list(kind):
            shape = load().shape
            kind = kind.value_type
        if pa.types.is_nested(kind):
            remarks.append(Loss(f"{name}: a {kind} is not read"))
            continue
        own = schema.field(position).metadata or {}
        unit = (own.get(b"unit") or own.get(b"uom") or b"").decode("utf-8", "replace")
        unit = unit or unit_in_name(name) or own_unit(name, remarks)
        is_text = not (pa.types.is_integer(kind) or pa.types.is_floating(kind) or _becomes_float(kind))
        channels.append(Channel(name, unit, "", load, source.nulls, None, shape, is_text, nan_is_missing=False))
    return RawFile("parquet", [RawSet(source.path, "table", channels, rows, None, header, remarks)], file.close)


def _value_count(file: Any) -> int:
    """Return how many values the footer of a Parquet file states; those of lists stand there for each row group."""
    leaves = range(file.metadata.num_columns)
    lists = [leaf for leaf in leaves if file.schema.column(leaf).max_repetition_level]
    groups = [file.metadata.row_group(number) for number in range(file.metadata.num_row_groups)] if lists else []
    in_lists: int = sum(group.column(leaf).num_values for group in groups for leaf in lists)
    return in_lists + (len(leaves) - len(lists)) * int(file.metadata.num_rows)


def _parquet_loader(source: InputFile, file: Any, position: int) -> Callable[[], Array]:
    names = file.schema_arrow.names
    name = names[position]

    def load() -> Array:
        import pyarrow as pa

        try:
            table = file.read([name])  # all columns of this name, and the members of a struct that are named like it
            found = [column for other, column in zip(table.column_names, table.columns, strict=True) if other == name]
            column = found[names[:position].count(name)].combine_chunks()
        except (pa.ArrowException, OSError, ValueError) as error:
            raise source.damaged("damaged Parquet", error, name) from error
        if not pa.types.is_nested(column.type):
            return parquet_values(column)
        if column.null_count:
            raise source.error(f"{column.null_count} rows have no list: every row must have one", column=name)
        lengths = set(column.value_lengths().to_pylist()) if not pa.types.is_fixed_size_list(column.type) else {None}
        if len(lengths) != 1:
            raise source.error(f"lists have {len(lengths)} different lengths: all must have one length", column=name)
        return parquet_values(column.flatten()).reshape(len(column), -1)

    return load


def parquet_values(column: Any) -> Array:
    """Return the values of a ``pyarrow.Array``, as a masked array if they are floats and some of them are null.

    Booleans and decimal numbers become floats.
    """
    if _becomes_float(column.type):
        column = column.cast("float64")
    values: Array = column.to_numpy(zero_copy_only=False)
    empty = bool(column.null_count) and values.dtype.kind == "f"
    return np.ma.MaskedArray(values, column.is_null().to_numpy(zero_copy_only=False)) if empty else values


def _becomes_float(kind: Any) -> bool:
    import pyarrow as pa

    return bool(pa.types.is_boolean(kind) or pa.types.is_decimal(kind) or pa.types.is_null(kind))


DAMAGED_NPZ = (*DAMAGED_ZIP, ValueError, OSError, KeyError)
"""The errors of `numpy.load` for an NPZ archive that is cut, damaged or encrypted."""


def read_npz(source: InputFile) -> RawFile:
    """Read all arrays of an NPZ archive. An archive with a pickled array is refused."""
    try:
        with np.load(source.path, allow_pickle=False) as archive:
            members = archive.zip.infolist()
            check_limit(source.path.name, "columns", len(members))
            # zipfile reads no more of a member than the directory says, so that this sum cannot lie.
            check_unpacked(source.path.name, sum(member.file_size for member in members), source.path.stat().st_size)
            for member in members:
                _check_header(archive.zip, member)
            arrays = {name: _array(name, archive[name]) for name in archive.files}
    except InputError:
        raise
    except DAMAGED_NPZ as error:
        raise source.damaged("damaged archive of arrays", error) from error
    shapes = [array.shape for array in arrays.values() if array.ndim in (1, 2) and array.size]
    if not shapes:
        raise source.error("no array of one or two dimensions")
    images = [shape[0] for shape in shapes if len(shape) == 2]
    rows = Counter(images or [shape[0] for shape in shapes]).most_common(1)[0][0]
    channels = []
    remarks: list[str] = []
    for name, array in arrays.items():
        axis = _axis_beside(array, rows, arrays)
        is_axis = array.ndim == 1 and any(other.shape == (rows, array.size) for other in arrays.values())
        if array.ndim not in (1, 2) or array.dtype.kind not in "fiuUSbM" or not (len(array) == rows or is_axis):
            remarks.append(Loss(f"{name}: shape {array.shape} of {array.dtype} does not fit {rows} rows; left out"))
            continue
        unit = unit_in_name(name) or ("" if array.dtype.kind in "USM" else own_unit(name, remarks))
        channels.append(Channel(name, unit, "", array, source.nulls, axis, nan_is_missing=False))
    return RawFile("npz", [RawSet(source.path, "arrays", channels, rows, None, {}, remarks)])


def _check_header(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> None:
    """Refuse an array that is larger than its member: `numpy.load` asks for the memory that the header states."""
    with archive.open(member) as file:
        if file.read(6) != np.lib.format.MAGIC_PREFIX:
            return
        version = tuple(file.read(2))
        read_header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _, dtype = read_header(file)
        if math.prod(shape) * dtype.itemsize > member.file_size:
            raise ValueError(f"{member.filename} states shape {shape} of {dtype} in {member.file_size:,} bytes")


def _array(name: str, member: Array | bytes) -> Array:
    """Return a member of an archive; refuse bytes, which `numpy.load` returns if the member is not an array."""
    if isinstance(member, bytes):
        raise ValueError(f"{name} is not an array")
    return member


def own_unit(name: str, remarks: list[str]) -> str:
    """Return the unit of a Parquet or NPZ column that has a name of `OWN_UNITS`, and add a remark; else return ""."""
    unit = OWN_UNITS.get(name, "")
    if unit:
        remarks.append(f"{name}: no unit stated; a binary column of this name is taken as {unit}")
    return unit


def _axis_beside(array: Array, rows: int, arrays: dict[str, Array]) -> SectorAxis | None:
    """Return the sector axis of an (n, K) image from the first array of K angles in the same archive.

    Return None if ``array`` is not an (n, K) image, if K is 1 or n, or if the archive holds no array of K numbers.
    """
    if array.ndim != 2 or array.shape[0] != rows:
        return None
    for name, other in arrays.items():
        if other.shape == (array.shape[1],) and array.shape[1] != rows and other.dtype.kind in "fiu" and other.size > 1:
            return SectorAxis.of_angles(other.astype(np.float64).tolist(), unit_in_name(name))
    return None
