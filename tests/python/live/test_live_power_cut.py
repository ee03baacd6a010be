"""Simulated power cuts of a live wall, at any write, sync, rename or deletion of its journal, checkpoints and archive.

play     ... write | sync | write | rename | X        the disk refuses everything from some operation on
disk     what was synced is there; of the rest, any part of the bytes and of the names may be
check    every synced record is there, the restart has the bits of a replay of the whole journal
"""

from __future__ import annotations

import os
import random
from pathlib import Path

import pytest
from live_wires import FRAMES, SENT, Clock, same_bits

from helibore import Live
from helibore.live.journal import archived_segments, checkpoint
from helibore.live.journal.journal import segments
from helibore.live.rules.configuration import parse


class PowerLostError(BaseException):
    """The power is gone."""


class Disk:
    """A folder as a disk holds it: which bytes and names are synced. It loses power at operation ``at``."""

    OPERATIONS = ("pwritev", "fdatasync", "fsync", "mkdir", "rename", "replace", "unlink")

    def __init__(self, folder: Path, at: int, patch: pytest.MonkeyPatch) -> None:
        self.folder, self.at, self.count = folder, at, 0
        self.synced: dict[int, int] = {}  # bytes of each inode
        self.names: dict[Path, int] = {}  # the inode of each synced name
        self.gone: dict[Path, bytes] = {}  # deleted or replaced files that may come back
        for name in self.OPERATIONS:
            patch.setattr(os, name, self._counted(name, getattr(os, name)))

    def _counted(self, name: str, real):
        def operation(*arguments, **options):
            self.count += 1
            if self.count == self.at:
                if name == "pwritev":  # a part of it may be written
                    text = b"".join(arguments[1])
                    os.pwrite(arguments[0], text[: random.Random(self.at).randrange(len(text))], arguments[2])
                raise PowerLostError
            if name in ("replace", "unlink"):
                target = Path(arguments[-1])
                if target.exists():
                    self.gone[target] = target.read_bytes()
            result = real(*arguments, **options)
            if name in ("fdatasync", "fsync"):
                self._sync(arguments[0])
            return result

        return operation

    def _sync(self, file: int) -> None:
        status = os.fstat(file)
        self.synced[status.st_ino] = status.st_size
        path = Path(f"/proc/self/fd/{file}").readlink()
        if path.is_dir():
            self.names = {name: of for name, of in self.names.items() if name.parent != path}
            self.names |= {name: name.stat().st_ino for name in path.iterdir()}
            self.gone = {name: text for name, text in self.gone.items() if name.parent != path}

    def after_the_cut(self, target: Path, draw: random.Random) -> None:
        """Write to ``target`` what may be left after the cut."""
        found = sorted(self.folder.rglob("*"))
        lost = {path for path in found if path.is_dir() and self._may_be_lost(path) and draw.random() < 0.5}
        files = {path: path.read_bytes() for path in found if path.is_file() and path.parent not in lost}
        for path, text in files.items():
            node = path.stat().st_ino
            size = draw.randint(min(self.synced.get(node, 0), len(text)), len(text))
            if path.name == "lock" or not self._may_be_lost(path) or draw.random() < 0.5:
                self._put(target, path, text[:size] + bytes(draw.choice([0, 0, len(text) - size])))
        for path, text in self.gone.items():
            if (
                draw.random() < 0.5
                and path.parent not in lost
                and not (target / path.relative_to(self.folder)).exists()
            ):
                self._put(target, path, text)

    def _may_be_lost(self, path: Path) -> bool:
        return self.names.get(path) != path.stat().st_ino

    def _put(self, target: Path, path: Path, text: bytes) -> None:
        copy = target / path.relative_to(self.folder)
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_bytes(text)


def played(folder: Path, frames: list[bytes]) -> int:
    """Play frames with rotations, checkpoints and archiving until the power is lost; return how many were synced."""
    synced = 0
    live = Live(parse(SENT), folder, clock=Clock())
    assert live.journal is not None
    live.journal._segment_bytes = 7000
    try:
        done = live.model.readers[1].total("frames")
        for number, frame in enumerate(frames[done:], done + 1):
            live.receive("mwd", frame)
            if number % 5 == 0:
                live.sync()
                synced = number
            if live.checkpoint_due:
                live.checkpoint()
                if len(checkpoint.paths(folder)) == 2:
                    archived_segments.archive(folder)
    except PowerLostError:
        pass
    finally:
        live.journal._close_files()
    return synced


def power_cuts(folder: Path, cuts: int, seed: int) -> tuple[int, int]:
    """Cut the power ``cuts`` times; return how many frames were synced, and how many were found."""
    draw, synced, found = random.Random(seed), 0, 0
    for number in range(cuts):
        disk, left = folder / f"{number}", folder / f"{number}-left"
        with pytest.MonkeyPatch.context() as patch:
            cut = Disk(disk, draw.randrange(12, 700), patch)
            promised = played(disk, FRAMES)
        left.mkdir()
        cut.after_the_cut(left, draw)
        with Live(parse(SENT), left, clock=Clock()) as again:
            whole = Live.replay(left)
            assert again.wall.sample_count == whole.wall.sample_count
            assert not len(again.wall) or same_bits(again.wall, whole.wall)
            kept = {segment.payload(row) for segment in segments(left) for row in range(len(segment.records))}
            assert kept.issuperset(FRAMES[:promised]), f"cut {number}: {promised} synced, {len(kept)} found"
            again.receive("mwd", b"".join(frame for frame in FRAMES if frame not in kept))
            assert again.wall.sample_count == 600
        synced, found = synced + promised, found + len(kept.intersection(FRAMES))
        for path in [*disk.rglob("*"), *left.rglob("*")]:
            if path.is_file():
                path.unlink()
    return synced, found


def test_a_power_cut_at_any_operation_loses_nothing_that_was_synced(tmp_path):
    synced, found = power_cuts(tmp_path, 12, seed=1)
    assert 100 < synced <= found
