"""Read the looks of images and curves from texts: ``GR=20,150``, ``RES=0.2,2000,log``, ``GR=map:viridis,window:2m``."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from helibore.base.errors import InputError, unknown_name
from helibore.settings.declared import members
from helibore.settings.print_settings import Look
from helibore.settings.toml_reading import parse_setting

FORM = "NAME=LOW,HIGH, log, linear, map:MAP or window:LENGTH"
WORDS = {"log": ("log", "true"), "linear": ("log", "false")}
"""Words without a value, and the setting and the value that they mean."""
KINDS = {"map": "color_map", "window": "window"}
"""Words with a value, and the settings that have this value."""


def look_of_text(text: str, place: str) -> tuple[str, dict[str, Any]]:
    """Return the name of an image or curve, and the settings of its look that a text states; errors name ``place``."""
    name, _, words = text.rpartition("=")
    if not (name and words):
        raise InputError(f"{place} {text}", f"must be {FORM}")
    stated: dict[str, Any] = {}
    limits = []
    for word in words.split(","):
        kind, _, value = word.partition(":")
        setting, value = WORDS.get(word) or (KINDS.get(kind, ""), value)
        if setting and value:
            stated[setting] = parse_setting(members(Look)[setting], value, f"{place} {name}={word}")
        else:
            limits.append(word)
    if limits:
        try:
            low, high = map(float, limits)
        except ValueError:
            raise InputError(f"{place} {text}", f"must be {FORM}") from None
        stated["limits"] = [low, high]
    return name, stated


def look_of_setting(text: str, place: str) -> tuple[str, dict[str, Any]]:
    """Return the same for a setting, ``GR.limits=20,150``; a name may have a dot."""
    setting, _, value = text.partition("=")
    name, _, key = setting.rpartition(".")
    known = members(Look)
    if not name or key not in known:
        raise unknown_name(f"{place}{setting}", key, known)
    return name, {key: parse_setting(known[key], value, f"{place}{setting}")}


def merged_looks(stated: Iterable[tuple[str, dict[str, Any]]]) -> dict[str, dict[str, Any]]:
    """Return the settings of all looks by name; a later one counts over an earlier one."""
    looks: dict[str, dict[str, Any]] = {}
    for name, settings in stated:
        looks.setdefault(name, {}).update(settings)
    for name, settings in looks.items():
        try:
            Look(**settings)
        except InputError as error:
            raise error.within(f"look.{name}") from None
    return looks
