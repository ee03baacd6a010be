"""Proofs of the live part that take minutes: ``python tests/slow/live.py kill|power|hostile|flips|truncations|disk``.

kill      a live wall under load is killed 300 times, half of them at a checkpoint or while segments are archived; every
          acknowledged byte is there, the recovered wall has the bits of the wall rebuilt from its samples
power     the power is cut 1,500 times, at any write, sync, rename or deletion; everything synced is there, the restart
          has the bits of a replay of the whole journal
hostile   100 MB without an end, a number of 10 million digits, binary noise, one-byte packets and 1,000 connections a
          second, over loopback; memory stays bounded and the good frame after each is drawn
flips     2,000 bit flips of a journal, replayed: one record lost each time, reported, and nothing else changed
truncations  a live wall's journal cut at each of its last 4,096 bytes, recovered and continued with the rest of the
          stream: the wall in the end has the bits of one that was never cut
disk      a journal on a disk of 1 MB (tmpfs, needs root) that fills up again and again under a sender: nothing is lost

The fast versions are in tests/python/test_live*.py, which this imports.
"""

from __future__ import annotations

import os
import random
import resource
import socket
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "python"))
sys.path.insert(0, str(Path(__file__).parents[1] / "python" / "live"))

import live_wires
import test_live_killed
import test_live_power_cut
from live_servers import Running, configured, frames, free_port, payloads, until

from helibore import Live
from helibore.live.journal.journal import RECORDS_START
from helibore.live.rules.configuration import parse

MEMORY = "/dev/shm" if Path("/dev/shm").is_dir() else None
"""A disk in memory, where a sync takes no time; what a power cut leaves is simulated."""


def kill() -> None:
    """300 kills of a live wall, 200 of a journal."""
    with tempfile.TemporaryDirectory() as folder:
        acknowledged, found, samples, fell = test_live_killed.kill_wall(Path(folder), 300, seed=11)
        print(f"300 kills of a live wall: {acknowledged:,} bytes acknowledged, {found:,} found; each time the wall of")
        print(
            f"the journal, bit for bit, and at the end that of the batch of its {samples:,} samples; kills by the last"
        )
        print(f"line before them: {fell}")
    with tempfile.TemporaryDirectory() as folder:
        acknowledged, found = test_live_killed.kill_journal(Path(folder), 200, seed=12)
        print(f"200 kills of a journal: {acknowledged:,} records acknowledged, {found:,} found, none missing between")


def power() -> None:
    """1,500 power cuts."""
    with tempfile.TemporaryDirectory(dir=MEMORY) as folder:
        synced, found = test_live_power_cut.power_cuts(Path(folder), 1500, seed=13)
        print(f"1,500 power cuts: {synced:,} frames synced, {found:,} found, each synced one among them")


def hostile() -> None:
    """Each attack, then a good frame."""
    draw = random.Random(1)
    megabyte = b"01081\r\n" * 150_000
    attacks = {
        "100 MB without an end": [b"&&\r\n", *([megabyte] * 95)],
        "a number of 10 million digits": [b"&&\r\n0108", *([b"7" * 1_000_000] * 10), b"\r\n"],
        "50 MB of noise": [draw.randbytes(1 << 20) for _ in range(50)],
        "50 MB of frames that never end": [b"&&\n" * 350_000] * 48,
        "100,000 packets of one byte": [b"&"] * 100_000,
    }
    with tempfile.TemporaryDirectory() as folder:
        port = free_port()
        with Running(configured(f"listen://127.0.0.1:{port}"), Path(folder)) as running:
            for number, (name, parts) in enumerate(attacks.items()):
                start = time.monotonic()
                with socket.create_connection(("127.0.0.1", port)) as link:
                    for part in parts:
                        link.sendall(part)
                    link.sendall(b"\r\n!!\r\n" + frames(1, number)[0])
                    until(lambda wanted=number + 1: running.live.wall.sample_count == wanted, 300)
                peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
                print(f"{name}: the good frame after it drawn in {time.monotonic() - start:.1f} s, peak {peak:.0f} MB")
            _connects(running, port)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss < 1_000_000


