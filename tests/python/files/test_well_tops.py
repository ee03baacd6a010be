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
