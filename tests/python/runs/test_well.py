"""One well of many: what the catalogue says of it, and which files are its own."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import unquote

import numpy as np
import pytest

import helibore as hb
from helibore.logs.turn_logs import NO_UNCERTAINTY
from helibore.runs.manifest import Job, read_jobs
from helibore.runs.project import Project
from helibore.runs.well import catalogue_row, reprocess_well


def test_the_catalogue_says_that_a_tool_with_few_arms_measured() -> None:
    depth = np.repeat(np.arange(1000, 1003, 0.05), 4)
    arm = np.tile([0, 1, 0, 1], depth.size // 4)
    toolface = np.tile([0.0, 90.0, 180.0, 270.0], depth.size // 4)
    caliper = hb.Caliper(depth, toolface, np.full(depth.size, 0.11), arm=arm)
    wall = hb.reconstruct(caliper, bit_diameter=0.2, sectors=64)
    row = catalogue_row("W", Project(gauge=True, wall=wall.settings), wall, wall.logs(), wall.summary())
    assert row["warnings"] == (  # the vertices at the four arms: 4 of 64
        "a tool with few arms measured 6 % of the turns; the wall between its arms is interpolated, and C1, C2, "
        f"ovality and zones are the arms'; {NO_UNCERTAINTY}"
    )


@pytest.mark.parametrize("name", [".", "..", "..."])
def test_a_well_named_by_dots_stays_in_its_own_folders(tmp_path: Path, name: str) -> None:
    """A well that fails deletes its files: with the folder of another well, it deleted that well's files."""
    k = np.arange(2000)
    rows = np.column_stack([1000 + k * 0.001, k * 37.0 % 360, np.full(k.size, 0.11)])
    np.savetxt(tmp_path / "c.csv", rows, "%.5f", ",", header="md_m,tf_deg,radius_m", comments="")
    head = 'output = "out"\n[defaults]\ncaliper = { file = "c.csv" }\n[defaults.wall]\nbit_diameter = 0.216\n'
    wells = f'[[well]]\nname = "B"\n[[well]]\nname = "{name}"\n'
    (tmp_path / "m.toml").write_text(head + wells)
    for job in read_jobs(tmp_path / "m.toml"):
        assert reprocess_well(job)["made"]
    assert unquote(Job(name, {}, "").key) == name
    files = {file for file in (tmp_path / "out").rglob("*") if file.is_file()}
    own = {file for file in files if Job(name, {}, "").key in str(file)}
    (tmp_path / "m.toml").write_text(f"{head}{wells}[well.wall]\nstart_depth = 9000.0\n")
    with pytest.raises(hb.InputError, match="no samples below 9000 m"):
        reprocess_well(read_jobs(tmp_path / "m.toml")[1])
    assert own
    assert {file for file in (tmp_path / "out").rglob("*") if file.is_file()} == files - own
