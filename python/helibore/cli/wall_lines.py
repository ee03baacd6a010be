"""The summary a driller reads: interval, diameters against the bit, support; and what was written."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from helibore.base.units import INCH, size_text

if TYPE_CHECKING:
    import helibore
    from helibore.base.arrays import Floats


def diameters(wall: helibore.Wall) -> Floats:
    """Return the diameter across each vertex that has one half a turn deeper, metres; NaN where either is missing.

    With an odd number of sectors the far side is the mean of the two vertices next to it.
    """
    radius, sectors = wall.radius, wall.settings.sectors
    near, far = sectors // 2, (sectors + 1) // 2
    count = max(radius.size - far, 0)
    across: Floats = radius[:count] + 0.5 * (radius[near : near + count] + radius[far : far + count])
    return across


def wall_lines(wall: helibore.Wall, quads: int, samples_mean: float) -> list[tuple[str, str]]:
    """Return the summary a driller reads, as labels and texts; ``samples_mean`` is their mean diameter in metres."""
    settings, depth, nearest = wall.settings, wall.depth, wall.nearest
    bit = settings.bit_diameter
    lines = [
        ("wall", f"{depth.min():.2f} to {depth.max():.2f} m, {settings.sectors} sectors, pitch {settings.pitch:g} m: "
         f"{len(wall):,} vertices, {quads:,} quads, from {wall.sample_count:,} samples"),
        ("bit", size_text(bit)),
    ]  # fmt: skip
    across = diameters(wall)
    across = across[~np.isnan(across)]
    if across.size:
        sizes = (("mean", across.mean()), ("least", across.min()), ("greatest", across.max()))
        for index, (name, size) in enumerate(sizes):
            text = (
                f"{name:<9}{size / INCH:7.3f} in ({size * 1e3:6.1f} mm), {(size - bit) / INCH:+.3f} in against the bit"
            )
            lines.append(("diameter" if index == 0 else "", text))
        lines.append(("", f"samples  {samples_mean / INCH:7.3f} in ({samples_mean * 1e3:6.1f} mm), their mean"))
    without = float(np.mean(wall.support == 0)) if len(wall) else 1.0
    lines.append(("support", f"{100 * without:.2f} % of the vertices are without support (no sample in reach)"))
    if without < 1:
        middle, most = np.nanpercentile(nearest, [50, 99])
        lines.append(
            ("", f"nearest sample: {middle * 1e3:.0f} mm away for half of the vertices, {most * 1e3:.0f} mm for 99 %")
        )
    return lines


def written_lines(output: Path, blake2b: str, expected: str) -> Iterator[tuple[str, str]]:
    """Yield what was written, and whether a run that was repeated from settings gave the same to the last bit."""
    from helibore.runs.run_settings import settings_file

    yield "wrote", f"{output} ({output.stat().st_size / 1e6:,.1f} MB), {settings_file(output).name}"
    if expected:
        yield (
            "repeated",
            "to the last bit" if blake2b == expected else "with other bytes: another ending, version or machine",
        )
