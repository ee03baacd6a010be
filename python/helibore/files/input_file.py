"""Read the bytes of a plain or gzipped file; only the bytes that a caller asks for are in memory.

    path -> first bytes -> format name          (the name of the file does not matter)
    path -> stream()    -> bytes, gunzipped (a gzip bomb is refused); text of a stated encoding or UTF-16 as UTF-8
    path -> lines(), pieces(), text()           (a very long line is refused: see LINE_LIMIT)

This file does not know about channels.
"""

from __future__ import annotations

import codecs
import gzip
import io
import re
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, cast

from helibore.base.errors import InputError
from helibore.base.limits import check_unpacked
from helibore.base.regular_file import check_regular

LINE_LIMIT = 1 << 20
"""Longest line (bytes) that `lines` yields, and the number of bytes read at a time.

`pieces` and `text` may read a line of up to four times this length; they refuse any longer line.
"""

HEAD = 1 << 16
"""Number of bytes at the start of a file that decide its format."""

PIECE = 1 << 21
"""Bytes that are unpacked (packed table) or decoded (table that is not UTF-8) at a time.

This number must not be less than the 2 MiB in which `delimited` looks for the header.
"""

TEXT_LIMIT = 1 << 30
"""Largest text (bytes) of a format that is read whole (LAS)."""

LINE_COST = 64
"""Bytes of memory that a line of a text needs beyond its characters; lines of packed texts count as this many more."""

UTF8_BOM = codecs.BOM_UTF8
SALVAGE = "; salvage = true reads what is before the damage"
"""End of a message about a file of which a part can be read."""

CYRILLIC_WORD = re.compile(rb"[\xc0-\xff]{3,20}")
"""A word of Windows-1251; in Windows-1252, three letters with accents hardly ever follow each other."""

END_OF_TEXT = b"\x1a"
"""Control-Z, with which old programs of DOS end a text."""

# First bytes of files that helibore does not read, and the advice in the error.
FOREIGN = {
    b"glTF": "a mesh (GLB) holds no samples: take the settings beside it (.glb.toml), a .wall or the caliper file",
    b"BZh": "bzip2: unpack it first",
    b"\xfd7zXZ": "xz: unpack it first",
    b"\x28\xb5\x2f\xfd": "zstandard: unpack it first",
    b"7z\xbc\xaf": "a 7-zip archive: unpack it first",
    b"\x89HDF": "HDF5: not a format that helibore reads",
    b"\xd0\xcf\x11\xe0": "an old Excel or a Word file: save the sheet as XLSX or CSV",
    b"%PDF": "a PDF: not a format that helibore reads",
}


def file_error(
    path: Path, rule: str, line: int | str | None = None, column: str | None = None, value: str | None = None
) -> InputError:
    """Return an InputError that names the file, and the line (or "row 7") and the column if they are known."""
    place = path.name
    if line is not None:
        place += f", line {line}" if isinstance(line, int) else f", {line}"
    if column is not None:
        place += f", column {column}"
    return InputError(place, rule, value)


class Gunzip(io.RawIOBase):
    """The unpacked bytes of a gzip file; gzip bombs are refused, and errors name the file.

    If there is a set ``lost``, a stream that is damaged ends at the damage, and the set gets a sentence about it.
    """

    def __init__(self, path: Path, lost: set[str] | None = None) -> None:
        self._path, self._lost = path, lost
        self._packed = path.open("rb")
        self._plain = gzip.GzipFile(fileobj=self._packed, mode="rb")
        self._unpacked = 0

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        try:
            piece = self._plain.read1(len(buffer))
        except (EOFError, OSError, zlib.error) as error:
            damage = self._damage(error)
            if self._lost is None:
                raise damage from error
            self._lost.add(f"salvaged: {damage.rule.removesuffix(SALVAGE)}: what follows is lost")
            return 0
        self._unpacked += len(piece)
        check_unpacked(self._path.name, self._unpacked, self._packed.tell())
        buffer[: len(piece)] = piece
        return len(piece)

    def _damage(self, error: Exception) -> InputError:
        if isinstance(error, EOFError):
            return file_error(self._path, f"truncated: the gzip stream ends early{SALVAGE}")
        return file_error(self._path, f"damaged gzip stream ({error})")

    def close(self) -> None:
        if not self.closed:
            self._plain.close()
            self._packed.close()
        super().close()


