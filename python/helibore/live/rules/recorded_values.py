"""Tables as journals record them: a configuration with recorded values, and the place of a value."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import Any


def with_values(value: Any, recorded: Any) -> Any:
    """Return a copy of ``value`` that holds the values of ``recorded``, which was read from JSON.

    A field of a dataclass that ``recorded`` lacks keeps its value. A dict has the keys of ``recorded``: first those
    that ``value`` also has, in the order of ``value``. If two lists differ in length, the recorded list is used.
    """
    if is_dataclass(value) and not isinstance(value, type):
        names = {one.name for one in fields(value)} & recorded.keys()
        return replace(value, **{name: with_values(getattr(value, name), recorded[name]) for name in names})
    if isinstance(value, dict):  # in the order of value: JSON has sorted keys
        order = [*(key for key in value if key in recorded), *(key for key in recorded if key not in value)]
        return {key: with_values(value.get(key), recorded[key]) for key in order}
    if isinstance(value, (list, tuple)) and isinstance(recorded, list):
        if len(value) == len(recorded):
            recorded = [with_values(of, one) for of, one in zip(value, recorded, strict=True)]
        return type(value)(recorded)
    return recorded


def joined_place(*parts: str) -> str:
    """Return the place that the parts name, such as ``source.rig.nulls``."""
    return ".".join(part for part in parts if part)
