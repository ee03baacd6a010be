"""The same table by every door: files of each format, data frames, wells of a manifest and a WITS replay give the same
samples, and the same messages where the door can say them.
"""

import json
import re
from decimal import Decimal
from pathlib import Path

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest
import xarray as xr
from pyarrow import parquet

import helibore as hb
from helibore.live.rules.configuration import parse
from helibore.runs.manifest import read_jobs
from helibore.runs.run import preparation_lines
from helibore.runs.well import reprocess_well

rng = np.random.default_rng(11)
ROWS = 240


def _table(**columns):
    """A rotating tool's rows, all well; a column is replaced, added or (None) left out."""
    at = np.arange(ROWS)
    whole = {
        "MD_m": 2000 + at * 0.01,
        "TOOLFACE_deg": at * 37.0 % 360,
        "RADIUS_mm": 108 + np.round(rng.normal(0, 1, ROWS), 3),
    }
    whole |= columns
    return {name: list(values) for name, values in whole.items() if values is not None}


def _with(values, places, by):
    """Return a copy of values in which those at the places are replaced."""
    values = list(values)
    for place in places:
        values[place] = by
    return values


GOOD = _table()
MD, TF, R = GOOD["MD_m"], GOOD["TOOLFACE_deg"], GOOD["RADIUS_mm"]
FLAWED = {
    "as it should be": GOOD,
    "feet": _table(MD_m=None, MD_ft=[of / 0.3048 for of in MD]),
    "inches": _table(RADIUS_mm=None, RADIUS_in=[of / 25.4 for of in R]),
    "radians": _table(TOOLFACE_deg=None, TOOLFACE_rad=np.radians(TF)),
    "units in brackets": {
        "MD [ft]": [of / 0.3048 for of in MD],
        "TOOLFACE (deg)": TF,
        "RADIUS [in]": [of / 25.4 for of in R],
    },
    "nulls": _table(RADIUS_mm=_with(R, range(0, ROWS, 7), -999.25)),
    "other nulls": _table(RADIUS_mm=_with(R, range(0, ROWS, 9), -9999.0), TOOLFACE_deg=_with(TF, [3, 4], -999.25)),
    "empty cells": _table(RADIUS_mm=_with(R, [1, 5, 200], None)),
    "no depth in some rows": _table(MD_m=_with(MD, [0, 17], None)),
    "repeated rows": {name: of + of[:20] for name, of in GOOD.items()},
    "upwards": {name: of[::-1] for name, of in GOOD.items()},
    "a radius of zero": _table(RADIUS_mm=_with(R, [40], 0.0)),
    "a radius that cannot be": _table(RADIUS_mm=_with(R, [40], 5000.0)),
    "a negative radius": _table(RADIUS_mm=_with(R, [41], -3.0)),
    "diameters called radius": _table(RADIUS_mm=[2 * of for of in R]),
    "no toolface": _table(TOOLFACE_deg=None),
    "no radius": _table(RADIUS_mm=None),
    "nothing but nulls": _table(RADIUS_mm=[-999.25] * ROWS),
    "X-Y": {"MD_m": MD, "RB_deg": TF, "CAL1_in": [of / 12.7 for of in R], "CAL2_in": [of / 12.6 for of in R]},
    "a passenger": _table(GR_gapi=[50.0] * ROWS, RADIUS_mm=_with(R, [8], None)),
    "a shifted clock": _table(TIME_s=[1.6e9 + of for of in range(ROWS)]),
    "no unit of radius": _table(RADIUS_mm=None, RADIUS=R),
}


def _parts(name):
    """Return a column's name and unit, which LAS and JSON keep apart."""
    found = re.fullmatch(r"(\w+?)(?: \[(\w+)\]| \((\w+)\)|_(\w+))?", name)
    return found[1], found[2] or found[3] or found[4] or ""


def _las(table, path):
    rows = zip(*table.values(), strict=True)
    curves = ["{}.{}  :".format(*_parts(name)) for name in table]
    cells = [" ".join("-999.25" if of is None else repr(float(of)) for of in row) for row in rows]
    head = ["~V", "VERS. 2.0:", "WRAP. NO:", "~W", "NULL. -999.25:", "~C", *curves, "~A"]
    path.write_text("\n".join([*head, *cells]) + "\n")


def _json(table, path):
    parts = map(_parts, table)
    curves = [{"name": name, "unit": unit or None, "valueType": "float", "dimensions": 1} for name, unit in parts]
    rows = [list(row) for row in zip(*table.values(), strict=True)]
    path.write_text(json.dumps([{"header": {"name": "log"}, "curves": curves, "data": rows}]))


