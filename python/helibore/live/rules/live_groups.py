"""All groups of settings of the configuration of a live wall, by the names of their tables behind ``live.``."""

from __future__ import annotations

import dataclasses
import typing
from collections.abc import Iterator
from typing import Any

from helibore.live.rules.configuration import LiveTables
from helibore.live.rules.kinds import kinds
from helibore.settings.declared import Member, members


def live_groups() -> dict[str, type[Any]]:
    """Return the declared class of each group; the tables of sources stand under the word of their kind."""
    found = dict(_groups("live", LiveTables))
    for kind in kinds():
        found |= _groups(f"live.source.{kind.schemes[0]}", kind.table)
    return found


def _groups(name: str, of: type[Any]) -> Iterator[tuple[str, type[Any]]]:
    """Yield the group of a declared class, and the groups of the tables in it."""
    yield name, of
    for member in members(of).values():
        if member.stated is not None:
            yield f"{name}.{member.name}", member.stated
        elif (inner := _inner(member)) is not None:
            yield from _groups(f"{name}.{member.name}{'.NAME' if member.kind is dict else ''}", inner)


def _inner(member: Member) -> type[Any] | None:
    """Return the declared class of a setting that is a table, or tables by their names; None: it is no table."""
    kind = (typing.get_args(member.hint) or (None,))[-1] if member.kind is dict else member.hint
    return kind if isinstance(kind, type) and dataclasses.is_dataclass(kind) else None
