"""Archived segments: read while they move, read where they are damaged, on the disk itself, and by the stated rule."""

from __future__ import annotations

import contextlib
import os
import shutil
from pathlib import Path

import pytest
from live_servers import until
from live_wires import CHANGED, FRAMES, SENT, Clock, same_bits, write_two_sessions

from helibore import Live
from helibore.live.journal import archived_segments as archives
from helibore.live.journal import checkpoint, journal
from helibore.live.journal.archived_segments import archive, old_segments
from helibore.live.journal.journal import segments
from helibore.live.journal.session_header import sources_of
from helibore.live.rules.configuration import parse
from helibore.live.server import Server


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    path = tmp_path_factory.mktemp("written") / "well.journal"
    write_two_sessions(path, Clock())
    return path


@pytest.fixture
def folder(written, tmp_path):
    """A copy of that journal."""
    return Path(shutil.copytree(written, tmp_path / "well.journal"))


@pytest.mark.parametrize("cut", ["middle", "end", "all"])
def test_a_damaged_archived_segment_stops_no_restart_and_a_replay_reports_it(folder, cut):
    whole = Live.replay(folder)
    found = len(archive(folder))
    damaged = folder / "archive" / "000001.hbj.gz"
    text = bytearray(damaged.read_bytes())
    if cut == "middle":
        text[len(text) // 2] ^= 255
    damaged.write_bytes({"middle": text, "end": text[:-20], "all": b"nothing"}[cut])
    clock = Clock()
    clock.step(9000)
    with Live(parse(CHANGED), folder, clock=clock) as again:
        assert same_bits(again.wall, whole.wall)
    replayed = Live.replay(folder)
    assert 0 < replayed.wall.sample_count < whole.wall.sample_count
    reported = [event.newest.text for event in replayed.model.events.latest if event.rule == "journal"]
    assert any("000001.hbj.gz: damaged: " in one or "hold no intact record" in one for one in reported)
    first = next(iter(segments(folder)))
    assert first.error.startswith("damaged: ")
    assert len(list(segments(folder))) >= found
    assert {number: one.name for number, one in sources_of(folder, None).items()} == {1: "mwd", 2: "alpha"}


def test_what_comes_before_the_damage_of_an_archived_segment_is_read(folder):
    records = len(next(iter(segments(folder))).records)
    archive(folder)
    damaged = folder / "archive" / "000001.hbj.gz"
    damaged.write_bytes(damaged.read_bytes()[:-60])
    first = next(iter(segments(folder)))
    assert records > len(first.records) > records // 2
    assert first.damage_texts()[-1] == (
        f"000001.hbj.gz: damaged: it ends early: what follows byte {len(first.text)} is lost"
    )


def test_the_sources_of_a_journal_are_known_after_its_first_segments_are_removed(folder):
    before = sources_of(folder, None)
    assert {number: one.name for number, one in before.items()} == {1: "mwd", 2: "alpha"}
    archive(folder, remove=True)
    assert sources_of(folder, None) == before
    only = parse(CHANGED)
    assert {number: one.name for number, one in sources_of(folder, only).items()} == {1: "mwd", 2: "alpha"}


def test_a_reader_reads_every_record_while_segments_are_archived(folder, monkeypatch):
    """The archive takes all old segments after the reader has listed them, and again while it reads the first one."""
    expected = [segment.payload(row) for segment in segments(folder) for row in range(len(segment.records))]
    for moment in ("all_paths", "content"):
        copy = folder.parent / moment
        shutil.copytree(folder, copy)
        real, done = getattr(journal, moment), []

        def then(*arguments, real=real, done=done, copy=copy):
            result = real(*arguments)
            if not done:
                done.append(1)
                done.append(len(archive(copy)))
            return result

        with monkeypatch.context() as patch:
            patch.setattr(journal, moment, then)
            found = [segment.payload(row) for segment in segments(copy) for row in range(len(segment.records))]
        assert done[1] > 3
        assert found == expected


def test_a_segment_that_moves_between_two_listings_is_listed(folder, monkeypatch):
    real = Path.glob

    def glob(path, pattern):
        result = list(real(path, pattern))
        if path == folder and pattern == "*.hbj":
            with monkeypatch.context() as patch:
                patch.setattr(Path, "glob", real)
                archive(folder)
        return iter(result)

    expected = [journal.number_of(path) for path in journal.all_paths(folder)]
    monkeypatch.setattr(Path, "glob", glob)
    assert [journal.number_of(path) for path in journal.all_paths(folder)] == expected


def test_segments_that_are_removed_while_they_are_read_are_missing_and_nothing_else(folder, monkeypatch):
    paths = journal.all_paths(folder)
    monkeypatch.setattr(journal, "all_paths", lambda _: paths)
    removed = len(archive(folder, remove=True))
    assert [segment.number for segment in segments(folder)] == [journal.number_of(path) for path in paths[removed:]]


def test_the_names_of_new_folders_are_on_the_disk(folder, monkeypatch):
    synced = []
    real = os.fsync

    def fsync(file):
        synced.append(Path(f"/proc/self/fd/{file}").readlink())
        real(file)

    monkeypatch.setattr(os, "fsync", fsync)
    archive(folder)
    assert synced.index(folder) < synced.index(folder / "archive")
    Live(parse(SENT), folder.parent / "a" / "b").close()
    assert {folder.parent, folder.parent / "a", folder.parent / "a/b"} <= set(synced)


def test_only_segments_older_than_a_time_are_old(folder):
    starts = [int(segment.records["wall"][0]) for segment in segments(folder)]
    whole = old_segments(folder)
    assert len(whole) > 3
    assert old_segments(folder, starts[2]) == whole[:2]
    assert old_segments(folder, starts[2] - 1) == whole[:1]
    assert old_segments(folder, starts[0]) == []


@pytest.mark.parametrize("old", ["archive", "remove"])
def test_a_server_archives_what_is_older_than_keep_days_and_a_checkpoint_covers(tmp_path, old):
    clock = Clock()
    live = Live(parse(SENT + f'[journal]\nkeep_days = 1.0\nold = "{old}"\n'), tmp_path / "j", clock=clock)
    assert live.journal is not None
    live.journal._segment_bytes = 12_000
    server = Server(live)
    server.start()
    try:
        for frame in FRAMES:
            clock.step(7200)  # 12 frames a day
            before = live.journal.segment
            live.receive("mwd", frame)
            if live.journal.segment > before:
                until(lambda: not live.checkpoint_due)
        until(lambda: not (tmp_path / "j/000001.hbj").exists())
    finally:
        server.stop()
    live.journal.close()
    kept = journal.paths(tmp_path / "j")
    assert 2 <= len(kept) < live.journal.segment
    archived = list((tmp_path / "j/archive").glob("*.gz")) if old == "archive" else []
    assert len(archived) + len(kept) == (live.journal.segment if old == "archive" else len(kept))
    limit = min(map(checkpoint.position, checkpoint.paths(tmp_path / "j")))
    assert all(header.sequence <= limit for path in kept[:1] if (header := journal.header_of(path)))
    with Live(parse(SENT), tmp_path / "j", clock=clock) as again:
        assert same_bits(again.wall, live.wall)
    assert "checkpoint" not in {event.rule for event in live.model.events.latest}
    assert server.failure is None


def test_two_archivers_at_once_lose_nothing(folder, monkeypatch):
    whole = Live.replay(folder)
    real = archives.write_whole

    def write(target, fill, **how):
        real(target, fill, **how)
        with monkeypatch.context() as patch:
            patch.setattr(archives, "write_whole", real)
            archive(folder)

    monkeypatch.setattr(archives, "write_whole", write)
    with contextlib.suppress(FileNotFoundError):  # the other one has taken the next segment
        archive(folder)
    assert same_bits(Live.replay(folder).wall, whole.wall)


def test_a_segment_has_no_error_unless_its_file_is_damaged(folder):
    assert {segment.error for segment in segments(folder)} == {""}
    archive(folder)
    assert {segment.error for segment in segments(folder)} == {""}
