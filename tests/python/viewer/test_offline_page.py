"""The page without a server rebuilds the walls that the package rebuilds from the same files, or says why it does not.

`./develop page` builds what these tests read; where it was not run, they are skipped.
"""

from __future__ import annotations

import base64
import gzip
import hashlib
import json
import math
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from locations import WEB
from patience import PATIENCE

import helibore as hb
from helibore.base.decimals import DECIMALS
from helibore.cli import cli
from helibore.logs.curves import curves_of
from helibore.logs.summary import WallSummary
from helibore.logs.turn_logs import Logs
from helibore.samples.helix import helix_of
from helibore.viewer.exports import curve_bytes
from helibore.viewer.feed import Feed, history_of
from helibore.viewer.offline_rules import rules
from helibore.viewer.page_files import page
from helibore.viewer.scene import History

ROOT = WEB.parents[3]
WASM, PAGE = (ROOT / "build" / "page" / f"helibore.{ending}" for ending in ("wasm", "html"))
EXAMPLES = ROOT / "examples" / "files"
NODE = shutil.which("node")
BIT = 0.216
ROWS = [(1000 + 0.05 * row, 37.0 * row % 360, 108.0 + row % 7) for row in range(60)]

needs_page = pytest.mark.skipif(
    NODE is None or not WASM.exists() or not PAGE.exists(), reason="the page is not built: ./develop page builds it"
)


def table(header: str, mark: str = ",", decimal: str = ".", start: str = "") -> str:
    rows = (mark.join(f"{cell:.3f}".replace(".", decimal) for cell in row) for row in ROWS)
    return start + "\n".join([mark.join(header.split()), *rows]) + "\n"


def las(units: str = "M DEG MM", null: str = "-9999", body: str = "") -> str:
    names = zip(["DEPT", "TFO", "RADIUS"], units.split(), strict=True)
    curves = "\n".join(f"{name}.{unit} : {name}" for name, unit in names)
    rows = body or "\n".join(f"{at:.3f} {angle:.2f} {radius:.2f}" for at, angle, radius in ROWS)
    return f"~V\nVERS. 2.0 :\nWRAP. NO :\n~W\nNULL. {null} :\nWELL. A-7 :\n~C\n{curves}\n~A\n{rows}\n"


