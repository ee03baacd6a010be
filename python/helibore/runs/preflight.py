"""Before any work: read the head of each well's caliper files, so that a header that no role fits is known at once.

    jobs --the first 256 kB of each text, the first rows of each Parquet file--> roles and units --> reason by well
         --> equal reasons together

A head may lack what the whole file has, so the whole file is read before a well is refused.
"""

from __future__ import annotations

import gzip
import itertools
import tempfile
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

from helibore.base.addresses import file_name
from helibore.base.errors import InputError, MissingExtraError
from helibore.channels.channel_readings import readings
from helibore.files.reading import ending_of
from helibore.runs.manifest import Job
from helibore.runs.output_store import file_system
from helibore.runs.well import opened

HEAD = 1 << 18
"""Bytes of a text file that are read first."""

TEXTS = (".csv", ".tsv", ".txt", ".dat", ".asc", ".las")
"""Endings of texts whose head says what the columns are. Other files but Parquet and NPZ are left to the run."""

ROWS = 1000
"""Rows of a Parquet file that are read first."""

REMEDY = """\
for all wells, whatever names their files have, write in the manifest
    [defaults.caliper]
    map = "names.toml"
and in names.toml, for each role that was not found,
    [[names]]
    names = ["RAD", "ARM1"]
    role = "radius"
    unit = "in"    # where a file states none
for one file: its map, which helibore inspect FILE prints"""


def refused_wells(jobs: Sequence[Job]) -> dict[str, str]:
    """Return, by well, why its caliper files cannot be read; wells without such a fault are not among them."""
    with ThreadPoolExecutor(8) as pool:
        reasons = pool.map(_refusal, jobs)
        return {job.well: reason for job, reason in zip(jobs, reasons, strict=True) if reason}


def grouped(reasons: Mapping[str, str], jobs: Sequence[Job]) -> list[tuple[str, list[str]]]:
    """Return each reason once, FILE in place of names of files, with the wells that it concerns; most wells first."""
    names = {job.well: [file_name(address) for address in job.addresses()] for job in jobs}
    groups: dict[str, list[str]] = {}
    for well, reason in reasons.items():
        text = reason
        for name in names.get(well, ()):
            text = text.replace(name, "FILE")
        groups.setdefault(text, []).append(well)
    found = [(reasons[wells[0]] if len(wells) == 1 else text, wells) for text, wells in groups.items()]
    return sorted(found, key=lambda group: -len(group[1]))


def _refusal(job: Job) -> str:
    if "caliper" not in job.tree or "track" in job.tree:
        return ""
    others = ("survey", "image", "scalar")
    alone = replace(job, tree={name: of for name, of in job.tree.items() if name not in others})
    with tempfile.TemporaryDirectory(prefix="helibore-") as folder:
        heads = {}
        for number, address in enumerate(job.addresses(("caliper",))):
            place = Path(folder) / str(number)
            place.mkdir()
            head = _head(address, place)
            if head is None:
                return ""
            heads[address] = head
        tree = alone.mapped(lambda address: heads.get(address, address), ("caliper",))
        tables = [{name: of for name, of in table.items() if name != "blake2b"} for table in tree["caliper"]]
        short = replace(alone, tree=tree | {"caliper": tables})
        return _reason(short) and _reason(alone)


def _head(address: str, folder: Path) -> str | None:
    """Return the address of a file with the first whole lines of a text, in ``folder``; None for a file to leave alone.

    Of a Parquet file on this machine, the first rows. An NPZ file on this machine, and a role map, are their own head.
    """
    system, path, is_local = file_system(address)
    name = file_name(address)
    ending = ending_of(name)
    if ending == ".parquet" and is_local:
        return _first_rows(address, path, folder / name)
    if ending == ".toml" or (ending == ".npz" and is_local):
        return address
    if ending not in TEXTS:
        return None
    try:
        with system.open(path, "rb") as file:
            head = (gzip.GzipFile(fileobj=file) if name.lower().endswith(".gz") else file).read(HEAD)
    except (OSError, EOFError):
        return None
    if len(head) == HEAD:
        head = head[: head.rfind(b"\n") + 1]
    target = folder / name
    target.write_bytes(head)
    return str(target)


def _first_rows(address: str, path: str, target: Path) -> str:
    """Write the first rows of a Parquet file; return their address or, if it cannot be read, that of the file."""
    import pyarrow
    from pyarrow import parquet

    try:
        with parquet.ParquetFile(path) as file:
            rows = pyarrow.Table.from_batches(list(itertools.islice(file.iter_batches(ROWS), 1)), file.schema_arrow)
        parquet.write_table(rows, target)
    except (OSError, pyarrow.ArrowException):
        return address
    return str(target)


def _reason(job: Job) -> str:
    """Return why the readings of a well are refused; "" if they are not, or if the run will say it better."""
    try:
        with opened(job, ("caliper",)) as (run, _):
            wall = run.settings.wall
            bit = wall.bit_diameter if wall and wall.bit_diameter > 0 else None
            for each in run.settings.caliper:
                readings(run.files.log_set(each), each.roles, bit, run.settings.echo)
    except InputError as error:
        return " ".join(str(error).split())
    except (MissingExtraError, OSError):
        return ""
    return ""
