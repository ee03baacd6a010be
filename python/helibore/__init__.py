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
    from helibore import simulation as simulation
    from helibore._core import __version__ as __version__
    from helibore.base.errors import InputError as InputError
    from helibore.base.errors import MissingExtraError as MissingExtraError
    from helibore.base.tables import LogColumn as LogColumn
    from helibore.base.tables import LogImage as LogImage
    from helibore.base.tables import LogTable as LogTable
    from helibore.channels.log_set import LogFile as LogFile
    from helibore.channels.log_set import LogSet as LogSet
    from helibore.channels.opening import open as open  # noqa: A004
    from helibore.files.dip_writing import save_dips as save_dips
    from helibore.files.exchange_writing import save_trace as save_trace
    from helibore.files.exchange_writing import save_wellcad as save_wellcad
    from helibore.files.well_tops import read_intervals as read_intervals
    from helibore.images.image_breakouts import ImageBreakouts as ImageBreakouts
    from helibore.images.sector_image import SectorImage as SectorImage
    from helibore.live.live import Live as Live
    from helibore.live.model.events import Event as Event
    from helibore.live.model.update import Update as Update
    from helibore.logs.annulus import Annulus as Annulus
    from helibore.logs.cement_sheet import CementSection as CementSection
    from helibore.logs.cement_sheet import CementSheet as CementSheet
    from helibore.logs.intervals import Interval as Interval
    from helibore.logs.intervals import IntervalTable as IntervalTable
    from helibore.logs.passage import Drift as Drift
    from helibore.logs.passage import Passage as Passage
    from helibore.logs.passage import TightSpot as TightSpot
    from helibore.logs.picks import Pick as Pick
    from helibore.logs.picks import Picks as Picks
    from helibore.logs.stress import HorizontalStress as HorizontalStress
    from helibore.logs.stress import horizontal_stress as horizontal_stress
    from helibore.logs.stress import stress_of_picks as stress_of_picks
    from helibore.logs.stress import stress_of_zones as stress_of_zones
    from helibore.logs.summary import WallSummary as WallSummary
    from helibore.logs.turn_logs import Logs as Logs
    from helibore.logs.wall_images import wall_images as wall_images
    from helibore.logs.zones import Classification as Classification
    from helibore.logs.zones import Zone as Zone
    from helibore.mesh.surface import Surface as Surface
    from helibore.mesh.volume import Volume as Volume
    from helibore.preparation.prepare import Prepared as Prepared
    from helibore.preparation.prepare import prepare as prepare
    from helibore.runs.reconstruct import reconstruct as reconstruct
    from helibore.runs.reprocess import reprocess as reprocess
    from helibore.samples.caliper import Caliper as Caliper
    from helibore.settings.cement_settings import CementJob as CementJob
    from helibore.settings.output_settings import RigidBody as RigidBody
    from helibore.settings.preparation_settings import Preparation as Preparation
    from helibore.settings.wall_settings import Settings as Settings
    from helibore.settings.zone_settings import Criteria as Criteria
    from helibore.settings.zone_settings import ImageCriteria as ImageCriteria
    from helibore.trajectory.survey import Path as Path
    from helibore.trajectory.survey import Survey as Survey
    from helibore.viewer import Attribute as Attribute
    from helibore.viewer import Viewer as Viewer
    from helibore.viewer import WellsViewer as WellsViewer
    from helibore.viewer import view as view
    from helibore.viewer import view_wells as view_wells
    from helibore.wall.append_result import Change as Change
    from helibore.wall.load import load as load
    from helibore.wall.points import PointValues as PointValues
    from helibore.wall.tune import tune as tune
    from helibore.wall.tuning import Tuning as Tuning
    from helibore.wall.wall import Wall as Wall

_load, _, __all__ = lazy_loader.attach(
    __name__,
    ["plot", "simulation"],
    {
        "_core": ["__version__"],
        "base.errors": ["InputError", "MissingExtraError"],
        "base.tables": ["LogColumn", "LogImage", "LogTable"],
        "channels.log_set": ["LogFile", "LogSet"],
        "channels.opening": ["open"],
        "files.dip_writing": ["save_dips"],
        "files.exchange_writing": ["save_trace", "save_wellcad"],
        "files.well_tops": ["read_intervals"],
        "images.image_breakouts": ["ImageBreakouts"],
        "images.sector_image": ["SectorImage"],
        "live.live": ["Live"],
        "live.model.events": ["Event"],
        "live.model.update": ["Update"],
        "logs.annulus": ["Annulus"],
        "logs.cement_sheet": ["CementSection", "CementSheet"],
        "logs.intervals": ["Interval", "IntervalTable"],
        "logs.passage": ["Drift", "Passage", "TightSpot"],
        "logs.picks": ["Pick", "Picks"],
        "logs.stress": ["HorizontalStress", "horizontal_stress", "stress_of_picks", "stress_of_zones"],
        "logs.summary": ["WallSummary"],
        "logs.turn_logs": ["Logs"],
        "logs.wall_images": ["wall_images"],
        "logs.zones": ["Classification", "Zone"],
        "mesh.surface": ["Surface"],
        "mesh.volume": ["Volume"],
        "preparation.prepare": ["Prepared", "prepare"],
        "runs.reconstruct": ["reconstruct"],
        "runs.reprocess": ["reprocess"],
        "samples.caliper": ["Caliper"],
        "settings.cement_settings": ["CementJob"],
        "settings.output_settings": ["RigidBody"],
        "settings.preparation_settings": ["Preparation"],
        "settings.wall_settings": ["Settings"],
        "settings.zone_settings": ["Criteria", "ImageCriteria"],
        "trajectory.survey": ["Path", "Survey"],
        "viewer": ["Attribute", "Viewer", "WellsViewer", "view", "view_wells"],
        "wall.append_result": ["Change"],
        "wall.load": ["load"],
        "wall.points": ["PointValues"],
        "wall.tune": ["tune"],
        "wall.tuning": ["Tuning"],
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
