"""Proofs of many wells on Dask that take minutes: ``python tests/slow/wells.py VERB FOLDER``.

VERB is kill, resume, store, apart or scheduler.

kill    one worker is killed while the cluster starts, and ten at seeded moments while twelve wells, one of them in
        blocks, are made: the same bytes as an undisturbed run
resume  scheduler, workers and client are killed (-9) at seeded moments, five times, and the job is started again: the
        wells with a record are not made again, and the same bytes
store   the same manifest on local files and on moto's S3 server on loopback: the same bytes (needs moto[server], s3fs)
apart   scheduler and workers as processes of their own, each in an empty folder, which share the S3 store alone; a
        worker with another version of helibore is refused by name
scheduler   the scheduler is killed (-9) when two wells are done: exit code 3, a table of what was lost, nothing half
        written; started again without it, the same bytes

FOLDER keeps the field, 50 MB.
"""

from __future__ import annotations

import contextlib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

import psutil

from bench.wells.field import write_field
from helibore.runs.output_store import Store
from helibore.runs.reprocess import connected, reprocess

HEAD = "block_samples = 150000\n"


def content(folder: Path) -> dict[str, bytes]:
    """Return the files below a folder."""
    return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


def undisturbed(folder: Path) -> tuple[Path, dict[str, bytes]]:
    """Make a field of eleven wells in one piece and one in blocks; return its manifest and its outputs."""
    manifest = write_field(folder / "field", 12, 100_000, 0.0006, HEAD)
    from bench.wells.field import write_well

    if (folder / "field/11.parquet").stat().st_size < 10_000_000:
        write_well(folder / "field/11.parquet", 11, 800_000, 0.00015)
    out = folder / "undisturbed"
    if not (out / "catalogue.parquet").exists():
        report = reprocess(manifest, output=str(out))
        assert not report.failed, report.failed
    return manifest, content(out)


def kill(folder: Path) -> None:
    """Ten workers killed at seeded moments."""
    manifest, want = undisturbed(folder)
    shutil.rmtree(folder / "killed", ignore_errors=True)
    moments, killed = random.Random(11), 0
    begun, finished = threading.Event(), threading.Event()

    def workers() -> list[psutil.Process]:
        found = []
        for of in psutil.Process().children():
            with contextlib.suppress(psutil.Error):  # one that has just ended
                found += [of] if "spawn_main" in " ".join(of.cmdline()) else []
        return found

    def first() -> None:
        while not workers():
            time.sleep(0.01)
        workers()[0].kill()

    early = threading.Thread(target=first)
    early.start()
    with connected(None) as client:
        early.join()
        print("a worker was killed while the cluster started")

        def killer() -> None:
            nonlocal killed
            begun.wait()
            while killed < 10 and not finished.wait(moments.uniform(0.05, 0.3)):
                if there := workers():
                    moments.choice(there).kill()
                    killed += 1

        thread = threading.Thread(target=killer)
        thread.start()
        try:
            report = reprocess(manifest, client, output=str(folder / "killed"), progress=lambda _: begun.set())
        finally:
            begun.set()
            finished.set()
            thread.join()
    print(f"{killed} workers killed; {report.sentence()} {report.failed}")
    assert killed == 10, "the wells were made before ten workers were killed"
    assert content(folder / "killed") == want
    print("the same bytes as undisturbed")


def resume(folder: Path) -> None:
    """kill -9 of everything, then again."""
    manifest, want = undisturbed(folder)
    out = folder / "resumed"
    shutil.rmtree(out, ignore_errors=True)
    moments = random.Random(12)
    command = [sys.executable, "-m", "helibore", "reprocess", str(manifest), "-o", str(out)]
    for number in range(20):
        before = len(list(out.glob("records/*.json")))
        with subprocess.Popen(command, start_new_session=True, stdout=subprocess.PIPE, text=True) as process:
            if number < 5:  # once two more wells are done, at any moment of the next
                while process.poll() is None and len(list(out.glob("records/*.json"))) < before + 2:
                    time.sleep(0.01)
                time.sleep(moments.uniform(0.0, 1.0))
                os.killpg(process.pid, signal.SIGKILL)
            code = process.wait()
            print(
                f"start {number + 1}: {len(list(out.glob('records/*.json')))} wells recorded, exit {code}", flush=True
            )
            if process.returncode == 0:
                print(process.stdout.read().strip() if process.stdout else "")
                break
    found = {name: of for name, of in content(out).items() if not name.endswith(".part")}
    assert found == want, sorted(set(found) ^ set(want))
    print("the same bytes as undisturbed")


@contextlib.contextmanager
def s3() -> Iterator[dict[str, str]]:
    """Run moto's S3 server; give the environment that fsspec needs."""
    import socket

    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    server = subprocess.Popen(
        [sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", str(port)],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    given = {"AWS_ACCESS_KEY_ID": "test", "AWS_SECRET_ACCESS_KEY": "test", "AWS_DEFAULT_REGION": "us-east-1"}
    given["FSSPEC_S3_ENDPOINT_URL"] = f"http://127.0.0.1:{port}"
    os.environ |= given
    from fsspec.config import conf, set_conf_env

    set_conf_env(conf)
    try:
        for _ in range(100):
            with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), 1):
                break
            time.sleep(0.2)
        yield given
    finally:
        server.terminate()
        server.wait()


