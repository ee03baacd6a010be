"""All groups of settings: the tables of a settings file, and what stands before the dot of ``wall.power=2``."""

from __future__ import annotations

from typing import Any

from helibore.settings.cement_settings import CementTable
from helibore.settings.column_settings import Columns
from helibore.settings.header_settings import Header
from helibore.settings.output_settings import (
    LogSettings,
    MeshSettings,
    PassageSettings,
    RigidBody,
    StressSettings,
    ViewSettings,
)
from helibore.settings.path_settings import PathSettings
from helibore.settings.preparation_settings import Echo, Preparation
from helibore.settings.print_settings import Look, PrintTable
from helibore.settings.reading_settings import ReadingSettings
from helibore.settings.role_settings import ChannelRole, MapOfRoles, RoleOfNames
from helibore.settings.template import Template, TemplateTrack
from helibore.settings.wall_settings import Settings
from helibore.settings.zone_settings import ImageCriteria, ZoneSettings

GROUPS: dict[str, type[Any]] = {
    "header": Header,
    "columns": Columns,
    "reading": ReadingSettings,
    "preparation": Preparation,
    "echo": Echo,
    "path": PathSettings,
    "wall": Settings,
    "zones": ZoneSettings,
    "image_zones": ImageCriteria,
    "logs": LogSettings,
    "passage": PassageSettings,
    "passage.body": RigidBody,
    "stress": StressSettings,
    "cement": CementTable,
    "mesh": MeshSettings,
    "view": ViewSettings,
    "print": PrintTable,
    "look.NAME": Look,
    "template": Template,
    "template.track": TemplateTrack,
    "map": MapOfRoles,
    "map.channels.NAME": ChannelRole,
    "map.names": RoleOfNames,
}
"""The declared class of each group."""
