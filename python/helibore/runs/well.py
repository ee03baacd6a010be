"""Make one well of a manifest, from its files to its outputs in the store, on any worker.

    files --local copies--> Run --> wall --> archive, mesh, logs, zones --> the record, last

    OUTPUT/wells/A-1/A-1.wall, A-1.glb, A-1-overview.glb
    OUTPUT/logs/well=A-1/logs-0.parquet         all wells together: one partitioned data set
    OUTPUT/zones/well=A-1/zones-0.parquet
    OUTPUT/records/A-1.json                     what the outputs were made from, and the row of the catalogue

A well is complete when its record exists. The record states the settings, the versions, the checksums of the inputs and
the files that were written. A well whose record agrees with all of these is not made again. If there is no record, the
files of the well are replaced.
"""

from __future__ import annotations

import contextlib
import functools
import json
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from helibore._core import __version__
from helibore.base.errors import InputError
from helibore.files.log_writing import save_table
from helibore.logs.summary import WallSummary, summarize
from helibore.logs.turn_logs import Logs
from helibore.logs.zones import Classification, classify
from helibore.mesh.surface import Surface, surface_of
from helibore.runs.blocks import (
    Merged,
    make_block,
    merged,
    needs_stream,
    overview_settings,
    plan_well,
    prepared_batches,
    read_plan,
    stream,
)
from helibore.runs.manifest import FILES, Job, path_part
from helibore.runs.output_store import Json, Store, local_file
from helibore.runs.project import Project, project_of
from helibore.runs.run import OpenFiles, Run, build_wall, check_path, open_run, read_path, read_run, stated_criteria
from helibore.samples.helix import helix_of
from helibore.wall.wall import Wall, wall_of


@functools.cache
def versions() -> dict[str, str]:
    """Return, by name, the versions of the libraries that decide the bytes of the outputs."""
    import pyarrow

    return {"helibore": __version__, "numpy": np.__version__, "pyarrow": pyarrow.__version__}


def record_name(well: str) -> str:
    """Return the name of the file in the store that holds the record of a well."""
    return f"records/{path_part(well)}.json"


def reprocess_well(job: Job, expected: dict[str, str] | None = None) -> Json:
    """Make the outputs of one well, unless its record shows that they exist.

    Parameters
    ----------
    job
        The well.
    expected
        The `versions` of the calling process; a worker with other versions refuses the well. None: any versions.

    Returns
    -------
    dict
        The record; its ``made`` states whether the outputs were made now. For a well too large for one piece, a dict
        with ``blocks``: the number of blocks that `reprocess_block` makes, before `merge_well` makes the record.

    Raises
    ------
    InputError
        If the versions differ from ``expected``, and for the reasons of `helibore.runs.run.make_wall`.
    OSError
        If the store cannot be read or written.
    """
    check_versions(expected)
    store = Store(job.output)
    try:
        return _make(job, store)
    except InputError:  # outputs that the store has are of other inputs, or incomplete
        folders = (*_folders(job), _work_folder(job))
        store.delete([record_name(job.well), *(name for folder in folders for name in store.sizes(folder))])
        raise


def _folders(job: Job) -> tuple[str, ...]:
    """Return the folders of a well's outputs in the store."""
    return f"wells/{job.key}", f"logs/well={job.key}", f"zones/well={job.key}"


def _make(job: Job, store: Store) -> Json:
    with opened(job) as (run, local):
        before: Json | None = store.read_checked(record_name(job.well))
        if before is not None:
            if not _changes(before, _made_from(job, run.files, local), store):
                return before | {"made": False}
            store.delete([record_name(job.well), *before["files"]])
        store.delete([name for folder in _folders(job) for name in store.sizes(folder) if name.endswith(".part")])
        most, is_stream = job.block_samples, needs_stream(run, job.block_samples)
        if is_stream:
            read_path(run)
        images, samples = ([], None) if is_stream else read_run(run)
        batches = stream(run, most) if is_stream else prepared_batches(run, samples, most)
        if batches is not None:
            made_from = _made_from(job, run.files, local)
            plan = plan_well(run, store, _work_folder(job), made_from, most, batches)
            _check_path(job, run, plan["start_depth"], plan["last_depth"])
            return {"blocks": len(plan["blocks"])}
        build_wall(run, images, samples, threads=1)
        if len(run.wall):
            _check_path(job, run, *helix_of(run.wall).ends(len(run.wall)))
        files, row = write_outputs(run, job, store)
        made_from = _made_from(job, run.files, local)
    return _write_record(job, store, made_from, files, row)


def _check_path(job: Job, run: Run, *ends: float) -> None:
    """Refuse a path that does not reach both ends of the wall, if the outputs include an archive or a mesh."""
    if {"archive", "mesh"} & set(job.outputs):
        check_path(run, *ends)


def reprocess_block(job: Job, number: int, expected: dict[str, str] | None = None) -> None:
    """Make block ``number`` of a large well by `make_block`; refuse versions other than ``expected``."""
    check_versions(expected)
    with opened(job, ("survey",)) as (run, _):
        archive = f"wells/{job.key}/{job.key}-{number:05}.wall" if "archive" in job.outputs else None
        make_block(run, Store(job.output), _work_folder(job), number, archive)


