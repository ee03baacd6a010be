"""All groups of settings: the tables of a settings file, and what stands before the dot of ``wall.power=2``."""

from __future__ import annotations

from typing import Any

from helibore.settings.wall_settings import Settings

GROUPS: dict[str, type[Any]] = {"wall": Settings}
"""The declared class of each group."""
