"""Tables go to pandas, Polars and Arrow, and data frames become samples."""

from __future__ import annotations

import sys
from datetime import datetime
from pathlib import Path

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest
import xarray as xr

import helibore as hb

FRAME = {"MD": [100.0, 101.0, np.nan, 103.0], "TF": [0.0, 1.0, 2.0, 3.0], "R": [4.0, np.nan, 4.2, 4.3]}


@pytest.fixture(scope="module")
def wall():
    k = np.arange(900)
    radius = 0.11 + 0.002 * np.sin(k)
    depth = np.where(k < 450, k, k + 400) * 0.004  # with a gap
    return hb.reconstruct(
        hb.Caliper(depth, k * 37.0, radius, np.arange(900.0)), bit_diameter=0.216, sectors=12, max_distance=0.5
    )


def test_logs_zones_and_samples_are_arrow_with_null_for_missing(wall):
    for table in (wall.logs(), wall.zones(), wall.samples, wall.logs().by_step(0.5).table()):
        made = pa.table(table)
        assert made.column_names == [of.mnemonic for of in table.table()]
        for column in table.table():
            assert made.field(column.mnemonic).metadata == ({b"unit": column.unit.encode()} if column.unit else None)
            values = made[column.mnemonic]
            assert values.null_count == np.isnan(column.values).sum()
            assert np.array_equal(values.to_numpy(), column.values, equal_nan=True)
    logs = wall.logs()
    assert 0 < pa.table(logs)["DEQ"].null_count < len(logs)
    assert pl.DataFrame(logs)["DEQ"].mean() == pytest.approx(np.nanmean(logs.equivalent_diameter), rel=1e-12)


def test_a_slice_that_is_not_contiguous_keeps_its_values(wall):
    logs = wall.logs().between(0.5, 3.0)
    assert pl.DataFrame(logs)["DEPT"].to_list() == logs.depth.tolist()


def test_to_pandas_keeps_units_and_facts(wall):
    frame = wall.logs().to_pandas()
    assert frame["C1"].isna().sum() == np.isnan(wall.logs().c1).sum()
    assert frame.attrs["units"]["C1"] == "m"
    assert frame.attrs["facts"]["bit diameter"] == "0.216 m"
    assert wall.zones().to_pandas().columns[3] == "CLASS"


@pytest.mark.parametrize("of", ["logs", "table", "zones", "samples"])
def test_pandas_makes_no_rows_of_names_and_units(wall, of):
    table = {"logs": wall.logs(), "table": wall.logs().table(), "zones": wall.zones(), "samples": wall.samples}[of]
    with pytest.raises(hb.InputError) as error:
        pd.DataFrame(table)
    name = type(table).__name__
    assert str(error.value) == f"{name}: is not an array: to_pandas() or polars.DataFrame() make a data frame"


@pytest.mark.parametrize(("call", "library"), [("logs", "pandas"), ("wall", "xarray")])
def test_a_missing_library_names_the_extra(wall, monkeypatch, call, library):
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(hb.MissingExtraError) as error:
        wall.logs().to_pandas() if call == "logs" else wall.to_xarray()
    assert (error.value.library, error.value.extra) == (library, "tables")


def test_to_xarray_has_turns_and_sectors_and_leaves_the_incomplete_turn_missing(wall):
    made = wall.to_xarray()
    flat = {name: made[name].values.reshape(-1) for name in ("radius", "nearest", "support", "angular_gap", "depth")}
    for name in ("radius", "nearest", "support", "angular_gap"):
        assert np.array_equal(flat[name][: len(wall)], getattr(wall, name), equal_nan=True)
    assert np.isnan(flat["radius"][len(wall) :]).all()
    assert not flat["support"][len(wall) :].any()
    assert np.array_equal(flat["depth"][: len(wall)], wall.depth)
    assert np.array_equal(made["toolface"].values, wall.toolface[:12])
    assert made["radius"].attrs["units"] == "m"


@pytest.mark.parametrize("of", [dict, pd.DataFrame, pl.DataFrame, pa.table, lambda d: xr.Dataset(pd.DataFrame(d))])
def test_any_data_frame_becomes_samples_without_its_missing_rows(of):
    units = {"depth": "ft", "toolface": "rad", "radius": "in"}
    made = hb.Caliper.from_table(of(FRAME), depth="MD", toolface="TF", radius="R", units=units)
    assert made.left_out == 2
    assert made.depth.tolist() == [100 * 0.3048, 103 * 0.3048]
    assert made.toolface.tolist() == [0.0, 3 * (180 / np.pi)]
    assert made.radius.tolist() == [4 * 0.0254, 4.3 * 0.0254]
    assert made.time is None