def merge_well(job: Job, expected: dict[str, str] | None = None) -> Json:
    """Make outputs and record of a large well from its blocks; return the record as `reprocess_well` does."""
    check_versions(expected)
    store = Store(job.output)
    with opened(job, ("survey",)) as (run, _):
        wall, logs, over = merged(run, store, _work_folder(job))
        files, save = _saver(store)
        files |= store.sizes(f"wells/{job.key}")
        zones = _save_tables(job, save, classify(wall, stated_criteria(run.settings, wall), logs), run.settings.header)
        if "mesh" in job.outputs:
            _save_overview(job, save, surface_of(over, run.path, threads=1))
        row = catalogue_row(job.well, run.settings, wall, logs, summarize(wall, zones=zones))
    made_from = read_plan(store, _work_folder(job))["made_from"]
    record = _write_record(job, store, made_from, files, row)
    store.delete(list(store.sizes(_work_folder(job))))
    return record


def _work_folder(job: Job) -> str:
    """Return the folder of a large well's temporary files in the store."""
    return f"work/{job.key}"


def _write_record(job: Job, store: Store, made_from: Json, files: dict[str, int], row: Json) -> Json:
    row = row | _provenance(made_from)
    record = {"well": job.well, "made_from": made_from, "files": dict(sorted(files.items())), "catalogue": row}
    store.write_checked(record_name(job.well), record)
    return record | {"made": True}


def check_versions(expected: dict[str, str] | None) -> None:
    """Raise an InputError if this worker has other versions than the process that started the job.

    ``expected`` are the `versions` of that process; None: any versions.
    """
    for name, wanted in (expected or {}).items():
        if versions()[name] != wanted:
            raise InputError(f"worker: {name} {versions()[name]}", f"must be {wanted}, as in the calling process")


def _made_from(job: Job, files: OpenFiles, local: dict[str, Path]) -> Json:
    """Return what decides the bytes of the outputs: settings, checksums of the input files, versions."""
    inputs = [{"name": file.name, "blake2b": files.checksum(file).result()} for file in local.values()]
    return {"settings": job.settings_hash, "inputs": inputs, "versions": versions()}


def _changes(record: Json, now: Json, store: Store) -> str:
    """Return what differs between a well's record and ``now``, as text; "" if the well need not be made again."""
    before = record["made_from"]
    found = ["its settings"] if before["settings"] != now["settings"] else []
    known = {(of["name"], of["blake2b"]) for of in before["inputs"]}
    found += [of["name"] for of in now["inputs"] if (of["name"], of["blake2b"]) not in known]
    found += [f"{name} {was}" for name, was in before["versions"].items() if now["versions"].get(name) != was]
    if not found and before != now:
        found = ["its input files"]
    return ", ".join(found if store.holds(record["files"]) else [*found, "its outputs"])


def changes(job: Job) -> str | None:
    """Return what has changed since a well was made, such as "its settings, A-1.csv"; "" if nothing has.

    None if the well is not made. All its input files are read, to compute their checksums.
    """
    store = Store(job.output)
    record: Json | None = store.read_checked(record_name(job.well))
    if record is None:
        return None
    files = OpenFiles(())
    with contextlib.ExitStack() as copies:
        try:
            local = {address: copies.enter_context(local_file(address)) for address in job.addresses()}
            return _changes(record, _made_from(job, files, local), store)
        except FileNotFoundError as error:
            return f"{Path(error.filename or str(error)).name} (no such file)"


def _provenance(made_from: Json) -> Json:
    """Return the columns of the catalogue that state what a well was made from."""
    inputs = ", ".join(f"{of['name']} {of['blake2b']}" for of in made_from["inputs"])
    return {"inputs": inputs, "settings_hash": made_from["settings"], **made_from["versions"]}


@contextlib.contextmanager
def opened(job: Job, keys: tuple[str, ...] = FILES) -> Iterator[tuple[Run, dict[str, Path]]]:
    """Yield the run of a job with the files of ``keys`` opened, and the local file for each of their addresses.

    Roles that neither the settings nor a map state are guessed.
    """
    with contextlib.ExitStack() as copies:
        local = {address: copies.enter_context(local_file(address)) for address in job.addresses(keys)}
        tree = job.mapped(lambda address: str(local.get(address, address)))
        run = open_run(project_of(tree, job.well), keys=keys)
        for file in local.values():
            run.files.checksum(file)
        if keys != FILES:
            read_path(run)
        yield run, local


Save = Callable[[str, Callable[[Path], object]], None]


def _saver(store: Store) -> tuple[dict[str, int], Save]:
    """Return a dict and a function; the function writes a file to the store and adds its name and bytes to the dict."""
    files: dict[str, int] = {}

    def save(name: str, write: Callable[[Path], object]) -> None:
        with store.writing(name) as path:
            write(path)
            files[name] = path.stat().st_size

    return files, save