SAME = {
    "plain.csv": table("depth_m toolface_deg radius_mm"),
    "comma.csv": table("depth_m toolface_deg radius_mm", ";", ","),
    "stated.csv": table("depth_m toolface_deg radius_mm", ";", ",", "sep=;\n"),
    "titles.csv": table("depth_m toolface_deg radius_mm", start="Well: A-7\nDate: May\n"),
    "tabs.txt": table("MD[m] GTF[deg] wall_radius[mm]", "\t"),
    "blanks.txt": table("depth_m toolface_deg radius_mm", "  "),
    "units.csv": table("MD TF RADIUS", start="").replace("\n", "\nm,deg,mm\n", 1),
    "dated.csv": "time,depth_m,toolface_deg,radius_mm\n" + "".join(
        f"2024-05-03T10:{row:02}:07.25Z,{at:.3f},{angle:.2f},{radius}\n" for row, (at, angle, radius) in enumerate(ROWS)
    ),
    "gaps.csv": table("depth_m toolface_deg radius_mm").replace("108.000", "").replace("110.000", "-999.25", 3),
    "quoted.csv": table("depth_m toolface_deg radius_mm").replace("1000.050", '"1,000.050"'),
    "plain.las": las(),
    "feet.las": las("FT DEG MM"),
    "null.las": las(null="-777", body="\n".join(f"{at:.3f} {angle:.2f} {-777 if row % 9 == 4 else radius:.2f}"
                                              for row, (at, angle, radius) in enumerate(ROWS))),
    "header.las": las().replace("~A\n", "~A\nDEPT TFO RADIUS\n"),
    "two_arms.csv": "MD_m,RB_deg,CALX_mm,CALY_mm\n" + "".join(
        f"{at:.3f},{angle:.2f},{2 * radius:.1f},{219 if radius < 112 else ''}\n" for at, angle, radius in ROWS
    ),
    "closed.csv": "depth_m,toolface_deg,radius_mm\n" + "".join(
        f"{1000 + 0.05 * row:.2f},{37.0 * row % 360},{40 if row > 100 else 108 + row % 7}\n" for row in range(200)
    ),
    "limit.csv": "depth_m,toolface_deg,radius_mm\n" + "".join(
        f"{1000 + 0.05 * row:.2f},{37.0 * row % 360},{150 if row > 160 else 108 + row % 7}\n" for row in range(200)
    ),
}  # fmt: skip
FOUND = {
    "closed.csv": [
        "the arms close or open in 1 row, 1005.0 to 1005.0 m: left out",
        "all arms are closed in 99 rows, 1005.0 to 1010.0 m: left out",
    ],
    "limit.csv": ["radius_mm stays at its limit in 39 rows, 1008.0 to 1010.0 m: left out"],
}
REFUSED = {
    "binary.las": ("\x00\x01\x02" * 50, "binary"),
    "empty.csv": ("\n\n", "empty"),
    "prose.txt": ("It was a dark night.\nThe hole was wide.\nNobody measured it.\n", "not a table|blanks"),
    "numbers.csv": (table("1 2 3"), "no line of names"),
    "no_radius.csv": (table("depth_m toolface_deg gamma_api"), "radius or diameter"),
    "no_unit.csv": (table("MD TF RADIUS"), "column MD: its unit is not stated"),
    "wrong_unit.csv": (table("depth_m toolface_deg radius_in"), "no radius of a borehole; mm would fit"),
    "diameter.csv": (table("depth_m toolface_deg radius_mm").replace(",1", ",21"), "degrees|looks like a diameter"),
    "short.csv": (table("depth_m toolface_deg radius_mm") + "1003,5\n", "line 62: 2 values where 3 columns"),
    "mean.csv": (table("depth_m toolface_deg cali_mm"), "a mean diameter has no direction"),
    "las3.las": (las().replace("VERS. 2.0", "VERS. 3.0"), "reads LAS 2"),
    "wrapped.las": (las().replace("WRAP. NO", "WRAP. YES"), "wrapped"),
}  # fmt: skip


def read_by_page(folder: Path, files: list[Path]) -> list[dict[str, Any]]:
    given = folder / "rules.json"
    given.write_text(json.dumps(rules()))
    script = WEB / "tests" / "offline_reads.mjs"
    command = [str(NODE), str(script), str(WASM), str(given), str(BIT), *map(str, files)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True)
    return [json.loads(line) for line in done.stdout.splitlines()]


def opened(file: Path) -> hb.Wall:
    if file.suffix == ".wall":
        return hb.load(file, threads=1)
    with hb.open(file) as log:
        return hb.reconstruct(log, bit_diameter=BIT, threads=1)


def digest(values: np.ndarray) -> str:
    return hashlib.sha256(np.ascontiguousarray(values)).hexdigest()


def compare_las(logs: Logs, text: str) -> None:
    """Check that the page's LAS file has the columns of the logs that have a value anywhere, in their order."""
    head, _, rows = text.partition("~A  ")
    names, *lines = rows.splitlines()
    values = dict(zip(names.split(), np.array([line.split() for line in lines], dtype=float).T, strict=True))
    table = {column.mnemonic: column for column in logs.table()}
    assert [name for name in table if name in values] == list(values)
    assert all(np.isnan(column.values).all() for name, column in table.items() if name not in values)
    for name, column in table.items():
        if name in values:
            assert f"{name:<9}.{column.unit.upper():<5} " in head
            seen = np.where(values[name] == -999.25, np.nan, values[name])
            np.testing.assert_allclose(seen, column.values, rtol=0, atol=0.51 * 10.0 ** -DECIMALS[column.unit])


