"""JSON Well Log Format and WITSML 1.4.1.1, good and bad."""

from __future__ import annotations

import gzip
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from refused_files import refused

import helibore as hb
from helibore.files import witsml_log

NAMESPACE = 'xmlns="http://www.witsml.org/schemas/1series"'


def json_file(folder: Path, tree: Any) -> Path:
    path = folder / "log.json"
    path.write_text(tree if isinstance(tree, str) else json.dumps(tree))
    return path


def curve(name: str, **more: Any) -> dict[str, Any]:
    return {"name": name, "unit": "m", "valueType": "float", "dimensions": 1} | more


def test_json_arrays_text_and_sets(tmp_path: Path) -> None:
    curves = [curve("MD"), curve("RADI", dimensions=3, unit="mm"), curve("T", valueType="datetime", unit=None)]
    log = {"header": {"name": "A", "well": "W"}, "curves": curves, "data": []}
    log["data"] = [[1, [1, 2, None], "2020-01-01T00:00:00Z"], [2.5, None, None]]
    file = hb.open(json_file(tmp_path, [log, log | {"header": None}]))
    assert [one.name for one in file.sets] == ["A", "log"]
    one = file.set("A")
    np.testing.assert_array_equal(one["RADI"].values, [[1, 2, np.nan], [np.nan] * 3])
    assert one["T"].values.tolist() == ["2020-01-01T00:00:00Z", ""]
    assert [one[name].missing for name in one.names] == [0, 4, 1]
    assert one.header["well"] == "W"
    packed = tmp_path / "packed"
    packed.write_bytes(gzip.compress((tmp_path / "log.json").read_bytes()))
    assert len(hb.open(packed).sets) == 2


def log_of(curves: Any, data: Any) -> list[dict[str, Any]]:
    return [{"header": {}, "curves": curves, "data": data}]


@pytest.mark.parametrize(
    ("tree", "rule"),
    [
        ('[{"header": {}, "curves": [', "truncated: Expecting value"),
        ('[{"header": {}\n "curves": []}]', "line 2: Expecting ',' delimiter"),
        ("[1, 2]", 'not JSON Well Log Format: each log must hold "header", "curves" and "data"'),
        ("[" * 100_000, "not sensible JSON (RecursionError)"),
        (log_of([], [[1]]), '"curves" must be a list'),
        (log_of([curve("A")], []), '"data" has no rows'),
        (log_of([curve("A")], [[1], [1, 2]]), "row 1: 2 values where 1 curves are defined"),
        (log_of([curve("A")], [[1], 3]), "row 1: no list of values"),
        (log_of([curve("A")], [[1], ["x"]]), "row 1, column A = 'x': is not a number"),
        (log_of([curve("A")], [[1], [True]]), "row 1, column A = 'True': is not a number"),
        (log_of([curve("A")], [[1], [[1]]]), "row 1, column A: a list in a curve of one dimension"),
        (log_of([curve("A", dimensions=2)], [[[1, 2]], [[1]]]), "row 1, column A: must hold 2 values"),
        (log_of([curve("A", dimensions=2)], [[[1, "x"]]]), "row 0, column A: holds something that is not a number"),
        (log_of([curve("A", dimensions=0.5)], [[1]]), "column A: dimensions = 0.5: must be a whole number"),
        (log_of([curve("A")], [[10**400]]), "column A: holds a whole number too large"),
        ({"wells": {"W": {"header": {}}}}, "well 'W': holds no columns"),
        ({"wells": {"W": {"MD": [], "IncDeg": []}}}, "well 'W': no rows"),
        ({"wells": {"W": 3}}, "well 'W': must be an object of columns"),
        ({"wells": {}}, "JSON wells: holds no channels"),
    ],
)
def test_bad_json(tmp_path: Path, tree: Any, rule: str) -> None:
    refused(json_file(tmp_path, tree), rule)


@pytest.mark.parametrize("header", ["W", [1], None, {"name": None}])
def test_a_header_without_entries_counts_as_empty(tmp_path: Path, header: Any) -> None:
    one = hb.open(json_file(tmp_path, [{"header": header, "curves": [curve("A")], "data": [[1]]}])).set()
    assert (one.name, one.header) == ("log", {})


@pytest.mark.parametrize("blank", ["", None])
def test_an_empty_cell_of_a_text_column_is_nan_among_numbers(tmp_path: Path, blank: str | None) -> None:
    log = log_of([curve("A"), curve("B", valueType="string")], [[1, "1.5"], [2, blank]])
    np.testing.assert_array_equal(hb.open(json_file(tmp_path, log)).set().numbers("B"), [1.5, np.nan])


