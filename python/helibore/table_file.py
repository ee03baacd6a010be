"""Named columns of numbers from a CSV (.gz) or NPZ file, quickly, with the exact place of whatever is wrong; and back.

    line 1   # comments and blank lines before the header are skipped
    line 2   md_m,rb_deg,x_in            the delimiter is the one of , ; tab that the header holds most of
    line 3   3161.2332,327.352,6.23207   row 0: errors name the file, the column, the line and the rule

CSV is read by NumPy's own parser. Where that stops, the slow reader below goes through the file again, cell by cell: it
takes an empty cell as absent and names the first one that is no number. Both give the same values.
Not here: what a column means (``caliper_file``, ``survey_file``), and formats with more structure.
"""

from __future__ import annotations

import csv
import gzip
import warnings
import zipfile
import zlib
from array import array
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import IO, Any, Protocol, cast

import numpy as np
import numpy.typing as npt

from helibore.arrays import Floats, column
from helibore.atomic_file import write_whole

ABSENT = (-999.25, -9999.0)
"""The numbers that mean: no value. An empty CSV cell is read as the first of them."""

_LONGEST_HEADER = 1 << 20


class Table(Protocol):
    """A file with named columns, opened but not yet read."""

    path: str
    format: str
    names: list[str]

    def read(self, names: Sequence[str]) -> list[Floats]:
        """Return these columns, equally long, each an owned float64 array. NaN and infinity pass."""

    def place(self, name: str, row: int) -> str:
        """Return where ``row`` (from 0) of a column stands, for an error: ``column md_m, line 17``."""


def open_table(path: str | Path) -> Table:
    """Open a file by its content: a zip archive is NPZ, anything else is CSV, gzipped or not.

    Raises
    ------
    ValueError
        If the file is empty, not text, damaged, or its header names a column twice.
    OSError
        If it cannot be read.
    """
    path = Path(path)
    with path.open("rb") as file:
        start = file.read(4096)
    if not start:
        raise ValueError(f"{path}: is empty: must have a header line and rows")
    if start[:4] in (b"PK\x03\x04", b"PK\x05\x06"):
        return _NpzTable(path)
    zipped = start[:2] == b"\x1f\x8b"
    if not zipped and b"\0" in start:
        raise ValueError(f"{path}: is not text: must be CSV (.gz) or NPZ")
    return _CsvTable(path, zipped)


class _CsvTable:
    def __init__(self, path: Path, zipped: bool) -> None:
        self.path, self._zipped = str(path), zipped
        self._header_line, header = self._find_header()
        self._delimiter = max(",;\t", key=header.count)
        named = {",": "comma", ";": "semicolon", "\t": "tab"}[self._delimiter]
        self.format = f"CSV, {named}-separated{', gzipped' if zipped else ''}"
        self.names = [
            name.strip() for name in next(csv.reader([header], delimiter=self._delimiter, skipinitialspace=True))
        ]
        for name in self.names:
            if name and self.names.count(name) > 1:
                raise ValueError(f"{self.path}: line {self._header_line}: two columns are called {name}")

    def read(self, names: Sequence[str]) -> list[Floats]:
        indexes = [self.names.index(name) for name in names]
        columns = self._read_fast(indexes)
        if columns is None:
            columns = self._read_slowly(indexes)
        if not columns[0].size:
            raise ValueError(f"{self.path}: has no rows below its header in line {self._header_line}")
        return columns

    def place(self, name: str, row: int) -> str:
        for index, (line, _) in enumerate(self._rows()):
            if index == row:
                return f"column {name}, line {line}"
        raise RuntimeError(f"{self.path} has no row {row}; this is a bug in helibore")

    def _open(self) -> IO[str]:
        if self._zipped:
            return cast(IO[str], gzip.open(self.path, "rt", encoding="utf-8-sig", newline=""))
        return Path(self.path).open(encoding="utf-8-sig", newline="")

    def _find_header(self) -> tuple[int, str]:
        """Return the first line that is neither blank nor a comment, and its number."""
        try:
            with self._open() as file:
                for number in range(1, 1000):
                    line = file.readline(_LONGEST_HEADER)
                    if len(line) >= _LONGEST_HEADER:
                        raise ValueError(f"{self.path}: line {number}: is longer than {_LONGEST_HEADER} characters")
                    if line.strip() and not line.startswith("#"):
                        return number, line.rstrip("\r\n")
                    if not line:
                        break
        except (EOFError, zlib.error, gzip.BadGzipFile, UnicodeDecodeError) as error:
            raise self._damaged(error) from error
        raise ValueError(f"{self.path}: has no header line")

    def _read_fast(self, indexes: list[int]) -> list[Floats] | None:
        """Read with NumPy's parser; None where it meets a cell it cannot read."""
        # NumPy reads a named file in large pieces and anything else line by line; it knows gzip by the name's ending.
        named = not self._zipped or self.path.endswith(".gz")
        try:
            with nullcontext(self.path) if named else self._open() as source, warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of no rows
                cells = np.loadtxt(
                    source, delimiter=self._delimiter, comments=None, quotechar='"', skiprows=self._header_line,
                    usecols=indexes, ndmin=2, encoding="utf-8-sig",
                )  # fmt: skip
        except (ValueError, EOFError, zlib.error, gzip.BadGzipFile):
            return None
        return [cells[:, index].copy() for index in range(len(indexes))]

    def _read_slowly(self, indexes: list[int]) -> list[Floats]:
        columns = [array("d") for _ in indexes]
        for line, row in self._rows():
            for index, values in zip(indexes, columns, strict=True):
                place = f"{self.path}: column {self.names[index]}, line {line}"
                if index >= len(row):
                    raise ValueError(f"{place}: the line has {len(row)} cells, the header has {len(self.names)}")
                values.append(_number(row[index], place))
        return [np.frombuffer(values, dtype=np.float64) if values else np.empty(0) for values in columns]

    def _rows(self) -> Iterator[tuple[int, list[str]]]:
        """Line number and cells of each row that is not blank."""
        with self._open() as file:
            reader = csv.reader(file, delimiter=self._delimiter, skipinitialspace=True)
            try:
                for row in reader:
                    line = reader.line_num
                    blank = not row or (len(row) == 1 and not row[0].strip())
                    if line > self._header_line and not blank:
                        yield line, row
            except csv.Error as error:
                raise ValueError(f"{self.path}: line {reader.line_num}: {error}") from error
            except (EOFError, zlib.error, gzip.BadGzipFile, UnicodeDecodeError) as error:
                raise self._damaged(error) from error

    def _damaged(self, error: Exception) -> ValueError:
        if isinstance(error, UnicodeDecodeError):
            return ValueError(f"{self.path}: is not UTF-8 text (byte 0x{error.object[error.start]:02x})")
        return ValueError(f"{self.path}: is damaged: {error}")