class Transcoder(io.RawIOBase):
    """The text of a stream in any encoding, as UTF-8; a byte that the encoding does not know raises an error."""

    def __init__(self, path: Path, stream: BinaryIO, encoding: str) -> None:
        self._path, self._stream, self._encoding = path, stream, encoding
        self._decoder = codecs.getincrementaldecoder(encoding)()
        self._ready = b""

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        more = True
        while not self._ready and more:
            piece = self._stream.read(len(buffer))
            more = bool(piece)
            try:
                self._ready = self._decoder.decode(piece, final=not more).encode()
            except UnicodeError as error:
                raise file_error(self._path, f"is not {self._encoding} text throughout ({error})") from error
        size = min(len(buffer), len(self._ready))
        buffer[:size], self._ready = self._ready[:size], self._ready[size:]
        return size

    def close(self) -> None:
        if not self.closed:
            self._stream.close()
        super().close()


@dataclass(frozen=True)
class ReadOptions:
    """What a caller states about a file because the file does not.

    Attributes
    ----------
    nulls
        Numbers that mean no value.
    header_line
        The line of a table's column names, counted from 1. None: it is searched.
    encoding
        Name of the text's encoding, such as "cp1251". None: UTF-8, UTF-16 with its mark, or else Windows-1252.
    decimal
        The decimal mark of numbers, "." or ",". None: the cells decide.
    salvage
        Whether a truncated or damaged file gives what can be read of it, with a remark on what is lost.
    strict
        Whether a file of which only a part can be read is an error; else the part is read, with a remark.
    layouts
        A file of rules for the layout of texts (``text_layouts``), which come before those of helibore.

    Raises
    ------
    InputError
        If the encoding is unknown to Python or not of text, or ``decimal`` is another mark.
    """

    nulls: tuple[float, ...] = ()
    header_line: int | None = None
    encoding: str | None = None
    decimal: str | None = None
    salvage: bool = False
    strict: bool = False
    layouts: Path | None = None

    def __post_init__(self) -> None:
        if self.decimal not in (None, ".", ","):
            raise InputError("decimal", "must be . or ,", repr(self.decimal))
        if self.encoding is not None:
            try:
                "".encode(self.encoding)
            except LookupError:
                raise InputError("encoding", "is not one that Python knows", repr(self.encoding)) from None


def _utf16(head: bytes) -> str | None:
    """Return the name of the kind of UTF-16 that a file is in, None if it is in none.

    Without the mark of its order, it is UTF-16 if every second byte of the first 200 is zero and no other: a header.
    """
    if head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    even, odd = head[:200:2], head[1:200:2]
    if len(odd) < 8:
        return None
    if not any(odd) and 0 not in even:
        return "utf-16-le"
    return "utf-16-be" if not any(even) and 0 not in odd else None


