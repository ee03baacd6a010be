"""True dips as files: beds of known dip and azimuth on an inclined hole, read back by hb.open and by plain reading."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import helibore as hb
from helibore.logs.picks import plane

SURVEY = hb.Survey([0, 1000, 2000], [0, 40, 40], [0, 120, 120], north="grid")
TRUE = [
    ("bed", 1200.5, 12.0, 275.0, "top, of =A1"),
    ("fracture", 1250.0, 71.0, 40.0, ""),
    ("fault", 1500.0, 45.0, 359.0, ""),
]


@pytest.fixture
def picks() -> hb.Picks:
    path = SURVEY.path()
    found = hb.Picks()
    for kind, depth, dip, azimuth, note in reversed(TRUE):
        sigmas = {"dip_sigma": 0.4, "toolface_sigma": 1.5} if kind == "fracture" else {}
        found.append(hb.Pick(**{**vars(plane(kind, depth, dip, azimuth, path)), "note": note, **sigmas}))
    found.append(hb.Pick(kind="breakout", depth=1300.0, toolface=40.0, height=2.0, opening=30.0))
    found.append(hb.Pick(kind="bed", depth=2500.0, toolface=0.0, apparent_dip=20.0))  # beyond the path
    return found


def test_a_table_with_names_and_units(tmp_path: Path, picks: hb.Picks) -> None:
    assert hb.save_dips(picks, SURVEY.path(), tmp_path / "d.csv") == 3
    assert (tmp_path / "d.csv").read_text().split("\n")[:2] == [
        "MD,DIP,DIP_AZIMUTH,TYPE,NOTE,DIP_SIGMA,DIP_AZIMUTH_SIGMA",
        "m,deg,deg,,,deg,deg",
    ]
    one = hb.open(tmp_path / "d.csv").set()
    assert [one[name].unit for name in ("MD", "DIP", "DIP_AZIMUTH")] == ["m", "deg", "deg"]
    for name, at in (("MD", 1), ("DIP", 2), ("DIP_AZIMUTH", 3)):
        np.testing.assert_allclose(one.numbers(name), [row[at] for row in TRUE], atol=0.005)
    assert one["TYPE"].values.tolist() == [row[0] for row in TRUE]
    assert one["NOTE"].values[0] == "top, of =A1"
    half = next(pick for pick in picks if pick.kind == "fracture").dip_interval(SURVEY.path())
    for name, interval in zip(("DIP_SIGMA", "DIP_AZIMUTH_SIGMA"), half, strict=True):
        sigma = one.numbers(name)
        assert np.isnan(sigma).tolist() == [True, False, True], "of the others it is not known how sure they are"
        assert sigma[1] == pytest.approx(interval / 1.96, abs=0.005)


def test_the_same_between_blanks_below_comments(tmp_path: Path, picks: hb.Picks) -> None:
    assert hb.save_dips(picks, SURVEY.path(), tmp_path / "d.dip", well="A 1") == 3
    lines = (tmp_path / "d.dip").read_text().splitlines()
    assert "# WELL NAME: A 1" in lines
    assert any("FROM GRID NORTH" in line for line in lines)
    rows = [line.split(" ") for line in lines if not line.startswith("#")]
    assert {len(row) for row in rows} == {7}
    np.testing.assert_allclose(
        [[float(cell) for cell in row[:3]] for row in rows], [row[1:4] for row in TRUE], atol=0.005
    )
    one = hb.open(tmp_path / "d.dip").set()
    np.testing.assert_allclose(one.numbers("DIP"), [row[2] for row in TRUE], atol=0.005)
    assert one["TYPE"].values.tolist() == [row[0] for row in TRUE]
    assert [row[3:5] for row in rows] == [["bed", "top,_of_=A1"], ["fracture", "-"], ["fault", "-"]]


def test_nothing_is_written_without_a_true_dip(tmp_path: Path, picks: hb.Picks) -> None:
    with pytest.raises(hb.InputError, match="none is a plane with a true dip"):
        hb.save_dips(picks[-2:], SURVEY.path(), tmp_path / "d.csv")
    with pytest.raises(hb.InputError, match=r"\.csv, \.dip|\.dip"):
        hb.save_dips(picks, SURVEY.path(), tmp_path / "d.txt")
    assert list(tmp_path.iterdir()) == []
