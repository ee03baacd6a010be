"""Many wells: the manifest, one well, all of them on Dask; what is there is not made again, failures are named."""

from __future__ import annotations

import contextlib
import gc
import json
import os
import re
import resource
import shutil
import signal
import socket
import ssl
import subprocess
import sys
import time
import zipfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
import pytest
from click.testing import CliRunner
from fsspec.exceptions import FSTimeoutError
from golden_texts import Golden
from hypothesis import given
from hypothesis import strategies as st
from patience import PATIENCE
from pyarrow import parquet

import helibore as hb
from helibore.cli import cli
from helibore.cli.reprocess_command import ctrl_c_again_where_ignored
from helibore.files.log_writing import save_table
from helibore.runs.blocks import AS_STREAM, PartColumn, _beyond_gap
from helibore.runs.manifest import OUTPUTS, Job, check_files, read_jobs
from helibore.runs.output_store import Store
from helibore.runs.reprocess import Progress, _start_cluster, connected, status
from helibore.runs.run import checksum
from helibore.runs.well import merge_well, reprocess_block, reprocess_well, versions
from helibore.simulation.tool import Hole, Tool, simulate


@pytest.fixture(scope="module")
def field(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three wells of 3 m, one with a survey, and a file that is no log."""
    folder = tmp_path_factory.mktemp("field")
    for number in range(3):
        of = simulate(Hole.example(1000.0, 1003.0, seed=number), Tool(), samples=4000, seed=number)
        columns = {"depth_m": of.depth, "toolface_deg": of.toolface, "radius_m": of.radius}
        parquet.write_table(pyarrow.table(columns), folder / f"{number}.parquet")
    (folder / "s.csv").write_text("md_m,incl_deg,azim_deg\n990,5,40\n1010,7,50\n")
    (folder / "bad.parquet").write_bytes(b"PAR1 is not enough")
    return folder


MANIFEST = """
output = "out"
[defaults.wall]
bit_diameter = 0.2159
sectors = 16
[[well]]
name = "15/9-F 1"
caliper = "0.parquet"
survey = "s.csv"
[[well]]
name = "B"
[[well.caliper]]
file = "1.parquet"
[well.wall]
sectors = 32
"""


def manifest(folder: Path, text: str = MANIFEST, name: str = "m.toml") -> Path:
    (folder / name).write_text(text)
    return folder / name


def content(folder: Path) -> dict[str, bytes]:
    return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


def test_defaults_of_files_hold_for_every_file_of_their_key(tmp_path: Path) -> None:
    text = """output = "out"
[defaults.caliper]
map = "arms.toml"
[defaults.wall]
bit_diameter = 0.2
[[well]]
name = "A"
caliper = "a.csv"
[[well]]
name = "B"
[[well.caliper]]
file = "b.csv"
map = "b.toml"
"""
    a, b = read_jobs(manifest(tmp_path, text))
    assert a.tree["caliper"] == [{"file": f"{tmp_path}/a.csv", "map": f"{tmp_path}/arms.toml"}]
    assert b.tree["caliper"] == [{"file": f"{tmp_path}/b.csv", "map": f"{tmp_path}/b.toml"}]
    with pytest.raises(hb.InputError, match="mapp"):
        read_jobs(manifest(tmp_path, text.replace("map =", "mapp =", 1)))


def test_a_manifest_becomes_jobs(field: Path) -> None:
    first, second = read_jobs(manifest(field))
    assert (first.well, first.key, first.output, first.outputs) == (
        "15/9-F 1", "15%2F9-F%201", f"{field}/out", OUTPUTS,
    )  # fmt: skip
    assert first.tree["caliper"] == [{"file": f"{field}/0.parquet"}]
    assert first.tree["wall"] == {"bit_diameter": 0.2159, "sectors": 16}
    assert second.tree["wall"] == {"bit_diameter": 0.2159, "sectors": 32}
    assert first.addresses() == [f"{field}/0.parquet", f"{field}/s.csv"]
    assert first.named()["survey"] == {"file": "s.csv"}


def test_a_parquet_catalogue_gives_the_same_jobs(field: Path) -> None:
    rows = [
        {"name": "15/9-F 1", "caliper": "0.parquet", "survey": "s.csv", "wall.sectors": 16},
        {"name": "B", "caliper": "1.parquet", "survey": None, "wall.sectors": 32},
    ]
    rows = [row | {"wall.bit_diameter": 0.2159} for row in rows]
    parquet.write_table(pyarrow.Table.from_pylist(rows), field / "wells.parquet")
    assert read_jobs(field / "wells.parquet", f"{field}/out") == read_jobs(manifest(field))
    for row in rows:  # pandas makes floats of whole numbers where some are missing
        row["wall.sectors"] = float(row["wall.sectors"])
    parquet.write_table(pyarrow.Table.from_pylist(rows), field / "wells.parquet")
    assert read_jobs(field / "wells.parquet", f"{field}/out") == read_jobs(manifest(field))
    named = manifest(field, 'output = "out"\ncatalogue = "wells.parquet"\n', "c.toml")
    assert read_jobs(named) == read_jobs(manifest(field))


@pytest.mark.parametrize(
    ("before", "after", "text"),
    [
        ("[defaults.wall]", "[default.wall]", "m.toml: default: not known; did you mean defaults?"),
        ('output = "out"', "", "m.toml: output: is missing; it is the folder of all results"),
        ('output = "out"', 'output = "out"\noutputs = ["wall"]',
         "m.toml: outputs 1 = 'wall': must be one of archive, mesh, logs, zones"),
        ('name = "B"', "", "m.toml: well 2: name: must be a text: the name of the well"),
        ('name = "B"', 'name = "15/9-F 1"', "m.toml: well 15/9-F 1: two wells have this name; names must differ"),
        ("sectors = 32", 'sectors = "32"', "m.toml: well B: wall.sectors = '32': must be an integer"),
        ("sectors = 32", "sectors = 2", "m.toml: well B: wall.sectors = 2: must lie in 3 to 1000000"),
        ("bit_diameter = 0.2159", "", "m.toml: well 15/9-F 1: wall.bit_diameter: is missing"),
        ('caliper = "0.parquet"', "",
         "m.toml: well 15/9-F 1: caliper, average, archive, gauge: give exactly one of them"),
        ('caliper = "0.parquet"', "caliper = 3", "m.toml: well 15/9-F 1: caliper 1 = 3: must be a table"),
        ('caliper = "0.parquet"', 'caliper = { file = "0.parquet", mapp = "m.toml" }',
         "m.toml: well 15/9-F 1: caliper 1.mapp: not known; did you mean map?"),
        ('name = "B"', 'name = "B"\nverb = "logs"', "m.toml: well B: verb: has no effect on a well of a manifest"),
        ("[[well]]", "[[well]", "m.toml: not TOML: "),
        ('output = "out"', "output = 3", "m.toml: output = 3: must be text"),
        ('output = "out"', 'output = "out"\noutputs = "mesh"', "m.toml: outputs = 'mesh': must be a list"),
        ('output = "out"', 'output = "out"\noutputs = [["mesh"]]', "m.toml: outputs 1 = ['mesh']: must be one of "),
        ('output = "out"', 'output = "out"\nblock_samples = true',
         "m.toml: block_samples = True: must be an integer"),
        ('survey = "s.csv"', 'image = { file = "s.csv", name = "GR", origin = "top" }',
         "m.toml: well 15/9-F 1: image 1.origin = 'top': must be one of centre, edge"),
        ('survey = "s.csv"', 'survey = ["s.csv", "s.csv"]',
         "m.toml: well 15/9-F 1: survey = ['s.csv', 's.csv']: must be a table"),
        ('survey = "s.csv"', 'survey = { file = "s.csv", map = 3 }',
         "m.toml: well 15/9-F 1: survey.map = 3: must be the name of a file"),
    ],
)  # fmt: skip
def test_an_error_of_the_manifest_names_well_key_and_rule(field: Path, before: str, after: str, text: str) -> None:
    with pytest.raises(hb.InputError) as caught:
        read_jobs(manifest(field, MANIFEST.replace(before, after, 1)))
    assert re.sub(r", line \d+:", ":", str(caught.value)).startswith(text)


@pytest.mark.parametrize(
    "text",
    [
        'well = "A"',
        'well = ["A"]',
        'defaults = 3\n[[well]]\nname = "A"',
        "[[well]]\nheader = 3",
        '[defaults]\nwall = 3\n[[well]]\nname = "A"\nwall = {}',
    ],
)
def test_a_manifest_of_other_types_is_refused(tmp_path: Path, text: str, golden: Golden) -> None:
    (tmp_path / "m.toml").write_text(f'output = "out"\n{text}\n')
    with pytest.raises(hb.InputError) as caught:
        read_jobs(tmp_path / "m.toml")
    golden(re.sub(r", line \d+:", ":", str(caught.value)))


def test_an_error_of_the_manifest_names_the_line_of_the_well_or_of_the_defaults(field: Path) -> None:
    lines = MANIFEST.splitlines()
    own, usual = lines.index("sectors = 32") + 1, lines.index("sectors = 16") + 1
    for text, line, well in (("sectors = 32", own, "B"), ("sectors = 16", usual, "15/9-F 1")):
        with pytest.raises(hb.InputError) as caught:
            read_jobs(manifest(field, MANIFEST.replace(text, "sectors = 2")))
        assert caught.value.place == f"m.toml, line {line}: well {well}: wall.sectors"


def test_a_well_may_have_a_project_which_counts_over_the_defaults(field: Path) -> None:
    """Its files are named relative to it; what helibore wrote about an output is not taken."""
    (field / "B").mkdir(exist_ok=True)
    text = 'helibore = "0.1.0"\nverb = "plot"\ncaliper = "../1.parquet"\n[header]\nwell = "B"\n[wall]\nsectors = 24\n'
    (field / "B/well.toml").write_text(text + '[zones]\nwashout = "0.1in"\n')
    base = 'output = "out"\n[defaults.wall]\nbit_diameter = "8.5in"\nsectors = 16\n[[well]]\nproject = "B/well.toml"\n'
    (job,) = read_jobs(manifest(field, base))
    assert (job.well, job.tree["wall"]) == ("B", {"bit_diameter": "8.5in", "sectors": 24})
    assert job.tree["caliper"] == [{"file": f"{field}/B/../1.parquet"}]
    (own,) = read_jobs(manifest(field, base + 'name = "C"\n[well.wall]\nsectors = 32\n'))
    assert (own.well, own.tree["wall"]["sectors"]) == ("C", 32)
    record = reprocess_well(job)
    assert record["catalogue"]["sectors"] == 24
    zones = parquet.read_schema(f"{job.output}/zones/well=B/zones-0.parquet").metadata
    assert any(b"0.00254" in value for value in zones.values()), "the criteria of the project"
    assert hb.load(f"{job.output}/wells/B/B.wall").made_from["project"] == {
        "header": {"well": "B"}, "zones": {"washout": pytest.approx(0.00254)},
    }  # fmt: skip


def test_nothing_starts_where_a_file_is_missing_or_the_output_cannot_be_written(
    field: Path, tmp_path: Path, golden: Golden
) -> None:
    lost = manifest(field, MANIFEST.replace("1.parquet", "9.parquet"))
    result = CliRunner().invoke(cli, ["reprocess", str(lost), "-o", str(tmp_path / "none")])
    assert result.exit_code == 2
    assert f"helibore: well B: {field}/9.parquet: no such file" in result.stderr
    assert not (tmp_path / "none").exists()
    many = manifest(field, MANIFEST.replace("s.csv", "t.csv").replace("1.parquet", "9.parquet"))
    names = f"well 15/9-F 1: {field}/t.csv: no such file; also missing: well B: {field}/9.parquet"
    with pytest.raises(hb.InputError, match=f"^{names}$"):
        check_files(read_jobs(many))
    with pytest.raises(hb.InputError, match=r"a11\.csv, and 2 more$"):
        check_files([Job("A", {"caliper": [{"file": f"{field}/a{k}.csv"} for k in range(2, 14)]}, "")])
    (tmp_path / "file").write_text("")
    with golden.raises():
        hb.reprocess(manifest(field), output=f"{tmp_path}/file/out")


def test_one_well(field: Path, tmp_path: Path) -> None:
    job = read_jobs(manifest(field), str(tmp_path))[0]
    record = reprocess_well(job)
    key = job.key
    assert record.pop("made")
    assert set(record["files"]) == {
        f"wells/{key}/{key}.wall", f"wells/{key}/{key}.glb", f"wells/{key}/{key}-overview.glb",
        f"logs/well={key}/logs-0.parquet", f"zones/well={key}/zones-0.parquet",
    }  # fmt: skip
    assert all((tmp_path / name).stat().st_size == size for name, size in record["files"].items())
    wall = hb.load(tmp_path / f"wells/{key}/{key}.wall")
    assert wall.path is not None
    assert (record["catalogue"]["vertices"], record["catalogue"]["samples"]) == (len(wall), wall.sample_count)
    assert record["catalogue"]["volume"] == wall.summary().volume
    assert record["made_from"]["inputs"][0] == {"name": "0.parquet", "blake2b": checksum(field / "0.parquet")}
    logs = parquet.read_table(tmp_path / "logs")
    assert set(logs["well"].to_pylist()) == {"15/9-F 1"}
    assert np.array_equal(logs["DEQ"].to_numpy(), wall.logs().equivalent_diameter, equal_nan=True)


def test_a_well_is_made_again_only_where_something_changed(field: Path, tmp_path: Path) -> None:
    shutil.copy(field / "0.parquet", tmp_path / "a.parquet")
    tree = {"caliper": [{"file": str(tmp_path / "a.parquet")}], "wall": {"bit_diameter": 0.2159, "sectors": 8}}
    job = Job("A", tree, str(tmp_path / "out"), ("archive", "mesh"))
    first = reprocess_well(job)
    files = content(tmp_path / "out")
    assert first.pop("made")
    assert reprocess_well(job) == first | {"made": False}
    (tmp_path / "out/wells/A/A.wall").write_bytes(b"cut short")
    (tmp_path / "out/records/A.json").write_bytes(b"{")
    assert reprocess_well(job)["made"]
    assert content(tmp_path / "out") == files
    (tmp_path / "out/wells/A/A.glb").unlink()
    assert reprocess_well(job)["made"]
    assert content(tmp_path / "out") == files
    assert reprocess_well(Job("A", tree, str(tmp_path / "out"), ("archive",)))["made"]
    assert set(content(tmp_path / "out")) == {"wells/A/A.wall", "records/A.json"}
    shutil.copy(field / "1.parquet", tmp_path / "a.parquet")
    assert reprocess_well(Job("A", tree, str(tmp_path / "out"), ("archive",)))["made"]
    assert content(tmp_path / "out")["wells/A/A.wall"] != files["wells/A/A.wall"]


def test_what_a_killed_worker_left_in_part_goes_when_its_well_is_made(field: Path, tmp_path: Path) -> None:
    job = read_jobs(manifest(field), str(tmp_path))[1]
    for left in ("wells/B/.B.glb.0123abcd.part", "logs/well=B/.logs-0.parquet.0123abcd.part"):
        (tmp_path / left).parent.mkdir(parents=True)
        (tmp_path / left).write_bytes(b"")
    reprocess_well(job)
    assert not [name for name in content(tmp_path) if name.endswith(".part")]


def test_sigma_that_a_well_asks_for_is_in_its_logs_and_row(field: Path, tmp_path: Path) -> None:
    text = MANIFEST.replace("sectors = 32", "sectors = 32\nsigma = true")
    plain, sure = (reprocess_well(job) for job in read_jobs(manifest(field, text, "s.toml"), str(tmp_path)))
    logs = parquet.read_table(tmp_path / "logs/well=B/logs-0.parquet")
    assert sure["catalogue"]["diameter_sigma"] == np.nanmean(logs["DEQ_SIGMA"].to_numpy())
    assert plain["catalogue"]["diameter_sigma"] is None


def test_a_store_with_errors_of_its_own_is_refused_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, golden: Golden
) -> None:
    def unreachable(*_: Any) -> None:
        raise RuntimeError("could not connect to the endpoint")

    monkeypatch.setattr(Store, "write_json", unreachable)
    with golden.raises():
        Store(str(tmp_path / "out")).check_writable()


def test_ctrl_c_says_how_to_go_on(field: Path, tmp_path: Path) -> None:
    wells = "".join(
        f'[[well]]\nname = "{k}"\ncaliper = "1.parquet"\n' for k in range(60)
    )  # more than are made till then
    interruptible = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"  # a background job is not
    command = [sys.executable, "-c", f"{interruptible}; from helibore.cli import main; main()", "reprocess"]
    command += [str(manifest(field, MANIFEST + wells, "many.toml")), "-o", str(tmp_path), "--workers", "1"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True) as process:
        assert process.stderr is not None
        assert process.stderr.readline().startswith("making 62 wells")
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does
        lines = process.stderr.read().splitlines()
    assert process.returncode == 130, lines
    assert "run the command again to go on, and to write the catalogue" in lines[-1]
    assert "Traceback" not in "\n".join(lines)


def test_ctrl_c_in_a_callback_of_the_garbage_collector_comes_again() -> None:
    dropped: list[str] = []

    def collecting(phase: str, _: object) -> None:
        if not dropped:
            dropped.append(phase)
            raise KeyboardInterrupt

    def drop_and_wait() -> None:
        gc.collect()
        assert dropped  # Python goes on here
        for _ in range(int(PATIENCE / 0.05)):
            time.sleep(0.05)  # as the command waits, in short steps

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    gc.callbacks.append(collecting)
    try:
        with pytest.raises(KeyboardInterrupt), ctrl_c_again_where_ignored():
            drop_and_wait()
    finally:
        gc.callbacks.remove(collecting)
        signal.signal(signal.SIGINT, before)


def test_a_well_whose_input_fails_leaves_nothing(field: Path, tmp_path: Path) -> None:
    sheet = tmp_path / "w.parquet"
    sheet.write_bytes((field / "1.parquet").read_bytes())
    text = MANIFEST.replace('"1.parquet"', f'"{sheet}"')
    job = read_jobs(manifest(field, text, "f.toml"), str(tmp_path / "out"))[1]
    assert reprocess_well(job)["made"]
    assert len(content(tmp_path / "out")) > 3
    sheet.write_bytes(b"PAR1 is not enough")
    with pytest.raises(hb.InputError, match=r"^w.parquet: "):
        reprocess_well(job)
    assert content(tmp_path / "out") == {}


def test_a_survey_that_ends_above_the_well_leaves_nothing(field: Path, tmp_path: Path, golden: Golden) -> None:
    (field / "short.csv").write_text("md_m,incl_deg,azim_deg\n900,5,40\n950,7,50\n")
    text = MANIFEST.replace('"s.csv"', '"short.csv"')
    job = read_jobs(manifest(field, text, "g.toml"), str(tmp_path))[0]
    job.tree["preparation"] = dict(BY_ROW)
    for outputs in (job.outputs, ("archive",)):
        for most in (job.block_samples, 1000):
            with golden.raises():
                reprocess_well(replace(job, outputs=outputs, block_samples=most))
            assert not [name for name in content(tmp_path) if not name.startswith("work/")]
    assert reprocess_well(replace(job, outputs=("logs",)))["made"]  # as helibore logs


def test_another_store_gets_the_same_bytes(field: Path, tmp_path: Path) -> None:
    local = read_jobs(manifest(field), str(tmp_path))[0]
    memory = Store("memory://field")
    for name in ("0.parquet", "s.csv"):
        memory.system.pipe_file(memory.path(name), (field / name).read_bytes())
    memory.system.pipe_file(memory.path("m.toml"), MANIFEST.encode())
    remote = read_jobs("memory://field/m.toml")[0]
    assert remote.addresses() == ["memory://field/0.parquet", "memory://field/s.csv"]
    reprocess_well(local)
    reprocess_well(remote)
    there = Store(remote.output)
    found = {name: there.system.cat_file(there.path(name)) for name in there.sizes("")}
    assert found == content(tmp_path)
    assert not reprocess_well(remote)["made"]


def test_a_worker_with_other_versions_refuses(field: Path, tmp_path: Path) -> None:
    job = read_jobs(manifest(field), str(tmp_path))[0]
    own = versions()["helibore"]
    with pytest.raises(hb.InputError, match=rf"^worker: helibore {own}: must be 9.9.9, as in the calling process$"):
        reprocess_well(job, versions() | {"helibore": "9.9.9"})
    assert content(tmp_path) == {}


def large_well(file: Path, timed: bool, upward: bool) -> None:
    """12 m of a turning tool, with ties in depth, a gap of 1.5 m and rows in no order, one row without a radius."""
    random = np.random.default_rng(7)
    depth = np.sort(np.round(random.uniform(1000.0, 1010.5, 9000), 3))
    depth[depth > 1004.0] += 1.5
    radius = 0.108 + 0.02 * np.sin(depth) ** 2 + random.normal(0.0, 0.001, depth.size)
    radius[77] = np.nan
    order = random.permutation(depth.size) if timed else np.arange(depth.size)[:: -1 if upward else 1]
    columns = {"depth_m": depth, "toolface_deg": random.uniform(0.0, 360.0, depth.size), "radius_m": radius}
    columns |= {"time_s": np.round(np.linspace(0.0, 900.0, depth.size), 0)} if timed else {}
    parquet.write_table(pyarrow.table({name: values[order] for name, values in columns.items()}), file)


BY_ROW = {"saturated": False, "drop_closed": False}
COVARIANCE = [0.11, 1e-6, 1e-5, 0.1, 0.3, 9e-5, 0.1, 8.0]  # its thinned set has cells that are longer than a reach


@pytest.mark.parametrize(
    ("timed", "wall"),
    [
        (True, {"max_distance": 0.6}),
        (False, {"pitch": -0.01, "max_distance": "none", "neighbors": 30}),
        (False, {"window": 60, "start_depth": 1000.5, "stop_depth": 1011.0}),
        (False, {"estimator": "near-and-far", "covariance": COVARIANCE, "sectors": 12, "max_distance": 0.6}),
    ],
)
def test_a_well_in_blocks_has_the_bits_of_one_piece(tmp_path: Path, timed: bool, wall: dict[str, Any]) -> None:
    large_well(tmp_path / "a.parquet", timed, wall.get("pitch", 1.0) < 0)
    settings = {"bit_diameter": 0.2159, "sectors": 8, "pitch": 0.01} | wall
    tree = {"caliper": [{"file": str(tmp_path / "a.parquet")}], "wall": settings, "preparation": BY_ROW}
    tree |= {"header": {"company": "ACME"}, "zones": {"washout": 0.01}}
    whole = reprocess_well(Job("A", tree, str(tmp_path / "whole")))
    job = Job("A", tree, str(tmp_path / "blocks"), block_samples=3000)
    count = reprocess_well(job)["blocks"]
    assert count >= 3
    for number in reversed(range(count)):
        reprocess_block(job, number)
    record = merge_well(job)
    one, many = content(tmp_path / "whole"), content(tmp_path / "blocks")
    for name in one:
        if name.endswith((".parquet", "overview.glb")):
            assert many[name] == one[name], name
    samples = [whole["catalogue"].pop("samples"), record["catalogue"].pop("samples")]
    assert whole["catalogue"] | {"settings_hash": ""} == record["catalogue"] | {"settings_hash": ""}
    if "start_depth" not in wall:
        assert samples[0] == samples[1]
    in_one_piece = hb.load(tmp_path / "whole/wells/A/A.wall")
    assert in_one_piece.made_from["project"] == {"header": {"company": "ACME"}, "zones": {"washout": 0.01}}
    seen = np.zeros(len(in_one_piece), dtype=bool)
    for number in range(count):
        part = hb.load(tmp_path / f"blocks/wells/A/A-{number:05}.wall")
        assert part.made_from["project"] == in_one_piece.made_from["project"]
        first = part.settings.first_vertex
        seen[first : first + len(part)] = True
        same = zip(part.vertices(), in_one_piece.vertices(first, first + len(part)), strict=True)
        assert all(mine.tobytes() == its.tobytes() for mine, its in same)
    assert seen.all()
    assert not any(name.startswith("work/") for name in many)
    assert not reprocess_well(job)["made"]


def outputs_of(tree: dict[str, Any], folder: Path, most: int) -> tuple[dict[str, bytes], int]:
    job = Job("A", tree, str(folder), block_samples=most)
    blocks = reprocess_well(job).get("blocks", 0)
    for number in range(blocks):
        reprocess_block(job, number)
    if blocks:
        merge_well(job)
    return content(folder), blocks


@pytest.mark.parametrize("ending", ["las", "csv"])
def test_a_well_of_few_samples_and_many_vertices_is_made_in_blocks_whatever_its_file(
    tmp_path: Path, ending: str
) -> None:
    of = simulate(Hole.example(1000.0, 1012.0, seed=5), Tool(), samples=9000, seed=5)
    save_table(hb.Caliper(of.depth, of.toolface, of.radius).table(), file := tmp_path / f"a.{ending}")
    wall = {"bit_diameter": 0.2159, "sectors": 16, "pitch": 0.01}
    tree = {"caliper": [{"file": str(file)}], "wall": wall}
    one, none = outputs_of(tree, tmp_path / "whole", 10_000)
    many, blocks = outputs_of(tree, tmp_path / "blocks", 9_000)
    assert (none, blocks) == (0, 3)
    shared = [name for name in one if name.endswith((".parquet", "overview.glb"))]
    assert len(shared) == 3
    assert all(many[name] == one[name] for name in shared)


@pytest.mark.parametrize("most", [9_000, 5_000, 1_000_000])
def test_a_wall_asked_for_where_no_sample_lies_is_refused_however_it_is_made(
    tmp_path: Path, most: int, golden: Golden
) -> None:
    of = simulate(Hole.example(1000.0, 1012.0, seed=5), Tool(), samples=9000, seed=5)
    columns = {"depth_m": of.depth, "toolface_deg": of.toolface, "radius_m": of.radius}
    parquet.write_table(pyarrow.table(columns), file := tmp_path / "a.parquet")
    wall = {"bit_diameter": 0.2159, "sectors": 16, "pitch": 0.01, "start_depth": 900.0, "stop_depth": 920.0}
    tree = {"caliper": [{"file": str(file)}], "wall": wall, "preparation": BY_ROW}
    with golden.raises():
        reprocess_well(Job("A", tree, str(tmp_path / "out"), block_samples=most))
    assert content(tmp_path / "out") == {}


def test_a_tool_of_few_arms_with_too_many_vertices_for_one_piece_is_refused(tmp_path: Path, golden: Golden) -> None:
    (tmp_path / "a.csv").write_text("md_m,rb_deg,cal_x_in,cal_y_in\n10,0,8.5,8.6\n14,0,8.5,8.6\n")
    tree = {"caliper": [{"file": str(tmp_path / "a.csv")}], "wall": {"bit_diameter": 0.2159, "pitch": 0.01}}
    with pytest.raises(hb.InputError) as caught:
        reprocess_well(Job("A", tree, str(tmp_path / "out"), block_samples=1000))
    golden(str(caught.value))


def test_a_well_with_too_many_turns_to_be_merged_is_refused(tmp_path: Path) -> None:
    columns = {"depth_m": [0.0, 900.0], "toolface_deg": [0.0, 90.0], "radius_m": [0.1, 0.1]}
    parquet.write_table(pyarrow.table(columns), tmp_path / "a.parquet")
    wall = {"bit_diameter": 0.2, "pitch": 0.0004, "sectors": 8}
    tree = {"caliper": [{"file": str(tmp_path / "a.parquet")}], "wall": wall, "preparation": BY_ROW}
    with pytest.raises(hb.InputError) as caught:
        reprocess_well(Job("A", tree, str(tmp_path / "out")))
    rule = "the wall from 0 m to 900 m would have 2,250,000 turns, of which 2,000,000 fit in memory"
    assert str(caught.value) == f"pitch = 0.0004: {rule}"
    assert content(tmp_path / "out") == {}


@given(st.lists(st.integers(0, 5), min_size=1, max_size=6), st.integers(-2, 30), st.integers(-2, 30))
def test_a_column_in_parts_is_cut_as_an_array(sizes: list[int], start: int, stop: int) -> None:
    stops = np.cumsum(sizes).tolist()
    whole = np.arange(float(stops[-1]))
    parts = np.split(whole, stops[:-1])
    column = PartColumn(parts.__getitem__, stops)
    for span in (slice(start, stop), slice(0, stop), slice(start, None)):
        np.testing.assert_array_equal(column[span], whole[span])


@pytest.mark.parametrize(
    ("more", "place"),
    [
        ({"preparation": {}}, "preparation.saturated = True: needs the whole well"),
        ({"preparation": BY_ROW | {"find_shifts": True}}, "preparation.find_shifts = True: needs the whole well"),
        (
            {"wall": {"bit_diameter": 0.2, "estimator": "kriging"}},
            "wall.kriging_range: must be a number, because finding it needs the whole well",
        ),
    ],
)
def test_what_needs_the_whole_well_is_refused_in_blocks_by_name(
    field: Path, tmp_path: Path, more: dict[str, Any], place: str
) -> None:
    tree = {"caliper": [{"file": f"{field}/0.parquet"}], "wall": {"bit_diameter": 0.2}, "preparation": BY_ROW} | more
    with pytest.raises(hb.InputError) as caught:
        reprocess_well(Job("A", tree, str(tmp_path), block_samples=1000))
    assert str(caught.value).startswith(place)


def test_a_stretch_of_hole_with_too_many_samples_for_a_block_is_refused(field: Path, tmp_path: Path) -> None:
    settings = {"bit_diameter": 0.2159, "sectors": 8}
    tree = {"caliper": [{"file": f"{field}/0.parquet"}], "wall": settings, "preparation": BY_ROW}
    with pytest.raises(hb.InputError) as caught:
        reprocess_well(Job("A", tree, str(tmp_path), block_samples=999))
    rule = "256 turns from 1000 m on have 4,000 samples or vertices; must be at least 1/4 of this number"
    assert str(caught.value) == f"block_samples = 999: {rule}"


def test_a_block_skips_a_gap_and_reads_no_more_than_it_needs_beyond() -> None:
    plan = {"height": 2.0, "counts": {"-1": 5, "0": 3, "500": 9, "501": 4}}
    ways = [_beyond_gap(plan, at, 1) for at in (0.5, 2.5, 1000.5, 1005.0)]
    assert ways == [0.5, 1000.0, 1000.5, 1005.0]
    ways = [-_beyond_gap(plan, -at, -1) for at in (1003.0, 1000.0, 900.0, -1.5, -9.0)]
    assert ways == [1003.0, 1000.0, 2.0, -1.5, -9.0]


def test_a_parquet_file_is_read_in_little_memory(tmp_path: Path) -> None:
    values = np.random.default_rng(0).uniform(1.0, 2.0, 600_000)
    table = pyarrow.table(dict.fromkeys(("depth_m", "toolface_deg", "radius_m"), values))
    for rows in (60_000, values.size):
        parquet.write_table(table, tmp_path / "a.parquet", row_group_size=rows, use_dictionary=False)
        size, begin = (tmp_path / "a.parquet").stat().st_size, pyarrow.total_allocated_bytes()
        with parquet.ParquetFile(tmp_path / "a.parquet", **AS_STREAM) as file:
            most = max(pyarrow.total_allocated_bytes() - begin for _ in file.iter_batches(10_000))
        assert most < size / 2, (most, size)


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    """A scheduler and two workers in threads of this process."""
    import dask
    from distributed import Client, LocalCluster

    with (
        dask.config.set({"distributed.admin.tick.interval": "10s"}),
        LocalCluster(n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None) as cluster,
        Client(cluster) as made,
    ):
        yield made


@pytest.mark.filterwarnings("ignore")
def test_all_wells_on_dask(field: Path, tmp_path: Path, client: Any) -> None:
    text = MANIFEST + '[[well]]\nname = "C"\ncaliper = "bad.parquet"\n'
    jobs = read_jobs(manifest(field, text), str(tmp_path))
    seen: list[int] = []
    found = hb.reprocess(jobs, client, progress=lambda progress: seen.append(progress.finished))
    assert sorted(found.done) == ["15/9-F 1", "B"]
    assert list(found.failed) == ["C"]
    assert found.failed["C"].startswith("bad.parquet: ")
    assert seen == [1, 2, 3]  # the well whose file cannot be read is known before any work
    catalogue = parquet.read_table(tmp_path / "catalogue.parquet").to_pylist()
    assert [row["well"] for row in catalogue] == ["15/9-F 1", "B"]
    schema = parquet.read_schema(tmp_path / "catalogue.parquet")
    assert [schema.field(name).metadata[b"unit"] for name in ("VOL", "EXCESS", "COVER")] == [b"m3", b"", b""]
    assert found.warnings == {row["well"]: row["warnings"] for row in catalogue if row["warnings"]}
    assert json.loads((tmp_path / "failures.json").read_text()) == found.failed
    assert (len(status(jobs).skipped), list(status(jobs).failed)) == (2, ["C"])
    before = content(tmp_path)
    again = hb.reprocess(jobs, client)
    assert (again.done, sorted(again.skipped)) == ([], ["15/9-F 1", "B"])
    elsewhere = hb.reprocess(jobs[1:2], client, output=str(tmp_path / "elsewhere"))
    assert elsewhere.done == ["B"]
    assert (tmp_path / "elsewhere" / "wells" / "B" / "B.wall").is_file()
    shutil.rmtree(tmp_path / "elsewhere")
    assert content(tmp_path) == before
    duckdb = pytest.importorskip("duckdb")
    count = duckdb.sql(f"SELECT well, count(*) FROM '{tmp_path}/logs/*/*.parquet' GROUP BY well ORDER BY well")
    assert [well for well, _ in count.fetchall()] == ["15/9-F 1", "B"]


@pytest.mark.filterwarnings("ignore")
def test_the_command(field: Path, tmp_path: Path, client: Any, golden: Golden) -> None:
    where = ["-o", str(tmp_path), "--scheduler", client.scheduler.address]
    good, bad = manifest(field), MANIFEST + '[[well]]\nname = "C"\ncaliper = "bad.parquet"\n'
    result = CliRunner().invoke(cli, ["reprocess", str(good), *where])
    assert result.exit_code == 0, result.stderr
    assert result.stdout.startswith("2 made, 0 there already, 0 failed, of 2 wells in ")
    assert "2 of 2 wells, 0 failed" in result.stderr
    result = CliRunner().invoke(cli, ["reprocess", str(manifest(field, bad, "b.toml")), *where, "-q"])
    assert (result.exit_code, result.stdout) == (3, "")
    assert result.stderr.startswith("C: bad.parquet: ")
    result = CliRunner().invoke(cli, ["reprocess", "status", str(field / "b.toml"), "-o", str(tmp_path)])
    golden((result.exit_code, result.stdout.splitlines()[0]))


def ports_of(*processes: int) -> set[int]:
    """The TCP ports on which some processes listen."""
    listening = {}
    for line in Path("/proc/net/tcp").read_text().splitlines()[1:]:
        _, local, _, state, *_, inode = line.split()[:10]
        if state == "0A":
            listening[f"socket:[{inode}]"] = int(local.split(":")[1], 16)
    found = set()
    for process in processes:
        for link in Path(f"/proc/{process}/fd").iterdir():
            with contextlib.suppress(OSError):
                found |= {listening[name] for name in [str(link.readlink())] if name in listening}
    return found


def test_the_cluster_of_this_machine_answers_nobody_else() -> None:
    """Every port of the client's process and of the workers gives nothing: in plain, by TLS, by TLS as someone else."""
    before = ports_of(os.getpid())  # of clusters of other tests
    with connected(None, 2) as own:
        check_silent(ports_of(os.getpid(), *own.run(os.getpid).values()) - before)


def check_silent(ports: set[int]) -> None:
    from distributed import Security

    assert len(ports) >= 4
    nobody = ssl.create_default_context()
    nobody.check_hostname, nobody.verify_mode = False, ssl.CERT_NONE
    other = Security.temporary().get_connection_args("client")["ssl_context"]
    other.check_hostname, other.verify_mode = False, ssl.CERT_NONE
    paths = ("/", "/status", "/metrics", "/info/main/workers.html", "/json/counts.json", "/api/v1", "/health")
    for port in ports:
        for context, path in [(None, path) for path in paths] + [(nobody, "/"), (other, "/")]:
            given = b""
            with contextlib.ExitStack() as links, contextlib.suppress(OSError):
                link = links.enter_context(socket.create_connection(("127.0.0.1", port), 1))
                if context is not None:
                    link = links.enter_context(context.wrap_socket(link))
                link.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n".encode())
                given = link.recv(1000)
            assert given[:12] in (b"", b"HTTP/1.1 404"), (port, path, given)


ENDING = """
import os, signal, sys
import dask
from helibore.runs import fault_notes
with dask.config.set({fault_notes.FOLDER: sys.argv[1]}):
    try:
        with fault_notes.noted("task", 3):
            print("begun", flush=True)
            if sys.argv[2] != "end":
                os.kill(os.getpid(), getattr(signal, sys.argv[2]))
    except ValueError as refused:
        print(refused)
"""


def test_a_task_that_ends_its_process_is_not_tried_again(tmp_path: Path) -> None:
    """A fatal error once, a kill from outside three times; a task that ends leaves no note."""

    def run(how: str) -> str:
        command = [sys.executable, "-c", ENDING, str(tmp_path), how]
        return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False).stdout

    assert run("end") == "begun\n"
    assert [run("SIGABRT"), run("SIGABRT")] == [
        "begun\n", "process: ended with a fatal error (Aborted); not tried again\n"
    ]  # fmt: skip
    (tmp_path / "task").unlink()
    assert [run("SIGKILL") for _ in range(3)] == ["begun\n"] * 3
    assert run("SIGKILL").startswith("process: was killed 3 times")


