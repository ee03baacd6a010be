"""The journal keeps what it acknowledged: torn, flipped, killed, full, and with a clock that jumps."""

from __future__ import annotations

import contextlib
import errno
import os
import random
import resource
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helibore import _core
from helibore.live.journal import journal
from helibore.live.journal.journal import BYTES, OPENED, RECORDS_START, Journal, JournalFullError, segments


def stored(folder: Path, read=None) -> list[tuple[int, int, bytes]]:
    """(source, connection, payload) of every intact record of received bytes, in ``read`` segments or all."""
    rows = []
    for segment in read or segments(folder):
        received = np.flatnonzero(segment.records["kind"] == BYTES).tolist()
        sources, connections = segment.records["source"].tolist(), segment.records["connection"].tolist()
        rows += [(sources[row], connections[row], segment.payload(row)) for row in received]
    return rows


def slow_crc32c(text: bytes, crc: int = 0) -> int:
    crc ^= 0xFFFFFFFF
    for byte in text:
        crc ^= byte
        for _ in range(8):
            crc = (crc >> 1) ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


def test_crc32c_has_the_published_check_values():
    assert _core.crc32c(b"123456789") == 0xE3069283
    assert _core.crc32c(bytes(32)) == 0x8A9136AA  # RFC 3720, B.4
    assert _core.crc32c(b"\xff" * 32) == 0x62A8AB43


@given(st.binary(max_size=50), st.binary(max_size=50))
def test_crc32c_continues(first, second):
    assert _core.crc32c(second, _core.crc32c(first)) == slow_crc32c(first + second)


def test_what_is_appended_is_read(tmp_path):
    clock = iter([(1000, 1), (2000, 2), (1500, 3)])
    with Journal(tmp_path, b"hello", clock=lambda: next(clock)) as j:
        assert j.append(7, 3, b"abc") == (1, 2000, 2)
        assert j.append(8, 1 << 31, b"") == (2, 1500, 3)
    (segment,) = segments(tmp_path)
    assert segment.records["kind"].tolist() == [OPENED, BYTES, BYTES]
    assert segment.records["wall"].tolist() == [1000, 2000, 1500]
    assert segment.records["monotonic"].tolist() == [1, 2, 3]
    assert segment.payload(0) == b"hello"
    assert segment.damage == []
    assert stored(tmp_path) == [(7, 3, b"abc"), (8, 1 << 31, b"")]


def test_segments_follow_each_other_and_each_begins_with_the_opening(tmp_path):
    wanted = [(1, 1, bytes([i]) * 300) for i in range(40)]
    for part in (wanted[:25], wanted[25:]):
        with Journal(tmp_path, b"open", segment_bytes=2000) as j:
            for row in part:
                j.append(*row)
    found = list(segments(tmp_path))
    assert len(found) > 5
    assert all(segment.records["kind"][0] == OPENED for segment in found)
    sequence = np.concatenate([segment.records["sequence"] for segment in found])
    assert np.array_equal(sequence, np.arange(len(sequence)))
    assert stored(tmp_path) == wanted


def small_journal(folder: Path) -> list[tuple[int, int, bytes]]:
    """A journal whose last 4 kB hold records of many sizes."""
    draw = random.Random(1)
    rows = [
        (draw.randrange(9), draw.randrange(99), draw.randbytes(draw.choice([0, 1, 40, 47, 300]))) for _ in range(60)
    ]
    with Journal(folder, b"open") as j:
        for row in rows:
            j.append(*row)
    return rows


def test_every_truncation_of_the_last_4_kb_keeps_every_whole_record_and_can_be_continued(tmp_path):
    rows = small_journal(tmp_path / "whole")
    whole = (tmp_path / "whole" / "000001.hbj").read_bytes()
    ends, at = [], RECORDS_START + journal.HEADER.size + 16 + len(b"open")
    for _, _, payload in rows:
        at += 48 + len(payload)
        ends.append(at)
    assert at == len(whole) > 4096
    folder = tmp_path / "cut"
    folder.mkdir()
    for size in range(len(whole) - 4096, len(whole)):
        (folder / "000001.hbj").write_bytes(whole[:size])
        kept = sum(end <= size for end in ends)
        with Journal(folder) as j:
            torn = size - (ends[kept - 1] if kept else RECORDS_START + 52)
            assert j.recovery.cut_bytes == torn
            j.append(5, 5, b"after")
        assert stored(folder) == [*rows[:kept], (5, 5, b"after")]
        for path in folder.iterdir():  # a folder of its own each would take ten times as long
            path.unlink()


