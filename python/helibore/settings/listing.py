"""List all settings: for ``helibore settings``, for the documentation, and as types of keyword arguments.

``./develop settings`` writes docs/reference/settings.md and ``helibore/settings/keywords.py`` from the declarations.
"""

from __future__ import annotations

import typing
from collections.abc import Iterator, Mapping
from dataclasses import MISSING
from typing import Any, Literal

from helibore.settings.declared import Member, members
from helibore.settings.groups import GROUPS

KEYWORDS = {"wall": "WallSettings"}
"""Groups whose settings are keyword arguments of public functions, and the names of the types of these arguments."""

NO_KEYWORD = ("bit_diameter",)
"""Settings that public functions have as arguments of their own."""


def rows(groups: Mapping[str, type[Any]] = GROUPS) -> Iterator[tuple[str, str, str, str, str]]:
    """Yield name, unit, default, rule and explanation of each setting."""
    for group, kind in groups.items():
        for name, member in members(kind).items():
            usual = "must be given" if member.default is MISSING else member.default_text
            unit = member.unit.word if member.unit else ""
            yield f"{group}.{name}", unit, usual, member.rule_text, member.text


def page(groups: Mapping[str, type[Any]] = GROUPS) -> str:
    """Return the page of settings for the documentation, Markdown."""
    text = PAGE
    for group, kind in groups.items():
        own = (kind.__dict__.get("__doc__") or "").strip().partition("\n")[0]
        text += (
            f"\n## `[{group}]`\n\n{own}\n\n| setting | unit | default | rule | what it is |\n|---|---|---|---|---|\n"
        )
        for name, *cells in rows({group: kind}):
            text += (
                f"| `{name.rpartition('.')[2]}` | {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |\n"
            )
    return text


PAGE = """# Settings

Each setting has one name: in Python, as a key in a settings file, and after `--setting`. If the command line has an
option for it, the option has this name, too, with hyphens. `helibore settings` prints this list,
but for a live wall: `helibore settings live`.

`./develop settings` writes this page from the declarations in `python/helibore/settings`.
"""


def keywords(groups: Mapping[str, type[Any]] = GROUPS) -> str:
    """Return the source of ``keywords.py``."""
    text = HEAD
    for group, name in KEYWORDS.items():
        text += (
            f'\n\nclass {name}(TypedDict, total=False):\n    """The settings of `{groups[group].__name__}` as keyword '
        )
        text += 'arguments; a setting that is left out has its default."""\n\n'
        for member in members(groups[group]).values():
            text += f"    {member.name}: {_spelled(member)}\n" if member.name not in NO_KEYWORD else ""
    return text


HEAD = '''"""Types of settings as keyword arguments. `./develop settings` writes this file; do not edit it."""

from __future__ import annotations

from typing import Literal, TypedDict
'''


def _spelled(member: Member) -> str:
    """Return the type of a setting as source text."""
    hint = member.hint
    if typing.get_origin(hint) is Literal:
        text = f"Literal[{', '.join(chr(34) + str(one) + chr(34) for one in typing.get_args(hint))}]"
    else:
        text = hint.__name__ if isinstance(hint, type) and not typing.get_args(hint) else str(hint)
    return f"{text} | None" if member.optional else text
