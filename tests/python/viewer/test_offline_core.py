"""The core as WebAssembly gives the bits of the native core, and its errors; `./develop page` builds it."""

from __future__ import annotations

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
from locations import WEB
from patience import PATIENCE

import helibore as hb
from helibore import _core
from helibore.logs.zones import KINDS
from helibore.viewer.offline_rules import rules
from helibore.wall.estimates import choose_left_out
from helibore.wall.uncertainty import TARGETS

ROOT = WEB.parents[3]
WASM = ROOT / "build" / "page" / "helibore.wasm"
NODE = shutil.which("node")
RULE = {
    "noise": 2e-7, "between": 3e-3, "scatter_power": 0.7, "distance_power": 0.8, "stretch": 16.0, "reach": 0.4,
}  # fmt: skip
MEASURED = rules()["measured"]

needs_core = pytest.mark.skipif(
    NODE is None or not WASM.exists(), reason="the WebAssembly core is not built: ./develop page builds it"
)


def samples(seed: int) -> dict[str, list[float]]:
    """Raw samples of an uneven helix with a washout, a breakout, a gap, noise and repeated rows."""
    draw = np.random.default_rng(seed)
    depth = 1000.0 + np.sort(draw.uniform(0.0, 12.0, 6000))
    depth = depth[(depth < 1004.0) | (depth > 1005.5)]
    toolface = np.cumsum(draw.uniform(0.0, 41.0, depth.size)) % 360.0
    radius = 0.108 + 0.01 * np.exp(-((depth - 1008.0) ** 2)) + draw.normal(0.0, 4e-4, depth.size)
    radius += 0.02 * (depth < 1002.0) * np.maximum(np.cos(np.radians(2 * toolface - 80.0)), 0.0) ** 4
    rows = np.append(np.arange(depth.size), np.arange(0, depth.size, 50))
    return {
        name: values[rows].tolist() for name, values in (("depth", depth), ("toolface", toolface), ("radius", radius))
    }


def run(folder: Path, case: dict[str, Any]) -> dict[str, Any]:
    file = folder / "case.json"
    file.write_text(json.dumps(case))
    command = [str(NODE), str(WEB / "tests" / "core_hashes.mjs"), str(WASM), str(file)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def numbers_of(zone: hb.Zone) -> list[float]:
    """Return the numbers of a zone in the order of zones.hpp."""
    lobes = [of for lobe in zone.lobes for of in (lobe.toolface, lobe.opening, lobe.height)]
    return [
        KINDS.index(zone.kind), zone.start, zone.stop, zone.measure, zone.median, zone.severity, zone.enlargement,
        zone.elongation, zone.peak, zone.coverage, zone.confidence, zone.pipe_diameter, zone.toolface, zone.deviation,
        *lobes, *[math.nan] * (6 - len(lobes)),
    ]  # fmt: skip


@needs_core
@pytest.mark.parametrize("sectors", [64, 37])
def test_the_bits_of_radii_distances_sigma_and_zones_are_those_of_the_native_core(tmp_path: Path, sectors: int) -> None:
    columns = samples(sectors)
    settings = {"bit_diameter": 0.216, "sectors": sectors}
    found = run(tmp_path, {**columns, "settings": settings, "rule": RULE, "measured": MEASURED})
    kinds, zones = found.pop("kinds"), found.pop("zones")
    wall = hb.Wall(bit_diameter=0.216, sectors=sectors, sigma=True, threads=1)
    wall.append(*columns.values())
    sigma = _core.sigma_of(wall._core.sums(), tuple(RULE.values()))
    expected = {"radius": wall.radius, "nearest": wall.nearest, "sigma": sigma}
    assert np.isfinite(sigma).any()
    assert np.isnan(sigma).any()
    sums = {name: hashlib.sha256(np.ascontiguousarray(of)).hexdigest() for name, of in expected.items()}
    assert found == sums | {"version": hb.__version__}
    native = wall.zones()
    assert native.of("washout")
    assert hashlib.sha256(native.kind.astype(np.int32)).hexdigest() == kinds
    assert [[None if math.isnan(of) else of for of in numbers_of(zone)] for zone in native.zones] == zones


@needs_core
def test_an_error_has_the_text_of_the_native_core(tmp_path: Path) -> None:
    columns = samples(1)
    columns["radius"][3] = -0.1
    with pytest.raises(hb.InputError) as native:
        hb.Wall(bit_diameter=0.216).append(*columns.values())
    found = run(tmp_path, {**columns, "settings": {"bit_diameter": 0.216}, "rule": RULE})
    assert found == {"error": str(native.value)}
    assert found["error"].startswith("radius[3] = -0.1")


@pytest.mark.skipif(NODE is None, reason="Node.js is missing")
@pytest.mark.parametrize("count", [100, 9_000, 20_000, 120_000])
def test_the_samples_that_are_left_out_are_those_of_the_package(tmp_path: Path, count: int) -> None:
    draw = np.random.default_rng(count)
    columns = np.sort(draw.uniform(2000, 2300, count)), draw.uniform(0, 360, count), np.full(count, 0.11)
    settings = hb.Wall(bit_diameter=0.216, pitch=-0.12, sectors=48).settings
    wanted, boxes = choose_left_out(columns, settings, TARGETS, 0, "")
    places, given = (tmp_path / name for name in ("places.bin", "rules.json"))
    places.write_bytes(np.concatenate(columns[:2]).tobytes())
    given.write_text(json.dumps(rules()))
    script = (
        "import { readFileSync } from 'node:fs';"
        f"import {{ chooseLeftOut }} from '{(WEB / 'offline' / 'left_out.js').as_uri()}';"
        f"import {{ setRules }} from '{(WEB / 'offline' / 'rules.js').as_uri()}';"
        f"setRules(JSON.parse(readFileSync('{given}', 'utf8')));"
        f"const all = new Float64Array(new Uint8Array(readFileSync('{places}')).buffer);"
        f"const places = {{ depth: all.slice(0, {count}), toolface: all.slice({count}) }};"
        "const found = chooseLeftOut(places, { pitch: -0.12, sectors: 48 });"
        "console.log(JSON.stringify([found.rows, found.height, found.width].map((of) => [...of])))"
    )
    command = [str(NODE), "--input-type=module", "-e", script]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True)
    rows, *sizes = json.loads(done.stdout)
    assert rows == wanted.tolist()
    assert sizes == [of.tolist() for of in boxes]


