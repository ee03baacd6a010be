"""Reprocess many wells on Dask: `hb.reprocess`. helibore defines the tasks, Dask runs them.

    manifest --read_jobs--> jobs --one task a well--> records --> one catalogue

The scheduler holds names and records only; no wall and no samples are sent to it. If a well fails, it is reported with
the reason, and the other wells finish. A second run makes only the wells that are incomplete or out of date. Without a
scheduler the wells run on this machine, with one worker per processor and one core thread in each worker.
"""

from __future__ import annotations

import contextlib
import logging
import tempfile
import time
import uuid
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple
from urllib.parse import unquote

from helibore.base.addresses import file_name, without_secrets
from helibore.base.atomic_file import write_whole
from helibore.base.errors import InputError, MissingExtraError, needs
from helibore.base.thread_count import thread_count
from helibore.files.log_writing import write_parquet
from helibore.files.reading import check_library, ending_of
from helibore.runs import fault_notes
from helibore.runs.main_guard import check_main_guard
from helibore.runs.manifest import Job, check_files, read_jobs
from helibore.runs.output_store import Json, Store
from helibore.runs.preflight import refused_wells
from helibore.runs.well import (
    COLUMNS,
    changes,
    check_versions,
    merge_well,
    record_name,
    reprocess_block,
    reprocess_well,
    versions,
)

if TYPE_CHECKING:
    from distributed import Client

CATALOGUE, FAILURES = "catalogue.parquet", "failures.json"
DEATHS = 30
"""Dask fails a task if more workers than this die that had been given it. Most of these had not begun the task; the
notes of `fault_notes` say which had. Dask's default, 3, can fail a good task."""
QUIET = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "500ms",
    "distributed.admin.system-monitor.interval": "2s",
    "distributed.nanny.pre-spawn-environ": dict.fromkeys(
        ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MALLOC_ARENA_MAX"), 1
    ),
}
"""Dask settings for local workers; Dask's default self-monitoring takes a large share of the time of a small well.

Its environment of workers also makes glibc return memory at once: 80,000 page faults a well of 0.5 M samples. One arena
holds the memory of the thread that works; a process by itself has 5,000 faults.
"""
SILENT: dict[str, list[str]] = {"distributed.scheduler.http.routes": [], "distributed.worker.http.routes": []}
"""Dask settings without a dashboard: the HTTP servers that Dask starts in any case answer every request with 404."""
IGNORE_CTRL_C = ["helibore.runs.ignore_ctrl_c"]
"""Modules that each worker of this machine loads."""
TRIES = 3
"""Most attempts at a task or at the start of a cluster: a store may not answer, or a worker may be killed."""


@dataclass
class Progress:
    """The progress of `reprocess`, its result, and the result of `status`."""

    wells: int
    done: list[str] = field(default_factory=list)  # wells made now
    skipped: list[str] = field(default_factory=list)  # wells made earlier, from the same inputs and settings
    failed: dict[str, str] = field(default_factory=dict)  # by well: why it failed
    warnings: dict[str, str] = field(default_factory=dict)  # by well: the warnings on its wall
    unwritten: dict[str, str] = field(default_factory=dict)  # by file (catalogue, failures): why it is not written
    seconds: float = 0.0
    dashboard: str | None = None  # address of Dask's dashboard, if it is asked for
    outdated: dict[str, str] = field(default_factory=dict)  # `status`, by well: what changed since it was made
    orphans: list[str] = field(default_factory=list)  # wells of the output that the manifest does not name

    @property
    def finished(self) -> int:
        """Number of wells that are done, skipped or failed."""
        return len(self.done) + len(self.skipped) + len(self.failed)

    @property
    def unmade(self) -> int:
        """Number of wells that are neither finished nor out of date."""
        return self.wells - self.finished - len(self.outdated)

    @property
    def seconds_left(self) -> float:
        """Seconds left, estimated from the wells made up to now; infinite before the first well is made."""
        made = len(self.done) + len(self.failed)
        return self.seconds / made * (self.wells - self.finished) if made else float("inf")

    def sentence(self) -> str:
        """Return one line: how many wells were made now, had been made before, and failed."""
        counts = f"{len(self.done)} made, {len(self.skipped)} there already, {len(self.failed)} failed"
        return f"{counts}, of {self.wells} wells in {self.seconds:.1f} s"