def test_2000_bit_flips_lose_only_the_record_they_hit(tmp_path):
    rows = small_journal(tmp_path)
    path = tmp_path / "000001.hbj"
    whole = path.read_bytes()
    draw = random.Random(2)
    for _ in range(2000):
        at = draw.randrange(len(whole))
        flipped = bytearray(whole)
        flipped[at] ^= 1 << draw.randrange(8)
        with path.open("r+b") as file:  # in place: a disk takes longer to make a file
            file.write(flipped)
        (segment,) = segments(tmp_path)
        found = stored(tmp_path, [segment])
        if at < RECORDS_START:
            assert found == rows
            continue
        missing = len(rows) - len(found)
        hit_opening = at < RECORDS_START + 52
        assert missing == (0 if hit_opening else 1)
        assert [row for row in rows if row in found] == found
        ((start, stop),) = segment.damage
        assert start <= at < stop
        assert segment.damage_texts() == [
            f"000001.hbj: bytes {start} to {stop} hold no intact record ({stop - start} bytes lost)"
        ]


def test_damage_before_the_end_is_told_and_left_where_it_is(tmp_path):
    rows = small_journal(tmp_path)
    path = tmp_path / "000001.hbj"
    text = bytearray(path.read_bytes())
    text[RECORDS_START + 900] ^= 1
    path.write_bytes(text)
    with Journal(tmp_path) as j:
        assert j.recovery.notes == []
        assert len(j.recovery.damage) == 1
        assert "hold no intact record" in j.recovery.damage[0]
        assert j.recovery.cut_bytes == 0
    assert path.read_bytes()[: len(text)] == text
    assert len(stored(tmp_path)) == len(rows) - 1


def test_bytes_from_outside_cannot_pass_as_a_record(tmp_path):
    """A payload that holds another journal's records, behind a damaged header, is skipped as a whole."""
    small_journal(tmp_path / "other")
    forged = (tmp_path / "other" / "000001.hbj").read_bytes()[RECORDS_START:]
    with Journal(tmp_path / "mine") as j:
        j.append(1, 1, forged)
        j.append(1, 1, b"good")
    path = tmp_path / "mine" / "000001.hbj"
    text = bytearray(path.read_bytes())
    text[RECORDS_START + 48 + 2 + 5] ^= 1
    path.write_bytes(text)
    assert stored(tmp_path / "mine") == [(1, 1, b"good")]


def test_a_segment_that_died_while_it_was_made_is_set_aside(tmp_path, golden):
    rows = small_journal(tmp_path)
    (tmp_path / "000002.hbj").write_bytes(b"HELIBJ")
    with Journal(tmp_path) as j:
        golden(j.recovery.notes)
        j.append(5, 5, b"after")
    assert stored(tmp_path) == [*rows, (5, 5, b"after")]
    assert (tmp_path / "000002-0.torn").read_bytes() == b"HELIBJ"


def test_a_last_segment_without_records_does_not_reuse_sequence_numbers(tmp_path):
    rows = small_journal(tmp_path)
    first = (tmp_path / "000001.hbj").read_bytes()
    (tmp_path / "000002.hbj").write_bytes(first[:RECORDS_START])
    with Journal(tmp_path) as j:
        assert j.append(5, 5, b"after")[0] > 61
    assert stored(tmp_path) == [*rows, (5, 5, b"after")]


