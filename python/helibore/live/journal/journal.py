"""The journal: it stores every received byte on disk before any other code reads it.

A journal is a folder of numbered segment files. A segment is a header (32 bytes, at 0 and again at 4096, so that one
torn sector does not destroy both) and records with checksums (``cpp/include/helibore/journal.hpp`` shows a record).
Every prefix of a segment is valid::

    000001.hbj  | header | zeros | header | record | record | ...
    000002.hbj  | header | zeros | header | record | ...            <- appended to, locked by its writer
    archive/000001.hbj.gz                                           a segment that ``archived_segments.py`` compressed

Segments of format 1 have their second header at 32; they are read and continued, and new segments have format 2.

The journal does not use SQLite. It writes a record with one ``pwritev`` at the end of a file. It has no index that can
be corrupted, and it never stops to reorganise its file while a socket waits. Damage destroys only the records that it
touches.

After :meth:`Journal.append` returns, the operating system has the bytes, and they survive the end of the process (kill
-9). A power cut or a system crash can destroy the records after the last :meth:`Journal.sync`: with ``sync_interval`` =
0.1 s, the records of the last 100 ms and of the duration of one fdatasync. With ``sync_interval`` = 0 every append is
synced before it returns.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import secrets
import struct
import threading
import time
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from helibore import _core
from helibore.base.arrays import Rows
from helibore.base.atomic_file import PRIVATE, make_folder
from helibore.base.errors import InputError

BYTES, OPENED, CONNECTED, CLOSED, SAMPLES, STATIONS, IMAGE, FITTED = range(8)
"""Kinds of record: received bytes; the journal was opened; a connection began or ended; values pushed by the host; the
settings that a fit found for a layer whose estimator is automatic."""

HEADER = struct.Struct("<8sIIQII")  # magic, version, segment, first sequence number, salt, checksum
MAGIC = b"HELIBJ\r\n"
VERSION = 2
SECOND_HEADERS = {1: HEADER.size, VERSION: 4096}
RECORDS_START = SECOND_HEADERS[VERSION] + HEADER.size
ARCHIVE = "archive"
RECORD_HEADER = 48
LONGEST_PAYLOAD = 1 << 20
PIECE = 1 << 16
"""Bytes of an archived segment that are decompressed at a time."""


class JournalFullError(OSError):
    """The disk refused a record or a sync. Earlier acknowledged records are intact, and the next try may succeed."""


@dataclass(frozen=True, slots=True)
class Segment:
    """The intact records of one file.

    Attributes
    ----------
    records
        Structured (n,): sequence, wall, monotonic (ns), offset, length (of the payload), connection, source, kind.
    damage
        Byte ranges [start, stop) that hold no intact record. If ``error`` is not "", the last range is empty: the bytes
        after it are lost.
    text
        The whole file.
    error
        What is wrong with the compressed file of an archived segment; "" if nothing is.
    """

    path: Path
    records: Rows
    damage: list[tuple[int, int]]
    text: bytes
    error: str = ""

    def payload(self, row: int) -> bytes:
        """Return the bytes of record ``row``."""
        start = int(self.records["offset"][row])
        return self.text[start : start + int(self.records["length"][row])]

    def wall_before(self, offset: int) -> int:
        """Return the wall clock time of the last intact record before ``offset``.

        If there is no such record, return the time of the first record; 0 if no record is intact.
        """
        at = int(np.searchsorted(self.records["offset"], offset)) - 1
        return int(self.records["wall"][max(at, 0)]) if len(self.records) else 0

    @property
    def number(self) -> int:
        """Number of the segment, from 1."""
        return number_of(self.path)

    def damage_texts(self) -> list[str]:
        """Return one line for each damaged range."""
        return [
            f"{self.path.name}: bytes {start} to {stop} hold no intact record ({stop - start} bytes lost)"
            if start < stop else f"{self.path.name}: {self.error}: what follows byte {start} is lost"
            for start, stop in self.damage
        ]  # fmt: skip


@dataclass(slots=True)
class Recovery:
    """What opening a journal found and did.

    Attributes
    ----------
    last_sequence
        The next record gets the number after ``last_sequence``, which is the number of the last record; a larger
        number if the last segment has no intact record; -1 in a new journal.
    cut_bytes
        Number of bytes at the ends of segments that were no whole record, and were moved to files ``*.torn``.
    notes
        One line of text for each end of a segment that was moved.
    damage
        One line for each other damaged range of the last segment; the range stays in the file. `segments` returns the
        damage of all segments.
    """

    last_sequence: int = -1
    cut_bytes: int = 0
    notes: list[str] = field(default_factory=list)
    damage: list[str] = field(default_factory=list)


class _Header(NamedTuple):
    version: int
    sequence: int
    salt: int

    @property
    def records_start(self) -> int:
        return SECOND_HEADERS[self.version] + HEADER.size


def paths(folder: Path) -> list[Path]:
    """Return the segment files of a journal in order, without those in its archive."""
    return sorted((path for path in folder.glob("*.hbj") if path.stem.isdigit()), key=number_of)


def all_paths(folder: Path) -> list[Path]:
    """Return the segment files of a journal and of its archive, in order; a segment in both folders is listed once."""
    found = {number_of(path): path for path in paths(folder)}  # before the archive: a segment may move there
    archived = {number_of(path): path for path in (folder / ARCHIVE).glob("*.hbj.gz") if path.name[:-7].isdigit()}
    found = archived | found
    return [found[number] for number in sorted(found)]


def number_of(path: Path) -> int:
    """Return the number of a segment, with which the name of its file begins."""
    return int(path.name.partition(".")[0])


def content(path: Path, size: int = -1) -> tuple[bytes, str]:
    """Return the first ``size`` bytes of a segment (-1: all), and what is wrong with its file if it is archived, or "".

    A damaged archived segment gives the bytes of the pieces (`PIECE`) that can be decompressed. A segment that is
    archived while it is being read is read from the archive.

    Raises
    ------
    FileNotFoundError
        If the segment was deleted.
    """
    if path.suffix != ".gz":
        try:
            with path.open("rb") as file:
                return file.read(size), ""
        except FileNotFoundError:
            path = path.parent / ARCHIVE / f"{path.name}.gz"
    text, error, packed = bytearray(), "", zlib.decompressobj(zlib.MAX_WBITS | 16)
    with path.open("rb") as file:
        while not packed.eof and not 0 <= size <= len(text):
            piece = file.read(PIECE)
            try:
                text += packed.decompress(piece)
            except zlib.error as problem:
                error = f"damaged: {problem}"
            if error or not piece:
                break
    if not error and not packed.eof and not 0 <= size <= len(text):
        error = "damaged: it ends early"
    return bytes(text if size < 0 else text[:size]), error


def segments(folder: str | os.PathLike[str], first: int = 1) -> Iterator[Segment]:
    """Yield the segments of a journal from number ``first`` on; a journal can also be read while it is written.

    Raises
    ------
    ValueError
        If the folder holds no journal, or no segment of it has an intact header.
    """
    found = all_paths(Path(folder))
    if not found:
        raise InputError(str(folder), "holds no journal (no file 000001.hbj)")
    salt = salt_of(found)
    for path in (path for path in found if number_of(path) >= first):
        try:
            text, error = content(path)
        except FileNotFoundError:  # an archive command has just deleted it
            continue
        header = _intact_header(text, path)
        start = header.records_start if header else RECORDS_START
        records, damage = _core.journal_scan(text, min(start, len(text)), salt)
        if error:
            damage.append((len(text), len(text)))
        yield Segment(path, records, damage, text, error)


def salt_of(found: list[Path]) -> int:
    """Return the random number that all segments of a journal share, from the last segment with an intact header.

    Raises
    ------
    InputError
        If no segment has an intact header, or if a header has a newer version.
    """
    for path in reversed(found):  # the archived ones, which must be decompressed, come last
        if header := header_of(path):
            return header.salt
    raise InputError(str(found[0].parent), "no segment has an intact header")


def header_of(path: Path) -> _Header | None:
    """Return the header of a segment; None if no copy of it is intact, or if the segment was deleted meanwhile.

    Raises
    ------
    InputError
        If the header has a newer version.
    """
    with contextlib.suppress(FileNotFoundError):
        return _intact_header(content(path, RECORDS_START)[0], path)
    return None


def _intact_header(head: bytes, path: Path) -> _Header | None:
    for start in (0, *SECOND_HEADERS.values()):
        if len(head) >= start + HEADER.size:
            magic, version, _, sequence, salt, checksum = HEADER.unpack_from(head, start)
            if magic == MAGIC and checksum == _core.crc32c(head[start : start + HEADER.size - 4]):
                if version not in SECOND_HEADERS:
                    raise InputError(str(path), f"version {version}: this helibore reads versions up to {VERSION}")
                return _Header(version, sequence, salt)
    return None


def first_wall(path: Path) -> int:
    """Return the receive time of the first intact record near the start of a segment, ns since 1970 (0: none)."""
    text, _ = content(path, RECORDS_START + 2 * LONGEST_PAYLOAD)
    header = _intact_header(text, path)
    if header is None:
        return 0
    records, _ = _core.journal_scan(text, min(header.records_start, len(text)), header.salt)
    return int(records["wall"][0]) if len(records) else 0


def segment_of(folder: Path, sequence: int) -> int:
    """Return the number of the last segment whose header gives a first record up to ``sequence``; 1 if none does."""
    for path in reversed(all_paths(folder) if sequence else []):
        header = header_of(path)
        if header and header.sequence <= sequence:
            return number_of(path)
    return 1


def _header(number: int, sequence: int, salt: int) -> bytes:
    start = HEADER.pack(MAGIC, VERSION, number, sequence, salt, 0)[:-4]
    header = start + struct.pack("<I", _core.crc32c(start))
    return header.ljust(SECOND_HEADERS[VERSION], b"\0") + header


def _lock(file: int, folder: Path) -> None:
    """Lock a file of the journal; raise InputError if another process has locked it."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise InputError(str(folder), "is being written by another process") from None


