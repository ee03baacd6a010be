"""Radius and images of a wall in files: a feature at toolface 90 is at toolface 90 for dlisio, lasio and `hb.open`."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import helibore as hb
from helibore.channels.roles import WALL, guess
from helibore.cli import cli
from helibore.logs.wall_images import wall_images

BIT, TURNS, SECTORS, START = 0.2159, 40, 16, 10.0


@pytest.fixture(scope="module")
def wall(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A hole with a groove at toolface 90, and an image that is bright there, whose sector 1 starts at 180."""
    k = np.arange(SECTORS * TURNS)
    depth, toolface = 1000 + k * 0.1 / SECTORS, (START + k * 360 / SECTORS) % 360
    radius = BIT / 2 + 0.02 * (np.abs(toolface - 90) < 13)
    survey = hb.Survey([0, 2000], [30, 30], [0, 0])
    made = hb.reconstruct(
        hb.Caliper(depth, toolface, radius), bit_diameter=BIT, sectors=SECTORS, start_toolface=START, path=survey.path()
    )
    rows = np.arange(999.0, 1006.0, 0.05)
    values = np.where(np.arange(36) == 27, 100.0, 1.0) + np.zeros((rows.size, 1))  # sector 28: 450 to 460 degrees
    made.images["AMP"] = hb.SectorImage(rows, values, "AMP", "mV", origin="edge", reference="high-side", offset=180.0)
    file = tmp_path_factory.mktemp("images") / "w.wall"
    made.save(file)
    return file


def written(wall: Path, file: Path, *words: str) -> Path:
    done = CliRunner().invoke(cli, ["logs", str(wall), "-o", str(file), "--by-sector", *words])
    assert done.exit_code == 0, done.output
    return file


def test_rows_and_sectors_are_those_of_the_wall(wall: Path) -> None:
    made = hb.load(wall)
    radius, image = wall_images(made)
    np.testing.assert_array_equal(radius.values.ravel(), made.radius[: radius.values.size])
    np.testing.assert_allclose(radius.toolface, made.toolface[:SECTORS])
    expected = np.where(np.abs(image.toolface - 95) < 5, 100.0, 1.0)
    np.testing.assert_array_equal(image.values, np.broadcast_to(expected, image.values.shape))
    assert (image.mnemonic, image.unit) == ("AMP_IMG", "mV")
    assert "toolface from high-side" in image.description


def test_dlisio_finds_the_feature_at_toolface_90(wall: Path, tmp_path: Path) -> None:
    dlis = pytest.importorskip("dlisio.dlis")
    pytest.importorskip("dliswriter")
    with dlis.load(str(written(wall, tmp_path / "w.dlis", "--sigma"))) as (logical,):
        frame = logical.frames[0]
        rows = frame.curves()
        channels = {channel.name: channel for channel in frame.channels}
        assert channels["RADIUS"].dimension == [SECTORS]
        axis = channels["RADIUS"].axis[0]
        assert axis.attic["COORDINATES"].units == "deg"
        bright = np.argmax(rows["RADIUS"], axis=1)
        assert np.abs(np.array(axis.coordinates)[bright] - 90).max() < 13
        np.testing.assert_array_equal(rows["RADIUS"], wall_images(hb.load(wall))[0].values)
        assert rows["RADIUS_SIGMA"].shape == rows["AMP_IMG"].shape == rows["RADIUS"].shape


def test_lasio_finds_the_feature_at_toolface_90(wall: Path, tmp_path: Path) -> None:
    lasio = pytest.importorskip("lasio")
    read = lasio.read(str(written(wall, tmp_path / "w.las")))
    curves = [curve for curve in read.curves if curve.mnemonic.startswith("RADIUS[")]
    angles = [float(re.findall(r"\{AF;(.*)deg\}", curve.descr)[0]) for curve in curves]
    values = np.stack([curve.data for curve in curves], axis=1)
    assert np.abs(np.array(angles)[np.argmax(values, axis=1)] - 90).max() < 13
    np.testing.assert_allclose(values, wall_images(hb.load(wall))[0].values, atol=1e-6)


@pytest.mark.parametrize("ending", ["las", "dlis", "csv", "parquet"])
def test_our_readers_have_the_same_image(wall: Path, tmp_path: Path, ending: str) -> None:
    library = {"las": "lasio", "dlis": "dliswriter", "parquet": "pyarrow", "csv": "numpy"}[ending]
    pytest.importorskip(library)
    with hb.open(written(wall, tmp_path / f"w.{ending}")) as file:
        found = file.image("RADIUS")
        expected = wall_images(hb.load(wall))[0]
        np.testing.assert_allclose(found.values, expected.values, atol=1e-6)
        if ending in ("las", "dlis"):
            assert (found.first, found.step) == pytest.approx((START, 360 / SECTORS))
            image = found.sector_image("centre", "high-side")
            np.testing.assert_allclose(image.toolface, expected.toolface)


@pytest.mark.parametrize("ending", ["las", "dlis", "parquet", "csv"])
def test_such_a_file_read_as_a_caliper_gives_the_radii_and_nothing_derived(
    wall: Path, tmp_path: Path, ending: str
) -> None:
    """The diameters of its logs, their toolface and the uncertainties are no further measurements."""
    if ending == "dlis":
        pytest.importorskip("dliswriter")
    first = START if ending in ("las", "dlis") else None  # CSV and Parquet have no axis
    set_ = hb.open(written(wall, tmp_path / f"w.{ending}", "--sigma")).sets[0]
    found = guess(set_).all(*WALL, "toolface")
    assert [(role.channel, role.role, role.first) for role in found] == [("RADIUS", "radius-image", first)]


def test_a_step_is_refused(wall: Path, tmp_path: Path) -> None:
    words = ["logs", str(wall), "-o", str(tmp_path / "w.las"), "--by-sector", "--step", "1m"]
    done = CliRunner().invoke(cli, words)
    assert (done.exit_code, "--by-sector" in done.output) == (2, True)