def reprocess(
    jobs: str | Path | Sequence[Job],
    client: Client | str | None = None,
    *,
    output: str | None = None,
    workers: int | None = None,
    insecure: bool = False,
    dashboard: bool = False,
    progress: Callable[[Progress], object] | None = None,
) -> Progress:
    """Rebuild the walls of many wells, with their archives, meshes, logs, zones and one catalogue.

    Parameters
    ----------
    jobs
        A manifest (TOML) or a catalogue (Parquet), or the jobs that `read_jobs` made of it.
    client
        A Dask client, or the address of a scheduler, ``tls://host:8786``, with the certificates that Dask's
        configuration names; None: a cluster on this machine, one worker for each processor, behind certificates that
        are made for it and exist only in its memory.
    output
        Folder of the results at any fsspec address, in place of the folder that the manifest or the jobs state.
    workers
        Without a client: how many processes work on this machine; None: one for each processor.
    insecure
        Allow the address of a scheduler without TLS. Whoever reaches its port can run code here and on its workers.
    dashboard
        Without a client: serve Dask's dashboard on this machine, without a password: each user of the machine can
        read it.
    progress
        Called at the start and after each well.

    Returns
    -------
    Progress
        The wells made now, made before, and failed with their reasons; wells in the output that the manifest does not
        name; and whether the catalogue could not be written.

    Raises
    ------
    InputError
        Raised before any work, on: a manifest that breaks a rule (the error names well, key and rule); a missing file;
        an output that cannot be written; a worker with other versions of helibore, NumPy or pyarrow, or without a
        library that a file needs; the address of a scheduler without TLS, unless ``insecure``; a script without
        ``if __name__ == "__main__":``, if ``client`` is None.
    MissingExtraError
        If the extra ``scale`` is not installed.

    Examples
    --------
    >>> hb.reprocess("manifest.toml").failed                    # doctest: +SKIP
    {'A-7': 'A-7.parquet: truncated or damaged Parquet'}
    """
    if isinstance(jobs, str | Path):
        jobs = read_jobs(jobs, output)
    else:
        jobs = [replace(job, output=output or job.output) for job in jobs]
    if not jobs:
        raise InputError("jobs", "must contain at least one job")
    if client is None:
        check_main_guard("hb.reprocess")
    elif isinstance(client, str):
        check_encrypted(client, insecure)
    check_files(jobs)
    store = Store(jobs[0].output)
    store.check_writable()
    records: dict[str, Json] = {}
    refused = refused_wells(jobs)
    if len(refused) == len(jobs):
        so_far = Progress(len(jobs), failed=refused)
    else:
        with connected(client, workers, dashboard=dashboard) as cluster:
            _check_workers(cluster, jobs)
            so_far = _run(cluster, jobs, records, progress or (lambda _: None), dashboard, refused)
    try:
        name = CATALOGUE
        _write_catalogue(store, records)
        name = FAILURES
        if so_far.failed:
            store.write_json(FAILURES, so_far.failed)
        else:
            store.delete([FAILURES])
    except OSError as error:
        so_far.unwritten[name] = _reason(error)
    so_far.orphans = _orphans(store, jobs)
    return so_far


def check_encrypted(address: str, insecure: bool) -> None:
    """Refuse the address of a scheduler that takes tasks from everyone who reaches it, unless ``insecure``."""
    if not insecure and not address.startswith(("tls://", "wss://", "inproc://")):
        rule = "must be tls://HOST:PORT: without TLS, whoever reaches the port can run code on this machine and on all "
        rule += "workers; insecure=True allows it"
        raise InputError("scheduler", rule, address, setting="insecure_scheduler")


