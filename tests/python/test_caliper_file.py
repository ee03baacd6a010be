"""Caliper files: units, arms, absent values, exact places of errors; the fast and the slow reader agree."""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from helibore import table_file, units
from helibore.caliper_file import read_caliper

F12 = Path(__file__).parents[3] / "shared/data/calipers/volve_F-12_2010_pfcs_xy_caliper.csv.gz"


def written(folder: Path, text: str, name: str = "c.csv") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_one_radius_a_row(tmp_path: Path) -> None:
    path = written(tmp_path, "time_s,md_m,toolface_deg,radius_mm\n0,10,350,108\n1,10.1,370,109\n")
    reading = read_caliper(path)
    caliper = reading.caliper
    assert caliper.depth.tolist() == [10.0, 10.1]
    assert caliper.toolface.tolist() == [350.0, 10.0]
    assert caliper.radius.tolist() == [0.108, 0.109]
    assert caliper.time is not None
    assert caliper.time.tolist() == [0.0, 1.0]
    assert (reading.rows, reading.dropped) == (2, {})
    assert reading.notes == (
        "CSV, comma-separated",
        "depth: md_m, unit m (column and unit assumed by name)",
        "toolface: toolface_deg, unit deg (column and unit assumed by name)",
        "time: time_s, unit s (column and unit assumed by name)",
        "radius: radius_mm, unit mm (column and unit assumed by name)",
    )


def test_diameter_without_an_angle_stands_at_the_toolface(tmp_path: Path) -> None:
    caliper = read_caliper(written(tmp_path, "md_m,tf_deg,diameter_in\n10,20,8.5\n")).caliper
    assert (caliper.toolface.tolist(), caliper.radius.tolist()) == ([20.0], [0.5 * (8.5 * 0.0254)])
    assert caliper.time is None


def test_xy_caliper_is_four_wall_points_a_row(tmp_path: Path) -> None:
    path = written(tmp_path, "MD\tRB\tX\tY\n1000\t0.5\t8\t9\n1001\t300\t10\t11\n")
    reading = read_caliper(path, depth="MD:FT", toolface="RB:deg", diameter=["X@0:IN", "Y@90:INCHES"])
    caliper = reading.caliper
    np.testing.assert_allclose(caliper.depth, np.repeat([304.8, 305.1048], 4), rtol=1e-15)
    assert caliper.toolface.tolist() == [0.5, 180.5, 90.5, 270.5, 300.0, 120.0, 30.0, 210.0]
    np.testing.assert_allclose(caliper.radius / 0.0254, [4, 4, 4.5, 4.5, 5, 5, 5.5, 5.5], rtol=1e-15)
    assert reading.notes == (
        "CSV, tab-separated",
        "depth: MD, unit ft",
        "toolface: RB, unit deg",
        "diameter: X at 0 deg, unit in",
        "diameter: Y at 90 deg, unit in",
    )


def test_radius_arms_at_angles(tmp_path: Path) -> None:
    path = written(tmp_path, "md_m;rb_deg;A;B;C\n5;300;100;200;300\n")
    caliper = read_caliper(path, radius=["A@0:mm", "B@120:mm", "C@240:mm"]).caliper
    assert caliper.toolface.tolist() == [300.0, 60.0, 180.0]
    assert caliper.radius.tolist() == [0.1, 0.2, 300 * 0.001]


def test_toolface_in_radians(tmp_path: Path) -> None:
    caliper = read_caliper(
        written(tmp_path, "md_m,tf,radius_m\n5,-1.5707963267948966,0.1\n"), toolface="tf:RAD"
    ).caliper
    assert caliper.toolface.tolist() == [270.0]


def test_absent_values_are_dropped_and_counted(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        "md_m,rb_deg,x_in,y_in\n1,10,8,9\n-999.25,10,8,9\n2,,8,9\n3,10,-9999,9\n4,10,8,nan\n5,10,,\n6,-999.250,,\n",
    )
    reading = read_caliper(path, diameter=["x_in@0", "y_in@90"])
    assert reading.rows == 7
    assert reading.dropped == {"md_m": 1, "rb_deg": 2, "x_in": 3, "y_in": 3}
    assert reading.caliper.depth.tolist() == [1, 1, 1, 1, 3, 3, 4, 4]
    assert reading.caliper.toolface.tolist() == [10, 190, 100, 280, 100, 280, 10, 190]


def test_other_absent_values(tmp_path: Path) -> None:
    path = written(tmp_path, "md_m,tf_deg,radius_m\n1,10,0\n2,10,0.1\n")
    reading = read_caliper(path, absent=[0.0])
    assert (reading.dropped, reading.caliper.depth.tolist()) == ({"radius_m": 1}, [2.0])