def test_a_scheduler_without_tls_needs_the_users_word(field: Path, tmp_path: Path) -> None:
    for address in ("tcp://127.0.0.1:1", "127.0.0.1:1"):
        with pytest.raises(hb.InputError, match="TLS") as refused:
            hb.reprocess(read_jobs(manifest(field), str(tmp_path)), address)
        assert (refused.value.place, refused.value.value) == ("scheduler", address)
    where = ["-o", str(tmp_path), "--scheduler", "tcp://127.0.0.1:1"]
    result = CliRunner().invoke(cli, ["reprocess", str(manifest(field)), *where])
    assert (result.exit_code, result.stdout) == (2, "")
    assert "--insecure-scheduler" in result.stderr
    assert content(tmp_path) == {}


@pytest.mark.filterwarnings("ignore")
def test_status_names_what_is_out_of_date_and_who_left_the_manifest(field: Path, tmp_path: Path) -> None:
    for name in ("0.parquet", "1.parquet", "s.csv"):
        shutil.copy(field / name, tmp_path)

    def found(text: str = MANIFEST) -> tuple[list[str], dict[str, str], list[str], int]:
        of = status(read_jobs(manifest(tmp_path, text)))
        return of.skipped, of.outdated, of.orphans, of.unmade

    both = ["15/9-F 1", "B"]
    assert found() == ([], {}, [], 2)
    for job in read_jobs(manifest(tmp_path)):
        reprocess_well(job)
    assert found() == (both, {}, [], 0)
    assert found(MANIFEST.replace("sectors = 32", "sectors = 64")) == (both[:1], {"B": "its settings"}, [], 0)
    assert found(MANIFEST.replace('"B"', '"C"')) == (both[:1], {}, ["B"], 1)
    (tmp_path / "out/logs/well=B/logs-0.parquet").unlink()
    (tmp_path / "s.csv").write_text("md_m,incl_deg,azim_deg\n990,5,40\n1010,7,51\n")
    assert found() == ([], {"15/9-F 1": "s.csv", "B": "its outputs"}, [], 0)
    (tmp_path / "s.csv").unlink()
    (tmp_path / "1.parquet").write_bytes((tmp_path / "0.parquet").read_bytes())
    assert found()[1] == {"15/9-F 1": "s.csv (no such file)", "B": "1.parquet, its outputs"}
    text = MANIFEST.replace('"B"', '"C"')
    result = CliRunner().invoke(cli, ["reprocess", "status", str(manifest(tmp_path, text))])
    assert (result.exit_code, result.stdout.splitlines()) == (0, [
        "0 of 2 wells are done, 0 failed, 1 out of date, 1 not made",
        "15/9-F 1: out of date: changed since it was made: s.csv (no such file)",
        f"wells in the output and its catalogue, but not in {tmp_path}/m.toml: B",
    ])  # fmt: skip


