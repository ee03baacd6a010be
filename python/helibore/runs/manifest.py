"""The wells to reprocess: a TOML manifest of projects, or a Parquet catalogue with one row per well.

    output = "s3://field/walls"             # folder of all results, any fsspec address
    outputs = ["archive", "logs"]           # one or more of archive, mesh, logs, zones; all four if left out
    block_samples = 2000000                 # a well with more samples, or twice as many vertices, is made in blocks
    catalogue = "wells.parquet"             # more wells; columns are keys, such as name, caliper, survey, wall.sectors

    [defaults.wall]                         # settings of every well that does not state its own
    bit_diameter = "8.5in"

    [[well]]
    project = "A-1/well.toml"               # a well that has a project

    [[well]]                                # or the tables of a project, here
    name = "A-2"
    caliper = "A-2.parquet"
    survey = "A-2-survey.csv"
    [well.preparation]
    find_shifts = true

A well is a project (``project``); what it states here counts over its project, and that over the defaults. Files are
named relative to the manifest, those of a project relative to the project.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal
from urllib.parse import quote

from helibore.base.addresses import file_name
from helibore.base.errors import InputError, needs
from helibore.base.toml_file import read_toml
from helibore.runs.output_store import Json, file_system, local_file
from helibore.runs.project import Project
from helibore.settings.declared import Declared, at_least
from helibore.settings.toml_reading import TomlSource, read_table
from helibore.wall.wall import Wall

Wanted = Literal["archive", "mesh", "logs", "zones"]
OUTPUTS: tuple[Wanted, ...] = ("archive", "mesh", "logs", "zones")
"""Outputs of a well."""

BLOCK_SAMPLES = 2_000_000
"""A well with at most this many samples, and twice as many vertices, is made in one piece, in less than 1 GB."""


@dataclass(frozen=True, kw_only=True)
class Manifest(Declared):
    """The wells to reprocess, each a project."""

    output: Annotated[str | None, "Folder of all results, any fsspec address."] = None
    outputs: Annotated[tuple[Wanted, ...], "What to make of a well."] = OUTPUTS
    block_samples: Annotated[int, at_least(1),
        "A well with more samples, or twice as many vertices, is made in blocks.",
    ] = BLOCK_SAMPLES  # fmt: skip
    catalogue: Annotated[str | None,
        "Parquet table of more wells; its columns are keys, such as name, caliper, survey, wall.sectors.",
    ] = None  # fmt: skip
    defaults: Annotated[dict[str, Any], "Tables of every well, as in a project."] = field(default_factory=dict)
    well: Annotated[tuple[dict[str, Any], ...], "The wells: name and project, or the tables of a project."] = ()


FILES = ("caliper", "average", "archive", "survey", "track", "image")
"""Keys of a well that name files."""

OF_A_RUN = ("verb", "output", "scalar", "options", "start_depth", "stop_depth")
"""Keys of a project that say what was written; they have no effect on a well of a manifest."""


def path_part(well: str) -> str:
    """Return the name of a well as a part of a path: 15/9-F-1 becomes 15%2F9-F-1, which data set readers decode."""
    part = quote(well, safe="")
    return part if part.strip(".") else part.replace(".", "%2E")  # "." and ".." are other folders


@dataclass(frozen=True)
class Job:
    """One well of a manifest, as Dask sends it to a worker: it holds addresses and settings, but no samples."""

    well: str
    tree: Json  # as in a settings file, but with addresses for files, and ``map`` beside ``file``
    output: str
    outputs: tuple[str, ...] = OUTPUTS
    block_samples: int = BLOCK_SAMPLES  # a well with more samples, or twice as many vertices, is made in blocks

    @property
    def key(self) -> str:
        """The name of the well as a part of a path."""
        return path_part(self.well)

    @property
    def settings_hash(self) -> str:
        """BLAKE2b of all settings that decide the bytes of the outputs, but not of folders and contents of files."""
        content = json.dumps([self.well, self.named(), sorted(self.outputs), self.block_samples], sort_keys=True)
        return hashlib.blake2b(content.encode(), digest_size=16).hexdigest()

    def named(self) -> Json:
        """Return the settings with the names of the files, without their folders, in place of the addresses."""
        return self.mapped(file_name)

    def mapped(self, change: Any, keys: tuple[str, ...] = FILES) -> Json:
        """Return the settings with ``change`` applied to the path of each file or role map under one of these keys."""
        tree = dict(self.tree)
        for key in keys:
            if key in tree:
                many = tree[key] if isinstance(tree[key], list) else [tree[key]]
                made = [of | {name: change(of[name]) for name in ("file", "map") if name in of} for of in many]
                tree[key] = made if isinstance(tree[key], list) else made[0]
        return tree

    def addresses(self, keys: tuple[str, ...] = FILES) -> list[str]:
        """Return the addresses of the files and role maps of these keys, each once."""
        found: dict[str, str] = {}
        self.mapped(lambda address: found.setdefault(address, address), keys)
        return list(found)


def read_jobs(manifest: str | Path, output: str | None = None) -> list[Job]:
    """Read a manifest or a catalogue, and check the settings of every well; no file of a well is opened.

    ``output`` replaces the output of the manifest. Raise InputError if a rule is broken; the error names manifest,
    well, key and rule.
    """
    address = str(manifest)
    name, folder = file_name(address), address.rpartition("/")[0]
    with local_file(address) as path:
        if name.endswith(".parquet"):
            source, tree = TomlSource(name), {"well": _rows(path)}
        else:
            source, tree = TomlSource.load(path)
    read = read_table(Manifest, tree, source)
    wells = list(read.well)
    if read.catalogue is not None:
        with local_file(_absolute(read.catalogue, folder)) as path:
            wells += _rows(path)
    target = output or (None if read.output is None else _absolute(read.output, folder))
    if target is None:
        raise InputError(f"{name}: output", "is missing; it is the folder of all results")
    jobs, names = [], set()
    for number, well in enumerate(wells):
        roots = (("well", number), ("defaults",)) if number < len(read.well) else ()
        own = replace(source, roots=roots, label=f"well {number + 1}", recorded=True)
        job = _job(own, folder, (read.defaults, well), target, read.outputs, read.block_samples)
        if job.well in names:
            raise InputError(f"{name}: well {job.well}", "two wells have this name; names must differ")
        names.add(job.well)
        jobs.append(job)
    if not jobs:
        raise InputError(f"{name}: well", "is missing; each well needs a table [[well]], or a row of a catalogue")
    return jobs


MOST_NAMED = 10
"""Greatest number of missing files that an error names."""


def check_files(jobs: list[Job]) -> None:
    """Raise InputError if a file is missing; the error names some of the missing files and their wells.

    32 threads query the stores.
    """

    def missing(one: tuple[str, str]) -> bool:
        system, path, _ = file_system(one[1])
        return not system.exists(path)

    named = [(job.well, address) for job in jobs for address in job.addresses()]
    with ThreadPoolExecutor(32) as pool:
        lost = [one for one, is_missing in zip(named, pool.map(missing, named), strict=True) if is_missing]
    if lost:
        first, *others = [f"well {well}: {address}" for well, address in lost]
        more = f", and {len(lost) - MOST_NAMED} more" if len(lost) > MOST_NAMED else ""
        rule = f"no such file; also missing: {', '.join(others[: MOST_NAMED - 1])}{more}" if others else "no such file"
        raise InputError(first, rule)


def _job(source: TomlSource, folder: str, trees: tuple[Json, Json], *how: Any) -> Job:
    """Return the job of a well, whose ``trees`` are the defaults and its own; ``source`` places its errors.

    Addresses are relative to ``folder``.
    """
    base, own = trees[0], dict(trees[1])
    if (project := own.pop("project", None)) is not None:
        base = _merged(source, base, _project(project, folder, source))
    stated = _merged(source, base, own)
    stated |= _addressed(stated, folder)
    header = stated.get("header")
    well = stated.pop("name", None) or (header.get("well") if isinstance(header, dict) else None)
    if not isinstance(well, str) or not well.strip():
        raise source.error(("name",), "must be a text: the name of the well", *([] if well is None else [well]))
    job, source = Job(well, stated, *how), replace(source, label=f"well {well}")
    for key in OF_A_RUN:
        if key in stated:
            raise source.error((key,), "has no effect on a well of a manifest")
    check_settings(job, source)
    return job


def _project(address: Any, folder: str, source: TomlSource) -> Json:
    """Return the tables of a well's project, with whole addresses, without what helibore wrote about an output."""
    if not isinstance(address, str):
        raise source.error(("project",), "must name a file", address)
    whole = _absolute(address, folder)
    with local_file(whole) as path:
        tree = read_toml(path, file_name(whole))
    of_a_well = {key: value for key, value in tree.items() if key not in ("helibore", *OF_A_RUN)}
    home = whole.rpartition("/")[0]
    return of_a_well | _addressed(of_a_well, home if "://" in home else str(Path(home).absolute()))


