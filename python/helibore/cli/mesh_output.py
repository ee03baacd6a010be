"""Write what ``helibore reconstruct`` and ``mesh`` make, and make the lines on it; loaded when a wall is made."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from helibore.base.color_limits import PERCENTILES
from helibore.base.colors import customary_map
from helibore.base.errors import InputError
from helibore.base.file_endings import ARCHIVE_ENDING
from helibore.cli.lines import Lines, summary_lines
from helibore.files.table_writing import write_table
from helibore.mesh.surface import Surface
from helibore.mesh.volume import Volume

if TYPE_CHECKING:
    from helibore.base.arrays import Floats
    from helibore.preparation.eccentering import Centres
    from helibore.runs.run import Run, Stage
    from helibore.wall.wall import Wall

COLORED = (".glb", ".ply")


def save_mesh(wall: Wall, made: Surface | Volume, output: Path, color_by: str | None) -> None:
    """Write the wall as an archive, or ``made`` as a mesh; ``color_by`` names the attribute that colours a surface."""
    if output.suffix.lower() == ARCHIVE_ENDING:
        wall.save(output)
    elif isinstance(made, Volume):
        made.save(output)
    else:
        name = color_by or next(iter(wall.images), "radius")
        made.save(output, color_by=None if name == "radius" else name, **_colors(wall, made, output, name))


def _colors(wall: Wall, made: Surface, output: Path, name: str) -> dict[str, Any]:
    """Return the arguments of `Surface.save` for the customary colours of an image; {} if they do not apply."""
    values = made.attributes[name] if name in wall.images else np.empty(0)
    there = values[np.isfinite(values)]
    if output.suffix.lower() not in COLORED or not there.size:
        return {}
    color_map = customary_map(wall.images[name].name, wall.images[name].unit)
    low, high = np.percentile(there, PERCENTILES).tolist()
    return {"limits": (low, high) if low < high else None, "color_map": color_map, "log": color_map == "resistivity"}


CENTRE_COLUMNS = (
    ("turn", "", 0), ("x", "_m", 7), ("y", "_m", 7), ("sigma_x", "_m", 7), ("sigma_y", "_m", 7),
    ("eccentering", "_m", 7), ("direction", "_deg", 2), ("mean_radius", "_m", 7), ("noise", "_m", 7),
    ("inliers", "", 4), ("one_sided", "", 4), ("samples", "", 0),
)  # fmt: skip
"""Columns of the table of centres after the depth: name in `Centres`, unit, and number of decimals."""


def write_centres(found: Centres, depth: Floats | None, file: Path) -> None:
    """Write the tool's centre in each turn to ``file``, as a table."""
    columns = {"depth_m": (np.empty(0) if depth is None else depth, 4)}
    for name, unit, decimals in CENTRE_COLUMNS:
        columns[name + unit] = (getattr(found, name).astype(np.float64), decimals)
    write_table(file, columns)


def error_lines(run: Run, threads: int | None, stage: Stage) -> Lines:
    """Return a line on the cross-validated error of the wall.

    There is no line if there is no such error, or if the choice of an estimator or tuning has printed what to expect:
    between arms, samples that are left out come back better than the wall, those of X-Y diameters exactly.
    """
    from helibore.wall.estimates import FEWEST_SAMPLES
    from helibore.wall.tune import cross_validate

    count, said = run.wall.sample_count, {label for label, _ in run.messages}
    if run.wall.basis != "azimuthal" or count < FEWEST_SAMPLES or said & {"tuned", "estimator"}:
        return []
    try:
        with stage("compare", "Comparing estimators"):
            return [("error", cross_validate(run.wall, min(1000, FEWEST_SAMPLES + count // 50), threads).sentence)]
    except InputError:  # the settings have a window, or no sample has a neighbour within reach
        return []


def made_lines(run: Run, made: Surface | Volume, ends: tuple[float | None, float | None]) -> Lines:
    cells = f", {len(made.hexes):,} hexahedra" if isinstance(made, Volume) else f", {len(made.quads):,} quads"
    lines = summary_lines(run.wall.summary(*ends), cells)
    for name, values in made.attributes.items():
        known = values[np.isfinite(values)]
        label, text = "missing", f"{values.size - known.size:,} of {values.size:,} cells have no {name}"
        if name == "measured":
            text = f"{int(values.sum()):,} of {values.size:,} cells are measured at each corner"
            label, text = name, text if values.all() else f"{text}; the others are interpolated"
        elif name == "difference" and known.size:
            median, low, high = 1e3 * np.median(known), 1e3 * known.min(), 1e3 * known.max()
            spread = f"{median:+.2f} mm in the median, {low:+.2f} to {high:+.2f}"
            count = f"{known.size:,} of {values.size:,} quads"
            label, text = name, f"this wall minus the wall of the earlier passes: {spread}; {count}"
        lines.append((label, text))
    return lines
