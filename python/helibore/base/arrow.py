"""Columns as an Arrow stream, which Polars, DuckDB, pandas and pyarrow read.

The Arrow PyCapsule interface: https://arrow.apache.org/docs/format/CDataInterface/PyCapsuleInterface.html. A missing
value (NaN) is null, so that their means leave it out. `nanoarrow` makes the stream: 1 MB, where pyarrow takes 100 MB.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from helibore.base.arrays import Floats, Integers


def arrow_stream(columns: Mapping[str, tuple[str, Floats | Integers]], requested_schema: object = None) -> object:
    """Return the capsule of a stream with one batch.

    Parameters
    ----------
    columns
        Unit and (n,) values, float64 or int64, by name; the unit goes to the field's metadata.
    requested_schema
        As the interface has it.
    """
    import nanoarrow as arrow
    from nanoarrow.c_array_stream import CArrayStream

    fields, arrays, length = {}, [], 0
    for name, (unit, values) in columns.items():
        kind = arrow.int64() if values.dtype.kind == "i" else arrow.float64()
        fields[name] = arrow.Schema(kind, metadata={"unit": unit} if unit else None)
        there, length = ~np.isnan(values), values.size
        validity = None if there.all() else np.packbits(there, bitorder="little")
        arrays.append(arrow.c_array_from_buffers(fields[name], length, [validity, values.copy()]))
    batch = arrow.c_array_from_buffers(arrow.struct(fields), length, [None], children=arrays)
    return CArrayStream.from_c_arrays([batch], batch.schema).__arrow_c_stream__(requested_schema)