def check_settings(job: Job, source: TomlSource) -> Project:
    """Return the project of a job; raise InputError, with place, key and rule, if a setting breaks its rule."""
    project = read_table(Project, job.tree, source)
    if project.wall is not None:
        try:
            found: Json = {"kriging_range": project.wall.kriging_range or 1.0}  # `reconstruct` finds both
            if project.wall.estimator == "automatic":
                found["estimator"] = "inverse-distance"
            Wall(threads=1, **vars(project.wall) | found)
        except InputError as error:
            raise error.within(source.place(("wall",))) from error
    return project


def _addressed(tree: Json, folder: str) -> Json:
    """Return the keys of a tree that name files, with each file as a table with a whole address.

    Those of caliper and image become lists of tables. What is no file is left to the reader, which refuses it.
    """
    found: Json = {}
    for key in FILES:
        if key not in tree:
            continue
        many = tree[key] if isinstance(tree[key], list) else [tree[key]]
        tables = [{"file": of} if isinstance(of, str) else of for of in many]
        made = [_whole(of, folder) if isinstance(of, dict) else of for of in tables]
        if key in ("caliper", "image"):
            found[key] = made
        elif len(made) == 1:
            found[key] = made[0]
    return found


def _whole(table: Json, folder: str) -> Json:
    """Return the table of a file with whole addresses of the file and of its map."""
    named = {name: table[name] for name in ("file", "map") if isinstance(table.get(name), str)}
    return table | {name: _absolute(address, folder) for name, address in named.items()}