@pytest.mark.parametrize("of", [pd.DataFrame, pl.DataFrame, pa.table, lambda d: xr.Dataset(pd.DataFrame(d))])
@pytest.mark.parametrize("ticks", ["ms", "us", "ns"])
def test_dates_are_seconds_since_1970_and_a_missing_one_is_left_out(of, ticks):
    when = np.array(["2024-01-01T00:00:00", "NaT", "2024-01-01T00:00:01.500", "2024-01-01T01:00"], f"M8[{ticks}]")
    frame = of({"DEPTH": [1.0, 2, 3, 4], "TOOLFACE": [0.0, 1, 2, 3], "RADIUS": [0.1] * 4, "WHEN": when})
    made = hb.Caliper.from_table(frame, time="WHEN")
    assert (made.time.tolist(), made.left_out) == ([1704067200.0, 1704067201.5, 1704070800.0], 1)


@pytest.mark.parametrize("of", [dict, pd.DataFrame, pl.DataFrame, pa.Table.from_pandas, pd.DataFrame.to_xarray])
def test_dates_with_a_time_zone_are_seconds_since_1970(of):
    when = pd.date_range("2024-01-01T01:00", periods=3, freq="h", tz="Europe/Oslo")
    frame = pd.DataFrame({"DEPTH": [1.0, 2, 3], "TOOLFACE": [0.0, 1, 2], "RADIUS": [0.1] * 3, "WHEN": when})
    frame.loc[1, "WHEN"] = pd.NaT
    made = hb.Caliper.from_table(of(frame), time="WHEN")
    assert (made.time.tolist(), made.left_out) == ([1704067200.0, 1704074400.0], 1)


@pytest.mark.parametrize("of", [dict, pd.DataFrame, pl.DataFrame, pa.table, lambda d: xr.Dataset(pd.DataFrame(d))])
def test_any_data_frame_becomes_a_survey_without_its_missing_rows(of, golden):
    frame = of({"MD": [0.0, 1000, 2000, 3000], "INC": [0.0, 20, np.nan, 30], "AZI": [0.0, 45, 50, -9999]})
    names = {"depth": "MD", "inclination": "INC", "azimuth": "AZI"}
    made = hb.Survey.from_table(frame, **names, units={"depth": "ft"})
    assert (made.depth.tolist(), made.left_out) == ([0.0, 304.8], 2)
    assert (made.inclination.tolist(), made.azimuth.tolist()) == ([0.0, 20.0], [0.0, 45.0])
    assert "2 of the table" in made._repr_html_()
    with golden.raises():
        hb.Survey.from_table(frame)


def test_a_column_that_is_the_index_is_refused_with_the_way_out(golden):
    frame = pd.DataFrame(FRAME).set_index("MD")
    with golden.raises():
        hb.Caliper.from_table(frame, depth="MD", toolface="TF", radius="R")


def test_columns_of_one_name_are_refused_by_name(golden):
    columns = [[1.0], [0.0], [0.1], [0.1]]
    names = ["DEPTH", "TOOLFACE", "RADIUS", "RADIUS"]
    for frame in (pd.DataFrame(np.transpose(columns), columns=names), pa.table(columns, names=names)):
        with golden.raises():
            hb.Caliper.from_table(frame)


def test_numbers_that_logs_write_for_no_value_are_missing():
    frame = {"DEPTH": [1, 2, 3, 4], "TOOLFACE": [0, -9999, 20, 30], "RADIUS": [4.3, 4.3, -999.25, 4.3]}
    made = hb.Caliper.from_table(pd.DataFrame(frame), units={"radius": "in"})
    assert (made.depth.tolist(), made.left_out) == ([1.0, 4.0], 2)


@pytest.mark.parametrize(("column", "fill"), [("R", 0.3), ("TF", 45.0), ("T", 5.0)])
def test_a_masked_value_is_missing_whatever_lies_under_the_mask(column, fill):
    frame: dict[str, object] = {"MD": [1.0, 2.0, 3.0], "TF": [0, 10, 20], "R": [0.1] * 3, "T": [1.0, 2.0, 3.0]}
    frame[column] = np.ma.masked_array([0.1, fill, 0.1], mask=[False, True, False])
    made = hb.Caliper.from_table(frame, depth="MD", toolface="TF", radius="R", time="T")
    assert (made.depth.tolist(), made.left_out) == ([1.0, 3.0], 1)


def test_a_masked_date_is_missing():
    dates = np.ma.masked_array(np.arange(3).astype("M8[s]"), mask=[True, False, False])
    frame = {"DEPTH": [1.0, 2.0, 3.0], "TOOLFACE": [0, 10, 20], "RADIUS": [0.1] * 3, "T": dates}
    assert hb.Caliper.from_table(frame, time="T").time.tolist() == [1.0, 2.0]