def _connects(running: Running, port: int) -> None:
    """10,000 connections at 1,000 a second beside a sender that goes on."""
    before = running.live.wall.sample_count
    with socket.create_connection(("127.0.0.1", port)) as good:
        start = time.monotonic()
        for i in range(10_000):
            time.sleep(max(start + i / 1000 - time.monotonic(), 0))
            socket.create_connection(("127.0.0.1", port)).close()
            if i % 100 == 0:
                good.sendall(frames(1, 1000 + i)[0])
        rate = 10_000 / (time.monotonic() - start)
        until(lambda: running.live.wall.sample_count == before + 100, 60)
    files = len(list(Path("/proc/self/fd").iterdir()))
    print(f"{rate:.0f} connections a second: the sender beside them lost nothing; {files} files open")


def flips() -> None:
    """Flip, replay, compare with the wall without the record that was hit."""
    draw = random.Random(3)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with Live(parse(live_wires.SENT), folder) as live:
            for frame in live_wires.FRAMES:
                live.receive("mwd", frame)
        whole = (folder / "000001.hbj").read_bytes()
        lost: dict[int, int] = {}
        for _ in range(2000):
            at = draw.randrange(RECORDS_START + 3000, len(whole))
            flipped = bytearray(whole)
            flipped[at] ^= 1 << draw.randrange(8)
            (folder / "000001.hbj").write_bytes(flipped)
            again = Live.replay(folder)
            missing = live.wall.sample_count - again.wall.sample_count
            lost[missing] = lost.get(missing, 0) + 1
            assert missing == 3, f"bit flip at byte {at}: {missing} samples lost"
            assert again.model.events.counts["", "journal"] == 1
    print(f"2,000 bit flips: each cost its record of 3 samples and was reported: {lost}")


def truncations() -> None:
    """Cut, recover, go on where the journal ends, compare."""
    os.fdatasync = os.fsync = lambda _: None  # 12,000 syncs say nothing about truncation
    configuration = parse(live_wires.SENT)
    stream = b"".join(live_wires.FRAMES[:60])
    cut = []
    with tempfile.TemporaryDirectory() as name:
        with Live(configuration, Path(name) / "whole") as live:
            for start in range(0, len(stream), 101):
                live.receive("mwd", stream[start : start + 101])
        whole = (Path(name) / "whole" / "000001.hbj").read_bytes()
        folder = Path(name) / "cut"
        folder.mkdir()
        for size in range(len(whole) - 4096, len(whole)):
            (folder / "000001.hbj").write_bytes(whole[:size])
            with Live(configuration, folder) as again:
                there = again.model.readers[1].total("bytes")
                cut.append(len(stream) - there)
                again.receive("mwd", stream[there:])
            for wall in (again.wall, Live.replay(folder).wall):
                assert live_wires.same_bits(wall, live.wall), f"cut at byte {size}"
            for path in folder.iterdir():
                path.unlink()
    print(
        f"{len(cut):,} truncations: {min(cut)} to {max(cut)} bytes of {len(stream):,} had to be sent again; each time"
    )
    print("the bits of the wall that was never cut")


def disk() -> None:
    """Fill, see the sender wait, make room, count."""
    with tempfile.TemporaryDirectory() as name:
        subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", name], check=True)
        try:
            port, fills, size = free_port(), 0, 1
            with Running(configured(f"listen://127.0.0.1:{port}"), Path(name) / "j") as running:
                stream = b"".join(frames(60_000))
                sender = threading.Thread(target=_send, args=(port, stream))
                sender.start()
                while running.live.wall.sample_count < 60_000:
                    if running.live.model.events.counts["mwd", "disk"] > fills:  # reported once each time it fills
                        fills, size = fills + 1, size + 1
                        subprocess.run(["mount", "-o", f"remount,size={size}m", name], check=True)
                    assert running.server.failure is None
                    time.sleep(0.01)
                sender.join()
            assert b"".join(payloads(Path(name) / "j")) == stream
        finally:
            subprocess.run(["umount", name], check=True)
    print(f"the disk was full {fills} times under {len(stream):,} bytes: every byte is there, 60,000 samples drawn")


def _send(port: int, stream: bytes) -> None:
    with socket.create_connection(("127.0.0.1", port)) as link:
        link.sendall(stream)


if __name__ == "__main__":
    commands = (kill, power, hostile, flips, truncations, disk)
    {command.__name__: command for command in commands}[sys.argv[1]]()
