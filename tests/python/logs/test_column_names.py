"""One quantity, one column: the tables of logs, zones, breakouts, passage, catalogue and picks name it alike."""

import re

import numpy as np
import pandas as pd
import polars as pl
from pyarrow import parquet

import helibore as hb
from helibore.files.log_writing import save_table
from helibore.logs.picks import COLUMNS as PICKS
from helibore.logs.picks import DIP, Pick, Picks
from helibore.logs.zones import classify
from helibore.runs.well import COLUMNS as CATALOGUE

NUMBER = re.compile(r"([A-Z_]+)(?: \((.+)\))?")
"""Heading of a column of numbers in CSV."""


def _wall():
    at = np.arange(4000)
    radius = 0.108 + 0.01 * (at > 1500) + 0.001 * np.cos(np.radians(at * 74.0))
    caliper = hb.Caliper(2000 + at * 0.001, at * 37.0 % 360, radius)
    return hb.reconstruct(caliper, bit_diameter=0.216, sectors=16, sigma=True)


def test_one_quantity_has_one_column_and_one_unit_in_all_tables():
    wall = _wall()
    logs = wall.logs(sigma=True)
    tables = {
        "logs": {of.mnemonic: of.unit for of in logs.table()},
        "zones": {of.mnemonic: of.unit for of in classify(wall, logs=logs).table()},
        "catalogue": {name: unit for name, unit, _ in CATALOGUE.values()},
        "picks": {of[1]: of[2] or "" for name in (*PICKS, *DIP) if (of := NUMBER.fullmatch(name))},
    }
    units = {}
    for name, columns in tables.items():
        for column, unit in columns.items():
            assert units.setdefault(column, unit) == unit, (name, column)
    assert {"TOP", "BOTTOM", "COVER", "AXIS", "AXISDEV"} <= tables["zones"].keys() & tables["catalogue"].keys()
    assert {"DEQ", "VOL", "EXCESS", "COVER", "DEQ_SIGMA"} <= tables["logs"].keys() & tables["catalogue"].keys()
    assert "DEPT" in tables["logs"].keys() & tables["zones"].keys() & tables["picks"].keys()


def test_each_table_opens_by_the_plain_call_of_others(tmp_path):
    wall = _wall()
    save_table(wall.zones().table(), tmp_path / "zones.csv")
    save_table(wall.zones().table(), tmp_path / "zones.parquet")
    Picks([Pick(kind="bed", depth=2001.0, toolface=10.0, apparent_dip=20.0)]).save(tmp_path / "picks.csv")
    zones = [pd.read_csv(tmp_path / "zones.csv"), pl.read_csv(tmp_path / "zones.csv")]
    assert all("TOP (m)" in frame.columns and len(frame) == len(wall.zones().zones) > 0 for frame in zones)
    assert {"TOP", "BOTTOM"} < set(pl.read_parquet(tmp_path / "zones.parquet").columns)
    assert parquet.read_schema(tmp_path / "zones.parquet").field("TOP").metadata[b"unit"] == b"m"
    for frame in (pd.read_csv(tmp_path / "picks.csv"), pl.read_csv(tmp_path / "picks.csv")):
        assert list(frame["DEPT (m)"]) == [2001.0]
