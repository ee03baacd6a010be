"""The wells to reprocess, their files and settings: a TOML manifest, or a Parquet catalogue with one row per well.

    output = "s3://field/walls"             # folder of all results, any fsspec address
    outputs = ["archive", "logs"]           # one or more of archive, mesh, logs, zones; all four if left out
    block_samples = 2000000                 # a well with more samples, or twice as many vertices, is made in blocks
    catalogue = "wells.parquet"             # more wells; columns are keys, such as name, caliper, survey, wall.sectors

    [defaults.wall]                         # settings of every well that does not state its own
    bit_diameter = 0.2159

    [[well]]
    name = "A-1"
    caliper = "A-1.parquet"                 # or [[well.caliper]] with file, set, map, header_line
    survey = "A-1-survey.csv"
    [well.preparation]
    find_shifts = true

The tables of a well are those of a run's settings (``project``). The key ``map`` beside ``file`` names a role
map; without a map the roles are guessed. Files are named relative to the manifest.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any
from urllib.parse import quote

from helibore.base.addresses import file_name, without_secrets
from helibore.base.errors import InputError, check_names, needs
from helibore.base.toml_file import read_toml
from helibore.runs.output_store import Json, file_system, local_file
from helibore.runs.project import ImageInput, Input, Project, project_of
from helibore.wall.wall import Wall

OUTPUTS = ("archive", "mesh", "logs", "zones")
"""Outputs of a well."""

BLOCK_SAMPLES = 2_000_000
"""A well with at most this many samples, and twice as many vertices, is made in one piece, in less than 1 GB."""

KEYS: dict[str, tuple[type, str]] = {
    "output": (str, "an address"), "outputs": (list, "a list"),
    "block_samples": (int, "a whole number of at least 1"), "catalogue": (str, "an address"),
    "defaults": (dict, "a table"), "well": (list, "tables, [[well]]"),
}  # fmt: skip
"""Keys of a manifest: the type of the value, and what the value must be."""

FILES = ("caliper", "average", "archive", "survey", "track", "image")
"""Keys of a well that name files."""

OF_A_RUN = ("verb", "output", "scalar", "options")
"""Keys of a run's settings that a well of a manifest does not have."""

OF_A_WELL = ("name", *(each.name for each in fields(Project) if each.name not in OF_A_RUN))
"""Keys of a well."""

OF_A_FILE = {key: tuple(each.name for each in fields(ImageInput if key == "image" else Input)) for key in FILES}
"""Keys of the table of a file, by the key of the well that has this table."""


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
        tree: Json = {"well": _rows(path)} if name.endswith(".parquet") else read_toml(path, name)
    check_names(f"{name}: ", tree, KEYS)
    for key, value in tree.items():
        if type(value) is not KEYS[key][0]:
            raise InputError(f"{name}: {key}", f"must be {KEYS[key][1]}", repr(value))
    wells = tree.get("well", [])
    if "catalogue" in tree:
        with local_file(_absolute(tree["catalogue"], folder)) as path:
            wells = [*wells, *_rows(path)]
    target = output or (_absolute(tree["output"], folder) if "output" in tree else None)
    if target is None:
        raise InputError(f"{name}: output", "is missing; it is the folder of all results")
    outputs = tuple(tree.get("outputs", OUTPUTS))
    if not all(one in OUTPUTS for one in outputs):
        raise InputError(f"{name}: outputs", f"must contain only {', '.join(OUTPUTS)}", repr(list(outputs)))
    most = tree.get("block_samples", BLOCK_SAMPLES)
    if most < 1:
        raise InputError(f"{name}: block_samples", f"must be {KEYS['block_samples'][1]}", repr(most))
    jobs, names = [], set()
    for number, well in enumerate(wells, 1):
        if not isinstance(well, dict):
            raise InputError(f"{name}: well {number}", "must be a table", repr(well))
        merged = _merged(name, tree.get("defaults", {}), well)
        job = _job(name, folder, f"well {number}", merged, target, outputs, most)
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
        first, *others = [f"well {well}: {without_secrets(address)}" for well, address in lost]
        more = f", and {len(lost) - MOST_NAMED} more" if len(lost) > MOST_NAMED else ""
        rule = f"no such file; also missing: {', '.join(others[: MOST_NAMED - 1])}{more}" if others else "no such file"
        raise InputError(first, rule)


def _job(name: str, folder: str, place: str, tree: Json, *how: Any) -> Job:
    well = tree.pop("name", None)
    if not isinstance(well, str) or not well.strip():
        rule = "must be a text: the name of the well"
        raise InputError(f"{name}: {place}.name", rule, None if well is None else repr(well))
    place = f"{name}: well {well}"
    check_names(f"{place}: ", tree, OF_A_WELL)
    for key in FILES:
        if key in tree:
            tree[key] = _files(key, tree[key], f"{place}: {key}", folder)
    job = Job(well, tree, *how)
    check_settings(job, place)
    return job


def check_settings(job: Job, place: str) -> Project:
    """Return the settings of a job; raise InputError, with place, key and rule, if a setting breaks its rule."""
    settings = project_of(job.tree, place)
    if settings.wall is not None:
        try:
            found: Json = {"kriging_range": settings.wall.kriging_range or 1.0}  # `reconstruct` finds both
            if settings.wall.estimator == "automatic":
                found["estimator"] = "inverse-distance"
            Wall(threads=1, **vars(settings.wall) | found)
        except InputError as error:
            raise error.within(f"{place}: wall") from error
    return settings


def _files(key: str, given: Any, place: str, folder: str) -> Any:
    """Return the value of a key that names files as the table of a file; for caliper and image, a list of tables.

    An address alone becomes a table. Relative addresses become absolute.
    """
    many = given if isinstance(given, list) else [given]
    tables = [{"file": of} if isinstance(of, str) else of for of in many]
    if key not in ("caliper", "image") and len(tables) != 1:
        raise InputError(place, "must name one file", repr(given))
    for of in tables:
        if not isinstance(of, dict) or not isinstance(of.get("file"), str):
            raise InputError(place, "must name a file")
        if not isinstance(of.get("map", ""), str):
            raise InputError(f"{place}: map", "must name a file", repr(of["map"]))
        check_names(f"{place}: ", of, OF_A_FILE[key])
    made = [of | {name: _absolute(of[name], folder) for name in ("file", "map") if name in of} for of in tables]
    return made if key in ("caliper", "image") else made[0]


def _absolute(address: str, folder: str) -> str:
    """Return an address; a relative address becomes an address below ``folder``."""
    return address if "://" in address or address.startswith("/") or not folder else f"{folder}/{address}"


def _merged(name: str, defaults: Json, own: Json) -> Json:
    """Return the tables of a well; the defaults of the manifest ``name`` supply the keys that the well lacks."""
    both: Json = {}
    for key in defaults:
        if isinstance(own.get(key), dict) and key not in FILES:
            if not isinstance(defaults[key], dict):
                raise InputError(f"{name}: defaults.{key}", "must be a table", repr(defaults[key]))
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
