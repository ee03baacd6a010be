"""A folder at any fsspec address (a path, s3://, gs://, abfs:// ...): files are written and read whole.

    store = Store("s3://field/walls")
    with store.writing("wells/A-1/A-1.wall") as path:      # a local file, in the store when the block ends
        wall.save(path)

A local file is written in place, by writers that rename a complete file; other stores get a copy of the complete file.
fsspec takes the login from its configuration and from the environment variables of the cloud.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import json
import shutil
import tempfile
import zlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from helibore.base.addresses import file_name
from helibore.base.arrays import Array, Floats
from helibore.base.atomic_file import write_whole
from helibore.base.errors import InputError, needs
from helibore.files.columnar import DAMAGED_NPZ

Json = dict[str, Any]

WITHIN = (
    "zip", "tar", "libarchive", "reference", "filecache", "blockcache", "simplecache", "cached", "dir", "generic",
    "async_wrapper", "dask", "git", "jlab", "jupyter",
)  # fmt: skip
"""Protocols of fsspec that open other addresses: what lies behind such an address is not checked."""


def file_system(address: str) -> tuple[Any, str, bool]:
    """Return the file system of an address, the path in that file system, and whether the path is local."""
    protocol = address.partition("://")[0].lower() if "://" in address else ""
    if "::" in address or protocol in WITHIN:
        name = "a chain" if "::" in address else f"{protocol}://"
        rule = f"{name} opens other addresses or archives, which is refused: name the files themselves"
        raise InputError(address, rule)
    with needs("fsspec", "scale"):
        from fsspec.core import url_to_fs
        from fsspec.implementations.local import LocalFileSystem
    try:
        system, path = url_to_fs(address)
    except ImportError as error:
        raise InputError(address, f"needs another library: {error}") from error
    except ValueError as error:
        raise InputError(address, str(error)) from None
    return system, path, isinstance(system, LocalFileSystem)


@contextlib.contextmanager
def local_file(address: str) -> Iterator[Path]:
    """Yield the file at an address as a local file: the file itself, or a copy that exists while the block runs."""
    system, path, is_local = file_system(address)
    if is_local:
        yield Path(path)
        return
    with tempfile.TemporaryDirectory(prefix="helibore-") as folder:
        copy = Path(folder) / file_name(path)
        system.get_file(path, str(copy))
        yield copy


def _checksum(value: Json) -> str:
    return hashlib.blake2b(json.dumps(value, sort_keys=True).encode(), digest_size=16).hexdigest()


class Store:
    """The files below an address; names are relative to the address, with forward slashes."""

    def __init__(self, address: str) -> None:
        self.address = address
        self.system, self.root, self.is_local = file_system(address)

    def path(self, name: str) -> str:
        """Return the path of the file ``name`` in the file system."""
        return f"{self.root}/{name}"

    def check_writable(self) -> None:
        """Write a file and delete it; if that fails, an InputError names the address and the reason."""
        try:
            self.write_json(".writable", {})
            self.delete([".writable"])
        except Exception as error:  # each store library has its own errors
            raise InputError(self.address, f"cannot be written: {error}") from None

    @contextlib.contextmanager
    def writing(self, name: str) -> Iterator[Path]:
        """Yield a local path to write to; the file is in the store when the block ends without an error."""
        if self.is_local:
            path = Path(self.path(name))
            path.parent.mkdir(parents=True, exist_ok=True)
            yield path
            return
        with tempfile.TemporaryDirectory(prefix="helibore-") as folder:
            path = Path(folder) / Path(name).name
            yield path
            self.system.put_file(str(path), self.path(name))

    @contextlib.contextmanager
    def writing_folder(self, name: str) -> Iterator[Path]:
        """Yield a new local folder to write to; its files are in the store when the block ends without an error."""
        if self.is_local:
            path = Path(self.path(name))
            path.mkdir(parents=True)
            try:
                yield path
            except BaseException:
                shutil.rmtree(path, ignore_errors=True)
                raise
            return
        with tempfile.TemporaryDirectory(prefix="helibore-") as folder:
            yield Path(folder)
            files = sorted(Path(folder).iterdir())
            self.system.put([str(of) for of in files], [self.path(f"{name}/{of.name}") for of in files])

    def read_array(self, name: str, checksum: int) -> Floats:
        """Return the numbers of a file of plain float64; raise an InputError if its CRC-32 is not ``checksum``."""
        content = self.system.cat_file(self.path(name))
        if zlib.crc32(content) != checksum:
            raise InputError(name, "is damaged")
        return np.frombuffer(content)

    def read_arrays(self, name: str, *wanted: str) -> list[Array]:
        """Return arrays of an NPZ file; delete a damaged file and raise an InputError that names it."""
        try:
            with self.system.open(self.path(name), "rb") as file, np.load(file) as found:
                return [found[of] for of in wanted]
        except DAMAGED_NPZ as error:
            if isinstance(error, OSError) and error.errno != errno.EINVAL:  # EINVAL: the file is damaged
                raise
            self.delete([name])
            raise InputError(name, f"was damaged and is deleted: start again ({error})") from error

    def write_json(self, name: str, value: Any) -> None:
        """Write a value as JSON; the same value gives the same bytes."""
        content = json.dumps(value, indent=1, allow_nan=False).encode()
        with self.writing(name) as path:
            write_whole(path, lambda file: file.write(content))

    def read_json(self, name: str) -> Any:
        """Return the value of a JSON file; None if there is no such file, or it is not JSON."""
        try:
            return json.loads(self.system.cat_file(self.path(name)))
        except (FileNotFoundError, ValueError):
            return None

    def write_checked(self, name: str, value: Json) -> None:
        """Write an object as JSON with its own checksum, which `read_checked` verifies."""
        self.write_json(name, value | {"blake2b": _checksum(value)})

    def read_checked(self, name: str) -> Any:
        """Return the object that `write_checked` wrote; None if there is no such file, or its checksum differs."""
        value = self.read_json(name)
        stated = value.pop("blake2b", None) if isinstance(value, dict) else None
        return value if stated is not None and stated == _checksum(value) else None

    def has(self, name: str) -> bool:
        """Return whether a file exists."""
        return bool(self.system.exists(self.path(name)))

    def holds(self, files: dict[str, int]) -> bool:
        """Return whether all files exist that ``files`` names, each with the number of bytes that ``files`` states."""
        try:
            return all(self.system.info(self.path(name))["size"] == size for name, size in files.items())
        except FileNotFoundError:
            return False

    def sizes(self, folder: str) -> dict[str, int]:
        """Return the names of the files below a folder, relative to the store, and their sizes in bytes."""
        self.system.invalidate_cache()
        found = self.system.find(self.path(folder), detail=True)
        return {path[len(self.root) + 1 :]: int(of["size"]) for path, of in found.items()}

    def delete(self, names: Iterable[str]) -> None:
        """Delete those of the files ``names`` that exist."""
        for name in names:
            with contextlib.suppress(FileNotFoundError):
                self.system.rm_file(self.path(name))
