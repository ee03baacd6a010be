"""What a rig's machine can lose, taken away from a running ``helibore live``: ``python tests/slow/resources.py``.

    sender --20 frames/s--> helibore live --view --metrics-port <--- metrics, page (a websocket), stderr: who, when

Descriptors, memory, disk (a tmpfs, needs root), folder and lock file are taken away and given back, and each thread is
killed. For each: the seconds until the alarm is on stderr, in the metrics and on the page (the bar is 2 s), whether it
ends when the resource is back, and whether every byte that was sent is in the journal, with the wall of a replay.
"""

from __future__ import annotations

import contextlib
import os
import re
import resource
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "python"))

from live_servers import configured, frames, free_port, payloads
from websockets.sync.client import connect

from helibore import Live

COMMAND = """
import ctypes, faulthandler, signal, sys, threading
from helibore.cli import cli
faulthandler.register(signal.SIGUSR1)

def obey():
    for line in sys.stdin:
        for thread in threading.enumerate():
            if thread.name == line.strip():
                error = SystemExit if "view-server" in thread.name else RuntimeError  # asyncio catches the others
                ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread.ident), ctypes.py_object(error))

threading.Thread(target=obey, daemon=True).start()
cli(sys.argv[1:])
"""
SETTINGS = '[alarms]\nlost = 1.0\ndisk_gb = 0.0\ncommand = ["true"]\n'
THREADS = ("mwd", "draw", "sync", "watch", "checkpoint", "alarms", "log", "metrics", "helibore-view-server",
           "helibore-view-feed", "helibore-view-zones")  # fmt: skip
WITHOUT = {"log": "stderr", "metrics": "metrics", "helibore-view-server": "page"}
"""What the death of a thread takes away; the command still says so on stderr when it ends."""


class Rig:
    """A running command and its sender; ``seen`` has the time at which a text first came, by where it came."""

    def __init__(self, folder: Path, count: int = 200_000) -> None:
        self.folder, self.port, self.page_port, self.metrics_port = folder, free_port(), free_port(), free_port()
        (folder / "rig.toml").write_text(configured(f"listen://127.0.0.1:{self.port}") + SETTINGS)
        self.frames, self.sent, self.burst, self.noise = frames(count), 0, 1, b""
        self.texts: dict[str, list[tuple[float, str]]] = {"stderr": [], "metrics": [], "page": []}
        self.stopping = threading.Event()

    def start(self) -> None:
        arguments = ["live", "rig.toml", "--journal", "disk/j", "-q", "--view", "--view-port", str(self.page_port),
                     "--metrics-port", str(self.metrics_port), "--token", "s3"]  # fmt: skip
        self.process = subprocess.Popen(
            [sys.executable, "-c", COMMAND, *arguments], cwd=self.folder, stdin=subprocess.PIPE,
            stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True, env={**os.environ, "MALLOC_ARENA_MAX": "1"},
        )  # fmt: skip
        for read in (self._stderr, self._metrics, self._page, self._send):
            threading.Thread(target=read, daemon=True).start()
        self.wait(lambda: self.drawn() >= self.sent > 20, 120)

    def _stderr(self) -> None:
        for line in self.process.stderr:
            self.texts["stderr"].append((time.monotonic(), line))

    def _metrics(self) -> None:
        while not self.stopping.wait(0.05):
            with (
                contextlib.suppress(OSError),
                urllib.request.urlopen(f"http://127.0.0.1:{self.metrics_port}/metrics?token=s3", timeout=5) as answer,
            ):
                self.texts["metrics"].append((time.monotonic(), answer.read().decode()))

    def _page(self) -> None:
        while not self.stopping.wait(0.05):
            with contextlib.suppress(Exception), connect(f"ws://127.0.0.1:{self.page_port}/ws?token=s3") as page:
                for message in page:
                    if isinstance(message, str):
                        self.texts["page"].append((time.monotonic(), message))

    def _send(self) -> None:
        while not self.stopping.is_set():
            with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", self.port)) as link:
                while not self.stopping.wait(0.05):
                    count, self.burst = self.burst, 1
                    link.sendall(b"".join(self.frames[self.sent : self.sent + count]) + self.noise)
                    self.sent += count

    def drawn(self) -> int:
        found = re.findall(r"^helibore_samples_drawn_total (\d+)", self.latest("metrics"), re.MULTILINE)
        return int(found[0]) if found else 0

    def latest(self, where: str) -> str:
        return self.texts[where][-1][1] if self.texts[where] else ""

    def wait(self, condition, seconds: float = 30.0) -> float:
        """Wait until ``condition``; return the seconds."""
        began = time.monotonic()
        while not condition():
            if time.monotonic() > began + seconds:
                raise AssertionError("\n".join(text for _, text in self.texts["stderr"][-20:]))
            time.sleep(0.01)
        return time.monotonic() - began

    def delay(self, where: str, pattern: str, since: float) -> float | None:
        """Return the seconds from ``since`` to the first text that matches, None if none does."""
        return next((at - since for at, text in list(self.texts[where]) if at >= since and re.search(pattern, text)),
                    None)  # fmt: skip

    def delays(self, rule: str, since: float) -> dict[str, float | None]:
        """Return when an alarm was on stderr, in the metrics and on the page, as seconds."""
        patterns = {"stderr": rf"alarm_{rule}:", "metrics": rf'alarm_active{{alarm="{rule}",source="\w*"}} 1.0',
                    "page": rf'"{rule.replace("_", " ")}[^"]*: '}  # fmt: skip
        found = lambda: {where: self.delay(where, pattern, since) for where, pattern in patterns.items()}  # noqa: E731
        end = time.monotonic() + 10
        while None in found().values() and time.monotonic() < end and self.process.poll() is None:
            time.sleep(0.05)
        time.sleep(0.2)  # what was received last
        return found()

    def ended(self, rule: str, since: float) -> float:
        """Return the seconds from ``since`` until the alarm had ended in the metrics."""
        pattern = rf'alarm_active{{alarm="{rule}",source="\w*"}} 0.0'
        return self.wait(lambda: self.delay("metrics", pattern, since) is not None) and self.delay(
            "metrics", pattern, since
        )

    def stop(self) -> int:
        """Stop the sender, then the command; return its exit code."""
        self.stopping.set()
        if self.process.poll() is None:
            time.sleep(0.5)
            self.process.send_signal(signal.SIGTERM)
        return self.end(60)

    def end(self, seconds: float) -> int:
        """Return the exit code; if the command does not end, print where its threads are."""
        try:
            return self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            self.process.send_signal(signal.SIGUSR1)
            time.sleep(2)
            raise AssertionError("".join(text for _, text in self.texts["stderr"][-200:])) from None

    def check(self) -> str:
        """Compare the journal with what was sent, and a restart with a replay; return a sentence."""
        stored = b"".join(payloads(self.folder / "disk/j")).count(b"!!")
        drawn = Live.replay(self.folder / "disk/j").wall.sample_count
        assert drawn == stored, f"{stored} frames in the journal, {drawn} drawn by a replay"
        return f"{self.sent} frames sent, {stored} in the journal"


