"""Choose sets of a file by ``--set``: a name, numbers, or the columns that they hold."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from helibore.base.errors import InputError

if TYPE_CHECKING:
    from helibore.channels.log_set import LogFile


def set_names(log: LogFile, texts: Sequence[str]) -> list[Any]:
    """Return the names of the sets that ``--set`` chooses, in the order of the file; [None] without ``--set``."""
    if not texts:
        return [None]
    chosen = set().union(*(_sets_of(log, text) for text in texts))
    return [each.name for each in log.sets if each.name in chosen]


def sets_of_calipers(log: LogFile, texts: Sequence[str]) -> list[Any]:
    """Return what `set_names` returns; without ``--set``, the only set with a depth and radii or arms, if one is."""
    from helibore.channels.roles import WALL, guess

    if texts or len(log.sets) < 2:
        return set_names(log, texts)
    roles = [guess(each) for each in log.sets]
    able = [each.set_name for each in roles if each.one("depth") and each.all(*WALL)]
    return able if len(able) == 1 else [None]


def _sets_of(log: LogFile, text: str) -> set[str]:
    """Return the names of the sets that one ``--set`` chooses: NAME, NUMBERS or with=COLUMNS."""
    names = [each.name for each in log.sets]
    if text in names:
        return {text}
    columns = text.removeprefix("with=").split(",")
    if text.startswith("with="):
        found = {each.name for each in log.sets if all(column in each for column in columns)}
        if not found:
            raise InputError(f"--set {text}", f"no set of {log.path.name} holds {' and '.join(columns)}")
        return found
    if not re.fullmatch(r"\d+(-\d+)?(,\d+(-\d+)?)*", text):
        return {log.set(text).name}
    found = set()
    for part in text.split(","):
        first, _, last = part.partition("-")
        numbers = range(int(first), int(last or first) + 1)
        if not numbers or not 1 <= numbers[0] <= numbers[-1] <= len(names):
            raise InputError(f"--set {text}", f"{log.path.name} has the sets 1 to {len(names)}")
        found |= {names[number - 1] for number in numbers}
    return found