def _doors(table, folder: Path):
    """Yield the name of each door and what `hb.open` takes."""
    frame = pd.DataFrame(table).astype("float64")
    frame.to_csv(folder / "t.csv", index=False)
    yield "t.csv", folder / "t.csv"
    parquet.write_table(pa.Table.from_pandas(frame, preserve_index=False), folder / "t.parquet")
    yield "t.parquet", folder / "t.parquet"
    _json(table, folder / "t.json")
    yield "t.json", folder / "t.json"
    _las(table, folder / "t.las")
    yield "t.las", folder / "t.las"
    data = xr.Dataset({name: ("row", column) for name, column in frame.items()})
    for one in (frame, frame.convert_dtypes(), pl.DataFrame(table, strict=False), pa.table(table), data, table):
        yield "data frame", one


def _neutral(text, door, names):
    for name in names:
        text = text.replace(name, _parts(name)[0])
    return re.sub(r"(line|row) [0-9]+", "place", text.replace(door, "TABLE"))


def _answer(door, given, names):
    try:
        readings = hb.open(given).readings(bit_diameter=0.216)
        made = hb.prepare(readings, bit_diameter=0.216)
    except hb.InputError as error:
        return _neutral(str(error), door, names)
    bits = [
        None if of is None else of.tobytes()
        for of in (made.caliper.depth, made.caliper.toolface, made.caliper.radius, made.caliper.time)
    ]
    return [bits, [(step, _neutral(text, door, names)) for step, text in made.report], made.counts]


@pytest.mark.parametrize("name", FLAWED)
def test_every_door_gives_the_same(name, tmp_path):
    answers = [
        (door, type(given).__name__, _answer(door, given, FLAWED[name]))
        for door, given in _doors(FLAWED[name], tmp_path)
    ]
    first = answers[0][2]
    assert {(door, kind): answer for door, kind, answer in answers if answer != first} == {}


def _bits(wall):
    """Return depth, toolface and radius of a wall's samples, in the order in which every wall keeps them."""
    samples = wall.samples
    return [of.tobytes() for of in (samples.depth, samples.toolface, samples.radius)]


@pytest.mark.parametrize("name", FLAWED)
def test_a_well_of_a_manifest_has_the_samples_and_messages_of_its_file(name, tmp_path):
    table = FLAWED[name]
    pd.DataFrame(table).astype("float64").to_csv(tmp_path / "t.csv", index=False)
    (tmp_path / "m.toml").write_text(
        f'output = "{tmp_path}/out"\noutputs = ["archive"]\n[defaults.wall]\nbit_diameter = 0.216\n'
        'sectors = 16\n[[well]]\nname = "w"\ncaliper = "t.csv"\n'
    )
    try:
        made = hb.prepare(hb.open(tmp_path / "t.csv").readings(bit_diameter=0.216), bit_diameter=0.216)
        file = [_bits(hb.reconstruct(made.caliper, bit_diameter=0.216, sectors=16)), list(made.report)]
    except hb.InputError as error:
        file = str(error)
    try:
        reprocess_well(read_jobs(tmp_path / "m.toml")[0])
        wall = hb.load(tmp_path / "out/wells/w/w.wall")
        well = [_bits(wall), preparation_lines(wall)]
    except hb.InputError as error:
        well = str(error)
    assert well == file


ITEMS = {"depth": "5010", "toolface": "5011", "radius": "5012"}
NAMED = {"MD": "depth", "TOOLFACE": "toolface", "RADIUS": "radius"}


def _columns(table):
    """Return name and unit of the columns of a table that a caliper by WITS has, by what they measure."""
    parts = {name: _parts(name) for name in table}
    return {NAMED[stem]: (name, unit) for name, (stem, unit) in parts.items() if stem in NAMED}


def _replay(table, folder):
    """Send each row of a table as a frame of WITS; return what the replay of the journal gives, and all events.

    Units are no part of the protocol, and the settings state them. A frame without an item has no value for it.
    """
    columns = _columns(table)
    rows = zip(*(table[columns[name][0]] for name in ITEMS), strict=True)
    frames = [
        [f"{item}{float(of)!r}" for item, of in zip(ITEMS.values(), row, strict=True) if of is not None] for row in rows
    ]
    units = "".join(f'{name}_unit = "{columns[name][1] or "mm"}"\n' for name in ITEMS)
    items = "".join(f'{name} = ["{item}"]\n' for name, item in ITEMS.items())
    settings = f"""
    [wall]\nbit_diameter = 0.216\nsectors = 16\nstart_depth = 2000.0
    [source.mwd]\naddress = "host"\nunits = "metric"
    [source.mwd.caliper]\n{items}{units}"""
    with hb.Live(parse(settings), folder) as live:
        events = live.receive("mwd", "".join("\r\n".join(["&&", *of, "!!", ""]) for of in frames).encode()).events
    return hb.Live.replay(folder), {event.rule: event.text for event in events}


