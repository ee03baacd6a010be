"""The metadata of a mesh: texts by name, the same in every format that holds texts.

{"made by": "helibore 0.1.0", "basis": "radius measured ...", "helix": "64 sectors, pitch 0.1 m, ...", ...}
"""

from __future__ import annotations

import json

from helibore import _core
from helibore.samples.caliper import BASIS_TEXT
from helibore.samples.helix import WallLike, basis_of, helix_of
from helibore.trajectory.survey import Path

UNITS = "metres and degrees; depth along the hole, positive down; toolface clockwise looking downhole"


def metadata_of(wall: WallLike, path: Path | None) -> dict[str, str]:
    """Return what a wall is made from and how it is placed along ``path``."""
    helix = helix_of(wall)
    metadata = {
        "made by": f"helibore {_core.__version__}",
        "units": UNITS,
        "basis": BASIS_TEXT[basis_of(wall)],
        "helix": f"{helix.sectors} sectors, pitch {helix.pitch!r} m, from {helix.start_depth!r} m, "
        f"toolface {helix.start_toolface!r} deg",
        "toolface 0": "north" if path is None else path.reference,
        "path": "straight down from (0, 0, 0)",
    }
    if path is not None:
        north, east, down = path.head
        stations = f"{len(path.survey)} stations from {path.start_depth!r} to {path.survey_depth!r} m"
        head = f"from (north {north!r}, east {east!r}, down {down!r})"
        metadata["path"] = f"{path.method} through {stations}, extended by {path.extend!r} m, {head}"
    bit_diameter = getattr(wall.settings, "bit_diameter", None)
    if bit_diameter is not None:
        metadata["bit_diameter"] = f"{bit_diameter!r} m"
    if made_from := getattr(wall, "made_from", None):
        metadata["made_from"] = json.dumps(made_from, ensure_ascii=False)
    return metadata