class _NpzTable:
    def __init__(self, path: Path) -> None:
        self.path, self.format = str(path), "NPZ"
        with self._open() as arrays:
            self.names: list[str] = list(arrays)

    def read(self, names: Sequence[str]) -> list[Floats]:
        columns: list[Floats] = []
        with self._open() as arrays:
            for name in names:
                try:
                    values = arrays[name]
                except (zipfile.BadZipFile, ValueError, EOFError, zlib.error) as error:
                    raise ValueError(f"{self.path}: array {name} is damaged: {error}") from error
                first = columns[0].size if columns else None
                columns.append(column(f"{self.path}: {name}", values, first, names[0]))
        if not columns[0].size:
            raise ValueError(f"{self.path}: {names[0]} is empty")
        return columns

    def place(self, name: str, row: int) -> str:
        return f"{name}[{row}]"

    @contextmanager
    def _open(self) -> Iterator[Mapping[str, npt.NDArray[np.generic]]]:
        with Path(self.path).open("rb") as file:
            try:
                arrays = np.load(file, allow_pickle=False)
            except (zipfile.BadZipFile, ValueError) as error:
                raise ValueError(f"{self.path}: is damaged: {error}") from error
            with arrays:
                yield arrays


def _number(cell: str, place: str) -> float:
    text = cell.strip()
    if not text:
        return ABSENT[0]
    try:
        # float() would also take 1_000 and the digits of other scripts.
        if "_" in text or not text.isascii():
            raise ValueError
        return float(text)
    except ValueError:
        shown = text if len(text) <= 40 else f"{text[:37]}..."
        raise ValueError(f"{place}: '{shown}': must be a number") from None


def write_table(path: Path, columns: dict[str, tuple[Floats, int]]) -> None:
    """Write columns, each with its number of decimals, as CSV, gzipped CSV or NPZ by the ending; whole or not at all.

    NPZ keeps every digit. The same columns give the same bytes.
    """
    if path.suffix == ".npz":
        arrays: dict[str, Any] = {name: values for name, (values, _) in columns.items()}
        write_whole(path, lambda file: np.savez(file, **arrays))
        return

    def write(file: IO[bytes]) -> None:
        if path.suffix == ".gz":
            with gzip.GzipFile(fileobj=file, mode="wb", filename="", mtime=0, compresslevel=6) as zipped:
                _write_csv(zipped, columns)
        else:
            _write_csv(file, columns)

    write_whole(path, write)


def _write_csv(file: IO[bytes] | gzip.GzipFile, columns: dict[str, tuple[Floats, int]]) -> None:
    file.write((",".join(columns) + "\n").encode())
    row = ",".join(f"%.{decimals}f" for _, decimals in columns.values()) + "\n"
    values = [column for column, _ in columns.values()]
    for start in range(0, values[0].size, 4096):
        block = np.column_stack([column[start : start + 4096] for column in values])
        file.write((row * len(block) % tuple(block.ravel().tolist())).encode())