def test_a_script_that_would_start_itself_again_is_refused(field: Path, tmp_path: Path) -> None:
    manifest(tmp_path, MANIFEST)
    for name in ("0.parquet", "1.parquet", "s.csv"):
        shutil.copy(field / name, tmp_path)
    call = 'hb.reprocess("m.toml")'
    script = tmp_path / "all.py"

    def run(text: str) -> subprocess.CompletedProcess[str]:
        script.write_text(f"import helibore as hb\n{text}\n")
        return subprocess.run(
            [sys.executable, "all.py"], cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE
        )

    for text, line in ((call, 2), (f"def main():\n    {call}\nmain()", 4)):
        done = run(text)
        assert done.stderr.count("Traceback") == 1
        assert f"InputError: all.py, line {line}: must stand, indented, below the line if __name__ ==" in done.stderr
        assert not (tmp_path / "out").exists()
    done = run(f'MAIN = __name__ == "__main__"\nif MAIN:\n    print({call}.sentence())')
    assert done.stdout.startswith("2 made, 0 there already, 0 failed"), done.stderr


@pytest.mark.filterwarnings("ignore")
def test_a_missing_library_is_named_before_any_work(
    field: Path, tmp_path: Path, client: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    (field / "late.las").write_text("~V\n")
    text = MANIFEST + '[[well]]\nname = "L"\ncaliper = "late.las"\n'
    monkeypatch.setitem(sys.modules, "lasio", None)
    with pytest.raises(
        hb.InputError, match=r'^worker .*: well L: .*late.las: needs lasio: pip install "helibore\[las\]"'
    ):
        hb.reprocess(manifest(field, text), client, output=str(tmp_path))
    assert not list(tmp_path.rglob("*.*"))


def flip(file: Path, seed: int, above: float = 0.0) -> None:
    """Flip a bit of a file, beyond a share of its length."""
    random, old = np.random.default_rng(seed), bytearray(file.read_bytes())
    old[random.integers(int(above * len(old)), len(old))] ^= 1 << random.integers(8)
    file.write_bytes(old)


@pytest.fixture
def large_job(field: Path, tmp_path: Path) -> Job:
    settings = {"bit_diameter": 0.2159, "sectors": 8, "pitch": 0.005}
    tree = {"caliper": [{"file": f"{field}/0.parquet"}], "wall": settings, "preparation": BY_ROW}
    return Job("A", tree, str(tmp_path / "out"), ("archive",), block_samples=2000)


def make_large(job: Job) -> Any:
    for number in range(reprocess_well(job)["blocks"]):
        reprocess_block(job, number)
    return merge_well(job)


def test_a_flipped_bit_in_what_a_large_well_left_is_noticed(large_job: Job, tmp_path: Path) -> None:
    make_large(large_job)
    want, out = content(tmp_path / "out"), tmp_path / "out"
    shutil.rmtree(out)
    reprocess_well(large_job)
    flip(next(out.glob("work/A/bins-*/*")), 1)
    with pytest.raises(
        hb.InputError, match=r"^work/A/bins-\w+/\d+: is damaged: start again, and the samples are sorted"
    ):
        make_large(large_job)
    reprocess_well(large_job)
    for number in range(2):
        reprocess_block(large_job, number)
    flip(out / "work/A/part-00000.npz", 2)
    with pytest.raises(hb.InputError, match=r"^work/A/part-00000.npz: was damaged and is deleted: start again"):
        make_large(large_job)
    (out / "wells/A/A-00001.wall").unlink()
    flip(out / "work/A/plan.json", 3)
    with pytest.raises(hb.InputError, match=r"^work/A/plan.json: is missing or damaged: start again$"):
        merge_well(large_job)
    make_large(large_job)
    assert content(out) == want


@pytest.mark.parametrize("seed", range(2))
def test_a_flipped_bit_in_input_or_output_is_refused(large_job: Job, field: Path, tmp_path: Path, seed: int) -> None:
    table = parquet.read_table(field / "0.parquet")
    given = tmp_path / "a.parquet"
    parquet.write_table(table, given, write_page_checksum=True, use_dictionary=False)
    flip_page(given, seed)
    tree = large_job.tree | {"caliper": [{"file": str(given)}]}
    for most in (10_000, 2000):
        with pytest.raises(hb.InputError, match=r"^a.parquet[:,].* damaged Parquet \("):
            reprocess_well(Job("A", tree, str(tmp_path / "out"), ("archive",), block_samples=most))
    assert content(tmp_path / "out") == {}
    job = Job("A", large_job.tree, str(tmp_path / "out"), ("archive", "logs"))
    reprocess_well(job)
    before = content(tmp_path / "out")
    flip(tmp_path / "out/records/A.json", seed)
    assert reprocess_well(job)["made"]
    assert content(tmp_path / "out") == before
    flip_page(tmp_path / "out/logs/well=A/logs-0.parquet", seed)
    with pytest.raises(OSError, match="CRC"):
        parquet.read_table(tmp_path / "out/logs/well=A/logs-0.parquet", page_checksum_verification=True)
    flip_member(tmp_path / "out/wells/A/A.wall", seed)
    with pytest.raises(hb.InputError, match=r"A\.wall"):
        hb.load(tmp_path / "out/wells/A/A.wall")


def flip_page(file: Path, seed: int) -> None:
    """Flip a bit in the last bytes of the first data page of a column."""
    chunk = parquet.read_metadata(file).row_group(0).column(seed % 3)
    content = bytearray(file.read_bytes())
    begin = chunk.data_page_offset if not chunk.has_dictionary_page else chunk.dictionary_page_offset
    content[begin + chunk.total_compressed_size - 3 - seed] ^= 1 << seed
    file.write_bytes(content)


def flip_member(file: Path, seed: int) -> None:
    """Flip a bit in the middle of the largest array of an archive."""
    with zipfile.ZipFile(file) as archive:
        member = max(archive.infolist(), key=lambda of: of.file_size)
    content = bytearray(file.read_bytes())
    content[member.header_offset + member.file_size // 2 + seed] ^= 1 << seed
    file.write_bytes(content)


@pytest.mark.filterwarnings("ignore")
def test_a_full_disk_leaves_nothing_half_written(field: Path, tmp_path: Path, client: Any) -> None:
    jobs = read_jobs(manifest(field), str(tmp_path))
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, hard))
    try:
        found = hb.reprocess(jobs, client)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert sorted(found.failed) == ["15/9-F 1", "B"]
    assert all("File too large" in reason for reason in found.failed.values())
    assert set(content(tmp_path)) == {"failures.json"}
    assert not list(tmp_path.rglob("*.part"))
    assert sorted(hb.reprocess(jobs, client).done) == ["15/9-F 1", "B"]