def write_outputs(run: Run, job: Job, store: Store) -> tuple[dict[str, int], Json]:
    """Write the outputs of a job; return the size of each file in bytes, by name, and the row of the catalogue."""
    wall, key = run.wall, job.key
    files, save = _saver(store)
    if "archive" in job.outputs:
        save(f"wells/{key}/{key}.wall", wall.save)
    logs = wall.logs(sigma=wall.settings.sigma)
    zones = _save_tables(job, save, classify(wall, stated_criteria(run.settings, wall), logs), run.settings.header)
    if "mesh" in job.outputs:
        save(f"wells/{key}/{key}.glb", lambda path: wall.surface().save(path))
        coarse = vars(overview_settings(wall.settings))
        _save_overview(job, save, surface_of(wall_of(wall.samples, threads=1, **coarse), wall.path, threads=1))
    return files, catalogue_row(job.well, run.settings, wall, logs, summarize(wall, zones=zones))


def _save_tables(job: Job, save: Save, zones: Classification, stated: dict[str, str]) -> Classification:
    """Write logs and zones of a well, each as a part of the data set of all wells; return the zones."""
    header, key = {**stated, "well": job.well}, job.key
    if "logs" in job.outputs:
        table = zones.logs.table([zones.column()])
        save(f"logs/well={key}/logs-0.parquet", lambda path: save_table(table, path, header=header))
    if "zones" in job.outputs:
        save(f"zones/well={key}/zones-0.parquet", lambda path: save_table(zones.table(), path, header=header))
    return zones


def _save_overview(job: Job, save: Save, surface: Surface) -> None:
    """Write the overview mesh of a well; write none if the well is too short for a quad."""
    if len(surface.quads):
        save(f"wells/{job.key}/{job.key}-overview.glb", surface.save)


NUMBERS = {
    "start": ("TOP", "m", "Start of the wall, measured depth"),
    "stop": ("BOTTOM", "m", "End of the wall, measured depth"),
    "bit_diameter": ("BIT", "m", "Bit diameter"),
    "sectors": ("SECTORS", "", "Vertices a turn"),
    "pitch": ("PITCH", "m", "Depth a turn"),
    "vertices": ("VERTICES", "", "Vertices"),
    "samples": ("SAMPLES", "", "Samples"),
    "mean_diameter": ("DEQ", "m", "Diameter of the cylinder with the volume of the whole turns"),
    "volume": ("VOL", "m3", "Volume of the whole turns"),
    "excess": ("EXCESS", "", "Volume divided by the volume at bit size, minus 1"),
    "whole_turns": ("WHOLE_TURNS", "m", "Length of turns that have every radius, measured or interpolated"),
    "incomplete_turns": ("INCOMPLETE_TURNS", "m", "Length of turns that miss at least one radius"),
    "washed_out": ("WASHED_OUT", "m", "Length of the turns that are washed out"),
    "coverage": ("COVER", "", "Mean share of the turns that is measured, not interpolated"),
    "without_radius": ("WITHOUT_RADIUS", "", "Share of the vertices that no sample reaches"),
    "nearest_half": ("NEAREST_HALF", "m", "50 % quantile of the distance from a vertex to the nearest sample"),
    "nearest_most": ("NEAREST_MOST", "m", "99 % quantile of the distance from a vertex to the nearest sample"),
}
"""Numbers of `WallSummary` in the catalogue: column, unit and description; logs and zones have the same columns."""

COLUMNS = NUMBERS | {
    "diameter_sigma": ("DEQ_SIGMA", "m", "Mean standard uncertainty of DEQ, if sigma was requested"),
    "breakout_length": ("BREAKOUT_LENGTH", "m", "Length of breakouts"),
    "breakout_axis": ("AXIS", "deg", "Mean axis of breakouts"),
    "breakout_deviation": ("AXISDEV", "deg", "Standard deviation of the axes of breakouts"),
}
"""Numbers of a row of the catalogue: column, unit and description."""


def catalogue_row(well: str, settings: Project, wall: Wall | Merged, logs: Logs, summary: WallSummary) -> Json:
    """Return the row of a well as its record keeps it, with the names of `COLUMNS`; None for missing values."""

    def known(value: Any) -> Any:
        return None if isinstance(value, float) and not math.isfinite(value) else value

    numbers = {name: known(getattr(summary, name)) for name in NUMBERS}
    axis, sigma = summary.breakout_axis, logs.diameter_sigma
    return {
        "well": well,
        "basis": summary.basis,
        **numbers,
        "diameter_sigma": float(np.nanmean(sigma)) if np.isfinite(sigma).any() else None,
        "breakout_length": summary.kinds.get("breakout", 0.0),
        "breakout_axis": known(axis.mean),
        "breakout_deviation": known(axis.deviation),
        "warnings": "; ".join(summary.warnings),
        "survey": settings.survey is not None or wall.path is not None,
        "settings": json.dumps(vars(wall.settings), sort_keys=True),
    }
