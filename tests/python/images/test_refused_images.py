"""What images, logs and zones refuse, one case a rule: the whole text of each error."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

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
    ("call", "text"),
    [
        (lambda: image(reference="parallel-transport").onto(path()),
         "image 'AMP': its toolface 0 follows another path, which is not known, so the image cannot be turned"),
        (lambda: image().onto(path()),
         "image 'AMP': from north to high-side: no row lies where the path has both references"),
        (lambda: image(depth=DEPTH + 900).on(wall()),
         "image 'AMP' reaches from 1899.93 to 1900.57 m: no quad of the wall, 1000.06 to 1001.89 m, has its centre "
         "there"),
        (lambda: wall().images.__setitem__("AMP", np.ones(3)),
         "images['AMP']: must be a SectorImage, which states its depths and where sector 1 lies, not ndarray"),
        (lambda: image(INFINITE), "values[1, 2] = inf: must be finite, or NaN where missing"),
        (lambda: image(np.full((6, 8), np.nan)), "values: all 48 are missing"),
        (lambda: image(name="GR", unit="gAPI").breakouts(),
         "image 'GR': gamma is dark in beds, not in breakouts; use an image of the wall"),
        (lambda: image(NEGATIVE).breakouts(),
         "image 'AMP', values[3, 4] = -1: must not be negative where dark is a share of the row's median"),
        (lambda: ImageCriteria(least_opening=120.0, most_opening=100.0),
         "least_opening = 120.0, most_opening = 100.0: the first must be less than the second, and the second at most "
         "180"),
        (lambda: ImageCriteria(dark=1.0), "dark = 1: must be in (0, 1)"),
        (lambda: ImageCriteria(opposite=91.0), "opposite = 91: must be at most 90"),
        (lambda: ImageCriteria(least_rows=0), "least_rows = 0: must be at least 1"),
        (lambda: ImageCriteria(join=-1.0), "join = -1: must be finite and not negative"),
        (lambda: percentile_limits([1, 2], percentiles=(98, 2)),
         "percentiles = (98, 2): must be two numbers in [0, 100], the first below the second"),
        (lambda: percentile_limits(np.full(9, 60.0)),
         "values: constant, 60 at both the 2 and the 98 percentile: give limits=(low, high)"),
        (lambda: sliding_window([0.0, 1.0], [1.0, 2.0, 3.0], 1.0),
         "values: must be of shape (2,) or (2, sectors), one row a depth: (3,)"),
        (lambda: sliding_window([1.0, 0.0], [1.0, 2.0], 1.0), "depth[1] = 0: must rise"),
        (lambda: Criteria(symmetry=1.5), "symmetry = 1.5: must be in [0, 1]"),
        (lambda: Criteria(opening_level=1.0), "opening_level = 1: must be in (0, 1)"),
        (lambda: Criteria(washout=math.nan), "washout = nan: must be finite and not negative"),
        (lambda: wall().logs(rugosity_window=0.0), "rugosity_window = 0.0: must be finite and above 0"),
        (lambda: hb.Wall(bit_diameter=0.2).logs().table(), "logs: the wall has no full turn"),
        (lambda: wall().logs().annulus(0.0), "casing = 0: must be finite and above 0"),
        (lambda: wall().logs().annulus(0.3).cement(top=1000.0, bottom=1001.0),
         "cement: 1 m between 1000 and 1001 m have a missing radius or are narrower than the casing; choose an "
         "interval in which every row has a volume"),
        (lambda: wall().logs().annulus(0.1).cement(excess=-0.1), "excess = -0.1: must be finite and not negative"),
        (lambda: wall().logs().annulus(0.1).cement(top=2000.0),
         "cement: the logs have no row between 2000 and 1001.84 m"),
        (lambda: gap().logs().annulus(0.1).cement(top=1000.0, bottom=1006.0),
         "cement: 3.1 m between 1000 and 1006 m have a missing radius or are narrower than the casing; choose an "
         "interval in which every row has a volume"),
    ],
)  # fmt: skip
def test_whole_texts(call: Callable[[], object], text: str) -> None:
    with pytest.raises(hb.InputError) as caught:
        call()
    assert str(caught.value) == text
