"""Reading a TOML table strictly: every key has a rule, an unknown key is an error, every error names its place."""

from __future__ import annotations

import math
from typing import Any

_REQUIRED: Any = object()


class Table:
    """One table of a configuration; keys are taken out one by one, :meth:`close` refuses what is left.

    Parameters
    ----------
    place
        Its name in errors, e.g. ``source.rig``.
    entries
        The table as ``tomllib`` gives it.
    """

    def __init__(self, place: str, entries: Any) -> None:
        if not isinstance(entries, dict):
            raise ValueError(f"{place} = {entries!r}: must be a table")
        self.place = place
        self._left = dict(entries)

    def fail(self, name: str, value: Any, rule: str) -> ValueError:
        """Return the error that ``name`` breaks ``rule``."""
        return ValueError(f"{self._name(name)} = {value!r}: {rule}")

    def _name(self, name: str) -> str:
        return f"{self.place}.{name}" if self.place else name

    def has(self, name: str) -> bool:
        """Return whether ``name`` was given and not yet taken."""
        return name in self._left

    def starts(self, name: str, beginning: str) -> bool:
        """Return whether ``name`` is a text that begins so, in capitals or not; it is not taken."""
        return str(self._left.get(name, "")).lower().startswith(beginning)

    def take(self, name: str, default: Any, why: str) -> Any:
        """Return the value of ``name`` as it stands."""
        if name in self._left:
            return self._left.pop(name)
        if default is _REQUIRED:
            raise ValueError(f"{self._name(name)}: must be set: {why}")
        return default

    def number(
        self, name: str, default: Any = _REQUIRED, *, least: float = -math.inf, most: float = math.inf, why: str = ""
    ) -> float:
        """Return a finite number in [least, most]."""
        value = self.take(name, default, why or "a number")
        if value is default:
            return float(value)
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise self.fail(name, value, "must be a finite number")
        if not least <= value <= most:
            limits = f"at least {least:g}" if most == math.inf else f"from {least:g} to {most:g}"
            raise self.fail(name, value, f"must be {limits}")
        return float(value)

    def whole(self, name: str, default: Any = _REQUIRED, *, least: int, most: int) -> int:
        """Return a whole number in [least, most]."""
        value = self.take(name, default, "a whole number")
        if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
            raise self.fail(name, value, f"must be a whole number from {least} to {most}")
        return value

    def text(self, name: str, default: Any = _REQUIRED, why: str = "a text") -> str:
        """Return a text that is not empty."""
        value = self.take(name, default, why)
        if value is not default and (not isinstance(value, str) or not value):
            raise self.fail(name, value, "must be a text that is not empty")
        return str(value)

    def choice(self, name: str, choices: tuple[str, ...], default: Any = _REQUIRED, why: str = "") -> str:
        """Return one of ``choices``."""
        named = " or ".join(f'"{choice}"' for choice in choices)
        value = self.take(name, default, named + why)
        if value not in choices:
            raise self.fail(name, value, f"must be {named}")
        return str(value)

    def array(self, name: str, kind: type, default: Any = _REQUIRED, why: str = "a list") -> list[Any]:
        """Return a list whose members are all of ``kind``."""
        value = self.take(name, default, why)
        kinds = (int, float) if kind is float else (kind,)
        if not isinstance(value, list | tuple) or any(isinstance(v, bool) or not isinstance(v, kinds) for v in value):
            members = {float: "numbers", int: "whole numbers"}.get(kind, "texts")
            raise self.fail(name, value, f"must be a list of {members}")
        return [kind(v) for v in value]

    def table(self, name: str) -> Table:
        """Return the table ``name``; an empty one when it is not there."""
        return Table(self._name(name), self._left.pop(name, {}))

    def tables(self, name: str) -> dict[str, Table]:
        """Return the tables within the table ``name``, by their names."""
        inner = self.table(name)
        return {key: Table(f"{inner.place}.{key}", value) for key, value in inner.rest().items()}

    def names(self) -> list[str]:
        """Return the keys not yet taken."""
        return list(self._left)

    def rest(self) -> dict[str, Any]:
        """Return everything that was not taken, and take it."""
        left, self._left = self._left, {}
        return left

    def close(self) -> None:
        """Refuse keys that nothing asked for."""
        for name in self._left:
            raise ValueError(f"{self._name(name)}: is not a setting")