def test_segments_are_in_order_also_when_their_numbers_have_seven_digits(tmp_path):
    with Journal(tmp_path, segment_bytes=1) as j:
        j._number = 999_997
        for number in range(4):
            j.append(1, 1, bytes([number]))
    assert [path.stem for path in journal.paths(tmp_path)] == ["000001", "999998", "999999", "1000000", "1000001"]
    with Journal(tmp_path, segment_bytes=1) as j:
        j.append(1, 1, b"after")
        assert j.segment == 1_000_002
    assert [payload for _, _, payload in stored(tmp_path)] == [b"\0", b"\1", b"\2", b"\3", b"after"]


def test_refusals(tmp_path, golden):
    with golden.raises():
        list(segments(tmp_path))
    (tmp_path / "000001.hbj").write_bytes(bytes(RECORDS_START))
    with golden.raises():
        Journal(tmp_path)
    with Journal(tmp_path / "a") as j:
        with golden.raises():
            Journal(tmp_path / "a")
        with golden.raises():
            j.append(1, 1, bytes((1 << 20) + 1))
        j.append(1, 1, b"x")
    assert stored(tmp_path / "a") == [(1, 1, b"x")]


@pytest.mark.parametrize("rotated", [False, True])
def test_a_removed_lock_file_lets_no_second_writer_in(tmp_path, rotated, golden):
    with Journal(tmp_path, segment_bytes=RECORDS_START + 200) as j:
        for number in range(20 if rotated else 1):
            j.append(1, 1, b"%d" % number * 20)
        (tmp_path / "lock").unlink()
        with golden.raises():
            Journal(tmp_path)
        j.append(1, 1, b"after")
    assert len(stored(tmp_path)) == (21 if rotated else 2)
    Journal(tmp_path).close()


def test_a_deleted_folder_or_segment_is_noticed_and_nothing_acknowledged_into_it(tmp_path, golden):
    with Journal(tmp_path / "a") as j:
        j.append(1, 1, b"before")
        shutil.rmtree(tmp_path / "a")
        with golden.raises(kind=JournalFullError):
            j.append(1, 1, b"lost")
        with pytest.raises(JournalFullError, match="not synced"):
            j.sync()
        with contextlib.suppress(JournalFullError):
            j.close()
    with Journal(tmp_path / "b") as j:
        j.append(1, 1, b"before")
        (tmp_path / "b").rename(tmp_path / "moved")
        with pytest.raises(JournalFullError, match="not synced"):
            j.sync()
        (tmp_path / "moved").rename(tmp_path / "b")
        j.sync()
        j.append(1, 1, b"after")
    assert stored(tmp_path / "b") == [(1, 1, b"before"), (1, 1, b"after")]


def test_a_sync_needs_no_descriptor(tmp_path):
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    with Journal(tmp_path) as j:
        resource.setrlimit(resource.RLIMIT_NOFILE, (3, limits[1]))
        try:
            j.append(1, 1, b"without")
            j.sync()
        finally:
            resource.setrlimit(resource.RLIMIT_NOFILE, limits)
    assert stored(tmp_path) == [(1, 1, b"without")]


def test_a_new_segment_that_lacks_a_descriptor_is_made_when_there_is_one(tmp_path):
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    with Journal(tmp_path, segment_bytes=RECORDS_START + 200, sync_interval=0) as j:
        acknowledged = 0
        for number in range(40):
            short = 10 <= number < 30
            resource.setrlimit(resource.RLIMIT_NOFILE, (3 if short else limits[0], limits[1]))
            try:
                j.append(1, 1, b"%d" % number)
                acknowledged += 1
            except JournalFullError:
                assert short
            finally:
                resource.setrlimit(resource.RLIMIT_NOFILE, limits)
    assert 20 < acknowledged < 40
    assert len(stored(tmp_path)) == acknowledged


