"""helibore: the wall of a borehole, rebuilt from scattered measurements on a uniform helix."""

from __future__ import annotations

from helibore._core import __version__
from helibore.surface import Surface, Volume
from helibore.survey import Path, Survey

__all__ = ["Path", "Surface", "Survey", "Volume", "__version__"]