def shown(delays: dict[str, float | None]) -> str:
    return ", ".join(f"{where} {'-' if at is None else f'{at:.2f} s'}" for where, at in delays.items())


def descriptors(rig: Rig):
    before = resource.prlimit(rig.process.pid, resource.RLIMIT_NOFILE)
    used = {int(path.name) for path in Path(f"/proc/{rig.process.pid}/fd").iterdir()}
    resource.prlimit(rig.process.pid, resource.RLIMIT_NOFILE, (min(set(range(len(used) + 1)) - used), before[1]))
    return "descriptors", lambda: resource.prlimit(rig.process.pid, resource.RLIMIT_NOFILE, before)


def disk(rig: Rig):
    room = rig.folder / "disk" / "other"
    with contextlib.suppress(OSError), room.open("wb", 0) as file:
        while file.write(bytes(4096)):
            pass
    return "disk", room.unlink


def folder(rig: Rig):
    (rig.folder / "disk/j").rename(rig.folder / "disk/k")
    return "journal", lambda: (rig.folder / "disk/k").rename(rig.folder / "disk/j")


def lock(rig: Rig):
    (rig.folder / "disk/j/lock").rename(rig.folder / "disk/lock")
    return "journal", lambda: (rig.folder / "disk/lock").rename(rig.folder / "disk/j/lock")


def memory(rig: Rig):
    before = resource.prlimit(rig.process.pid, resource.RLIMIT_AS)
    size = int(Path(f"/proc/{rig.process.pid}/statm").read_text().split()[0]) * resource.getpagesize()
    resource.prlimit(rig.process.pid, resource.RLIMIT_AS, (size, before[1]))
    rig.burst = 100_000
    return "(memory|failure)", lambda: resource.prlimit(rig.process.pid, resource.RLIMIT_AS, before)


@contextlib.contextmanager
def rig(disk_mb: int = 0) -> Iterator[Rig]:
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "disk").mkdir()
        if disk_mb:
            subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={disk_mb}m", "tmpfs", f"{name}/disk"], check=True)
        running = Rig(Path(name))
        try:
            running.start()
            yield running
        finally:
            running.stopping.set()
            running.process.kill()
            running.process.wait()
            if disk_mb:
                subprocess.run(["umount", "-l", f"{name}/disk"], check=True)


def main() -> None:
    late = []
    chosen = sys.argv[1:]
    for take in (descriptors, disk, folder, lock, memory):
        if chosen and take.__name__ not in chosen:
            continue
        with rig(8 if take is disk else 0) as running:
            since = time.monotonic()
            rule, give_back = take(running)
            delays = running.delays(rule, since)
            back = time.monotonic()
            give_back()
            if running.process.poll() is None and rule != "(memory|failure)":
                end = f"ended {running.ended(rule, back):.2f} s after"
            else:
                end = "lasts to the end of the process"
            sent = running.sent
            with contextlib.suppress(AssertionError):
                running.wait(lambda sent=sent: running.drawn() > sent, 10)
            code = running.stop()
            print(f"{take.__name__}: {shown(delays)}; {end}; exit {code}; {running.check()}", flush=True)
        late += [take.__name__] if any(at is None or at > 2 for at in delays.values()) else []
    for thread in THREADS:
        if chosen and thread not in chosen:
            continue
        with rig() as running:
            since = time.monotonic()
            running.process.stdin.write(f"{thread}\n")
            running.process.stdin.flush()
            running.noise = b"noise\r\n"  # a warning: it wakes the thread of the log
            delays = running.delays("failure", since)
            code = running.end(60)
            took = time.monotonic() - since
            if thread == "log":
                delays["stderr"] = running.delay("stderr", "it ended", since)
            expected = {where: at for where, at in delays.items() if where != WITHOUT.get(thread)}
            print(f"thread {thread}: {shown(delays)}; exit {code} after {took:.1f} s; {running.check()}", flush=True)
            assert code not in (0, -signal.SIGKILL)
        late += [thread] if any(at is None or at > 2 for at in expected.values()) else []
    print(f"later than 2 s: {', '.join(late) or 'none'}")


if __name__ == "__main__":
    main()
