"""True depths in the depth track: what a survey gives, below sea level where the datum is known, and nothing else."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from golden_texts import Golden

import helibore as hb
from helibore.cli import cli

pytest.importorskip("matplotlib", reason='pictures need the extra: pip install "helibore[plot]"')

from plotted_wall import plotted_wall

from helibore.plot.content import Drawing, content_of
from helibore.plot.log import log
from helibore.trajectory.true_depth import TrueDepth, true_depth

SLANTED = hb.Survey([0.0, 1000.0, 1000.001, 2100.0], [0.0, 0.0, 60.0, 60.0], [0.0, 0.0, 30.0, 30.0])
"""Straight down for 1000 m, then 60 degrees off it: every further metre is half a metre deeper."""


@pytest.fixture(scope="module")
def wall() -> hb.Wall:
    return plotted_wall()


def known(path: hb.Path | None, elevation: float | None = None) -> TrueDepth:
    found = true_depth(path, elevation)
    assert found is not None
    return found


def test_true_depths_are_those_of_the_path() -> None:
    depth = np.array([-1.0, 0.0, 1000.0, 2000.0, 2100.5])
    for head in ((0.0, 0.0, 0.0), (6.5e6, 4.3e5, -54.9)):  # a head's down at depth 0 is a datum of its own
        tvd = known(SLANTED.path(reference="north", head=head))
        assert tvd.name == "TVD"
        assert tvd.at(depth) == pytest.approx([math.nan, 0.0, 1000.0, 1500.0, math.nan], abs=1e-3, nan_ok=True)
        below = known(SLANTED.path(reference="north", head=head), 54.9)
        assert below.name == "TVDSS"
        assert below.at(depth) == pytest.approx([math.nan, -54.9, 945.1, 1445.1, math.nan], abs=1e-3, nan_ok=True)


def test_a_survey_that_begins_in_the_hole_tells_none_unless_its_head_does(golden: Golden) -> None:
    deep = hb.Survey([1990.0, 2100.0], [60.0, 60.0], [30.0, 30.0])
    assert true_depth(deep.path(), None) is None
    assert true_depth(None, None) is None
    near = hb.Survey([0.0005, 2100.0], [60.0, 60.0], [30.0, 30.0])
    assert known(near.path()).at(np.array([1000.0])) == pytest.approx([500.0], abs=1e-3)
    assert known(deep.path(head=(0.0, 0.0, 1495.0))).at(np.array([2000.0])) == pytest.approx([1500.0], abs=1e-9)
    for path in (deep.path(), None):
        with golden.raises():
            true_depth(path, 25.0)
    with golden.raises():
        Drawing(elevation=math.nan)


def depth_labels(figure: Any) -> list[Any]:
    """The labels of the depth track but zones, and the first and the last depth, which stand at the ends."""
    return [text for text in figure.axes[0].texts if text.get_position()[0] > 0.5 and text.get_va() == "center"]


@pytest.mark.parametrize(("elevation", "name"), [(None, "TVD"), (25.0, "TVDSS")])
def test_the_depth_track_writes_them_under_the_measured_depths(
    wall: hb.Wall, elevation: float | None, name: str
) -> None:
    wall.path = SLANTED.path()
    figure = log(wall, elevation=elevation, polar=(), body=(), dpi=40)
    assert f"{name} [m]" in [text.get_text() for text in figure.texts]
    above = "" if elevation is None else "; TVDSS is TVD less 25 m"
    assert f"1:40, 25 mm on paper a metre{above}" in [text.get_text() for text in figure.texts]
    texts = [(text.get_position()[1], text.get_text()) for text in depth_labels(figure)]
    measured = [float(text) for _, text in texts[::2]]
    assert measured == list(range(2001, 2022))
    assert [text for _, text in texts[1::2]] == [
        f"{1000 + (depth - 1000) / 2 - (elevation or 0):.1f}" for depth in measured
    ]
    assert all(0 < under - over < 0.15 for (over, _), (under, _) in zip(texts[::2], texts[1::2], strict=True))


def test_without_a_survey_the_track_is_as_it_was(wall: hb.Wall) -> None:
    wall.path = None
    figure = log(wall, polar=(), body=(), dpi=40)
    assert not [text.get_text() for text in figure.texts if "TVD" in text.get_text()]
    depths = [float(text.get_text()) for text in depth_labels(figure)]
    assert depths == list(range(2001, 2022))
    with pytest.raises(ValueError, match="elevation"):
        content_of(wall, Drawing(elevation=25.0))


def test_the_command_takes_the_elevation_in_any_unit(wall: hb.Wall, tmp_path: Path, golden: Golden) -> None:
    wall.path = SLANTED.path()
    wall.save(tmp_path / "w.wall")
    given = [
        "plot",
        str(tmp_path / "w.wall"),
        "-s",
        "print.elevation=82ft",
        "--no-polar",
        "--no-body",
        "--dpi",
        "40",
        "-o",
    ]
    done = CliRunner().invoke(cli, [*given, str(tmp_path / "w.svg")])
    assert done.exit_code == 0, done.output
    assert re.search(r"TVDSS is TVD less 24.9936 m", (tmp_path / "w.svg").read_text())
    hb.reconstruct(hb.Caliper.gauge(10.0, 12.0, 0.2), bit_diameter=0.2).save(tmp_path / "plain.wall")
    done = CliRunner().invoke(cli, ["plot", str(tmp_path / "plain.wall"), *given[2:], str(tmp_path / "p.svg")])
    assert (done.exit_code, (tmp_path / "p.svg").exists()) == (2, False)
    golden(done.stderr)