def test_null_of_integers_is_missing():
    frame = pl.DataFrame({"DEPTH": [1, 2, 3], "TOOLFACE": [0, None, 20], "RADIUS": [0.1, 0.1, 0.1], "T": [5, 6, 7]})
    made = hb.Caliper.from_table(frame, time="T")
    assert (len(made), made.left_out, made.time.tolist()) == (2, 1, [5.0, 7.0])


def test_samples_go_round_by_a_data_frame(wall):
    made = hb.Caliper.from_table(pl.DataFrame(wall.samples), time="TIME")
    again = hb.reconstruct(made, bit_diameter=0.216, sectors=12, max_distance=0.5)
    assert again.radius.tobytes() == wall.radius.tobytes()


@pytest.mark.parametrize(
    ("change", "options"),
    [
        ({}, {"radius": "CAL"}),
        ({"R": ["a", "b", "c", "d"]}, {}),
        ({"R": [np.nan] * 4}, {}),
        ({}, {"units": {"R": "in"}}),
        ({}, {"units": {"radius": "deg"}}),
        ({"R": [4.0] * 4}, {}),
        ({"R": [0.1, 0.1, 0.1, 4.0]}, {}),
        ({"R": [4.0, np.nan, 4.2, -999]}, {"units": {"radius": "in"}}),
        ({"TF": [0, 1, 2]}, {}),
        ({"TF": 0.0}, {}),
        ({"R": [[0.1, np.nan]] * 4}, {}),
        ({"R": np.arange(4).astype("M8[s]")}, {}),
        ({"T": np.arange(4).astype("m8[s]")}, {"time": "T"}),
        ({"T": np.arange(4).astype("M8[s]")}, {"time": "T", "units": {"time": "s"}}),
        ({"T": [*map(datetime.fromisoformat, ("2024-01-01", "2024-01-01T00:00Z"))] * 2}, {"time": "T"}),
        ({"T": [datetime(2024, 1, 1), "2024-01-01"] * 2}, {"time": "T"}),
        ({"T": [None, datetime(2024, 1, 1), 7.0, None]}, {"time": "T"}),
    ],
)  # fmt: skip
def test_a_bad_table_is_refused(change, options, golden):
    with golden.raises():
        hb.Caliper.from_table(FRAME | change, **{"depth": "MD", "toolface": "TF", "radius": "R"} | options)


def test_diameters_in_the_place_of_radii_are_refused():
    """An 8.5 in hole; the radii of a 17.5 in hole are as large, and stay."""
    frame = {"DEPTH": np.arange(9.0), "TOOLFACE": np.arange(9.0), "RADIUS": np.full(9, 8.52)}
    with pytest.raises(hb.InputError) as error:
        hb.Caliper.from_table(frame, units={"radius": "in"})
    rule = "looks like a diameter, where a radius is expected; halve it, or use hb.Caliper, which accepts it"
    assert str(error.value) == f"column 'RADIUS': median = 0.216 m: {rule}"
    frame["RADIUS"] = np.full(9, 8.75)
    assert len(hb.Caliper.from_table(frame, units={"radius": "in"})) == 9


@pytest.mark.parametrize(
    ("place", "call"),
    [
        ("samples", lambda frame: hb.reconstruct(frame, bit_diameter=0.2)),
        ("caliper", lambda frame: hb.tune(frame, bit_diameter=0.2)),
        ("readings", hb.prepare),
        ("wall", hb.view),
    ],
)
def test_a_data_frame_for_samples_is_an_error_that_names_from_table(place, call):
    with pytest.raises(hb.InputError) as error:
        call(pd.DataFrame(FRAME))
    assert (error.value.place, error.value.value) == (place, "DataFrame")
    assert "hb.open(frame).caliper()" in error.value.rule


