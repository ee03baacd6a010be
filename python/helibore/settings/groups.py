"""All groups of settings: the tables of a settings file, and what stands before the dot of ``wall.power=2``."""

from __future__ import annotations

from typing import Any

from helibore.settings.cement_settings import CementTable
from helibore.settings.column_settings import Columns
from helibore.settings.header_settings import Header
from helibore.settings.interval_settings import IntervalInput
from helibore.settings.output_settings import (
    LogSettings,
    MeshSettings,
    PassageSettings,
    RigidBody,
    StressSettings,
    ViewSettings,
)
from helibore.settings.path_settings import PathSettings
from helibore.settings.preparation_settings import Echo, EchoCasing, Preparation
from helibore.settings.print_settings import Look, PrintTable
from helibore.settings.reading_settings import ReadingSettings
from helibore.settings.role_settings import ChannelRole, MapOfRoles, RoleOfNames
from helibore.settings.template import Template, TemplateTrack
from helibore.settings.wall_settings import Settings
from helibore.settings.zone_settings import ImageCriteria, ZoneSettings

KINDS: tuple[type[Any], ...] = (
    Header,
    Columns,
    ReadingSettings,
    Preparation,
    Echo,
    EchoCasing,
    PathSettings,
    IntervalInput,
    Settings,
    ZoneSettings,
    ImageCriteria,
    LogSettings,
    PassageSettings,
    RigidBody,
    StressSettings,
    CementTable,
    MeshSettings,
    ViewSettings,
    PrintTable,
    Look,
    Template,
    TemplateTrack,
    MapOfRoles,
    ChannelRole,
    RoleOfNames,
)
GROUPS: dict[str, type[Any]] = {kind.group: kind for kind in KINDS}
"""The declared class of each group."""
