"""The mean of an image as a column of the logs."""

from __future__ import annotations

import numpy as np

import helibore as hb
from helibore.logs.image_means import image_means


def logs_of_a_wall() -> hb.Wall:
    depth = np.repeat(np.arange(1000.0, 1010.0, 0.05), 16)
    toolface = np.tile(np.arange(16) * 22.5, depth.size // 16)
    return hb.reconstruct(hb.Caliper(depth, toolface, np.full(depth.size, 0.1)), bit_diameter=0.2, pitch=0.1)


def image(depth: np.ndarray, values: np.ndarray, reach: float, unit: str = "gAPI") -> hb.SectorImage:
    return hb.SectorImage(depth, values, "GR", unit, origin="edge", reference="high-side", reach=reach)


def test_a_mean_is_weighed_by_the_hole_that_each_row_covers_and_missing_where_none_does() -> None:
    logs = logs_of_a_wall().logs().by_step(1.0)
    values = np.array([[10.0, 30.0], [40.0, np.nan], [np.nan, np.nan], [80.0, 80.0]])
    one = image(np.array([1001.0, 1001.5, 1003.5, 1006.5]), values, 0.5)
    (column,) = image_means(logs, {"GR": one})
    assert (column.mnemonic, column.unit) == ("GR", "gAPI")
    means = dict(zip((logs.depth - 0.5).round().astype(int).tolist(), column.values.tolist(), strict=True))
    # covered: 20 from 1000.5 to 1001.25, 40 to 1002, nothing of the row without a value, 80 from 1006 to 1007
    assert np.isclose(means[1001], (20 * 0.25 + 40 * 0.75) / 1.0)
    assert np.isnan([means[depth] for depth in (1002, 1003, 1004, 1005, 1007, 1008)]).all()
    assert means[1006] == 80.0


def test_a_constant_image_is_that_constant_in_every_turn_and_names_are_mnemonics() -> None:
    logs = logs_of_a_wall().logs()
    one = image(np.arange(999.0, 1012.0, 0.15), np.full((87, 8), 55.0), 0.2)
    columns = image_means(logs, {"gr up": one, "GR_UP": one, "AGE": one, "8 inch": one, "Incl": one, "CLEAR_178": one})
    assert [column.mnemonic for column in columns] == [
        "GR_UP", "GR_UP_", "IMAGE_AGE", "IMAGE_8_INCH", "IMAGE_INCL", "IMAGE_CLEAR_178",
    ]  # fmt: skip
    for column in columns:
        np.testing.assert_allclose(column.values, 55.0, rtol=1e-12)
    names = [of.mnemonic for of in logs.table(columns)]
    assert len(set(names)) == len(names)