class InputFile:
    """One file on disk: its path, its first bytes, its bytes as a stream, and what the caller states about it."""

    def __init__(self, path: Path, options: ReadOptions = ReadOptions()) -> None:
        self.path, self.options = path, options
        self.lost: set[str] = set()  # sentences on what a salvaged file has lost
        check_regular(path)
        with path.open("rb") as file:
            self.compressed = file.read(2) == b"\x1f\x8b"
        self.encoding: str | None = None
        with self.stream() as stream:
            self.head = read_exactly(stream, HEAD)
        if options.encoding is not None and (b"\0" not in self.head or "16" in options.encoding):
            self.encoding = options.encoding
        else:
            self.encoding = _utf16(self.head)
        if self.encoding is not None:
            with self.stream() as stream:
                self.head = read_exactly(stream, HEAD)

    @property
    def nulls(self) -> tuple[float, ...]:
        return self.options.nulls

    @property
    def as_stored(self) -> bool:
        """Whether the stream's bytes are those on the disk: neither unpacked nor decoded."""
        return not self.compressed and self.encoding is None

    def stream(self) -> BinaryIO:
        """Return a stream of the file's bytes, unpacked and as UTF-8. The caller closes the stream."""
        stream = self.path.open("rb")
        if self.compressed:
            stream.close()
            stream = cast(
                Any, io.BufferedReader(Gunzip(self.path, self.lost if self.options.salvage else None), LINE_LIMIT)
            )
        if self.encoding is not None:
            stream = cast(Any, io.BufferedReader(Transcoder(self.path, stream, self.encoding), LINE_LIMIT))
        return stream

    def lines(self) -> Iterator[bytes]:
        """Yield every line with its ending; a line longer than ``LINE_LIMIT`` raises an error that names the line."""
        with self.stream() as stream:
            number = 1
            while line := stream.readline(LINE_LIMIT + 1):
                if len(line) > LINE_LIMIT:
                    raise self.line_too_long(number)
                yield line
                number += 1

    def pieces(self) -> Iterator[bytes]:
        """Yield the content in pieces of whole lines, about 2 MiB each; a line that is too long raises an error."""
        with self.stream() as stream:
            lines, rest = 0, b""
            while more := read_exactly(stream, PIECE):
                piece = rest + more
                end = 1 + max(piece.rfind(b"\n"), piece.rfind(b"\r"))
                if end:
                    yield piece[:end]
                    lines += piece.count(b"\n")
                elif len(piece) > LINE_LIMIT:
                    raise self.line_too_long(lines + 1)
                rest = piece[end:]
            if rest:
                yield rest

    def damaged(self, what: str, error: BaseException, column: str | None = None) -> InputError:
        """Return an InputError with the text ``what`` ("damaged LIS") and the first line of ``error``, of a library."""
        reason = (str(error).strip().splitlines() or [type(error).__name__])[0]
        return self.error(f"{what} ({reason})", column=column)

    def error(
        self, rule: str, line: int | str | None = None, column: str | None = None, value: str | None = None
    ) -> InputError:
        return file_error(self.path, rule, line, column, value)

    def line_too_long(self, line: int | None) -> InputError:
        return self.error(f"a line is longer than {LINE_LIMIT:,} bytes", line)

    def text(self) -> tuple[str, str]:
        """Return the whole text and a remark on its encoding ('' for UTF-8).

        A text that is UTF-8 throughout is read as UTF-8, any other text as Windows-1252, with a remark. A text of which
        only some lines are UTF-8 with characters beyond ASCII mixes encodings. It is refused, because neither encoding
        fits all of it.
        """
        content, lines = bytearray(), 0
        with self.stream() as stream:
            while piece := read_exactly(stream, LINE_LIMIT):
                if len(piece) == LINE_LIMIT and b"\n" not in piece and b"\r" not in piece:
                    raise self.line_too_long(content.count(b"\n") + 1)
                content += piece
                if len(content) > TEXT_LIMIT:
                    raise self.error(f"more than {TEXT_LIMIT >> 20} MiB of text, which is read whole; split the file")
                if self.compressed:
                    lines += piece.count(b"\n")
                    check_unpacked(self.path.name, len(content) + LINE_COST * lines, self.path.stat().st_size)
        return decode(self.path, content)


def decode(path: Path, content: bytes | bytearray) -> tuple[str, str]:
    """Return ``content`` as text, with ``\\n`` for every newline, and a remark on the encoding ('' for UTF-8)."""
    while content.startswith(UTF8_BOM):  # removeprefix copies all of it, with or without the mark
        content = content[len(UTF8_BOM) :]
    if content[-4:].rstrip(b"\r\n").endswith(END_OF_TEXT):
        content = content.rstrip(b"\r\n").rstrip(END_OF_TEXT)
    at = content.find(b"\0")
    if at >= 0:
        raise file_error(path, "a zero byte: not text, or damaged", content.count(b"\n", 0, at) + 1)
    try:
        text, remark = content.decode("utf-8"), ""
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        odd = _utf8_line(content)
        if odd is not None:
            rule = f"encodings are mixed: line {odd} is UTF-8, byte 0x{content[error.start]:02x} here is not"
            raise file_error(path, rule, line) from error
        try:
            text = content.decode("cp1252")
        except UnicodeDecodeError as other:
            rule = f"byte 0x{content[other.start]:02x} is neither UTF-8 nor Windows-1252{_cyrillic(content)}"
            raise file_error(path, rule, content.count(b"\n", 0, other.start) + 1) from error
        remark = f"not UTF-8 (line {line}): read as Windows-1252; the option encoding names another{_cyrillic(content)}"
    if "\r" in text:
        text = text.replace("\r\n", "\n").replace("\r", "\n")
    return text, remark


def _cyrillic(content: bytes | bytearray) -> str:
    """Return the encoding to try, with a word, if letters beyond ASCII stand together as only Cyrillic ones do."""
    word = CYRILLIC_WORD.search(content)
    return f": cp1251 reads {word[0].decode('cp1251')}" if word else ""


def _utf8_line(content: bytes | bytearray) -> int | None:
    """Return the number of the first line that is not ASCII and is valid UTF-8 as a whole; None if there is none."""
    lines: list[bytes | bytearray] = [*content.split(b"\n")]
    for number, line in enumerate(lines, 1):
        if not line.isascii():
            with suppress(UnicodeDecodeError):
                line.decode("utf-8")
                return number
    return None


def read_exactly(stream: BinaryIO, size: int) -> bytes:
    """Read ``size`` bytes, or fewer at the end of the stream; memory grows only with the bytes that are read."""
    pieces = []
    while size and (piece := stream.read(min(size, LINE_LIMIT))):
        pieces.append(piece)
        size -= len(piece)
    return b"".join(pieces)