def test_a_torn_sector_leaves_a_copy_of_the_header(tmp_path):
    rows = small_journal(tmp_path)
    path = tmp_path / "000001.hbj"
    whole = path.read_bytes()
    for start in (0, RECORDS_START // 512 * 512):
        path.write_bytes(
            whole[:start] + bytes(min(512, RECORDS_START - start)) + whole[start + min(512, RECORDS_START - start) :]
        )
        assert stored(tmp_path) == rows


def test_a_journal_of_a_later_version_is_refused(tmp_path, golden):
    start = journal.HEADER.pack(journal.MAGIC, 9, 1, 0, 1, 0)[:-4]
    (tmp_path / "000001.hbj").write_bytes((start + _core.crc32c(start).to_bytes(4, "little")) * 2)
    with golden.raises():
        list(segments(tmp_path))


def test_a_write_that_fails_half_way_leaves_nothing(tmp_path, monkeypatch, golden):
    with Journal(tmp_path) as j:
        j.append(1, 1, b"before")
        real = os.pwritev

        def half(file, parts, offset):
            return real(file, [b"".join(parts)[:30]], offset)

        def refused(*_):
            raise OSError(errno.ENOSPC, "No space left on device")

        with monkeypatch.context() as patch:
            patch.setattr(os, "pwritev", half)
            patch.setattr(os, "pwrite", refused)
            with golden.raises(kind=JournalFullError):
                j.append(1, 1, b"refused")
        with monkeypatch.context() as patch:
            patch.setattr(os, "pwritev", half)
            j.append(1, 1, b"in two writes")
    assert stored(tmp_path) == [(1, 1, b"before"), (1, 1, b"in two writes")]


damages = st.lists(  # (kind, place, source, length)
    st.tuples(st.sampled_from(["flip", "cut out", "zeros", "copy", "noise"]), *[st.integers(0, 5000)] * 2,
              st.integers(1, 400)), min_size=1, max_size=6)  # fmt: skip


def damaged(text: bytes, damage: list[tuple[str, int, int, int]]) -> bytes:
    """The records behind the two headers, flipped, cut out, zeroed, written over with noise or copied elsewhere."""
    rows = bytearray(text[RECORDS_START:])
    for kind, place, source, length in damage:
        at, source = place % max(len(rows), 1), source % max(len(rows), 1)
        stop = min(at + length, len(rows))
        if kind == "flip" and rows:
            rows[at] ^= 1 << (length % 8)
        elif kind == "cut out":
            del rows[at:stop]
        elif kind == "zeros":
            rows[at:stop] = bytes(stop - at)
        elif kind == "copy":
            rows[at:at] = rows[source : source + length]
        else:
            rows[at:stop] = random.Random(source).randbytes(stop - at)
    return text[:RECORDS_START] + bytes(rows)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A journal of 60 records: its rows, and the text of its one segment."""
    folder = tmp_path_factory.mktemp("whole")
    return small_journal(folder), (folder / "000001.hbj").read_bytes()


@settings(max_examples=150, deadline=None)
@given(damage=damages)
def test_fuzzed_damage_gives_nothing_that_was_not_written_and_the_journal_goes_on(whole, damage):
    rows, text = whole
    with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fdatasync", lambda _: None)
        patch.setattr(os, "fsync", lambda _: None)
        (Path(folder) / "000001.hbj").write_bytes(damaged(text, damage))
        with Journal(folder) as j:
            reported = j.recovery.notes + j.recovery.damage
            j.append(5, 5, b"after")
        found = stored(Path(folder))
        rest = iter([*rows, (5, 5, b"after")])
        assert all(row in rest for row in found)  # in order, each at most once
        assert found[-1] == (5, 5, b"after")
        assert reported or len(found) == len(rows) + 1 or damaged(text, damage) == text[: len(damaged(text, damage))]
        sequence = np.concatenate([segment.records["sequence"] for segment in segments(folder)])
        assert (np.diff(sequence.astype(np.int64)) > 0).all()


@pytest.mark.skipif(os.geteuid() != 0, reason="mounting a small disk needs root")
def test_a_full_disk_refuses_and_goes_on_when_there_is_room(tmp_path, golden):
    disk = tmp_path / "disk"
    disk.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", disk], capture_output=True).returncode:
        pytest.skip("this system does not let tests mount a disk")
    try:
        (disk / "ballast").write_bytes(bytes(300_000))
        acknowledged = []
        with Journal(disk / "j") as j:

            def fill():
                for i in range(100_000):
                    row = (1, 1, b"%d" % i * 500)
                    j.append(*row)
                    acknowledged.append(row)

            with golden.raises(kind=JournalFullError):
                fill()
            assert stored(disk / "j") == acknowledged
            (disk / "ballast").unlink()
            j.append(1, 1, b"again")
        assert stored(disk / "j") == [*acknowledged, (1, 1, b"again")]
    finally:
        subprocess.run(["umount", disk], check=True)


def test_sync_before_every_acknowledgement_when_asked(tmp_path, monkeypatch):
    synced = []
    real = os.fdatasync
    monkeypatch.setattr(os, "fdatasync", lambda file: (synced.append(file), real(file))[1])
    with Journal(tmp_path, sync_interval=0) as j:
        before = len(synced)
        j.append(1, 1, b"x")
        assert len(synced) == before + 1
        assert j.bytes_left > 0


def test_what_cannot_be_synced_is_not_acknowledged_and_is_written_anew(tmp_path, monkeypatch, golden):
    real, refusing = os.fdatasync, [False]

    def fdatasync(file: int) -> None:
        if refusing[0]:
            raise OSError(errno.EIO, "Input/output error")
        real(file)

    monkeypatch.setattr(os, "fdatasync", fdatasync)
    with Journal(tmp_path, segment_bytes=600, sync_interval=0) as j:
        j.append(1, 1, b"before")
        for i in range(20):
            refusing[0] = True
            with golden.raises(kind=JournalFullError):
                j.append(1, 1, b"%d" % i * 40)
            assert (1, 1, b"%d" % i * 40) not in stored(tmp_path)
            refusing[0] = False
            assert j.append(1, 1, b"%d" % i * 40)[0] > i
    assert stored(tmp_path) == [(1, 1, b"before"), *((1, 1, b"%d" % i * 40) for i in range(20))]
    found = [segment.records["sequence"] for segment in segments(tmp_path)]
    assert len(found) > 3
    assert np.array_equal(np.concatenate(found), np.arange(sum(map(len, found))))


def test_a_journal_that_cannot_be_synced_lets_go_of_its_folder(tmp_path, monkeypatch):
    def refused(_: int) -> None:
        raise OSError(errno.EIO, "Input/output error")

    j = Journal(tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr(os, "fdatasync", refused)
        with pytest.raises(JournalFullError, match="not synced"):
            j.close()
    Journal(tmp_path).close()


def test_what_the_disk_refused_to_sync_is_synced_next_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Segments that were finished before the refusal are not forgotten, and no descriptor is left open."""
    journal = Journal(tmp_path, segment_bytes=4096)
    for _ in range(6):
        journal.append(0, 0, bytes(2000))
    real, synced, refusing = os.fdatasync, [], [True]

    def fdatasync(file: int) -> None:
        if refusing[0]:
            raise OSError(5, "Input/output error")
        synced.append(str(Path(f"/proc/self/fd/{file}").readlink()))
        real(file)

    monkeypatch.setattr(os, "fdatasync", fdatasync)
    before = len(list(Path("/proc/self/fd").iterdir()))
    with pytest.raises(OSError, match="Input/output error"):
        journal.sync()
    assert len(list(Path("/proc/self/fd").iterdir())) == before
    refusing[0] = False
    journal.sync()
    assert [Path(name).name for name in synced] == [path.name for path in sorted(tmp_path.glob("*.hbj"))]
    synced.clear()
    journal.sync()
    assert len(synced) == 1
    journal.close()


def test_a_header_that_was_not_stored_is_in_no_segment(tmp_path, monkeypatch):
    """The disk is full after the new segment, which the change begins, has its own header."""
    with Journal(tmp_path, b"old", segment_bytes=1) as journal:
        write, room = journal._write, [1]

        def full(*record):
            if not room:
                raise OSError(28, "No space left on device")
            room.pop()
            write(*record)

        with monkeypatch.context() as patch:
            patch.setattr(journal, "_write", full)
            with pytest.raises(JournalFullError):
                journal.reopen(b"new")
        journal.append(1, 1, b"x")
    payloads = [segment.payload(row) for segment in segments(tmp_path) for row in range(len(segment.records))]
    assert payloads == [b"old", b"old", b"old", b"x"]
