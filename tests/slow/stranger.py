"""Another user of the machine, without a secret, at every socket: ``python tests/slow/stranger.py``, run as root.

    helibore view, live --view --metrics-port, reprocess (a local cluster), a notebook's widget
        '--all listening sockets and files of these processes--> probes that run as another user

The other user is made with useradd, and removed at the end (``--user NAME`` names one that exists). A probe sends
requests without the token, with guesses, TLS without a certificate and the handshake of Dask in the clear, and reads
all that comes. The proof fails if a probe gets more than a refusal; if the list of processes, a file of the address,
the environment, a log or the journal shows the token to that user; or if a pick was changed. The port of a WITS
listener is left out: WITS has no password, and `allow` says who may send.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import pwd
import re
import signal
import socket
import ssl
import subprocess
import sys
import tempfile
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT / "tests" / "python")]

from live_servers import configured, frames, free_port, until  # noqa: E402

import helibore as hb  # noqa: E402

TOKEN = "token-of-the-proof-9f31"
HELIBORE = [sys.executable, "-m", "helibore"]
SCRIPT = """
import threading, time
from helibore.runs.reprocess import connected
if __name__ == "__main__":
    with connected(None, 2) as client:
        client.run(time.time)
        print("ready", flush=True)
        time.sleep(600)
"""
WIDGET = """
import sys, time
import helibore as hb
viewer = hb.view(hb.load(sys.argv[1]), inline=True)
print("ready", flush=True)
time.sleep(600)
"""
REFUSALS = (b"403", b"404", b"400", b"501", b"505", b"414", b"431")
PATHS = (
    "/", "/app.js", "/healthz", "/metrics", "/api/vertex/1", "/api/picks.csv", "/api/pick?key=1",
    "/api/print.pdf?start=1&stop=2", "/status", "/info/main/workers.html", "/json/counts.json", "/health",
)  # fmt: skip
GUESSES = ("", "Authorization: Bearer \r\n", "Authorization: Bearer x\r\nContent-Length: 2\r\n", "Origin: null\r\n")
REQUESTS = [
    f"{method} {path} HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n{more}\r\n".encode()
    for method in ("GET", "PUT", "POST", "DELETE")
    for path in PATHS
    for more in GUESSES
]
BROWSER = f"{sys.executable} -c 'import time; time.sleep(60)' %s &"
DASK = bytes.fromhex("0100000000000000" + "20" + "00" * 7) + b"\x81\xa2op\xa8identity" + b"\0" * 19


def as_user(user: pwd.struct_passwd, run: Callable[[], list[str]]) -> list[str]:
    """Run a function in a child process of another user, and return its lines."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.setgroups([])
            os.setgid(user.pw_gid)
            os.setuid(user.pw_uid)
            text = "\n".join(run())
        except BaseException:
            text = "the probe failed: " + traceback.format_exc()
        os.write(writing, text.encode())
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        lines = pipe.read().decode().splitlines()
    os.waitpid(child, 0)
    return lines


def received(port: int, sent: bytes, tls: bool = False) -> bytes:
    """Return what a port of this machine answers."""
    got = b""
    with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), timeout=10) as plain:
        link: socket.socket = plain
        if tls:
            context = ssl.create_default_context()
            context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
            link = context.wrap_socket(plain)
        link.sendall(sent)
        link.settimeout(3)
        while piece := link.recv(65536):
            got += piece
    return got


def knocked(port: int) -> list[str]:
    """Return what a port gives to who has no secret, beyond a refusal."""
    found = []
    with ThreadPoolExecutor(16) as pool:
        answers = list(pool.map(lambda request: received(port, request), REQUESTS))
    for request, got in zip(REQUESTS, answers, strict=True):
        status = got.split(b" ")[1:2]
        if got and not (got.startswith(b"HTTP/1") and status[0] in REFUSALS):
            found.append(f"port {port}: {request[:40]!r} got {got[:80]!r}")
        if any(word in got for word in (b"helibore_", b"vertices", b"<canvas", b"%PDF", TOKEN.encode())):
            found.append(f"port {port}: {request[:40]!r} got something of the wall: {got[:80]!r}")
    for name, sent, tls in (("Dask", DASK, False), ("TLS", DASK, True), ("nothing", b"", False)):
        got = received(port, sent, tls)
        if b"identity" in got or b"Scheduler" in got or b"workers" in got:
            found.append(f"port {port}: {name} got {got[:80]!r}")
    return found


def family(process: int) -> list[int]:
    """Return the number of a process and of all that it started."""
    text = Path(f"/proc/{process}/task/{process}/children").read_text().split()
    return [process, *(number for child in text for number in family(int(child)))]