def shortest(value: float) -> str:
    """The shorter of both notations of the fewest digits, as std::to_chars."""
    digits = np.format_float_scientific(value, trim="-")
    exponent = int(digits.partition("e")[2])
    fixed = str(int(value)) if value == int(value) else np.format_float_positional(value, trim="-")
    scientific = f"{digits.partition('e')[0]}e{exponent:+03d}"
    return fixed if len(fixed) <= len(scientific) else scientific


@pytest.mark.skipif(NODE is None, reason="Node.js is missing")
def test_numbers_in_messages_are_written_as_in_those_of_the_native_core() -> None:
    draw = np.random.default_rng(3)
    values = [0.0, -0.0, 1e5, 123456.7, 999999.5, 1e20, 2.0**60, 5e-324, -1.5e-5, 1234567.0, 0.00012345678, 3600.0]
    values += [float(f"{of:.{n}g}") for n, of in enumerate(np.exp(draw.uniform(-60, 60, 16)), 1)]
    values += [float(of) for of in draw.normal(0, 1, 20) * 10.0 ** draw.integers(-8, 24, 20)]
    script = (
        f"import {{ numberText }} from '{(WEB / 'offline' / 'core.js').as_uri()}';"
        f"const values = {json.dumps(values)};"
        "console.log(JSON.stringify(values.map((of) => [numberText(of, 0), numberText(of, 6)])))"
    )
    command = [str(NODE), "--input-type=module", "-e", script]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True)
    for value, (whole, six) in zip(values, json.loads(done.stdout), strict=True):
        assert six == f"{value:g}"
        assert whole == ("-0" if str(value) == "-0.0" else shortest(value))


def test_the_structs_of_the_page_are_those_of_the_header() -> None:
    header = (ROOT / "cpp" / "include" / "helibore" / "helibore.h").read_text()
    script = (WEB / "offline" / "core.js").read_text()
    kinds = {"u": "uint32_t", "i": "int32_t", "d": "double", "l": "int64_t"}
    structs = re.findall(r"^  (hb_\w+): '([^']+)'", script, re.MULTILINE)
    assert len(structs) == 7
    for name, members in structs:
        body = re.search(rf"typedef struct {name} {{(.*?)}} {name};", header, re.DOTALL)
        assert body is not None
        before_arrays = body[1].partition("[")[0]  # the page states its size up to there: it needs none of them
        declared = re.findall(r"^ +(\w+) (\w+);", before_arrays, re.MULTILINE)
        assert [(kinds[kind], field) for kind, field in (each.split() for each in members.split(", "))] == declared
