"""Tables of tops and intervals, and Petrel's well tops, against depths that are known."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import helibore as hb
from helibore.files.well_tops import read_tops

PETREL = """# Petrel well tops
# Unit in X and Y direction: m
# Unit in depth: {unit}
VERSION 2
BEGIN HEADER
X
Y
MD
PVD auto
Type
Surface
Well
END HEADER
1 2 3190.0 -999 Horizon "Hugin" "15/9-F-12"
1 2 3105.2 -999 Horizon "Top O'Hare fm" "15/9-F-12"
1 2 3160.2 -999 Other "GOC" "15/9-F-12"
1 2 -999 -999 Horizon "Sleipner" "15/9-F-12"
1 2 900 -999 Horizon "Hugin" "15/9-F-11"
"""
FIRST = """VERSION 1
BEGIN HEADER
STRING Well
STRING Horizon Name
FLOAT MD
END HEADER
A-1 "Hugin" 3190.0
"""
TABLES = {
    "tops.csv": "Well,Surface,MD (m)\nA-1,Hugin,3190.0\nA-1,Draupne,3105.2\n",
    "intervals": "formation,top_m,base_m\nDraupne,3105.2,3190.0\nHugin,3190.0,\n",
    "semicolons": "Zone Name;Top Depth (m);Bottom Depth (m)\nDraupne;3105,2;3190,0\nHugin;3190,0;\n",
    "top and MD": "Top,MD (m),TVD (m)\nDraupne,3105.2,2900\nHugin,3190.0,2950\n",
    "tabs, feet": "Wellbore\tMarker\tMeasured Depth (ft)\nA-1\tDraupne\t10187.6640\nA-1\tHugin\t10465.8793\n",
    "titles": "Well: A-1\nField: F\nFormation,MD (m)\nDraupne,3105.2\nHugin,3190.0\n",
}


def write(folder: Path, text: str) -> Path:
    file = folder / "tops.txt"
    file.write_text(text)
    return file


@pytest.mark.parametrize("text", TABLES.values(), ids=TABLES.keys())
def test_tables_give_the_intervals_between_tops(tmp_path: Path, text: str) -> None:
    one, other = hb.read_intervals(write(tmp_path, text))
    assert (one.name, other.name) == ("Draupne", "Hugin")
    assert [one.start, one.stop, other.start] == pytest.approx([3105.2, 3190.0, 3190.0], abs=1e-3)
    assert math.isinf(other.stop)


@pytest.mark.parametrize(("unit", "metres"), [("m", 1.0), ("ft", 0.3048)])
def test_well_tops_of_petrel(tmp_path: Path, unit: str, metres: float) -> None:
    found = read_tops(write(tmp_path, PETREL.format(unit=unit)), likely="15_9-F-12")
    assert [one.name for one in found.intervals] == ["Top O'Hare fm", "Hugin"]
    assert [one.start / metres for one in found.intervals] == pytest.approx([3105.2, 3190.0])
    said = "; ".join(found.remarks)
    for part in ("names Surface, depths MD", "one of 2 wells", "1 of another Type", "1 without a depth"):
        assert part in said
    (alone,) = hb.read_intervals(write(tmp_path, FIRST), unit="m")
    assert (alone.name, alone.start) == ("Hugin", 3190.0)


@pytest.mark.parametrize(
    ("text", "setting", "part"),
    [
        ("name,MD\nA,3\nB,4\n", "intervals.unit", "no unit"),
        ("well,top,MD (m)\nA,x,3\nB,y,4\n", "intervals.well", "one of the wells of the file: A, B"),
        ("name,TVD (m)\nA,3\nB,4\n", "", "none is a measured depth"),
        ("MD (m),GR\n3,4\n4,5\n", "", "none is a name"),
        ("name,top_m,base_m\nA,4,3\nB,3,4\n", "", "interval 'A'"),
        ("BEGIN HEADER\nMD\nSurface\nEND HEADER\n3 A extra\n", "", "line 5: 3 values"),
        ("BEGIN HEADER\nMD\nSurface\n3 A\n", "", "END HEADER is missing"),
    ],
)
def test_what_cannot_be_read_names_the_reason(tmp_path: Path, text: str, setting: str, part: str) -> None:
    with pytest.raises(hb.InputError, match=r"tops\.txt") as error:
        hb.read_intervals(write(tmp_path, text))
    assert part in str(error.value)
    assert error.value.setting == setting


CASINGS = {
    "inches": "Casing,Top (m),Shoe (m),OD (in),Grade\nSurface,0,412,13 3/8,L-80\nLiner,1950,2012.5,9.625,L-80\n",
    "a unit in each cell": 'Casing,Top (m),Setting Depth (m),OD\nSurface,0,412,13 3/8"\nLiner,1950,2012.5,244.475 mm\n',
    "feet": "Section,From_ft,To_ft,OD_mm\nSurface,0,1351.706037,339.725\nLiner,6397.637795,6602.690289,244.475\n",
}


@pytest.mark.parametrize("text", CASINGS.values(), ids=CASINGS.keys())
def test_a_table_with_outer_diameters_holds_casings(tmp_path: Path, text: str) -> None:
    for found, name, start, stop, inches in zip(
        hb.read_intervals(write(tmp_path, text)), ("Surface", "Liner"), (0, 1950), (412, 2012.5), (13.375, 9.625),
        strict=True,
    ):  # fmt: skip
        assert (found.name, found.track) == (name, "Casing")
        assert [found.start, found.stop, found.diameter] == pytest.approx([start, stop, inches * 0.0254], abs=1e-5)


def test_casings_without_tops_begin_at_the_surface(tmp_path: Path) -> None:
    (one,) = hb.read_intervals(write(tmp_path, "Casing,Shoe (m),OD (in)\nSurface,412,20\n"))
    assert (one.start, one.stop) == (0.0, 412.0)


@pytest.mark.parametrize(
    ("cell", "part"),
    [("9.625 m", "9.625 m is 9.625 m"), ("9.625", "has no unit"), ("9.625 kg", "not known"), ("wide", "must be a num")],
)
def test_a_casing_whose_size_cannot_be_is_drawn_without_it_and_said(tmp_path: Path, cell: str, part: str) -> None:
    found = read_tops(write(tmp_path, f"Casing,Top (m),Shoe (m),OD\nA,0,10,20 in\nB,0,20,{cell}\n"))
    assert [one.diameter for one in found.intervals] == [pytest.approx(0.508), None]
    assert part in "; ".join(found.remarks)


def test_each_column_of_a_mud_log_is_a_track(tmp_path: Path) -> None:
    text = "From (m),To (m),Lithology,Oil_shows,ROP\n100,105,Claystone,,12\n105,110,Sandstone,fair,30\n"
    found = hb.read_intervals(write(tmp_path, text))
    assert [(one.track, one.name, one.start, one.stop) for one in found] == [
        ("Lithology", "Claystone", 100.0, 105.0),
        ("Lithology", "Sandstone", 105.0, 110.0),
        ("Oil shows", "fair", 105.0, 110.0),
    ]


def test_a_formation_with_its_lithology_is_two_tracks(tmp_path: Path) -> None:
    found = hb.read_intervals(write(tmp_path, "Formation,Top (m),Lithology\nDraupne,10,shale\nHugin,20,sand\n"))
    assert [(one.track, one.name, one.stop) for one in found] == [
        ("", "Draupne", 20.0), ("Lithology", "shale", 20.0), ("", "Hugin", math.inf), ("Lithology", "sand", math.inf),
    ]  # fmt: skip