def ports_of(process: int) -> set[int]:
    """Return the TCP ports on which a process, or one that it started, listens."""
    listed = subprocess.run(["ss", "-ltnpH"], capture_output=True, text=True, check=True).stdout
    numbers = {f"pid={number}," for number in family(process)}
    lines = [line for line in listed.splitlines() if any(number in line for number in numbers)]
    return {int(line.split()[3].rpartition(":")[2]) for line in lines}


def seen(process: int, file: str) -> list[str]:
    """Return where the other user sees the token: in the list of processes, the environment, a file."""
    found = []
    listed = subprocess.run(["ps", "auxwwe"], capture_output=True, text=True, check=True).stdout
    found += [f"ps shows {line}" for line in listed.splitlines() if TOKEN in line]
    for path in [f"/proc/{number}/environ" for number in family(process)] + ([file] if file else []):
        with contextlib.suppress(OSError):
            found += [f"{path} can be read"] if Path(path).read_bytes() else []
    return found


@contextlib.contextmanager
def started(command: list[str], folder: Path, ready: str) -> Iterator[subprocess.Popen[str]]:
    """Start a command; yield it when it has printed ``ready``."""
    variables = {**os.environ, "HELIBORE_TOKEN": TOKEN, "BROWSER": BROWSER}
    with (folder / "stderr.txt").open("a") as stderr:
        process = subprocess.Popen(command, cwd=folder, env=variables, stdout=subprocess.PIPE, stderr=stderr, text=True)
    lines: list[str] = []
    threading.Thread(target=lambda: lines.extend(process.stdout or ()), daemon=True).start()
    try:
        until(lambda: any(ready in line for line in lines) or process.poll() is not None, 120)
        assert process.poll() is None, (folder / "stderr.txt").read_text()
        yield process
    finally:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--user", default="helibore-stranger")
    name = options.parse_args().user
    made = name not in [user.pw_name for user in pwd.getpwall()]
    if made:
        subprocess.run(["useradd", "--system", "--no-create-home", name], check=True)
    try:
        with tempfile.TemporaryDirectory() as folder:
            found = proofs(pwd.getpwnam(name), Path(folder))
    finally:
        if made:
            subprocess.run(["userdel", name], check=True)
    print("\n".join(found) or "another user gets nothing")
    sys.exit(bool(found))


def proofs(user: pwd.struct_passwd, folder: Path) -> list[str]:
    "localhost".encode("idna")  # loads the codec, which the other user cannot read
    k = np.arange(20_000)
    caliper = hb.Caliper(1000 + k * 0.0005, k * 37.0 % 360, 0.11 + 0.001 * np.cos(k))
    hb.reconstruct(caliper, bit_diameter=0.216).save(folder / "a.wall")
    rig, page, metrics = free_port(), free_port(), free_port()
    (folder / "rig.toml").write_text(configured(f"listen://127.0.0.1:{rig}"))
    (folder / "cluster.py").write_text(SCRIPT)
    (folder / "widget.py").write_text(WIDGET)
    live = ["live", "rig.toml", "--journal", "j", "-q", "--view", "--view-port", str(page), "--metrics-port",
            str(metrics), "--log", "events.log"]  # fmt: skip
    commands = {
        "view": ([*HELIBORE, "view", "a.wall", "-q"], "Ctrl-C", 1),
        "live": ([*HELIBORE, *live], "the metrics are at", 2),
        "cluster": ([sys.executable, "cluster.py"], "ready", 3),
        "widget": ([sys.executable, "widget.py", "a.wall"], "ready", 0),
    }
    found: list[str] = []
    for name, (command, ready, least) in commands.items():
        with started(command, folder, ready) as process:
            if name == "live":
                with socket.create_connection(("127.0.0.1", rig)) as sender:
                    sender.sendall(b"".join(frames(100)))
                time.sleep(1)
            ports = ports_of(process.pid) - {rig}
            assert len(ports) >= least, f"{name}: only {ports}"
            for port in sorted(ports):
                found += [f"{name}: {line}" for line in as_user(user, lambda port=port: knocked(port))]
            arguments = subprocess.run(["ps", "axww", "-o", "args"], capture_output=True, text=True, check=True).stdout
            opened = re.findall(r"file://(/\S+/wall\.html)", arguments)
            assert opened or name != "view", f"no browser was started: {(folder / 'stderr.txt').read_text()}"
            file = opened[0] if name == "view" else ""
            found += [f"{name}: {line}" for line in as_user(user, lambda file=file: seen(process.pid, file))]
            print(f"{name}: {len(ports)} ports, {len(REQUESTS) + 3} probes each", flush=True)
    kept = [path for path in folder.rglob("*") if path.is_file()]
    found += [f"{path.name} holds the token" for path in kept if TOKEN.encode() in path.read_bytes()]
    if any(path.name.endswith("picks.csv") for path in kept):
        found.append("a pick was saved")
    return found


if __name__ == "__main__":
    main()
