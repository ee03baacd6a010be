"""Headers of many wells are read before any work, and equal faults are shown together."""

import gzip
from pathlib import Path

import numpy as np
import pyarrow
import pytest
from command import run
from golden_texts import Golden
from locations import ROOT
from pyarrow import parquet

from helibore.runs.manifest import read_jobs
from helibore.runs.preflight import HEAD, grouped, refused_wells

GOOD = (ROOT / "examples/files/caliper.csv").read_text()
MANIFEST = 'output = "out"\noutputs = ["logs"]\n[defaults.wall]\nbit_diameter = 0.216\n'


@pytest.fixture
def wells(tmp_path: Path) -> Path:
    """Seven wells: good, of an unknown name (two), without units, gzipped, and two without a value in the head."""
    named = GOOD.replace("radius_m", "blob", 1)
    late = "\n".join(["depth_m,toolface_deg,radius_m,note", *["2000,1,-999.25,x"] * (HEAD // 16), "2001,2,0.11,x", ""])
    texts = {
        "good": GOOD, "a": named, "b": named, "bare": GOOD.replace("_m,", ",", 1), "late": late,
        "never": late.replace("0.11", "-999.25"),
    }  # fmt: skip
    for name, text in texts.items():
        (tmp_path / f"{name}.csv").write_text(text)
    (tmp_path / "packed.csv.gz").write_bytes(gzip.compress(GOOD.encode()))
    files = [*(f"{name}.csv" for name in texts), "packed.csv.gz"]
    tables = [f'[[well]]\nname = "{name.partition(".")[0]}"\ncaliper = "{name}"\n' for name in files]
    (tmp_path / "m.toml").write_text(MANIFEST + "".join(tables))
    return tmp_path / "m.toml"


def test_wells_whose_files_cannot_be_read_are_named_with_the_reason(wells: Path, golden: Golden) -> None:
    refused = refused_wells(read_jobs(wells))
    assert refused.keys() == {"a", "b", "bare", "never"}
    assert refused["bare"].startswith("bare.csv, column depth: unit missing")
    golden(refused["never"])


def test_equal_reasons_are_shown_once_with_their_wells(wells: Path) -> None:
    jobs = read_jobs(wells)
    (first, together), *others = grouped(refused_wells(jobs), jobs)
    assert together == ["a", "b"]
    assert first.startswith("FILE: no channel has the role radius")
    assert sorted(name for _, (name,) in others) == ["bare", "never"]
    assert all(text.startswith(f"{name}.csv, ") for text, (name,) in others)


def test_check_reads_and_makes_nothing(wells: Path) -> None:
    done = run("reprocess", wells, "--check")
    assert done.exit_code == 3
    assert done.output.startswith("3 of 7 wells have caliper files that can be read\na, b: FILE: ")
    assert '[defaults.caliper]\n    map = "names.toml"' in done.output
    assert not (wells.parent / "out").exists()


def test_columns_for_all_wells_mend_a_header_that_no_role_fits(wells: Path) -> None:
    text = MANIFEST.replace("[defaults.wall]", '[defaults.columns]\nradius = ["blob:m"]\n[defaults.wall]')
    wells.write_text(text + "".join(f'[[well]]\nname = "{name}"\ncaliper = "{name}.csv"\n' for name in "ab"))
    assert refused_wells(read_jobs(wells)) == {}


def test_one_map_of_names_mends_headers_of_several_kinds(wells: Path) -> None:
    tables = [f'[[names]]\nnames = ["{of}"]\nrole = "{role}"\nunit = "m"\n' for of, role in (
        ("blob", "radius"), ("depth", "depth"),
    )]  # fmt: skip
    (wells.parent / "names.toml").write_text("".join(tables))
    text = wells.read_text()
    wells.write_text(text.replace("[defaults.wall]", '[defaults.caliper]\nmap = "names.toml"\n[defaults.wall]'))
    assert set(refused_wells(read_jobs(wells))) == {"never"}


def test_without_a_well_that_can_be_read_no_cluster_starts(wells: Path) -> None:
    wells.write_text(MANIFEST + '[[well]]\nname = "a"\ncaliper = "a.csv"\n')
    done = run("reprocess", wells)
    assert done.exit_code == 3
    assert "0 made, 0 there already, 1 failed, of 1 wells" in done.output
    assert "a: a.csv: no channel has the role radius" in done.output


def test_of_a_parquet_file_the_first_rows_are_read_and_all_rows_before_it_is_refused(tmp_path: Path) -> None:
    """The later rows of ``damaged`` cannot be read, which the run says; the first rows of ``late`` have no radius."""
    count = 50_000
    depth = np.linspace(2000.0, 2100.0, count)
    columns = {"depth_m": depth, "toolface_deg": np.arange(count) % 360.0, "radius_m": np.full(count, 0.11)}
    late = columns | {"radius_m": np.where(np.arange(count) < count - 9, np.nan, 0.11)}
    tables = {"damaged": columns, "late": late, "wrong": {"blob": depth, **columns} | {"radius_m": depth * np.nan}}
    for name, table in tables.items():
        parquet.write_table(
            pyarrow.table(table), tmp_path / f"{name}.parquet", row_group_size=10_000, compression="zstd"
        )
    file = tmp_path / "damaged.parquet"
    content = bytearray(file.read_bytes())
    middle = len(content) // 2
    content[middle : middle + 4_000] = bytes(4_000)
    file.write_bytes(content)
    with pytest.raises((OSError, pyarrow.ArrowException)):
        parquet.read_table(file)
    wells = [f'[[well]]\nname = "{name}"\ncaliper = "{name}.parquet"\n' for name in tables]
    (tmp_path / "m.toml").write_text(MANIFEST + "".join(wells))
    assert refused_wells(read_jobs(tmp_path / "m.toml")).keys() == {"wrong"}
