"""The files of examples/files: each opens, each role map mends its flaw, each configuration is read."""

from __future__ import annotations

import numpy as np
import pytest
from locations import ROOT

import helibore as hb
from helibore.base.errors import InputError
from helibore.channels.role_map import read_map
from helibore.live.rules.configuration import load
from helibore.runs.manifest import check_files, read_jobs

FILES = ROOT / "examples/files"
FLAWS = sorted(path.stem for path in FILES.glob("flaws/*.csv"))
RIGS = sorted(path.stem for path in FILES.glob("rigs/*.toml"))


def test_the_files_are_small_and_the_page_beside_them_names_each():
    about = (FILES / "ABOUT.md").read_text()
    assert sum(path.stat().st_size for path in FILES.rglob("*") if path.is_file()) < 250_000
    assert [name for name in [*FLAWS, *RIGS] if f"`{name}`" not in about] == []


def differ(one: hb.Caliper, other: hb.Caliper) -> bool:
    turned = np.mod(one.toolface - other.toolface + 180, 360) - 180
    away = (one.depth - other.depth, turned / 1000, one.radius - other.radius)
    return any(np.abs(values).max() > 2e-5 for values in away)


@pytest.mark.parametrize("flaw", FLAWS)
def test_a_role_map_mends_its_flaw(flaw):
    clean = hb.open(FILES / "caliper.csv").caliper()
    clean = hb.Caliper(clean.depth[:400], clean.toolface[:400], clean.radius[:400])
    with hb.open(FILES / f"flaws/{flaw}.csv") as file:
        assert not differ(file.caliper(read_map(FILES / f"flaws/{flaw}.toml", file)), clean)
        try:
            assert differ(file.caliper(), clean)
        except InputError as error:
            assert f"{flaw}.csv" in str(error)  # noqa: PT017 - refused, or wrong, without its map


def test_the_wireline_caliper_has_four_points_a_row():
    caliper = hb.open(FILES / "xy_caliper.csv").caliper()
    wall = hb.reconstruct(caliper, bit_diameter=0.216)
    assert len(caliper) == 4 * 329
    assert 0.22 < wall.summary().mean_diameter < 0.25


def test_survey_and_gamma_open():
    survey = hb.open(FILES / "survey.csv").survey()
    image = hb.open(FILES / "gamma.csv").image("GR").sector_image(origin="edge", reference="high-side")
    assert (len(survey), image.values.shape) == (4, (101, 16))


@pytest.mark.parametrize("rig", RIGS)
def test_a_live_configuration_is_read(rig):
    (source,) = load(FILES / f"rigs/{rig}.toml").sources.values()
    kind = {"connect": "tcp", "store": "https"}.get(rig, rig)
    assert source.address.kind == kind


def test_the_manifest_names_wells_and_files_that_are_there():
    jobs = read_jobs(FILES / "wells/manifest.toml")
    check_files(jobs)
    assert [job.well for job in jobs] == ["A-1", "A-2", "A-3"]
