"""Checkpoints: the whole state of the model after one record, so that a restart reads only the later records.

    checkpoint-000000123456.zip        the number of the first record that the checkpoint does not contain
        state.json                     format, version, salt of the journal, configuration, state
        0.npy, 1.npy ...               the arrays: samples of the walls, image rows, stations, pending rows ...

A file is written whole (temporary file, fsync, rename, fsync of the folder), after a sync of all records that it
contains. The last two checkpoints are kept. If the last checkpoint is damaged or of another version, a restart uses
the checkpoint before it. If that checkpoint is not usable either, the restart reads the whole journal.
``helibore.live.model.packed_state`` turns the model's state into JSON and arrays.
"""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from helibore.base.atomic_file import write_whole
from helibore.base.errors import InputError

FORMAT, VERSION = "helibore checkpoint", 3
KEPT = 2
CONTENTS = "state.json"
Arrays = list[Any]


def paths(folder: Path) -> list[Path]:
    """Return the paths of the checkpoints of a journal, the newest last."""
    return sorted((path for path in folder.glob("checkpoint-*.zip") if path.stem[11:].isdigit()), key=position)


def position(path: Path) -> int:
    """Return the number of the first record that a checkpoint does not contain."""
    return int(path.stem[11:])


def write(folder: Path, sequence: int, facts: dict[str, Any], state: Any) -> Path:
    """Write a checkpoint and return its path; then delete all but the two newest checkpoints.

    Parameters
    ----------
    folder
        The folder of the journal.
    sequence
        The number of the first record that the checkpoint does not contain.
    facts
        JSON values by name, which `read` returns besides the arrays; the ``salt`` of the journal must be among them.
    state
        The state as a JSON value and a list of arrays, to which it refers by their index.
    """
    contents, arrays = state
    text = json.dumps({"format": FORMAT, "version": VERSION, **facts, "sequence": sequence, "state": contents})

    def fill(file: BinaryIO) -> None:
        with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
            archive.writestr(CONTENTS, text)
            for number, array in enumerate(arrays):
                with archive.open(f"{number}.npy", "w", force_zip64=True) as member:
                    np.lib.format.write_array(member, array, allow_pickle=False)

    path = folder / f"checkpoint-{sequence:012d}.zip"
    write_whole(path, fill, private=True)
    for old in paths(folder)[:-KEPT]:
        old.unlink(missing_ok=True)
    return path


def read(path: Path, salt: int, *, only_facts: bool = False) -> tuple[dict[str, Any], Arrays]:
    """Return the facts and the arrays of a checkpoint.

    If ``only_facts``, the list of arrays is empty: all checksums of the file are checked, but no array is decoded.

    Raises
    ------
    InputError
        If the file is damaged, of another version, or of another journal.
    FileNotFoundError
        If newer checkpoints have replaced the file meanwhile.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            facts = json.loads(archive.read(CONTENTS))
            if facts["format"] != FORMAT or facts["version"] != VERSION:
                raise InputError(str(path), f"version {facts['version']}: this helibore reads version {VERSION}")
            if facts["salt"] != salt or facts["sequence"] != position(path):
                raise InputError(str(path), "belongs to another journal")
            if only_facts and (bad := archive.testzip()) is not None:
                raise InputError(str(path), f"damaged: {bad}")
            names = (f"{number}.npy" for number in range(0 if only_facts else len(archive.namelist()) - 1))
            arrays = [np.lib.format.read_array(io.BytesIO(archive.read(name)), allow_pickle=False) for name in names]
    except (InputError, FileNotFoundError):
        raise
    except Exception as error:  # zipfile raises errors of many kinds
        raise InputError(str(path), f"damaged: {type(error).__name__}: {error}") from error
    return facts, arrays


def usable(folder: Path, salt: int, stop: int) -> Iterator[tuple[Path, dict[str, Any], Arrays] | InputError]:
    """Yield path, facts and arrays of each checkpoint, the newest first; for an unusable checkpoint, yield its error.

    A checkpoint that contains records from ``stop`` on is renamed, because these records are lost and new records get
    their numbers.
    """
    for path in reversed(paths(folder)):
        if position(path) > stop:
            path.replace(path.with_suffix(".beyond"))
            yield InputError(str(path), f"goes beyond the last record of the journal, {stop - 1}")
            continue
        try:
            yield path, *read(path, salt)
        except InputError as error:
            yield error
