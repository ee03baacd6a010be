"""Read LIS79 tapes through dlisio: one RawSet for each data format specification (a pass) of each logical file.

Only the channels with the fewest samples per row are read; a remark names the channels with more.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from helibore.base.errors import InputError, MissingExtraError
from helibore.files.dlis import damage_named, dlisio_warnings, text_of
from helibore.files.raw_set import Channel, RawFile, RawSet, readable_sets
from helibore.files.source import Source, file_error


def read(source: Source, nulls: tuple[float, ...]) -> RawFile:
    """Open a LIS file; all its rows are read."""
    try:
        from dlisio import lis
    except ImportError as error:
        raise MissingExtraError("dlisio", "dlis") from error
    with damage_named(source, "LIS"), dlisio_warnings():
        tape = lis.load(str(source.path))
    try:
        with damage_named(source, "LIS"), dlisio_warnings() as warned:
            readers = []
            for number, logical in enumerate(tape):
                for position, spec in enumerate(logical.data_format_specs()):
                    readers.append(partial(_pass, source, f"{number}/{position}", logical, spec, nulls))
            if not readers:
                raise file_error(source.path, "LIS without a log")
            sets = readable_sets(readers)
    except InputError:
        tape.close()
        raise
    tape.close()
    for each in sets:
        each.remarks.extend(sorted(warned))
    return RawFile("LIS", sets)


def _pass(source: Source, name: str, logical: Any, spec: Any, nulls: tuple[float, ...]) -> RawSet:
    from dlisio import lis

    with damage_named(source, f"log {name}"):
        rate = min(spec.sample_rates()) if spec.sample_rates() else 1
        rows = lis.curves(logical, spec, sample_rate=rate, strict=False)
    if not len(rows):
        raise file_error(source.path, "no rows", f"log {name}")
    blocks = {text_of(block.mnemonic).strip(): block for block in spec.specs}
    units = {label: text_of(block.units).strip() for label, block in blocks.items()}
    index = text_of(spec.index_mnem).strip()
    units.setdefault(index, text_of(spec.index_units).strip())
    absent = spec.absent_value
    declared = (*nulls, float(absent)) if isinstance(absent, int | float) else nulls
    channels = [
        Channel(label.strip(), units.get(label.strip(), units.get(label.partition("(")[0].strip(), "")), "",
                rows[label], declared)
        for label in rows.dtype.names
    ]  # fmt: skip
    read_names = {channel.name for channel in channels}
    remarks = [
        f"{label}: {block.samples} samples a row, not read"
        for label, block in blocks.items()
        if label not in read_names and block.samples > rate
    ]
    return RawSet(source.path, name, channels, len(rows), index, {}, remarks)
