"""Facts about a CSV table, in a file beside it: the table itself opens by the plain call of any program.

zones.csv               header and rows, nothing else
zones.csv.facts.json    {"well": "A-1", "bit diameter": "0.2159 m", ..., "blake2b": "..."}

The checksum is that of the table: the facts of a table that another program has written anew are not those of the old.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path

from helibore.base.atomic_file import write_whole

LIMIT = 1 << 20
"""Most bytes of a file of facts; a larger one is not read."""
CHECKSUM = "blake2b"
"""Name of the table's checksum among the facts; facts without it, written by a person, count."""


def facts_path(table: Path) -> Path:
    """Return where the facts of a table stand."""
    return table.with_name(f"{table.name}.facts.json")


def write_facts(table: Path, facts: Mapping[str, str]) -> None:
    """Write facts beside a table, whole or not at all."""
    content = json.dumps({**facts, CHECKSUM: _checksum(table)}, indent=1, ensure_ascii=False) + "\n"
    write_whole(facts_path(table), lambda file: file.write(content.encode()))


def read_facts(table: Path) -> tuple[dict[str, str], str]:
    """Return the facts beside a table, and a remark if they cannot be read; both are empty where there are none."""
    path = facts_path(table)
    try:
        if not path.is_file():
            return {}, ""
        if path.stat().st_size > LIMIT:
            return {}, f"{path.name}: larger than {LIMIT:,} bytes: not read"
        facts = json.loads(path.read_bytes())
        checksum = facts.pop(CHECKSUM, None) if isinstance(facts, dict) else None
        if checksum is not None and checksum != _checksum(table):
            return {}, f"{path.name}: states the facts of another table than {table.name} is now: not read"
    except (OSError, ValueError, RecursionError) as error:
        return {}, f"{path.name}: cannot be read ({type(error).__name__})"
    if not isinstance(facts, dict):
        return {}, f"{path.name}: must be an object of texts"
    return {name: text for name, text in facts.items() if isinstance(text, str)}, ""


def _checksum(table: Path) -> str:
    with table.open("rb") as file:
        return hashlib.file_digest(file, lambda: hashlib.blake2b(digest_size=16)).hexdigest()
