"""What images, logs and zones refuse, one case a rule: the whole text of each error."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden

import helibore as hb
from helibore.base.color_limits import percentile_limits
from helibore.images.normalization import sliding_window
from helibore.images.sector_image import SectorImage
from helibore.logs.zone_criteria import Criteria
from helibore.settings.zone_settings import ImageCriteria

HOW: Any = {"origin": "edge", "reference": "north"}
DEPTH = 1000 + 0.1 * np.arange(6)


def image(values: Any = None, depth: Any = DEPTH, name: str = "AMP", unit: str = "", **how: Any) -> SectorImage:
    return hb.SectorImage(depth, np.ones((6, 8)) if values is None else values, name, unit, **(HOW | how))


def wall(radius: float = 0.108) -> hb.Wall:
    depth, toolface = np.repeat(1000 + 0.05 * np.arange(40), 8), np.tile(np.arange(8) * 45.0, 40)
    return hb.reconstruct(hb.Caliper(depth, toolface, np.full(320, radius)), bit_diameter=0.2, sectors=8)


def gap() -> hb.Wall:
    depth, toolface = np.repeat(np.r_[1000:1001:0.1, 1006:1007:0.1], 8), np.tile(np.arange(8) * 45.0, 20)
    return hb.reconstruct(hb.Caliper(depth, toolface, np.full(160, 0.1)), bit_diameter=0.2, sectors=8)


def path(stop: float = 5.0, reference: Any = "high-side") -> Any:
    return hb.Survey([0.0, stop], [30.0, 30.0], [10.0, 10.0]).path(reference=reference)


NEGATIVE = np.ones((6, 8))
NEGATIVE[3, 4] = -1.0
INFINITE = np.ones((6, 8))
INFINITE[1, 2] = np.inf


@pytest.mark.parametrize(
    "call",
    [
        lambda: image(reference="parallel-transport").onto(path()),
        lambda: image().onto(path()),
        lambda: image(depth=DEPTH + 900).on(wall()),
        lambda: wall().images.__setitem__("AMP", np.ones(3)),
        lambda: image(INFINITE),
        lambda: image(np.full((6, 8), np.nan)),
        lambda: image(name="GR", unit="gAPI").breakouts(),
        lambda: image(NEGATIVE).breakouts(),
        lambda: ImageCriteria(least_opening=120.0, most_opening=100.0),
        lambda: ImageCriteria(dark=1.0),
        lambda: ImageCriteria(opposite=91.0),
        lambda: ImageCriteria(least_rows=0),
        lambda: ImageCriteria(join=-1.0),
        lambda: percentile_limits([1, 2], percentiles=(98, 2)),
        lambda: percentile_limits(np.full(9, 60.0)),
        lambda: sliding_window([0.0, 1.0], [1.0, 2.0, 3.0], 1.0),
        lambda: sliding_window([1.0, 0.0], [1.0, 2.0], 1.0),
        lambda: Criteria(symmetry=1.5),
        lambda: Criteria(opening_level=1.0),
        lambda: Criteria(washout=math.nan),
        lambda: wall().logs(rugosity_window=0.0),
        lambda: hb.Wall(bit_diameter=0.2).logs().table(),
        lambda: wall().logs().annulus(0.0),
        lambda: wall().logs().annulus(0.3).cement(top=1000.0, bottom=1001.0),
        lambda: wall().logs().annulus(0.1).cement(excess=-0.1),
        lambda: wall().logs().annulus(0.1).cement(top=2000.0),
        lambda: gap().logs().annulus(0.1).cement(top=1000.0, bottom=1006.0),
    ],
)  # fmt: skip
def test_whole_texts(call: Callable[[], object], golden: Golden) -> None:
    with pytest.raises(hb.InputError) as caught:
        call()
    golden(str(caught.value))