class Journal:
    """The only writer of a journal folder; the constructor repairs the end of the journal (see `Recovery`).

    Parameters
    ----------
    folder
        Folder of the journal; it is made if it does not exist.
    opening
        Payload of the OPENED record that begins this session and each segment.
    segment_bytes
        A segment that has reached this size is followed by a new one.
    sync_interval
        0: every append is synced before it returns. Otherwise the caller must call :meth:`sync` about every
        ``sync_interval`` seconds.
    clock
        Returns (wall ns, monotonic ns).

    Raises
    ------
    ValueError
        If another process writes this journal, if no segment has an intact header, or if a header has a newer version.
    OSError
        If the folder cannot be written.
    """

    def __init__(
        self,
        folder: str | os.PathLike[str],
        opening: bytes = b"{}",
        *,
        segment_bytes: int = 64 << 20,
        sync_interval: float = 0.1,
        clock: Callable[[], tuple[int, int]] = lambda: (time.time_ns(), time.monotonic_ns()),
    ) -> None:
        self.folder = Path(folder)
        self.sync_interval = sync_interval
        self.recovery = Recovery()
        self._opening = opening
        self._segment_bytes = segment_bytes
        self._clock = clock
        self._lock = threading.Lock()
        self._unsynced: list[int] = []
        self._named = -1  # the last segment whose file name is synced
        self._syncing = threading.Lock()
        self._file = -1
        self._path = self.folder
        make_folder(self.folder)
        self._directory = os.open(self.folder, os.O_RDONLY)
        self._guard = os.open(self.folder / "lock", os.O_RDWR | os.O_CREAT, PRIVATE)
        try:
            _lock(self._guard, self.folder)
            self._recover()
            self._write(0, 0, self._opening, OPENED, *self._clock())
            self.sync()
        except BaseException:
            self._close_files()
            raise

    def _recover(self) -> None:
        """Find where the records of the last segment end, and move the incomplete bytes after them to another file."""
        found = paths(self.folder)
        if found:  # the lock file may be removed, so the writer also locks its segment
            last = os.open(found[-1], os.O_RDWR)
            try:
                _lock(last, self.folder)
            finally:
                os.close(last)
        while found and self._is_empty(found[-1]):  # the process died while it made this segment
            self._set_aside(found.pop(), 0)
        if not found:
            before = all_paths(self.folder)  # only archived segments are left
            self._salt = salt_of(before) if before else secrets.randbits(32)
            self._number = number_of(before[-1]) if before else 0
            self._sequence = self._first_sequence() if before else 0
            self.recovery.last_sequence = self._sequence - 1
            self._begin_segment()
            return
        self._salt, self._number = salt_of(found), number_of(found[-1])
        text = found[-1].read_bytes()
        header = _intact_header(text, found[-1])
        records, damage = _core.journal_scan(text, header.records_start if header else RECORDS_START, self._salt)
        stop = len(text)
        if damage and damage[-1][1] == len(text):
            stop = damage.pop()[0]
            self._set_aside(found[-1], stop)
        self.recovery.damage += Segment(found[-1], records, damage, text).damage_texts()
        self._sequence = int(records["sequence"][-1]) + 1 if len(records) else self._first_sequence()
        self.recovery.last_sequence = self._sequence - 1
        self._path = found[-1]
        self._file = os.open(self._path, os.O_RDWR)
        _lock(self._file, self.folder)
        self._stop = stop

    @staticmethod
    def _is_empty(path: Path) -> bool:
        """Return whether a segment is too short to hold a record."""
        header = header_of(path)
        return path.stat().st_size < (header.records_start if header else RECORDS_START)

    def _first_sequence(self) -> int:
        """Return a sequence number after all others, for a journal whose last segment has no intact record."""
        last = [segment.records["sequence"] for segment in segments(self.folder)]
        after = max((int(numbers[-1]) + 1 for numbers in last if len(numbers)), default=0)
        return after + (1 << 32)  # more than the number of lost records

    def _set_aside(self, path: Path, stop: int) -> None:
        """Cut ``path`` at ``stop``; keep the bytes after it in a separate file."""
        torn = path.read_bytes()[stop:]
        if torn:
            aside = path.with_name(f"{path.stem}-{stop}.torn")
            aside.touch(PRIVATE)
            aside.write_bytes(torn)
            self.recovery.cut_bytes += len(torn)
            self.recovery.notes.append(f"{path.name}: torn after byte {stop}; {len(torn)} bytes were set aside")
        if stop == 0:
            path.unlink()
        else:
            os.truncate(path, stop)

    def _begin_segment(self) -> None:
        path = self.folder / f"{self._number + 1:06d}.hbj"
        beside = path.with_suffix(".new")
        file = os.open(beside, os.O_RDWR | os.O_CREAT | os.O_TRUNC, PRIVATE)
        try:
            _lock(file, self.folder)
            os.pwrite(file, _header(self._number + 1, self._sequence, self._salt), 0)
            if os.fstat(file).st_size < RECORDS_START:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            beside.rename(path)
        except BaseException:
            os.close(file)
            raise
        if self._file >= 0:
            self._unsynced.append(self._file)
        self._number, self._path, self._file, self._stop = self._number + 1, path, file, RECORDS_START

    def append(self, source: int, connection: int, payload: bytes, kind: int = BYTES) -> tuple[int, int, int]:
        """Store a record with ``payload``; after the return, the record survives the end of the process.

        Returns
        -------
        tuple
            (sequence number, wall ns, monotonic ns) of the record.

        Raises
        ------
        JournalFullError
            If the disk refuses the record, or its sync if every append is synced; or if the file of the segment was
            deleted. No part of the record remains.
        ValueError
            If the payload is over 1 MiB.
        """
        if self.sync_interval > 0:
            return self._append(source, connection, payload, kind)
        with self._syncing:  # no other append starts before this record is synced, so it can be removed
            opening = self._opening
            stamp = self._append(source, connection, payload, kind)
            try:
                self._sync()
            except BaseException:
                self._take_back(payload)
                self._opening = opening
                raise
        return stamp

    def _append(self, source: int, connection: int, payload: bytes, kind: int) -> tuple[int, int, int]:
        with self._lock:
            wall, monotonic = self._clock()
            try:
                if os.fstat(self._file).st_nlink == 0:
                    raise FileNotFoundError(errno.ENOENT, "the segment was deleted")
                if self._stop >= self._segment_bytes:
                    self._begin_segment()
                    self._write(0, 0, self._opening, OPENED, wall, monotonic)
                self._write(source, connection, payload, kind, wall, monotonic)
                if kind == OPENED:
                    self._opening = payload
            except OSError as error:
                raise JournalFullError(
                    error.errno, f"{error.strerror}: the record was not stored", str(self.folder)
                ) from error
            return self._sequence - 1, wall, monotonic

    def _take_back(self, payload: bytes) -> None:
        """Remove the last record, whose sync failed; a later sync may succeed although the record is not on disk."""
        with self._lock:
            self._stop -= RECORD_HEADER + len(payload)
            self._sequence -= 1
            with contextlib.suppress(OSError):  # if this fails, the next record overwrites it
                os.ftruncate(self._file, self._stop)

    def _write(self, source: int, connection: int, payload: bytes, kind: int, wall: int, monotonic: int) -> None:
        header = _core.journal_seal(self._sequence, wall, monotonic, connection, source, kind, payload, self._salt)
        size = len(header) + len(payload)
        try:
            written = os.pwritev(self._file, [header, payload], self._stop)
            while written < size:  # the disk is full: the next write raises the reason
                written += os.pwrite(self._file, (header + payload)[written:], self._stop + written)
        except OSError:
            os.ftruncate(self._file, self._stop)
            raise
        self._stop += size
        self._sequence += 1

    def reopen(self, opening: bytes) -> tuple[int, int, int]:
        """Append an OPENED record with another payload, which each later segment repeats; return as `append` does."""
        return self.append(0, 0, opening, OPENED)

    def sync(self) -> None:
        """Write all appended records to the disk itself; other threads may append meanwhile.

        Raises
        ------
        JournalFullError
            If the disk refuses the sync, or the file of the segment was deleted or replaced; the next call tries again.
        """
        with self._syncing:
            self._sync()

    def _sync(self) -> None:
        with self._lock:  # only this function closes files, so a sync needs no new descriptor
            finished, current, number, path = list(self._unsynced), self._file, self._number, self._path
        try:
            for file in [*finished, current]:
                os.fdatasync(file)
            if number != self._named:  # a new segment: sync its file name too
                os.fsync(self._directory)
            if not os.path.samestat(path.stat(), os.fstat(current)):
                raise FileNotFoundError(errno.ENOENT, f"{path.name} was replaced by another file")
        except OSError as error:
            raise JournalFullError(error.errno, f"{error.strerror}: not synced", str(self.folder)) from error
        with self._lock:
            self._named = number
            self._unsynced = self._unsynced[len(finished) :]
        for file in finished:
            os.close(file)

    @property
    def salt(self) -> int:
        """The random number that all segments of this journal share."""
        return self._salt

    @property
    def segment(self) -> int:
        """Number of the segment that is written."""
        return self._number

    @property
    def bytes_left(self) -> int:
        """Number of bytes that this user can still write to the disk."""
        status = os.statvfs(self.folder)
        return status.f_bavail * status.f_frsize

    def close(self) -> None:
        """Sync and close the files."""
        try:
            if self._file >= 0:
                self.sync()
        finally:
            self._close_files()

    def _close_files(self) -> None:
        with self._syncing:
            for file in [*self._unsynced, self._file, self._guard, self._directory]:
                if file >= 0:
                    os.close(file)
            self._unsynced, self._file, self._guard, self._directory = [], -1, -1, -1

    def __enter__(self) -> Journal:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