def _absolute(address: str, folder: str) -> str:
    """Return an address; a relative address becomes an address below ``folder``."""
    return address if "://" in address or address.startswith("/") or not folder else f"{folder}/{address}"


def _merged(source: TomlSource, defaults: Json, own: Json) -> Json:
    """Return the tables of a well; the defaults supply the keys that the well lacks."""
    both: Json = {}
    for key in defaults:
        if isinstance(own.get(key), dict) and key not in FILES:
            if not isinstance(defaults[key], dict):
                raise source.error(("defaults", key), "must be a table", defaults[key])
            both[key] = defaults[key] | own[key]
    for key in FILES:
        if isinstance(of_all := defaults.get(key), dict):
            given = own.get(key, [of_all] if "file" in of_all else [])
            given = given if isinstance(given, list) else [given]
            many = [{"file": of} if isinstance(of, str) else of for of in given]
            both[key] = [of_all | of if isinstance(of, dict) else of for of in many]
    return {key: of for key, of in (defaults | own | both).items() if of != []}


def _rows(path: Path) -> list[Json]:
    """Return the rows of a Parquet catalogue; a column ``wall.sectors`` is a key of the table ``wall``."""
    with needs("pyarrow", "scale"):
        from pyarrow import ArrowException, parquet
    try:
        rows = parquet.read_table(path).to_pylist()
    except (ArrowException, OSError) as error:
        raise InputError(path.name, f"not a Parquet catalogue: {error}") from error
    return [dict(_nested(row)) for row in rows]


def _nested(row: Json) -> Iterator[tuple[str, Any]]:
    tables: dict[str, Json] = {}
    for key, value in row.items():
        table, dot, inner = key.partition(".")
        if isinstance(value, float) and value.is_integer():  # pandas stores whole numbers as floats if some are missing
            value = int(value)
        if value is not None and dot:
            tables.setdefault(table, {})[inner] = value
        elif value is not None:
            yield key, value
    yield from tables.items()