def test_diameters_of_few_arms_are_those_of_a_file(tmp_path: Path) -> None:
    k = np.arange(300)
    x, y = 8.5 + 0.1 * np.sin(k / 9), 8.6 + 0.1 * np.cos(k / 7)
    y[20] = -999.25
    frame = {"md_m": 100 + 0.05 * k, "rb_deg": k * 0.1, "cal_x_in": x, "cal_y_in": y}
    np.savetxt(tmp_path / "xy.csv", np.column_stack([*frame.values()]), delimiter=",", header=",".join(frame),
               comments="")  # fmt: skip
    places = {"depth": "md_m", "toolface": "rb_deg"}
    diameters, units = {"cal_x_in": 0, "cal_y_in": 90}, {"diameter": "in"}
    caliper = hb.Caliper.from_table(frame, **places, diameters=diameters, units=units)
    assert (len(caliper), caliper.left_out) == (4 * 300 - 2, 1)
    by_name = hb.Caliper.from_table(frame, **places, diameters=diameters)  # the names of the columns state the unit
    assert by_name.radius.tobytes() == caliper.radius.tobytes()
    wall = hb.reconstruct(caliper, bit_diameter=0.2)
    of_file = hb.reconstruct(hb.open(tmp_path / "xy.csv").readings(), bit_diameter=0.2)
    np.testing.assert_allclose(wall.radius, of_file.radius, atol=1e-12)
    np.testing.assert_allclose(wall.logs().c1, of_file.logs().c1, atol=1e-12)
    assert len(wall.logs().arm_diameter) == 2
    for more, text in (
        ({"diameters": {"cal": 0}}, "column 'cal': median = 8.5"),
        ({"diameters": {}}, "diameters = {}: must be the angle of the arms by column, degrees: {"),
        ({"diameters": ["cal_x_in"]}, "diameters = ['cal_x_in']: must be the angle of the arms by column"),
        ({"diameters": {"cal_x_in": "0"}}, "diameters['cal_x_in'] = '0': must be finite degrees"),
        ({"diameters": diameters, "radius": "R"}, "diameters: must not be given together with radius or arm"),
        ({"diameters": {"z": 0}}, "column 'z': is not in the table (diameter)"),
    ):  # fmt: skip
        with pytest.raises(hb.InputError) as caught:
            hb.Caliper.from_table(frame | {"cal": x}, **places, **more)
        assert str(caught.value).startswith(text)


@pytest.mark.parametrize(
    ("table", "options", "place"),
    [
        (pl.LazyFrame(FRAME), {},
         "table"),
        (pa.table(FRAME).to_reader(), {},
         "table"),
        ([{"MD": 1.0}], {}, "table"),
        (pd.DataFrame(FRAME, index=[4.0, 5.0, 6.0, 7.0]), {"depth": "md_m"},
         "column 'md_m'"),
        (pd.DataFrame(FRAME), {"depth": "md_m"}, "column 'md_m'"),
        ("well.csv", {}, "table"),
        (None, {}, "table"),
        (FRAME, {"depth": None}, "depth"),
    ],
)  # fmt: skip
def test_what_is_no_data_frame_is_refused_with_the_way_out(table, options, place, golden):
    with golden.raises(place):
        hb.Caliper.from_table(table, **{"depth": "MD", "toolface": "TF", "radius": "R"} | options)


def test_a_relation_of_duckdb_is_refused_with_the_way_out():
    relation = pytest.importorskip("duckdb").sql("select 1.0 as MD")
    with pytest.raises(hb.InputError, match=r"must be a data frame or a dict of columns; its df\(\) is a data frame$"):
        hb.Caliper.from_table(relation, depth="MD")


@pytest.mark.parametrize("column", ["cal_x_in", "cal_y_in"])
def test_an_error_about_a_table_has_its_column_row_and_value(column, golden):
    k = np.arange(30.0)
    frame = {"DEPTH": 100 + k, "TOOLFACE": k, "cal_x_in": np.full(30, 8.5), "cal_y_in": np.full(30, 8.6)}
    frame["TOOLFACE"][3] = frame["cal_x_in"][7] = np.nan
    frame[column][20] = -999
    with pytest.raises(hb.InputError) as error:
        hb.Caliper.from_table(frame, diameters={"cal_x_in": 0, "cal_y_in": 90}, units={"diameter": "in"})
    assert (error.value.place, error.value.value) == (f"{column}[20]", "-999 in")
    golden(error.value.rule)


def test_an_error_about_a_survey_has_the_rows_and_values_of_its_table(golden):
    frame = {"MD": [0.0, np.nan, 1000, 900], "INC": [0.0, 0, 10, 20], "AZI": [0.0, 0, 0, 0]}
    with golden.raises():
        hb.Survey.from_table(frame, depth="MD", inclination="INC", azimuth="AZI", units={"depth": "ft"})


def test_rows_with_a_missing_value_count_once():
    frame = {"DEPTH": np.arange(20.0), "TOOLFACE": np.arange(20.0), "X": np.full(20, 0.2), "Y": np.full(20, 0.2)}
    frame["TOOLFACE"][:2] = frame["X"][5:10] = frame["Y"][8:12] = np.nan
    made = hb.Caliper.from_table(frame, diameters={"X": 0, "Y": 90})
    assert (len(made), made.left_out) == (2 * (20 - 7) + 2 * (20 - 6), 2 + 7)