# What a wire cannot do: refuse. A file with a radius of 5 m is wrong as a whole, and somebody can mend it before the
# wall is made. A rig goes on: the live wall leaves the sample out and reports its value. It has the samples of the file
# with the settings of preparation that leave out the same. A frame that comes twice is the sender's fault, a row that
# comes twice is perhaps the tool's: only the wire leaves it out unasked.
LEFT_OUT = {
    "repeated rows": ({"repeated": True}, "duplicate", ""),
    "a radius of zero": ({"least_radius": 0.027}, "range", "radius 0 m"),
    "a negative radius": ({"least_radius": 0.027}, "range", "radius -0.003 m"),
    "a radius that cannot be": ({"greatest_radius": 0.432}, "range", "radius 5 m"),
}
# No sample is left, or the table has no such column: a file is refused. "no unit of radius" and "diameters called
# radius" depend on what the settings of the source state in place of the header.
ONLY_FILES = ("X-Y", "no toolface", "no radius", "nothing but nulls", "no unit of radius", "diameters called radius")


@pytest.mark.parametrize("name", [name for name in FLAWED if name not in ONLY_FILES])
def test_the_replay_of_a_table_by_wits_has_the_samples_of_its_file(name, tmp_path):
    table = FLAWED[name]
    pd.DataFrame(table).astype("float64").to_csv(tmp_path / "t.csv", index=False)
    left_out, rule, value = LEFT_OUT.get(name, ({}, "", ""))
    preparation = hb.Preparation(**left_out) if left_out else None
    made = hb.prepare(hb.open(tmp_path / "t.csv").readings(bit_diameter=0.216), preparation, bit_diameter=0.216)
    live, events = _replay(table, tmp_path / "journal")
    assert _bits(live.wall) == _bits(hb.reconstruct(made.caliper, bit_diameter=0.216, sectors=16))
    missing = sum(count for why, count in made.counts.items() if why in ("no depth", "no toolface", "no radius"))
    assert live.model.counts.get("flag NULL", 0) == missing
    assert set(events) == ({rule} if rule else set())
    assert value in events.get(rule, "")


def test_wits_says_what_a_file_is_refused_for(tmp_path):
    live, _ = _replay(FLAWED["nothing but nulls"], tmp_path / "nulls")
    assert (live.wall.sample_count, live.model.counts["flag NULL"]) == (0, ROWS)
    _, events = _replay(FLAWED["diameters called radius"], tmp_path / "diameters")
    assert 'measures = "diameter"' in events["radius_scale"]
    for name in ("no toolface", "no radius"):
        items = "".join(f'{of} = ["{ITEMS[of]}"]\n' for of in _columns(FLAWED[name]))
        source = f'[source.mwd]\naddress = "host"\nunits = "metric"\n[source.mwd.caliper]\n{items}'
        with pytest.raises(hb.InputError) as caught:
            parse(f"[wall]\nbit_diameter = 0.216\nstart_depth = 2000.0\n{source}")
        assert caught.value.place.endswith(f"source.mwd.caliper.{name.removeprefix('no ')}")


def test_two_pairs_of_arms_by_wits_have_the_samples_of_the_file(tmp_path):
    table = FLAWED["X-Y"]
    pd.DataFrame(table).to_csv(tmp_path / "t.csv", index=False)
    made = hb.prepare(hb.open(tmp_path / "t.csv").readings(bit_diameter=0.216), bit_diameter=0.216)
    items = dict(zip(table, ("5010", "5011", "5012", "5013"), strict=True))
    frames = zip(*([f"{items[name]}{float(of)!r}" for of in column] for name, column in table.items()), strict=True)
    live = hb.Live(
        parse("""
    [wall]\nbit_diameter = 0.216\nsectors = 16\nstart_depth = 2000.0
    [source.mwd]\naddress = "host"\nunits = "metric"
    [source.mwd.caliper]\nmeasures = "diameter"\nradius_unit = "in"\ndepth = ["5010"]\ntoolface = ["5011"]
    radius = ["5012", "5012", "5013", "5013"]\ntoolface_offset = [0, 180, 90, 270]
    """)
    )
    live.receive("mwd", "".join("\r\n".join(["&&", *of, "!!", ""]) for of in frames).encode())
    # A file is read arm by arm, a frame holds all arms: the samples of one depth came in another order.
    wire, file = (
        sorted(zip(of.depth, of.toolface, of.radius, strict=True)) for of in (live.wall.samples, made.caliper)
    )
    assert wire == file