@needs_page
def test_the_page_rebuilds_the_wall_that_the_package_rebuilds_from_the_same_file(tmp_path: Path) -> None:
    for name, text in SAME.items():
        (tmp_path / name).write_text(text)
    files = [*(tmp_path / name for name in SAME), EXAMPLES / "caliper.csv", EXAMPLES / "xy_caliper.csv"]
    files += [EXAMPLES / "turning_arm.las", EXAMPLES / "flaws" / "two_depths.csv"]
    for name in ("caliper.csv", "xy_caliper.csv"):
        opened(EXAMPLES / name).save(tmp_path / f"{name}.wall")
        files.append(tmp_path / f"{name}.wall")
    files.append(WEB.parents[3] / "tests" / "python" / "wall" / "data" / "archive_56ff07e9.wall")  # with a path
    found = read_by_page(tmp_path, files)
    assert len(found) == len(files)
    for file, one in zip(files, found, strict=True):
        wall = opened(file)
        columns = {"radius": wall.radius, "nearest": wall.nearest, "measured": wall.measured.astype(np.uint8)}
        wanted = {name: digest(values) for name, values in columns.items()}
        assert {name: one.get(name) for name in wanted} == wanted, (file.name, one)
        assert one["found"] == FOUND.get(file.name, []), file.name
        logs = wall.logs()
        low, high = helix_of(wall).ends(len(wall))
        parts = [(low, high), (low + 0.31 * (high - low), low + 0.77 * (high - low))]
        for (start, stop), summary in zip(parts, one["summaries"], strict=True):
            compare(wall.summary(start=start, stop=stop), summary)
        curves = {curve.name: curve for curve in curves_of(logs)}
        assert list(one["curves"]) == list(curves), file.name
        for name, (*limits, bits) in one["curves"].items():
            assert limits == pytest.approx(curves[name].ends()), (file.name, name)
            assert bits == digest(np.frombuffer(curve_bytes(curves[name]), np.uint8)), (file.name, name)
        found_zones = wall.zones()
        assert one["kinds"] == digest(found_zones.kind.astype(np.int32)), file.name
        feed = Feed(wall, path=None, attributes={}, well="")
        assert one["zones"] == shown_zones(feed), file.name
        for name, ends in feed.scene.state.ranges.items():
            assert one["ranges"][name] == pytest.approx(ends), (file.name, name)
        assert one["shape"] == found_zones.logs.shape
        grown = history_of(wall) or History()
        assert one["history"] == grown.as_columns(), file.name
        try:
            sigma = digest(np.where(np.isnan(wall.sigma), np.nan, wall.sigma))
        except hb.InputError as error:
            assert "too few samples" in str(error)  # noqa: PT017
            sigma = None
        assert one["sigma"] == sigma, file.name
        compare_las(logs.between(low, low + 0.6 * (high - low)), one["las"])
        assert one["glb"] == mesh_digest(wall, max(low + (high - low) / 3, high - 50), high, tmp_path / "mesh.glb")


