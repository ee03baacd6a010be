"""helibore: the wall of a borehole, rebuilt from scattered measurements on a uniform helix."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from helibore._core import __version__
from helibore.caliper import Caliper
from helibore.changes import Change
from helibore.reconstruction import reconstruct
from helibore.sector_image import SectorImage
from helibore.settings import Settings
from helibore.surface import Surface
from helibore.survey import Path, Survey
from helibore.volume import Volume
from helibore.wall import Wall

if TYPE_CHECKING:
    from helibore import plot as plot
    from helibore.archive import load as load
    from helibore.files import open as open  # noqa: A004
    from helibore.live.live import Live
    from helibore.preparation import Preparation, prepare
    from helibore.viewer import view as view

__all__ = [
    "Caliper",
    "Change",
    "Live",
    "Path",
    "Preparation",
    "SectorImage",
    "Settings",
    "Surface",
    "Survey",
    "Volume",
    "Wall",
    "__version__",
    "load",
    "plot",
    "prepare",
    "reconstruct",
    "view",
]


def __getattr__(name: str) -> Any:
    """Load the live part, archive, readers and preparation when they are asked for; `import helibore` stays small.

    ``open`` stays out of ``__all__``: a star import must not shadow the builtin.
    """
    if name == "Live":
        from helibore.live.live import Live

        return Live
    if name == "load":
        from helibore.archive import load

        return load
    if name in ("Preparation", "prepare"):
        from helibore import preparation

        return getattr(preparation, name)
    if name == "open":
        from helibore.files import open  # noqa: A004

        return open
    if name == "plot":
        import helibore.plot

        return helibore.plot
    if name == "view":
        from helibore.viewer import view

        return view
    raise AttributeError(f"module 'helibore' has no attribute '{name}'")
