"""Kill helibore and an ETP server while 2,000 rows a second come: ``python -m bench.live.etp --kills 20``.

The server is a process of its own (tests/python/live/etp_server.py), with three channels by depth. ``--python`` names
the interpreter of an environment with `etptypes` and `etpproto` (pydantic below 2); then every message is encoded and
decoded by them, and not by helibore. Helibore and the server are killed in turn at equal intervals. At the end the wall
must have each row once, and a replay the same bits. With ``--compare 5 --count 40000``, a sender of WITS and the server
serve in turn five times without kills, both with a packet each 10 ms, and the times from packet to wall are printed.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from helibore import Live
from helibore.live.rules.configuration import parse
from helibore.live.server import Server
from helibore.live.wire import wits

TESTS = Path(__file__).parents[2] / "tests" / "python" / "live"
WALL = "[wall]\nbit_diameter = 0.216\nstart_depth = 100.0\nsectors = 16\nthreads = 1\n"
ETP = (
    WALL
    + '[source.rig]\naddress = "ws://127.0.0.1:PORT/etp"\nordered_by = "depth"\n'
    + 'uris = ["eml:///witsml20.ChannelSet(c)"]\ncaliper = { toolface = ["TF"], radius = ["RAD"] }\n'
)
WITS = (
    WALL
    + '[source.rig]\naddress = "tcp://127.0.0.1:PORT"\nunits = "metric"\n'
    + 'caliper = { toolface = ["5010"], depth = ["5011"], radius = ["5012"] }\n'
)
PROGRAM = """
import sys, time
from helibore import Live
from helibore.live.rules.configuration import parse
from helibore.live.server import Server
server = Server(Live(parse(sys.argv[1]), sys.argv[2]))
server.start()
print("up", flush=True)
time.sleep(36000)
"""


def free_port() -> int:
    """Return a port that is free now."""
    with socket.create_server(("127.0.0.1", 0)) as listening:
        return int(listening.getsockname()[1])


def begin(command: list[str]) -> subprocess.Popen[bytes]:
    """Start a process and wait for its first line."""
    process = subprocess.Popen(command, stdout=subprocess.PIPE)
    assert process.stdout
    print("  " + process.stdout.readline().decode().strip(), end="", flush=True)
    return process


def kill(process: subprocess.Popen[bytes]) -> None:
    """Kill a process with SIGKILL."""
    process.kill()
    process.wait()
    assert process.stdout
    process.stdout.close()


def drawn(text: str, folder: Path, count: int, seconds: float) -> tuple[Live, Server]:
    """Serve until the wall has ``count`` samples, or ``seconds`` have passed."""
    live = Live(parse(text), folder)
    server = Server(live)
    server.start()
    end = time.monotonic() + seconds
    while live.wall.sample_count < count and time.monotonic() < end:
        time.sleep(0.05)
    server.stop()
    live.close()
    return live, server


def send_wits(port: int, rate: float, count: int) -> None:
    """Send a frame for each row, at a rate, to the first program that connects."""
    with socket.create_server(("127.0.0.1", port)) as listening:
        link, _ = listening.accept()
        with link:
            began, number = time.monotonic(), 0
            while number < count:
                due = min(count, int((time.monotonic() - began) * rate))
                rows = range(number, due)
                link.sendall(b"".join(wits.frame([(5010, f"{one * 37 % 360}"), (5011, f"{100 + 0.001 * one:.3f}"),
                                                  (5012, "110")]) for one in rows))  # fmt: skip
                number = due
                time.sleep(0.01)
            time.sleep(2)


def serve(given: argparse.Namespace, kills: int, *, by_wits: bool) -> bool:
    """Serve all rows once, and print what came and how late; return whether each came once."""
    port, began = free_port(), time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if by_wits:
            arguments = port, given.rate, given.count
            multiprocessing.get_context("spawn").Process(target=send_wits, args=arguments, daemon=True).start()
            text = WITS.replace("PORT", str(port))
        else:
            text, since = ETP.replace("PORT", str(port)), folder / "since"
            since.write_text("")
            serves = [given.python, str(TESTS / "etp_server.py"), str(port), str(given.rate), str(given.count),
                      "--begun", str(since)]  # fmt: skip
            draws = [sys.executable, "-c", PROGRAM, text, str(folder / "j")]
            sender = begin(serves)
            pause = given.count / given.rate / max(2 * kills, 1)
            program = begin(draws) if kills else None
            for _ in range(kills):
                assert program
                time.sleep(pause)
                kill(program)
                program = begin(draws)
                time.sleep(pause)
                kill(sender)
                sender = begin(serves)
            print()
            if program:
                kill(program)
        live, server = drawn(text, folder / "j", given.count, given.count / given.rate + 120)
        if not by_wits:
            kill(sender)
        number = np.rint((live.wall.samples.depth - 100) * 1000).astype(int)
        came = np.bincount(number, minlength=given.count)
        lost, doubled = int(np.count_nonzero(came[: given.count] == 0)), int(np.maximum(came - 1, 0).sum())
        same = np.array_equal(Live.replay(folder / "j").wall.radius, live.wall.radius, equal_nan=True)
        print(f"{'WITS' if by_wits else 'ETP'}: {given.count:,} rows, {kills} kills of each, lost {lost}, "
              f"doubled {doubled}, same bits on replay: {same}, {time.monotonic() - began:.0f} s")  # fmt: skip
        p50, p99 = (1e3 * server.latency.quantile(share) for share in (0.5, 0.99))
        print(
            f"from packet to wall, the last thousand: p50 {p50:.1f} ms, p99 {p99:.1f} ms, load {os.getloadavg()[0]:.1f}"
        )
    return not (lost or doubled) and same


def main() -> int:
    """Serve once with kills, or WITS and ETP in turn without."""
    options = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    options.add_argument("--count", type=int, default=300_000)
    options.add_argument("--rate", type=float, default=2000)
    options.add_argument("--kills", type=int, default=20, help="kills of helibore, and as many of the server")
    options.add_argument("--python", default=sys.executable, help="interpreter of the server")
    options.add_argument("--compare", type=int, default=0, help="so many times WITS and ETP in turn, without kills")
    given = options.parse_args()
    if not given.compare:
        return int(not serve(given, given.kills, by_wits=False))
    right = [serve(given, 0, by_wits=by_wits) for _ in range(given.compare) for by_wits in (True, False)]
    return int(not all(right))


if __name__ == "__main__":
    raise SystemExit(main())
