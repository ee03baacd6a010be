"""Compare mapping a sector image on 1 M quads with a NumPy gather (np.take) of as many values.

    python -m bench images

The values are checked against the image's cells before the mapping is timed. The bar is 10 gathers, for values of cells
and for linear values, each of which needs four cells.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from bench.measure import in_turn, milliseconds, ratio
from helibore.images.sector_image import SectorImage

SECTORS, PITCH, QUADS = 64, 0.1, 1_000_000


def cases(rounds: int = 15) -> list[dict[str, Any]]:
    """Return the results of a 16-sector image, rows 5 cm apart, on a wall of 64 sectors; np.take gathers its cells."""
    settings = SimpleNamespace(sectors=SECTORS, pitch=PITCH, start_toolface=0.0)
    wall = SimpleNamespace(settings=settings, start_depth=0.0, radius=np.full(QUADS + SECTORS + 1, 0.108))
    rows = np.arange(0, QUADS / SECTORS * PITCH + 1, 0.05)
    values = np.random.default_rng(1).normal(size=(rows.size, 16))
    image = SectorImage(rows, values, "GR", origin="edge", reference="high-side")
    k = np.arange(QUADS)
    depth = (k + (SECTORS + 1) / 2) * (PITCH / SECTORS)
    taken = np.floor(depth / 0.05 + 0.5).astype(np.int64) * 16 + k % SECTORS // 4
    assert (image.on(wall) == values.ravel()[taken]).mean() > 0.999  # quads on the borders of cells may differ
    seconds = in_turn(
        {
            "cell": lambda: image.on(wall),
            "linear": lambda: image.on(wall, "linear"),
            "gather": lambda: np.take(values, taken),
        },
        rounds,
    )
    return [
        {
            "case": f"sector image on {QUADS} quads",
            "cell": {"ms": milliseconds(seconds["cell"]), "over a gather": ratio(seconds["cell"], seconds["gather"])},
            "linear": {
                "ms": milliseconds(seconds["linear"]),
                "over a gather": ratio(seconds["linear"], seconds["gather"]),
            },
            "over a gather at most": 10,
            "gather ms": milliseconds(seconds["gather"]),
        }
    ]
