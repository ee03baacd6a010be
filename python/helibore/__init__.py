"""helibore: the wall of a borehole, rebuilt from scattered measurements on a uniform helix."""

from __future__ import annotations

from helibore._core import __version__
from helibore.caliper import Caliper
from helibore.surface import Surface, Volume
from helibore.survey import Path, Survey
from helibore.wall import Change, Settings, Wall, reconstruct

__all__ = ["Caliper", "Change", "Path", "Settings", "Surface", "Survey", "Volume", "Wall", "__version__", "reconstruct"]