@contextlib.contextmanager
def connected(client: Client | str | None, workers: int | None = None, *, dashboard: bool = False) -> Iterator[Any]:
    """Yield ``client``, or a new Dask client of the scheduler at an address or of a cluster on this machine."""
    with needs("", "scale"):
        import cryptography  # noqa: F401
        import dask
        import pyarrow  # noqa: F401
        from distributed import Client, LocalCluster, Security
    if isinstance(client, str):
        try:
            made = Client(client)
        except OSError as error:
            raise InputError(client, f"no scheduler answers: {error}") from None
        with made:
            yield made
    elif client is not None:
        yield client
    else:
        count = thread_count(workers, "workers")
        local = {
            "n_workers": count,
            "threads_per_worker": 1,
            "dashboard_address": "127.0.0.1:0" if dashboard else None,
            "scheduler_kwargs": {} if dashboard else {"dashboard_address": "127.0.0.1:0"},
            "preload": IGNORE_CTRL_C,
            "silence_logs": logging.CRITICAL,  # the progress has each fault; a worker that is stopped logs tracebacks
            "security": Security.temporary(),
        }
        with tempfile.TemporaryDirectory(prefix="helibore-") as notes:
            own = {"distributed.scheduler.allowed-failures": DEATHS, fault_notes.FOLDER: notes, **QUIET}
            with (
                dask.config.set(own if dashboard else own | SILENT),
                _start_cluster(lambda: LocalCluster(**local)) as cluster,
                Client(cluster) as made,
            ):
                cluster.adapt(minimum=count, maximum=count)  # replaces workers that were lost
                yield made


def _start_cluster(start: Callable[[], Any]) -> Any:
    """Return the cluster that ``start`` makes; repeat if a worker dies early, because Dask then ends the cluster."""
    for _ in range(TRIES - 1):
        with contextlib.suppress(RuntimeError):
            return start()
    return start()


def status(jobs: Sequence[Job]) -> Progress:
    """Return which wells need no work (``skipped``), have ``failed``, or are ``outdated``; no other well is made yet.

    The input files of the wells that are made are read, to compute their checksums.
    """
    store = Store(jobs[0].output)
    failed = store.read_json(FAILURES) or {}
    found = Progress(len(jobs), failed={job.well: failed[job.well] for job in jobs if job.well in failed})
    others = [job for job in jobs if job.well not in found.failed]
    with ThreadPoolExecutor() as pool:
        for job, changed in zip(others, pool.map(changes, others), strict=True):
            if changed:
                found.outdated[job.well] = changed
            elif changed is not None:
                found.skipped.append(job.well)
    found.orphans = _orphans(store, jobs)
    return found


def _orphans(store: Store, jobs: Sequence[Job]) -> list[str]:
    """Return the names of the wells that have a record in the store but are not among the jobs."""
    known = {record_name(job.well) for job in jobs}
    records = (name for name in store.sizes("records") if name.endswith(".json") and name not in known)
    return sorted(unquote(name.removeprefix("records/").removesuffix(".json")) for name in records)


def _check_workers(client: Any, jobs: Sequence[Job]) -> None:
    """Refuse workers with other versions, or without a library that a file needs; the error names one such worker.

    A worker that joins later, with other versions, refuses its first task.
    """
    files: dict[str, str] = {}  # by ending: the first file with this ending
    for job in jobs:
        for address in job.addresses():
            files.setdefault(ending_of(file_name(address)), f"well {job.well}: {file_name(address)}")
    for worker, reason in client.run(_refusal, versions(), files, on_error="return").items():
        if reason and not isinstance(reason, OSError):  # an OSError: the worker has just died
            raise InputError(f"worker {worker}", str(reason))


def _refusal(expected: dict[str, str], files: dict[str, str]) -> str:
    """Return why this worker cannot do the job, or "". The error is not raised, since Dask would print a traceback."""
    try:
        check_versions(expected)
    except InputError as error:
        return str(error)
    for ending, file in files.items():
        try:
            check_library(ending)
        except MissingExtraError as error:
            return f"{file}: {error}"
    return ""


