"""helibore: the wall of a borehole, rebuilt from scattered measurements on a uniform helix.

Each public name is imported when it is first used, and NumPy and the core with the first of them: `helibore --help`
needs neither.
"""

from __future__ import annotations

import os
import threading
from typing import TYPE_CHECKING, Any

import lazy_loader

if TYPE_CHECKING:  # the same names as below
    from helibore import plot as plot
    from helibore._core import __version__ as __version__
    from helibore.base.errors import InputError as InputError
    from helibore.base.errors import MissingExtraError as MissingExtraError
    from helibore.base.tables import LogColumn as LogColumn
    from helibore.channels.opening import open as open  # noqa: A004
    from helibore.images.sector_image import SectorImage as SectorImage
    from helibore.live.live import Live as Live
    from helibore.logs.passage import RigidBody as RigidBody
    from helibore.logs.stress import HorizontalStress as HorizontalStress
    from helibore.logs.stress import horizontal_stress as horizontal_stress
    from helibore.logs.stress import stress_of_picks as stress_of_picks
    from helibore.mesh.surface import Surface as Surface
    from helibore.mesh.volume import Volume as Volume
    from helibore.preparation.prepare import prepare as prepare
    from helibore.runs.reconstruct import reconstruct as reconstruct
    from helibore.runs.reprocess import reprocess as reprocess
    from helibore.samples.caliper import Caliper as Caliper
    from helibore.settings.preparation_settings import Preparation as Preparation
    from helibore.settings.wall_settings import Settings as Settings
    from helibore.trajectory.survey import Path as Path
    from helibore.trajectory.survey import Survey as Survey
    from helibore.viewer import view as view
    from helibore.wall.append_result import Change as Change
    from helibore.wall.load import load as load
    from helibore.wall.tune import Tuning as Tuning
    from helibore.wall.tune import tune as tune
    from helibore.wall.wall import Wall as Wall

_load, _, __all__ = lazy_loader.attach(
    __name__,
    ["plot"],
    {
        "_core": ["__version__"],
        "base.errors": ["InputError", "MissingExtraError"],
        "settings.preparation_settings": ["Preparation"],
        "settings.wall_settings": ["Settings"],
        "base.tables": ["LogColumn"],
        "channels.opening": ["open"],
        "images.sector_image": ["SectorImage"],
        "live.live": ["Live"],
        "logs.passage": ["RigidBody"],
        "logs.stress": ["HorizontalStress", "horizontal_stress", "stress_of_picks"],
        "mesh.surface": ["Surface"],
        "mesh.volume": ["Volume"],
        "preparation.prepare": ["prepare"],
        "runs.reconstruct": ["reconstruct"],
        "runs.reprocess": ["reprocess"],
        "samples.caliper": ["Caliper"],
        "trajectory.survey": ["Path", "Survey"],
        "viewer": ["view"],
        "wall.append_result": ["Change"],
        "wall.load": ["load"],
        "wall.tune": ["Tuning", "tune"],
        "wall.wall": ["Wall"],
    },
)
__all__.remove("__version__")
__all__.remove("open")  # a star import must not replace the built-in function
_loading = threading.RLock()


def __getattr__(name: str) -> Any:
    """Import a public name."""
    with _loading:
        return _load(name)


if hasattr(os, "register_at_fork"):  # in the child, an import that another thread has begun would never end
    os.register_at_fork(before=_loading.acquire, after_in_parent=_loading.release, after_in_child=_loading.release)


def __dir__() -> list[str]:
    """Return the public names."""
    return sorted([*__all__, "__version__", "open"])


def _save_table(table: Any, filename: str | os.PathLike[str]) -> None:
    """Write a table of logs, for `LogTable.save`, which lies below the formats of files."""
    from helibore.files.log_writing import save_table

    save_table(table, filename)