def test_comments_blank_lines_quotes_and_gzip(tmp_path: Path) -> None:
    path = tmp_path / "named.any"
    text = '# a comment\n\n"md_m", "tf_deg",radius_m,remark\n1,10,"0.1",good\n\n 2 , 20 ,0.1,\n'
    path.write_bytes(gzip.compress(b"\xef\xbb\xbf" + text.encode()))
    assert read_caliper(path).caliper.depth.tolist() == [1.0, 2.0]


def test_npz(tmp_path: Path) -> None:
    path = tmp_path / "c.npz"
    np.savez(path, depth=[1.0, 2.0], toolface=[10, 370], radius=np.float32([0.125, np.nan]), time=[0, 1])
    reading = read_caliper(path)
    assert reading.dropped == {"radius": 1}
    assert reading.caliper.radius.tolist() == [0.125]
    assert reading.notes[1] == "depth: depth, unit m (column and unit assumed by name)"


LENGTHS = ["m", "cm", "mm", "ft", "ftUS", "in", "0.1in"]


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(
    rows=st.lists(
        st.tuples(st.floats(-1000, 20000), st.floats(-720, 720), st.floats(1e-3, 1.9)), min_size=1, max_size=20
    ),
    length=st.sampled_from(LENGTHS),
    size=st.sampled_from(LENGTHS),
    angle=st.sampled_from(["deg", "rad"]),
)
def test_written_in_any_unit_comes_back(
    tmp_path: Path, rows: list[tuple[float, float, float]], length: str, size: str, angle: str
) -> None:
    depth, toolface, radius = np.array(rows).T
    columns = [
        depth / units.factor(length, "length"),
        toolface / units.factor(angle, "angle"),
        radius / units.factor(size, "length"),
    ]
    lines = [
        f"md_{length},tf_{angle},radius_{size}",
        *(f"{d!r},{t!r},{r!r}" for d, t, r in np.array(columns).T.tolist()),
    ]
    caliper = read_caliper(written(tmp_path, "\n".join(lines)), absent=()).caliper
    np.testing.assert_allclose(caliper.depth, depth, rtol=1e-14, atol=1e-300)
    np.testing.assert_allclose(caliper.radius, radius, rtol=1e-14)
    off = (caliper.toolface - toolface + 180) % 360 - 180
    assert np.abs(off).max() < 1e-9
    assert ((caliper.toolface >= 0) & (caliper.toolface < 360)).all()


NUMBERS = st.one_of(
    st.floats(allow_nan=True).map(repr),
    st.integers().map(str),
    st.sampled_from(
        ["", " ", " 1.5 ", "+2", ".5", "1e3", "NaN", "-inf", "1_0", "0x1", "1d3", "one", "1 2", "٣", '"4"']
    ),
)


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(cells=st.lists(st.tuples(NUMBERS, NUMBERS), min_size=1, max_size=6), end=st.sampled_from(["\n", "\r\n"]))
def test_fast_and_slow_reader_agree(tmp_path: Path, cells: list[tuple[str, str]], end: str) -> None:
    path = tmp_path / "t.csv"
    path.write_bytes(end.join(["a,b", *(f"{a},{b}" for a, b in cells)]).encode())
    table = table_file._CsvTable(path, zipped=False)
    fast = table._read_fast([1, 0])
    if fast is not None:
        slow = table._read_slowly([1, 0])
        for one, two in zip(fast, slow, strict=True):
            assert np.array_equal(one, two, equal_nan=True)


HEADER = "md_m,tf_deg,radius_m\n"


