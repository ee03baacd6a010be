"""helibore: the wall of a borehole, rebuilt from scattered measurements on a uniform helix."""

from __future__ import annotations

from typing import TYPE_CHECKING

from helibore._core import __version__
from helibore.caliper import Caliper
from helibore.surface import Surface, Volume
from helibore.survey import Path, Survey
from helibore.wall import Change, Settings, Wall, reconstruct

if TYPE_CHECKING:
    from helibore.live.live import Live

__all__ = [
    "Caliper",
    "Change",
    "Live",
    "Path",
    "Settings",
    "Surface",
    "Survey",
    "Volume",
    "Wall",
    "__version__",
    "reconstruct",
]


def __getattr__(name: str) -> type[Live]:
    """Load the live part when it is asked for; `import helibore` stays small."""
    if name == "Live":
        from helibore.live.live import Live

        return Live
    raise AttributeError(f"module 'helibore' has no attribute '{name}'")