@needs_page
def test_an_archive_with_a_wrong_byte_is_refused_or_has_the_saved_wall(tmp_path: Path) -> None:
    whole = tmp_path / "whole.wall"
    opened(EXAMPLES / "xy_caliper.csv").save(whole)
    content = whole.read_bytes()
    files = [whole]
    for at in range(1, len(content), len(content) // 40):
        files.append(tmp_path / f"{at}.wall")
        files[-1].write_bytes(content[:at] + bytes([content[at] ^ 0x10]) + content[at + 1 :])
    right, *others = read_by_page(tmp_path, files)
    assert "radius" in right
    refused = [one["refused"] for one in others if "refused" in one]
    assert all(one["kind"] == "Refusal" for one in others if "refused" in one)
    assert any("another checksum" in text for text in refused)
    for one in others:  # what the checksums do not cover says nothing of the wall
        if "refused" not in one:
            assert one == right


def mesh_digest(wall: hb.Wall, start: float, stop: float, file: Path) -> str:
    """The SHA-256 of the binary part of a GLB file, without the attributes that the page does not write."""
    surface = wall.surface(start=start, stop=stop)
    for name in set(surface.attributes) - {"measured"}:
        del surface.attributes[name]
    surface.save(file)
    content = file.read_bytes()
    return hashlib.sha256(content[20 + int.from_bytes(content[12:16], "little") :]).hexdigest()


def shown_zones(feed: Feed) -> list[dict[str, Any]]:
    """The zones as the live page gets them, without the intervals of their sizes, which only rig mode names."""
    feed.find_zones()
    return [{name: of for name, of in zone.items() if name != "within"} for zone in feed.scene.state.zones]


def compare(wanted: WallSummary, found: dict[str, Any]) -> None:
    """Compare the page's figures of a section with the summary of the package."""
    names = ["start", "stop", "volume", "excess", "whole_turns", "incomplete_turns", "coverage", "without_radius"]
    names.append("washed_out")
    values = {name: float(getattr(wanted, name)) for name in (*names, "mean_diameter")}
    for name in ("least_diameter", "greatest_diameter"):
        values[name] = getattr(wanted, name).value
    for name, value in values.items():
        expected = None if math.isnan(value) else pytest.approx(value, rel=1e-9, abs=1e-12)
        assert found[name] == expected, name
    texts = [wanted.volume_text(), wanted.excess_text()] if wanted.ranged else [None, None]
    assert [found.get("volume_text"), found.get("excess_text")] == texts


@needs_page
def test_the_page_refuses_what_it_does_not_treat_as_the_package_does(tmp_path: Path) -> None:
    for name, (text, _) in REFUSED.items():
        (tmp_path / name).write_text(text)
    found = read_by_page(tmp_path, [tmp_path / name for name in REFUSED])
    for (name, (_, reason)), one in zip(REFUSED.items(), found, strict=True):
        assert re.search(reason, one.get("refused", "")), (name, one)
        assert one["kind"] == "Refusal"


@needs_page
def test_the_page_is_small_and_can_ask_no_machine_for_anything() -> None:
    content = PAGE.read_bytes()
    assert len(gzip.compress(content)) <= 450_000
    assert len(gzip.compress(WASM.read_bytes())) <= 250_000
    text = content.decode()
    policy = re.search(r'http-equiv="Content-Security-Policy" content="([^"]+)"', text)
    assert policy is not None
    parts = dict(part.strip().split(" ", 1) for part in policy[1].split(";"))
    assert parts["default-src"] == "'none'"
    assert "'unsafe-inline'" not in parts["script-src"]
    script = re.search(r'<script type="module">(.*?)</script>', text, re.DOTALL)
    assert script is not None
    digest = base64.b64encode(hashlib.sha256(script[1].encode()).digest()).decode()
    assert f"'sha256-{digest}'" in parts["script-src"]
    packed = re.search(r'id="parts">([^<]+)<', text)
    assert packed is not None
    tables, before, app, after, worker = gzip.decompress(base64.b64decode(packed[1])).decode().split("\0")
    assert json.loads(tables).keys() == {"rules", "examples"}
    assert "" not in (after, worker)
    digest = base64.b64encode(hashlib.sha256(f"\n{app}".encode()).digest()).decode()
    assert f"'sha256-{digest}'" in parts["script-src"]
    assert f"'sha256-{digest}'" in before


def test_the_command_writes_the_page_or_says_how_to_get_it(tmp_path: Path) -> None:
    file = tmp_path / "p.html"
    built = page("helibore.html")
    done = CliRunner().invoke(cli, ["page", "-o", str(file)])
    if built is None:
        assert done.exit_code == 2
        assert "./develop page" in done.stderr
        assert not file.exists()
    else:
        assert file.read_bytes() == built
    refused = CliRunner().invoke(cli, ["page", "-o", str(tmp_path / "p.txt")])
    assert refused.exit_code == 2
    assert ".html" in refused.stderr
