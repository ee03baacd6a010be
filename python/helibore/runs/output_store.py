"""A folder at any fsspec address (a path, s3://, gs://, abfs:// ...): files come and go whole.

    store = Store("s3://field/walls")
    with store.writing("wells/A-1/A-1.wall") as path:      # a local file, in the store when the block ends
        wall.save(path)

A local folder is written in place, by writers that rename a complete file; another store gets the complete file.
fsspec's own configuration and the cloud's environment variables say how to log in.
"""

from __future__ import annotations

import contextlib
import io
import json
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from helibore.base.arrays import Array, Floats
from helibore.base.atomic_file import write_whole
from helibore.base.errors import InputError, MissingExtraError

Json = dict[str, Any]


def file_system(address: str) -> tuple[Any, str, bool]:
    """Return the file system of an address, the path in it, and whether that is a path of this machine."""
    try:
        from fsspec.core import url_to_fs
        from fsspec.implementations.local import LocalFileSystem
    except ImportError as error:
        raise MissingExtraError("fsspec", "scale") from error
    try:
        system, path = url_to_fs(address)
    except ImportError as error:
        raise InputError(address, f"needs another library: {error}") from error
    except ValueError as error:
        raise InputError(address, str(error)) from error
    return system, path, isinstance(system, LocalFileSystem)


@contextlib.contextmanager
def local_file(address: str) -> Iterator[Path]:
    """Give the file at an address as a local file: itself, or a copy for as long as the block runs."""
    system, path, is_local = file_system(address)
    if is_local:
        yield Path(path)
        return
    with tempfile.TemporaryDirectory(prefix="helibore-") as folder:
        copy = Path(folder) / Path(path).name
        system.get_file(path, str(copy))
        yield copy


class Store:
    """The files below an address, by their names with forward slashes."""

    def __init__(self, address: str) -> None:
        self.address = address
        self.system, self.root, self.is_local = file_system(address)

    def path(self, name: str) -> str:
        """Return the path of a file in the file system."""
        return f"{self.root}/{name}"

    def check_writable(self) -> None:
        """Write and delete a file; an InputError names the address and the reason."""
        try:
            self.write_json(".writable", {})
            self.delete([".writable"])
        except OSError as error:
            raise InputError(self.address, f"cannot be written: {error}") from error

    @contextlib.contextmanager
    def writing(self, name: str) -> Iterator[Path]:
        """Give a local path to write to; the file is in the store when the block ends without an error."""
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
        """Give a new local folder to write to; its files are in the store when the block ends without an error."""
        if self.is_local:
            path = Path(self.path(name))
            path.mkdir(parents=True)
            yield path
            return
        with tempfile.TemporaryDirectory(prefix="helibore-") as folder:
            yield Path(folder)
            files = sorted(Path(folder).iterdir())
            self.system.put([str(of) for of in files], [self.path(f"{name}/{of.name}") for of in files])

    def read_array(self, name: str) -> Floats:
        """Return a file of plain float64 numbers."""
        return np.frombuffer(self.system.cat_file(self.path(name)))

    def read_arrays(self, name: str) -> dict[str, Array]:
        """Return the arrays of an NPZ file."""
        with np.load(io.BytesIO(self.system.cat_file(self.path(name)))) as found:
            return dict(found)

    def write_json(self, name: str, value: Any) -> None:
        """Write a value as JSON: the same value gives the same bytes."""
        content = json.dumps(value, indent=1, allow_nan=False).encode()
        with self.writing(name) as path:
            write_whole(path, lambda file: file.write(content))

    def read_json(self, name: str) -> Any:
        """Return a value from JSON; None if there is no such file, or it is damaged."""
        try:
            return json.loads(self.system.cat_file(self.path(name)))
        except (FileNotFoundError, ValueError):
            return None

    def holds(self, files: dict[str, int]) -> bool:
        """Say whether all these files are there, with these numbers of bytes."""
        try:
            return all(self.system.info(self.path(name))["size"] == size for name, size in files.items())
        except FileNotFoundError:
            return False

    def sizes(self, folder: str) -> dict[str, int]:
        """Return the names below a folder, relative to the store, and their bytes."""
        self.system.invalidate_cache()
        found = self.system.find(self.path(folder), detail=True)
        return {path[len(self.root) + 1 :]: int(of["size"]) for path, of in found.items()}

    def delete(self, names: Iterator[str] | list[str]) -> None:
        """Delete files, if they are there."""
        for name in names:
            with contextlib.suppress(FileNotFoundError):
                self.system.rm_file(self.path(name))