@pytest.mark.filterwarnings("ignore")
def test_failures_are_told_where_the_catalogue_cannot_be_written(
    field: Path, tmp_path: Path, client: Any, monkeypatch: pytest.MonkeyPatch, golden: Golden
) -> None:
    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("helibore.runs.reprocess._write_catalogue", full)
    where = ["-q", "-o", str(tmp_path), "--scheduler", client.scheduler.address]
    text = MANIFEST.replace("1.parquet", "bad.parquet")
    result = CliRunner().invoke(cli, ["reprocess", str(manifest(field, text, "b.toml")), *where])
    assert (result.exit_code, result.stdout) == (3, "")
    lines = result.stderr.splitlines()
    assert lines[0].startswith("B: bad.parquet: ")
    golden(lines[1])


@pytest.mark.filterwarnings("ignore")
def test_a_store_that_times_out_is_tried_again(field: Path, client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    jobs = [replace(job, outputs=("logs",)) for job in read_jobs(manifest(field), "memory://slow")]
    system, asked = Store("memory://slow").system, Counter[str]()
    put = type(system).put_file

    def slow(self: Any, local: str, path: str, **more: Any) -> None:
        asked[path] += 1
        if "logs-0" in path and (asked[path] < 3 or "well=B" in path):
            raise FSTimeoutError("no answer in 5 s")
        put(self, local, path, **more)

    monkeypatch.setattr(type(system), "put_file", slow)
    found = hb.reprocess(jobs, client)
    assert (found.done, found.failed) == (["15/9-F 1"], {"B": "no answer in 5 s"})
    assert [asked[path] for path in sorted(asked) if "logs-0" in path] == [3, 3]
    assert not [name for name in Store("memory://slow").sizes("") if "B" in name]


@pytest.mark.filterwarnings("ignore")
def test_a_scheduler_lost_while_it_sends_a_result_is_told_well_by_well(
    field: Path, tmp_path: Path, client: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def lost(*_: Any, **__: Any) -> None:
        raise ConnectionResetError(104, "Connection reset by peer")

    from distributed import Client

    monkeypatch.setattr(Client, "_gather", lost)
    where = ["-o", str(tmp_path), "--scheduler", client.scheduler.address]
    result = CliRunner().invoke(cli, ["reprocess", str(manifest(field)), *where])
    assert result.exit_code == 3, result.stderr
    assert result.stderr.splitlines()[-1:] == ["15/9-F 1, B: the scheduler was lost"]
    monkeypatch.undo()
    result = CliRunner().invoke(cli, ["reprocess", str(manifest(field)), *where])
    assert "2 there already" in result.stdout
    assert ", inf s left" not in result.stderr


def test_workers_of_another_version_are_refused_before_any_work(
    field: Path, tmp_path: Path, client: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("helibore.runs.reprocess.versions", lambda: versions() | {"numpy": "0.1"})
    with pytest.raises(hb.InputError, match=r"^worker inproc://.*: worker: numpy .*: must be 0.1, as in the calling"):
        hb.reprocess(read_jobs(manifest(field), str(tmp_path)), client)
    assert content(tmp_path) == {}


def test_a_cluster_is_started_again_where_a_worker_dies_at_its_start() -> None:
    left = [RuntimeError("Nanny failed to start."), RuntimeError("Nanny failed to start."), "cluster"]

    def start() -> Any:
        if isinstance(found := left.pop(0), RuntimeError):
            raise found
        return found

    assert _start_cluster(start) == "cluster"
    left[:] = [RuntimeError(f"Nanny failed to start, {number}.") for number in range(4)]
    with pytest.raises(RuntimeError, match="start, 2"):
        _start_cluster(start)


def test_time_left_follows_from_the_wells_made(golden: Golden) -> None:
    progress = Progress(10, done=["a", "b"], skipped=["c"], failed={"d": "reason"}, seconds=6.0)
    assert (progress.finished, progress.seconds_left) == (4, 12.0)
    golden(progress.sentence())