@pytest.mark.parametrize(
    ("text", "choice", "message"),
    [
        ("", {}, "is empty: must have a header line and rows"),
        ("# only\n\n", {}, "has no header line"),
        (HEADER, {}, "has no rows below its header in line 1"),
        ("md_m,md_m,radius_m\n", {}, "line 1: two columns are called md_m"),
        (
            "md_m,radius_m\n1,2\n",
            {},
            "no toolface column: none of a usual name (toolface, tf, rb); name it; the file has md_m, radius_m",
        ),
        (
            "md_m,depth_ft,tf_deg,radius_m\n1,2,3,4\n",
            {},
            "more than one depth column: md_m, depth_ft; name the one to take",
        ),
        (HEADER + "1,2,3\n", {"radius": ["cal:in"]}, "column 'cal': not in the file, which has md_m, tf_deg, radius_m"),
        ("md,tf_deg,radius_m\n1,2,3\n", {}, "column md: unit not given; write it as md:m"),
        (
            HEADER + "1,2,3\n",
            {"radius": ["radius_m:furlong"]},
            "column radius_m: unit 'furlong': not known; "
            "known are m, cm, mm, ft, ftUS, in, 0.1in, deg, rad, s, ms, min, h",
        ),
        (
            HEADER + "1,2,3\n",
            {"toolface": "tf_deg:in"},
            "column tf_deg: unit 'in': measures length, must be a unit of angle: deg, rad",
        ),
        (HEADER + "1,2,0.1\n1,x,0.1\n", {}, "column tf_deg, line 3: 'x': must be a number"),
        (HEADER + "1,2,0.1\n\n1,2\n", {}, "column radius_m, line 4: the line has 2 cells, the header has 3"),
        (HEADER + "1,2,0.1\nnan,2,0.1\n", {}, "column md_m, line 3: nan: must be finite"),
        (HEADER + "1,2,0.1\n\n-inf,2,0.1\n", {}, "column md_m, line 4: -inf: must be finite"),
        (HEADER + "1,inf,0.1\n", {}, "column tf_deg, line 2: inf: must be finite"),
        (HEADER + "1,2,0\n", {}, "column radius_m, line 2: radius 0 m: must be larger than 0 and at most 2 m"),
        (HEADER + "1,2,-3\n", {}, "column radius_m, line 2: radius -3 m: must be larger than 0 and at most 2 m"),
        (
            HEADER + ",2,99\n1,2,8.5\n",
            {"radius": ["radius_m:m"]},
            "column radius_m, line 3: radius 8.5 m: must be larger than 0 and at most 2 m",
        ),
        (
            HEADER + "1,2,0.1\n1,2,200\n",
            {"diameter": ["radius_m@90:in"]},
            "column radius_m, line 3: diameter 200 in: must be larger than 0 and at most 4 m",
        ),
        (HEADER + "1,2,inf\n", {}, "column radius_m, line 2: inf: must be finite"),
        (
            HEADER + "1,2,-999.25\n2,,0.1\n",
            {},
            "no samples: 1 of 2 rows without tf_deg, 1 of 2 rows without radius_m",
        ),
    ],
)
def test_bad_file(tmp_path: Path, text: str, choice: dict[str, Any], message: str) -> None:
    path = written(tmp_path, text)
    with pytest.raises(ValueError) as caught:  # noqa: PT011 - the whole text is compared
        read_caliper(path, **choice)
    assert str(caught.value) == f"{path}: {message}"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"md_m,tf_deg,radius_m\n1,2,\0\n", "is not text: must be CSV (.gz) or NPZ"),
        (b"md_m,tf_deg,radius_\xb5m\n1,2,3\n", "is not UTF-8 text (byte 0xb5)"),
        (b"md_m,tf_deg,radius_m,note\n1,2,0.1,\xb5\n1,2,x,\n", "is not UTF-8 text (byte 0xb5)"),
        (
            gzip.compress(b"md_m,tf_deg,radius_m\n" + b"1,2,0.1\n" * 9)[:-12],
            "is damaged: Compressed file ended before the end-of-stream marker was reached",
        ),
        (b"PK\x03\x04 no archive", "is damaged: File is not a zip file"),
    ],
)
def test_damaged_file(tmp_path: Path, content: bytes, message: str) -> None:
    path = tmp_path / "c.csv.gz"
    path.write_bytes(content)
    with pytest.raises(ValueError) as caught:  # noqa: PT011 - the whole text is compared
        read_caliper(path)
    assert str(caught.value) == f"{path}: {message}"


def test_bad_npz(tmp_path: Path) -> None:
    path = tmp_path / "c.npz"
    np.savez(path, depth=[1.0, 2.0], toolface=[1.0, 2.0], radius=[0.1, 3.0])
    with pytest.raises(ValueError, match="must be larger") as caught:
        read_caliper(path)
    assert str(caught.value) == f"{path}: radius[1]: radius 3 m: must be larger than 0 and at most 2 m"
    np.savez(path, depth=[1.0, 2.0], toolface=[1.0], radius=[0.1, 3.0])
    with pytest.raises(ValueError, match="must be equal") as caught:
        read_caliper(path)
    assert str(caught.value) == f"{path}: toolface has 1 values, depth has 2: must be equal"


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        read_caliper(tmp_path / "none.csv")


def test_f12() -> None:
    if not F12.exists():
        pytest.skip("shared data not beside the project: no Volve F-12 caliper")
    reading = read_caliper(F12, diameter=["pfc1_x_in@0", "pfc2_y_in@90"])
    assert (reading.rows, reading.dropped) == (20097, {})
    caliper = reading.caliper
    assert caliper.depth[:4].tolist() == [-7.7724] * 4
    np.testing.assert_allclose(caliper.toolface[:4], [221.527, 41.527, 311.527, 131.527], rtol=1e-15)
    np.testing.assert_allclose(caliper.radius[:4] / 0.0127, [6.36063, 6.36063, 6.38601, 6.38601], rtol=1e-15)
