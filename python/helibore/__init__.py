"""helibore: the wall of a borehole, rebuilt from scattered measurements on a uniform helix."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from helibore._core import __version__
from helibore.base.errors import InputError, MissingExtraError
from helibore.base.settings import Settings
from helibore.images.sector_image import SectorImage
from helibore.mesh.surface import Surface
from helibore.mesh.volume import Volume
from helibore.samples.caliper import Caliper
from helibore.trajectory.survey import Path, Survey
from helibore.wall.append_result import Change
from helibore.wall.reconstruct import reconstruct
from helibore.wall.wall import Wall

if TYPE_CHECKING:
    from helibore import plot as plot
    from helibore.files import open as open  # noqa: A004
    from helibore.live.live import Live
    from helibore.preparation.prepare import Preparation, prepare
    from helibore.viewer import view as view
    from helibore.wall.archive import load as load

__all__ = [
    "Caliper",
    "Change",
    "InputError",
    "Live",
    "MissingExtraError",
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
        from helibore.wall.archive import load

        return load
    if name in ("Preparation", "prepare"):
        from helibore.preparation import prepare as preparation

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