def test_large_json_is_refused_unread(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("helibore.files.json_log.SIZE_LIMIT", 1000)
    refused(json_file(tmp_path, "[" + " " * 2000 + "]"), "more than 0 MiB of JSON")


def test_a_damaged_or_empty_log_does_not_block_the_others(tmp_path: Path, golden: Golden) -> None:
    good = {"header": {"name": "A"}, "curves": [curve("MD"), curve("R")], "data": [[1, 2], [3, None]]}
    bad = {"header": {"name": "B"}, "curves": [curve("MD")], "data": [[1], [1, 2]]}
    one = hb.open(json_file(tmp_path, [bad, good, good | {"header": {"name": "C"}, "data": []}])).set()
    np.testing.assert_array_equal(one["R"].values, [2, np.nan])
    assert (one.name, one.remarks) == (
        "A",
        [
            "another set is left out: log.json: B, row 1: 2 values where 1 curves are defined",
            'another set is left out: log.json: C: "data" has no rows',
        ],
    )
    wells = {"wells": {"W": 3, "V": {"header": {"depth_unit": "ft"}, "MD": [1, 2]}}}
    one = hb.open(json_file(tmp_path, wells)).set()
    with pytest.raises(hb.InputError, match=r"only a part can be read: another set is left out: log\.json: well 'W'"):
        hb.open(json_file(tmp_path, wells), strict=True)
    assert (one["MD"].unit, one.remarks) == (
        "ft", ["another set is left out: log.json: well 'W': must be an object of columns"],
    )  # fmt: skip
    empty = LOG.replace("</logs>", '<log uid="M"><name>run 2</name></log></logs>')
    one = hb.open(xml_file(tmp_path, empty)).set()
    golden(one.remarks)
    second = re.search("<log uid.*</log>", LOG, re.DOTALL)
    assert second
    damaged = second[0].replace("run 1", "run 2").replace("<data>,3,-77</data>", "<data>3,-77</data>")
    one = hb.open(xml_file(tmp_path, LOG.replace("</logs>", f"{damaged}</logs>"))).set()
    text = "another set is left out: w.xml: log 'run 2', row 2: 2 values where 3 curves are listed"
    assert (one.name, one.rows, one.remarks) == ("run 1", 3, [text])


def test_a_channel_of_another_length_is_left_out_and_reported(tmp_path: Path, golden: Golden) -> None:
    wells = {"wells": {"W": {"header": {}, "MD": [1, 2], "GR": [50, 51, 52], "RT": [1, 2]}}}
    one = hb.open(json_file(tmp_path, wells)).set()
    assert one.names == ("MD", "RT")
    golden(one.remarks)


LOG = f"""<?xml version="1.0" encoding="UTF-8"?>
<logs {NAMESPACE} version="1.4.1.1"><log uid="L"><nameWell>W</nameWell><name>run 1</name>
<indexType>measured depth</indexType><indexCurve>DEPT</indexCurve><nullValue>-77</nullValue>
<logCurveInfo uid="1"><mnemonic>DEPT</mnemonic><unit>m</unit><curveDescription>depth</curveDescription></logCurveInfo>
<logCurveInfo uid="2"><mnemonic>TIME</mnemonic><unit>s</unit></logCurveInfo>
<logCurveInfo uid="3"><mnemonic>GR</mnemonic><unit>api</unit></logCurveInfo>
<logData><mnemonicList>TIME, DEPT,GR</mnemonicList><unitList>unitless,ft,gAPI</unitList>
<data>2020-01-01T00:00:00Z,1,50</data><data>2020-01-01T00:00:10Z,2,</data><data>,3,-77</data></logData></log></logs>
"""


def xml_file(folder: Path, text: str) -> Path:
    path = folder / "w.xml"
    path.write_text(text)
    return path


def test_witsml_log(tmp_path: Path) -> None:
    one = hb.open(xml_file(tmp_path, LOG)).set()
    assert (one.name, one.index, one.rows, one.header["nameWell"]) == ("run 1", "DEPT", 3, "W")
    assert [(c.name, c.unit, c.description) for c in one] == [
        ("TIME", "unitless", ""), ("DEPT", "ft", "depth"), ("GR", "gAPI", ""),
    ]  # fmt: skip
    np.testing.assert_array_equal(one["GR"].values, [50, np.nan, np.nan])
    assert one["TIME"].values.tolist() == ["2020-01-01T00:00:00Z", "2020-01-01T00:00:10Z", ""]
    plain = LOG.replace(' xmlns="http://www.witsml.org/schemas/1series"', "").replace("1.4.1.1", "1.3.1.1")
    assert hb.open(xml_file(tmp_path, plain)).set()["DEPT"].values.tolist() == [1, 2, 3]


def test_a_curve_of_a_witsml_log_has_its_own_null_value(tmp_path: Path) -> None:
    text = LOG.replace("<unit>api</unit>", "<unit>api</unit><nullValue>50</nullValue>").replace(",3,", ",50,")
    one = hb.open(xml_file(tmp_path, text)).set()
    assert one["DEPT"].values.tolist() == [1, 2, 50]
    assert one["GR"].missing == 3


def test_a_comma_in_a_quoted_text_of_a_witsml_log_does_not_split_it(tmp_path: Path) -> None:
    one = hb.open(xml_file(tmp_path, LOG.replace("<data>,3,-77", '<data>"on, off",3,-77'))).set()
    assert one["TIME"].values[2] == "on, off"


@pytest.mark.parametrize(
    ("old", "new", "rule"),
    [
        ("<logs", "<!DOCTYPE logs><logs", "<!DOCTYPE ...>: document types and entities are refused"),
        ("<logs", '<!DOCTYPE x [<!ENTITY a "b">]><logs', "document types and entities are refused"),
        ("</logs>", "", "truncated: no element found"),
        ("<data>,3,-77</data></logData></log></logs>", "<data>,3", "line 9: truncated: no element found"),
        ("<data>,3,-77</data>", "<data>3,-77</data>", "log 'run 1', row 2: 2 values where 3 curves are listed"),
        ("<data>,3,-77</data>", "<data>,x,-77</data>", "row 2, column DEPT = 'x': is not a number"),
        ("<data>,3,-77</data>", "<data>,3,-77</date>", "mismatched tag"),
        ("unitless,ft,gAPI", "ft,gAPI", "2 units for 3 mnemonics"),
        ("UTF-8", "UTF-7", "line 1: encoding UTF-7: must be UTF-8, US-ASCII, ISO-8859-1 or Windows-1252"),
        ("<nameWell>W</nameWell>", "<a>" * 40 + "</a>" * 40, "elements nested deeper than 32"),
        ("<nameWell>W</nameWell>", "<nameWell>&W;</nameWell>", "undefined entity"),
        ("-77</nullValue>", "x</nullValue>", "log 'run 1': nullValue = 'x': is not a number"),
        ("api</unit>", "api</unit><nullValue>y</nullValue>", "log 'run 1': GR: nullValue = 'y': is not a number"),
    ],
)
def test_bad_witsml(tmp_path: Path, old: str, new: str, rule: str) -> None:
    assert old in LOG
    refused(xml_file(tmp_path, LOG.replace(old, new)), rule)


def test_a_declaration_over_a_block_border_is_still_seen(tmp_path: Path) -> None:
    for shift in (0, 3, 9):
        filler = "<a>" + " " * (witsml_log.LINE_LIMIT - 20 - shift - len(f"<logs {NAMESPACE}>") - 7)
        text = f"<logs {NAMESPACE}>{filler}</a>" + "     <!DOCTYPE x><log/></logs>"
        refused(xml_file(tmp_path, text), "document types and entities are refused")


def test_endless_text_is_refused(tmp_path: Path) -> None:
    text = LOG.replace("<nameWell>W", "<nameWell>" + "W" * (3 << 20))
    refused(xml_file(tmp_path, text), "more than 1,048,576 bytes without a tag")


def trajectory(stations: list[tuple[float, float, float]], angle: str = "dega") -> str:
    rows = "".join(
        f'<trajectoryStation><md uom="m">{md}</md><incl uom="{angle}">{incl}</incl><azi uom="{angle}">{azi}</azi>'
        "</trajectoryStation>"
        for md, incl, azi in stations
    )
    return f"<trajectorys {NAMESPACE}><trajectory><name>T</name>{rows}</trajectory></trajectorys>"


def test_trajectory_units_and_order(tmp_path: Path, golden: Golden) -> None:
    stations = [(0, 0, 0), (30, 0.1, 1), (60, 0.2, 1.1), (90, 0.3, 1.2), (120, 0.4, 1.3)]
    survey = hb.open(xml_file(tmp_path, trajectory(stations, "rad"))).survey()
    np.testing.assert_allclose(survey.azimuth, np.degrees([0, 1, 1.1, 1.2, 1.3]))
    with golden.raises():
        hb.open(xml_file(tmp_path, trajectory(stations))).survey()
    with golden.raises():
        hb.open(xml_file(tmp_path, trajectory(stations, ""))).survey()
    for unit in ("furlong", "m"):
        rule = f"incl is named incl, like inclination, but '{unit}' is no known unit of angle"
        with pytest.raises(ValueError, match=rf"^w.xml: no channel has the role inclination: .*{rule}"):
            hb.open(xml_file(tmp_path, trajectory(stations, unit))).survey()
    bad = [*stations[:4], (90, 40.0, 200.0)]
    with golden.raises():
        hb.open(xml_file(tmp_path, trajectory(bad))).survey()
    mixed = trajectory(stations).replace('<md uom="m">60', '<md uom="ft">60')
    refused(xml_file(tmp_path, mixed), "column md: units change between stations ('ft', 'm')")
    refused(xml_file(tmp_path, trajectory([])), "trajectory 'T': no stations")


def test_a_station_without_a_value_is_left_out_and_reported(tmp_path: Path, golden: Golden) -> None:
    stations = [(0, 0, 0), (30, 10, 100), (60, -999.25, 110), (90, 30, 120)]
    file = hb.open(xml_file(tmp_path, trajectory(stations)))
    assert len(file.survey()) == 3
    golden(file.set().remarks)


def test_empty_arrays_do_not_fill_the_memory(tmp_path: Path, golden: Golden) -> None:
    curves = [
        {"name": n, "unit": "m", "valueType": "float", "dimensions": d} for n, d in (("MD", 1), ("IMG", 100_000_000))
    ]
    log = [{"header": {"name": "w"}, "curves": curves, "data": [[1.0, None], [2.0, None]]}]
    (tmp_path / "big.json").write_text(json.dumps(log))
    with golden.raises():
        hb.open(tmp_path / "big.json")
