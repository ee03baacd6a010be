"""Read LIS79 tapes through dlisio: one RawSet for each data format specification (a pass) of each logical file.

A row may hold several samples of one channel. Only the channels with the fewest samples in a row are read; a remark
names each channel with more samples.
"""

from __future__ import annotations

from contextlib import suppress
from functools import partial
from types import SimpleNamespace
from typing import Any

from helibore.base.errors import needs
from helibore.files.dlis import damage_named, dlisio_warnings, text_of
from helibore.files.headings import is_number
from helibore.files.input_file import InputFile
from helibore.files.raw_set import Channel, Loss, RawFile, RawSet, readable_sets

BYTE = 66
CODES = frozenset((49, 50, 56, 65, BYTE, 68, 70, 73, 79))
"""The representation codes of LIS79 that dlisio reads: floats, integers, texts and bytes; a mask (77) is none."""


def read(source: InputFile) -> RawFile:
    """Open a LIS file; all its rows are read."""
    with needs("dlisio", "dlis"):
        from dlisio import lis
    with damage_named(source, "LIS"), dlisio_warnings() as warned, lis.load(str(source.path)) as tape:
        readers = []
        for number, logical in enumerate(tape):
            header = _header(logical)
            for position, spec in enumerate(logical.data_format_specs()):
                readers.append(partial(_pass, source, f"{number}/{position}", logical, spec, header))
        if not readers:
            raise source.error("LIS without a log")
        sets = readable_sets(readers)
    for each in sets:
        each.remarks.extend(sorted(warned))
    return RawFile("LIS", sets)


def _header(logical: Any) -> dict[str, str]:
    """Return the entries of the well site and job records of a logical file by mnemonic: ``CN``, ``WN``, ``FN`` ...

    A record is a table of rows with the columns MNEM and VALU, or a list of values by mnemonic.
    """
    found: dict[str, str] = {}
    for read_records in (logical.wellsite_data, logical.job_identification):
        with suppress(Exception):  # a damaged record does not keep the logs from being read
            for record in read_records():
                name = ""
                for block in record.components():
                    mnemonic, value = text_of(block.mnemonic).strip(), text_of(block.component).strip()
                    if not record.isstructured():
                        name = mnemonic
                    elif mnemonic == "MNEM":
                        name = value
                    if name and value and (mnemonic == "VALU" or not record.isstructured()):
                        unit = text_of(block.units).strip() if is_number(value) else ""
                        found.setdefault(name, f"{value} {unit}".strip())
    return found


def _known_blocks(spec: Any) -> tuple[Any, dict[str, int]]:
    """Return a format specification in which channels of unknown representation codes are skipped, and these codes.

    The specification states the size of each channel, so that the others can be read.
    """
    unknown = {
        text_of(block.mnemonic).strip(): int(block.reprc) for block in spec.specs if int(block.reprc) not in CODES
    }
    if not unknown:
        return spec, {}
    fields = ("mnemonic", "units", "samples", "reprc", "reserved_size")
    blocks = [SimpleNamespace(**{name: getattr(block, name) for name in fields}) for block in spec.specs]
    for block in blocks:
        if int(block.reprc) not in CODES and block.reserved_size > 0:
            block.reprc, block.reserved_size = BYTE, -block.reserved_size  # dlisio skips a channel of negative size
    outer = ("info", "depth_mode", "depth_reprc", "index_mnem", "index_units", "absent_value", "directional_spacing")
    copied = SimpleNamespace(**{name: getattr(spec, name) for name in outer if hasattr(spec, name)}, specs=blocks)
    copied.default_index_mnem = spec.default_index_mnem
    copied.sample_rates = lambda: {block.samples for block in blocks if block.reserved_size > 0}
    return copied, unknown


def _pass(source: InputFile, name: str, logical: Any, spec: Any, header: dict[str, str]) -> RawSet:
    from dlisio import lis

    spec, unknown = _known_blocks(spec)
    with damage_named(source, f"log {name}"):
        rate = min(spec.sample_rates()) if spec.sample_rates() else 1
        rows = lis.curves(logical, spec, sample_rate=rate, strict=False)
    if not len(rows):
        raise source.error("no rows", f"log {name}")
    blocks = {text_of(block.mnemonic).strip(): block for block in spec.specs}
    units = {label: text_of(block.units).strip() for label, block in blocks.items()}
    index = text_of(spec.index_mnem).strip()
    units.setdefault(index, text_of(spec.index_units).strip())
    absent = spec.absent_value
    nulls = (*source.nulls, float(absent)) if isinstance(absent, int | float) else source.nulls
    channels = []
    for label in rows.dtype.names:
        unit = units.get(label.strip(), units.get(label.partition("(")[0].strip(), ""))
        channels.append(Channel(label.strip(), unit, "", rows[label], nulls))
    unread = {label: block for label, block in blocks.items() if label not in {channel.name for channel in channels}}
    remarks: list[str] = [
        Loss(f"{label}: not read, because it has {each.samples} samples in each frame instead of {rate}")
        for label, each in unread.items()
        if each.samples > rate and label not in unknown
    ]
    remarks += [Loss(f"{label}: not read, because no reader knows its code {code}") for label, code in unknown.items()]
    return RawSet(source.path, name, channels, len(rows), index, header, remarks)