def test_a_data_frame_is_opened_only_if_it_is_one_with_rows():
    for given, place, rule in (
        ({}, "data frame", "has no columns with names"),
        (np.zeros((3, 2)), "data frame", "has no columns with names"),
        ({"MD": []}, "data frame", "has no rows"),
        ([1, 2], "table", "must be a data frame or a dict of columns; pandas.DataFrame(records) makes one from a list"),
        ({"MD": [1, 2], "R": [1]}, "column 'R' has 1 values, column 'MD' has 2", "must be equal"),
    ):
        with pytest.raises(hb.InputError) as caught:
            hb.open(given)
        assert (caught.value.place, caught.value.rule) == (place, rule)


def test_a_null_of_an_arrow_dictionary_is_missing():
    coded = pa.chunked_array([pa.array(of).dictionary_encode() for of in ([0.11, None], [0.12, 0.13, None])])
    table = pa.table({"MD_m": [1.0, 2.0, 3.0, 4.0, 5.0], "TF_deg": [0.0] * 5, "R_m": coded})
    expected = [0.11, np.nan, 0.12, 0.13, np.nan]
    np.testing.assert_array_equal(hb.open(table).set().numbers("R_m"), expected)
    samples = hb.Caliper.from_table(table, depth="MD_m", toolface="TF_deg", radius="R_m")
    assert samples.radius.tolist() == [0.11, 0.12, 0.13]


def test_lists_of_one_length_are_sectors_and_other_lists_are_left_out():
    image = [[1.0, 2.0, None], [4.0, 5.0, 6.0]]
    texts = [[str(of) for of in row] for row in ([1.0, 2.0, 3.0], [4.0, 5.0, 6.0])]
    of_arrays = pd.DataFrame({"MD_m": [1.0, 2.0], "IMG": list(map(np.array, [[1, 2, np.nan], [4, 5, 6]]))})
    fixed = pa.table({"MD_m": [1.0, 2.0], "IMG": pa.array(image, pa.list_(pa.float64(), 3))})
    for frame in (of_arrays, fixed, {"MD_m": [1.0, 2.0], "IMG": image}, pl.DataFrame({"MD_m": [1, 2], "IMG": image})):
        np.testing.assert_array_equal(hb.open(frame).set().numbers("IMG"), np.array(image, float))
    assert hb.open(pl.DataFrame({"MD_m": [1, 2], "IMG": texts}))["IMG"].shape == (2, 3)
    for uneven in ([[1.0], [1.0, 2.0]], [None, [1.0]], [[], [1.0]]):
        one = hb.open(pl.DataFrame({"MD_m": [1, 2], "IMG": uneven})).set()
        assert [channel.name for channel in one.channels] == ["MD_m"]
        assert [of for of in one.remarks if of.startswith("IMG: ") and of.endswith("left out")] != []


def test_cells_that_float64_cannot_hold_are_refused_by_name_or_left_out(golden):
    depth = [1.0, 2.0]
    assert hb.open({"MD_m": depth, "R_m": pd.Series([Decimal("sNaN"), Decimal("0.1")])}).set().numbers("R_m")[1] == 0.1
    huge = pd.DataFrame({"MD_m": depth * 2, "TF_deg": [0.0] * 4, "R_m": [10**400, 0.1, 0.11, 0.12]})
    with pytest.raises(hb.InputError) as caught:
        hb.prepare(hb.open(huge).readings())
    golden(caught.value.rule)
    wide = pl.DataFrame({"MD_m": depth, "R_m": pl.Series([10**30, 1], dtype=pl.Int128)})
    for frame in (wide, pd.DataFrame({"MD_m": depth, "R_m": [1j, 2j]})):
        one = hb.open(frame).set()
        assert [channel.name for channel in one.channels] == ["MD_m"]
        assert [of for of in one.remarks if of.startswith("R_m: ") and of.endswith("left out")] != []


def test_metadata_state_a_unit_before_the_name_does():
    arrow = pa.table({"MD_m": [1.0, 2.0]}, pa.schema([pa.field("MD_m", pa.float64(), metadata={"unit": "ft"})]))
    data = xr.Dataset({"MD_m": ("row", [1.0, 2.0], {"units": "ft"})})
    assert [hb.open(frame)["MD_m"].unit for frame in (arrow, data)] == ["ft", "ft"]


def test_samples_of_named_columns_have_the_units_of_the_names():
    frame = {"MD_ft": [8800.0, 8801.0], "TF (rad)": [0.0, np.pi], "CAL [in]": [4.25, 4.5]}
    names = {"depth": "MD_ft", "toolface": "TF (rad)", "radius": "CAL [in]"}
    made = hb.Caliper.from_table(frame, **names)
    assert made.depth.tolist() == [8800 * 0.3048, 8801 * 0.3048]
    assert made.radius.tolist() == [4.25 * 0.0254, 4.5 * 0.0254]
    assert made.toolface.tolist() == pytest.approx([0.0, 180.0])
    stated = hb.Caliper.from_table(frame, **names, units={"depth": "m"})  # stated before the name
    assert stated.depth.tolist() == [8800.0, 8801.0]
