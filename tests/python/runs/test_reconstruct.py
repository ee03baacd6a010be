"""`hb.reconstruct` of readings and of what was prepared: the same as one step after the other."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import helibore as hb
from helibore.cli import cli
from helibore.preparation.passes import difference
from helibore.wall.interpolation import on_quads

BIT = 0.216
STEPS = hb.Preparation(greatest_radius=0.12, spikes=6, toolface_from="north", passes=(1, 2), earlier=(1,))
SETTINGS: dict[str, Any] = {"bit_diameter": BIT, "sectors": 16, "pitch": 0.05}


@pytest.fixture
def path() -> hb.Path:
    return hb.Survey([0.0, 2000.0], [48.0, 48.0], [248.0, 248.0]).path()


@pytest.fixture
def file(tmp_path: Path) -> Path:
    k = np.arange(4000)
    rng = np.random.default_rng(5)
    radius = 0.108 + 0.001 * (k >= 2000) + 0.0002 * rng.standard_normal(k.size)
    radius[rng.integers(0, k.size, 20)] = 0.2
    columns = (1000 + (k % 2000) * 0.0005, k * 37.0 % 360, radius, 1 + k // 2000)
    name = tmp_path / "caliper.csv"
    np.savetxt(name, np.column_stack(columns), delimiter=",", header="md_m,tf_deg,radius_m,pass", comments="")
    return name


def same(one: hb.Wall, other: hb.Wall) -> bool:
    return all(
        getattr(one, name).tobytes() == getattr(other, name).tobytes() for name in ("depth", "radius", "support")
    )


def test_readings_are_prepared_on_the_way(file: Path, path: hb.Path) -> None:
    readings = hb.open(file).readings()
    wall = hb.reconstruct(readings, preparation=STEPS, path=path, **SETTINGS)
    prepared = hb.prepare(readings, STEPS, path)
    assert prepared.counts["range"] == 20
    assert same(wall, hb.reconstruct(prepared, path=path, **SETTINGS))
    assert same(wall, hb.reconstruct(prepared.caliper, **SETTINGS))
    assert wall.path is path
    known = wall.attributes["difference"][np.isfinite(wall.attributes["difference"])]
    assert known.size > 250
    np.testing.assert_allclose(known.mean(), 0.001, atol=1e-4)  # pass 2 is 1 mm larger, whole, though passes names both
    assert wall.attributes.units["difference"] == "m"
    assert same(hb.reconstruct(readings, **(SETTINGS | {"path": None})), hb.reconstruct([readings], **SETTINGS))


def test_the_difference_is_that_of_the_passes(file: Path, path: hb.Path) -> None:
    steps = hb.Preparation(greatest_radius=0.12, passes=(2,), earlier=(1,))
    wall = hb.reconstruct(hb.open(file).readings(), preparation=steps, path=path, **SETTINGS)
    known = wall.attributes["difference"][np.isfinite(wall.attributes["difference"])]
    np.testing.assert_allclose(known, 0.001, atol=4e-4)  # noise of 0.2 mm, eight neighbours, four corners
    assert "difference" in wall.surface().attributes


def test_walls_that_are_compared_have_one_estimator(file: Path) -> None:
    """Else their difference would be that of two estimators, where one pass has fewer samples than the others."""
    steps = hb.Preparation(greatest_radius=0.12, passes=(1, 2), earlier=(1,))
    prepared = hb.prepare(hb.open(file).readings(), steps)
    assert prepared.earlier is not None
    one = prepared.earlier
    few = hb.Caliper(one.depth[::60], one.toolface[::60], one.radius[::60])
    wall = hb.reconstruct(replace(prepared, earlier=few), **SETTINGS, estimator="automatic")
    assert wall.settings.estimator != "inverse-distance", "which so few samples alone would get"
    earlier = hb.reconstruct(few, **vars(wall.settings))
    expected = on_quads(difference(earlier, wall), wall.settings.sectors)
    assert np.isfinite(expected).sum() > 250
    np.testing.assert_array_equal(wall.attributes["difference"], expected)


def test_the_wall_has_the_lines_on_its_readings_and_on_what_one_pass_sees(file: Path) -> None:
    prepared = hb.prepare(hb.open(file).readings(), hb.Preparation(greatest_radius=0.12))
    made, report = prepared.caliper, [list(line) for line in prepared.report]
    assert report
    assert hb.reconstruct(prepared, **SETTINGS).made_from == {"preparation": report}
    assert hb.reconstruct(made, **SETTINGS).made_from == {}
    tight = (prepared.pass_number == 2) & (abs(made.depth - 1000.5) < 0.1)
    seen = replace(prepared, caliper=hb.Caliper(made.depth, made.toolface, made.radius - 0.03 * tight))
    *lines, less, more = hb.reconstruct(seen, **SETTINGS).made_from["preparation"]
    assert lines == report
    assert [(label, text[:17]) for label, text in (less, more)] == [
        ("passes", "pass 2 reads up t"), ("passes", "pass 1 reads up t"),
    ]  # fmt: skip


def test_what_is_prepared_is_not_prepared_again(file: Path) -> None:
    prepared = hb.prepare(hb.open(file).readings(), hb.Preparation(greatest_radius=0.12))
    for samples, name in ((prepared, "Prepared"), (prepared.caliper, "Caliper")):
        with pytest.raises(ValueError, match=f"^preparation: applies only to readings; a {name} is already prepared$"):
            hb.reconstruct(samples, preparation=STEPS, **SETTINGS)


def test_recentring_knows_the_bit_of_the_wall(tmp_path: Path) -> None:
    """A tool 6 mm off the axis of a hole of the bit's size; without a bit size, it could be a washout on one side."""
    k = np.arange(1200)
    toolface = k * 33.0 % 360
    radius = 0.108 + 0.006 * np.cos(np.radians(toolface)) + np.random.default_rng(0).normal(0, 2e-4, k.size)
    name = tmp_path / "c.csv"
    rows = np.column_stack([100 + 0.002 * k, toolface, radius])
    np.savetxt(name, rows, delimiter=",", header="md_m,tf_deg,radius_m", comments="")
    steps, readings = hb.Preparation(recentre=True), hb.open(name).readings()
    unsized, sized = hb.prepare(readings, steps), hb.prepare(readings, steps, bit_diameter=0.216)
    wall = hb.reconstruct(readings, preparation=steps, bit_diameter=0.216, sectors=8)
    assert same(wall, hb.reconstruct(sized, bit_diameter=0.216, sectors=8))
    assert not same(wall, hb.reconstruct(unsized, bit_diameter=0.216, sectors=8))
    given = ["reconstruct", str(name), "--recentre", "--bit-diameter", "0.216m", "-o", str(tmp_path / "w.wall")]
    result = CliRunner().invoke(cli, given)
    assert result.exit_code == 0, result.output
    assert "turns corrected" in result.output
    assert "no bit size" not in result.output


def test_an_opened_file_or_frame_is_taken_as_its_readings(golden):
    at = np.arange(3000)
    frame = {"MD_ft": 8800 + at * 0.01, "TF_deg": at * 37.0 % 360, "RADIUS_in": 4.3 + 0.1 * np.cos(at)}
    file = hb.open(frame)
    expected = hb.reconstruct(file.readings(bit_diameter=0.216), bit_diameter=0.216, sectors=16)
    for given in (file, file.set()):
        assert hb.reconstruct(given, bit_diameter=0.216, sectors=16).radius.tobytes() == expected.radius.tobytes()
        with golden.raises():
            hb.reconstruct(given, bit_diameter="8.5in")  # type: ignore[arg-type]
