"""Well traces and WellCAD texts: read back by `hb.open`, with directions that are known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import helibore as hb


def test_a_trace_is_the_survey_again(tmp_path: Path) -> None:
    survey = hb.Survey([0, 500, 1000], [0, 20, 40], [0, 90, 90], north="grid")
    path = survey.path(head=(6_478_000.0, 435_000.0, 0.0))
    hb.save_trace(path, tmp_path / "w.dev", well="A-1", kb=25.0)
    with hb.open(tmp_path / "w.dev") as file:
        again, one = file.survey(), file.set()
    np.testing.assert_allclose(
        [again.depth, again.inclination, again.azimuth], [survey.depth, survey.inclination, survey.azimuth]
    )
    assert again.north == "grid"
    north, east, down = path.position(survey.depth).T
    np.testing.assert_allclose(one.numbers("X"), east, atol=1e-4)
    np.testing.assert_allclose(one.numbers("Y"), north, atol=1e-4)
    np.testing.assert_allclose(one.numbers("Z"), 25.0 - down, atol=1e-4)
    assert one.numbers("X")[-1] > 435_100  # the hole goes east
    assert one.numbers("DLS").tolist() == pytest.approx([0, 1.2, 1.2], abs=1e-4)


@pytest.mark.parametrize(
    ("origin", "offset", "direction", "bright"),
    [("edge", 0.0, "clockwise", 9), ("edge", 180.0, "clockwise", 27), ("centre", 5.0, "counterclockwise", 27)],
)
def test_the_bright_sector_of_a_wellcad_text_is_at_its_toolface(
    tmp_path: Path, origin: str, offset: float, direction: str, bright: int
) -> None:
    depth = np.arange(1000.0, 1001.0, 0.1)
    values = np.where(np.arange(36) == bright, 100.0, 1.0) + np.zeros((depth.size, 1))
    kept = np.delete(np.arange(depth.size), [4, 5])  # a gap of two rows
    image = hb.SectorImage(
        depth[kept], values[kept], "AMP", "mV", origin=origin, reference="north", offset=offset, direction=direction
    )  # type: ignore[arg-type]
    assert image.toolface[bright] == pytest.approx(95.0)
    hb.save_wellcad(image, tmp_path / "a.wai")
    lines = (tmp_path / "a.wai").read_text().splitlines()
    assert lines[0].split(",")[:3] == ["Depth", "0.00 deg", "10.00 deg"]
    assert lines[1].split(",")[:2] == ["m", "mV"]
    rows = np.array([line.split(",") for line in lines[2:]], dtype=float)
    np.testing.assert_allclose(rows[:, 0], depth, atol=1e-4)
    whole = rows[kept]
    np.testing.assert_array_equal(np.argmax(whole[:, 1:], axis=1), 9)  # the sector from 90 to 100 degrees
    assert (rows[[4, 5], 1:] == -999.25).all()


def test_refused(tmp_path: Path) -> None:
    path = hb.Survey([0, 500], [0, 20], [0, 90]).path()
    with pytest.raises(hb.InputError, match=r"\.dev"):
        hb.save_trace(path, tmp_path / "w.txt")
    row = hb.SectorImage([1.0], [[1.0, 2.0]], "A", origin="edge", reference="north", reach=1.0)
    with pytest.raises(hb.InputError, match="two rows or more"):
        hb.save_wellcad(row, tmp_path / "a.wai")