def fill(folder: Path) -> None:
    """Put the field into the bucket."""
    store = Store("s3://field")
    store.system.mkdir("field")
    for file in sorted((folder / "field").iterdir()):
        if file.is_file():
            store.system.put_file(str(file), f"field/{file.name}")


def taken() -> dict[str, bytes]:
    """Return the outputs in the bucket."""
    store = Store("s3://field/out")
    return {name: store.system.cat_file(store.path(name)) for name in store.sizes("")}


def store(folder: Path) -> None:
    """Local files and S3."""
    _, want = undisturbed(folder)
    with s3():
        fill(folder)
        print(reprocess("s3://field/manifest.toml").sentence())
        found = taken()
    assert found == want, sorted(set(found) ^ set(want))
    print(f"{len(want)} files, the same bytes on local files and on S3")


def apart(folder: Path) -> None:
    """A scheduler and workers of their own."""
    _, want = undisturbed(folder)
    environment = {name: os.environ[name] for name in ("PATH", "PYTHONPATH") if name in os.environ}
    with s3() as given, tempfile.TemporaryDirectory() as text:
        empty, running = Path(text), []
        fill(folder)
        file = empty / "scheduler.json"
        try:
            for name in ("scheduler", "worker", "worker"):
                place = Path(tempfile.mkdtemp(dir=empty))
                options = ["--scheduler-file", str(file), "--no-dashboard"]
                options += ["--nthreads", "1", "--no-nanny"] if name == "worker" else ["--port", "0"]
                own = environment | given | {"HOME": str(place)}
                running.append(subprocess.Popen(
                    [sys.executable, "-m", "dask", name, *options], cwd=place, env=own, stderr=subprocess.DEVNULL,
                ))  # fmt: skip
                while not file.exists():
                    time.sleep(0.1)
            address = json.loads(file.read_text())["address"]
            command = [sys.executable, "-m", "helibore", "reprocess", "s3://field/manifest.toml"]
            for _ in range(100):  # until both workers are there
                with connected(address) as client:
                    if len(client.scheduler_info()["workers"]) == 2:
                        break
                time.sleep(0.2)
            done = subprocess.run([*command, "--insecure-scheduler", "--scheduler", address],
                                  env=environment | given, check=False,
                                  capture_output=True, text=True, cwd=empty)  # fmt: skip
            print(done.stdout.strip(), done.stderr.strip().splitlines()[-1:], done.returncode)
            found = taken()
        finally:
            for process in running:
                process.terminate()
            for process in running:
                process.wait()
    assert found == want, sorted(set(found) ^ set(want))
    print("the same bytes by a scheduler and two workers that share the store alone")


def scheduler(folder: Path) -> None:
    """The scheduler is lost."""
    manifest, want = undisturbed(folder)
    out = folder / "lost"
    shutil.rmtree(out, ignore_errors=True)
    with tempfile.TemporaryDirectory() as text:
        file, running = Path(text) / "scheduler.json", []
        try:
            for name in ("scheduler", "worker"):
                options = ["--scheduler-file", str(file), "--no-dashboard"]
                options += ["--nthreads", "1", "--no-nanny"] if name == "worker" else ["--port", "0"]
                running.append(subprocess.Popen(
                    [sys.executable, "-m", "dask", name, *options], cwd=text, stderr=subprocess.DEVNULL,
                ))  # fmt: skip
                while not file.exists():
                    time.sleep(0.1)
            command = [sys.executable, "-m", "helibore", "reprocess", str(manifest), "-o", str(out)]
            address = json.loads(file.read_text())["address"]
            with subprocess.Popen(
                [*command, "--insecure-scheduler", "--scheduler", address],
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
            ) as process:
                while process.poll() is None and len(list(out.glob("records/*.json"))) < 2:
                    time.sleep(0.01)
                running[0].kill()
                lost = time.perf_counter()
                output = process.communicate(timeout=120)
                print(f"ended {time.perf_counter() - lost:.0f} s later, exit {process.returncode}")
        finally:
            for one in running:
                one.kill()
                one.wait()
    rows = [line for line in output[1].splitlines() if line.endswith(": the scheduler was lost")]
    print(output[0].strip(), "|", len(rows), "rows of the table, such as", rows[:1])
    assert process.returncode == 3
    assert rows
    assert json.loads((out / "failures.json").read_text())
    assert subprocess.run(command, check=False, capture_output=True).returncode == 0
    assert {name: of for name, of in content(out).items() if not name.endswith(".part")} == want
    print("started again without it: the same bytes as undisturbed")


if __name__ == "__main__":
    work = {"scheduler": scheduler, "kill": kill, "resume": resume, "store": store, "apart": apart}[sys.argv[1]]
    work(Path(sys.argv[2]).resolve())