def _run(
    client: Any,
    jobs: Sequence[Job],
    records: dict[str, Json],
    tell: Callable[[Progress], object],
    dashboard: bool,
    refused: dict[str, str],
) -> Progress:
    """Run a task for each well; for a large well, also one for each block and one to merge; fill ``records`` by well.

    The ``refused`` wells have failed already. ``tell`` is called with the progress at the start and after each well.
    """
    from distributed import CancelledError, KilledWorker, as_completed

    begin, so_far = time.perf_counter(), Progress(len(jobs), failed=dict(refused))
    so_far.dashboard = client.dashboard_link if dashboard else None
    tell(so_far)
    waiting: dict[Any, _Task] = {}
    blocks: dict[str, int] = {}  # by large well: the number of its blocks that are not made yet

    def submit(task: _Task) -> Any:
        key = f"{task.make.__name__}-{uuid.uuid4().hex}"
        future = client.submit(_attempt, key, task.make, task.job, *task.more, versions(), key=key, pure=False)
        waiting[future] = task
        return future

    def finish(job: Job, reason: str | None, record: Json | None = None) -> None:
        if reason is not None:
            so_far.failed[job.well] = reason
        elif record is not None:
            records[job.well] = record
            if text := record["catalogue"]["warnings"]:
                so_far.warnings[job.well] = text
            (so_far.done if record.pop("made") else so_far.skipped).append(job.well)
        so_far.seconds = time.perf_counter() - begin
        tell(so_far)

    finished = as_completed([submit(_Task(reprocess_well, job)) for job in jobs if job.well not in refused])
    for future in finished:
        task = waiting.pop(future)
        job = task.job
        if job.well in so_far.failed:  # another block of this well has failed
            continue
        try:
            error = future.exception()
            made = {} if error is not None else future.result()
        except (CancelledError, OSError):  # an error of the task itself is in `error`
            finish(job, "the scheduler was lost")
            continue
        if error is not None and task.tries < TRIES and not isinstance(error, KilledWorker):
            finished.add(submit(task._replace(tries=task.tries + 1)))
        elif error is not None:
            finish(job, _reason(error))
        elif "failed" in made:
            finish(job, made["failed"])
        elif task.make is reprocess_block:
            blocks[job.well] -= 1
            if not blocks[job.well]:
                finished.add(submit(_Task(merge_well, job)))
        elif "blocks" in made:
            blocks[job.well] = made["blocks"]
            finished.update([submit(_Task(reprocess_block, job, (number,))) for number in range(made["blocks"])])
        else:
            finish(job, None, made)
    return so_far


class _Task(NamedTuple):
    """A call of ``make`` with a well and ``more`` arguments, as a task for a worker; ``tries`` counts its attempts."""

    make: Callable[..., Any]
    job: Job
    more: tuple[int, ...] = ()
    tries: int = 1


def _attempt(name: str, make: Callable[..., Json | None], job: Job, *more: Any) -> Json:
    """Return the result of a task; errors of the input are returned as "failed", as Dask would print a traceback."""
    try:
        with fault_notes.noted(name, TRIES):
            return make(job, *more) or {}
    except (InputError, MissingExtraError, FileNotFoundError) as error:
        return {"failed": _reason(error)}


def _reason(error: BaseException) -> str:
    """Return an error in one line; unless the input caused it, the line begins with the type of the error."""
    text = without_secrets(" ".join(str(error).split()))
    return text if isinstance(error, InputError | OSError) else f"{type(error).__name__}: {text}"


def _write_catalogue(store: Store, records: dict[str, Json]) -> None:
    """Write the catalogue: the rows of all records in the store, also of earlier runs, sorted by well.

    Records of earlier runs are added to ``records``. Without rows, no file is written.
    """
    known = {record_name(well) for well in records}
    earlier = [
        store.read_checked(name) for name in store.sizes("records") if name.endswith(".json") and name not in known
    ]
    records |= {record["well"]: record for record in earlier if record is not None}
    rows = [records[well]["catalogue"] for well in sorted(records)]
    if rows:
        import pyarrow

        table = pyarrow.Table.from_pylist(rows)
        fields = []
        for of in table.schema:
            name, unit, description = COLUMNS.get(of.name, (of.name, "", ""))
            kind = pyarrow.float64() if pyarrow.types.is_null(of.type) else of.type  # no row has a value
            fields.append(pyarrow.field(name, kind, metadata={"unit": unit, "description": description}))
        table = table.rename_columns([of.name for of in fields]).cast(pyarrow.schema(fields))
        with store.writing(CATALOGUE) as path:
            write_whole(path, lambda file: write_parquet(table, file))