def zip_pieces(source: InputFile, file: BinaryIO, entry: zipfile.ZipInfo) -> Iterator[bytes]:
    """Yield the unpacked bytes of a member of a zip archive as any reader finds them, whatever size the directory says.

    `zipfile` stops at the size in the directory; readers in other languages do not. Raise InputError if the member is
    not where the directory says, is cut, or is packed by another method than deflate.
    """
    place = f"{source.path.name}, {entry.filename}"
    file.seek(entry.header_offset)
    start = file.read(30)
    if start[:4] != b"PK\x03\x04" or len(start) < 30:
        raise InputError(place, "truncated or damaged: the directory of the zip archive names a place without a member")
    file.seek(int.from_bytes(start[26:28], "little") + int.from_bytes(start[28:30], "little"), io.SEEK_CUR)
    left = entry.compress_size
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED) or entry.flag_bits & 1:
        raise InputError(place, "must be stored or packed by deflate, and not encrypted")
    inflater = zlib.decompressobj(-zlib.MAX_WBITS) if entry.compress_type == zipfile.ZIP_DEFLATED else None
    while left:
        piece = file.read(min(left, HEAD))
        if not piece:
            raise InputError(place, "truncated: the zip archive ends within this member")
        left -= len(piece)
        while piece:
            plain = inflater.decompress(piece, LINE_LIMIT) if inflater else piece
            piece = inflater.unconsumed_tail if inflater else b""
            yield plain


def find_format(source: InputFile) -> str:
    """Return the format of a file by its content: csv, xlsx, parquet, las, dlis, lis, json, witsml or npz."""
    head = source.head
    if not head:
        raise source.error("empty: 0 bytes")
    for magic, advice in FOREIGN.items():
        if head.startswith(magic):
            raise source.error(advice)
    if binary := _binary_format(source):
        if source.compressed:
            raise source.error(f"a gzipped {binary} file: unpack it first")
        return binary
    if b"\0" in head:
        raise source.error("binary, and no format that helibore reads (DLIS, LIS, Parquet, NPZ, XLSX)")
    text = head.removeprefix(UTF8_BOM).lstrip()
    if not text:
        raise source.error("empty: nothing but blanks")
    if re.match(rb"<(!doctype )?\s*(html|table)\b", text, re.IGNORECASE):
        raise source.error("a page of HTML, perhaps named .xls: open it in a spreadsheet and save it as XLSX or CSV")
    if b"urn:schemas-microsoft-com:office:spreadsheet" in head[:2000]:
        raise source.error("a workbook in XML of Excel 2003: save it as XLSX or CSV")
    if text.startswith(b"<"):
        return "witsml"
    if text.startswith((b"{", b"[")) and not re.match(rb"\[[A-Za-z][\w ]*\]\s*\n", text):  # not [Header] of a text
        return "json"
    lines = (line.lstrip() for line in text.splitlines())
    first = next((line for line in lines if line and not line.startswith(b"#")), b"")
    return "las" if first.startswith(b"~") else "csv"


def _binary_format(source: InputFile) -> str:
    head = source.head
    if head.startswith(b"PAR1"):
        return "parquet"
    # The storage unit label of RP66 V1 (80 bytes): sequence number, "V1.00", "RECORD"; tape marks may precede it.
    if b"V1.00RECORD" in head[:200]:
        return "dlis"
    if _is_lis(head) or (head.startswith(bytes(4)) and _is_lis(head[12:])):  # 12 bytes: a tape mark
        return "lis"
    if not head.startswith(b"PK\x03\x04"):
        return ""
    try:
        with zipfile.ZipFile(source.path) as archive:
            names = archive.namelist()
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError) as error:
        if source.compressed:
            return "zip"
        raise source.error(f"truncated or damaged zip archive ({error})") from error
    if names and all(name.endswith(".npy") for name in names):
        return "npz"
    if "xl/workbook.xml" in names:
        return "xlsx"
    if "helibore.json" in names:
        raise source.error("a saved wall: helibore plot, report, logs, mesh and view read it, and hb.load in Python")
    if "content.xml" in names:
        raise source.error("an OpenDocument file: save the sheet as XLSX or CSV")
    raise source.error("a zip archive: unpack it first")


def _is_lis(head: bytes) -> bool:
    """Return whether bytes start with a length and the header of a LIS reel (type 132), tape (130) or file (128)."""
    size, kind = int.from_bytes(head[:2], "big"), head[4:6]
    return 62 <= size <= 200 and kind in (b"\x84\0", b"\x82\0", b"\x80\0")
