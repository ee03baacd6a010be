"""Survey files: units, absent stations, exact places of errors."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helibore.survey_file import read_survey

WELL_1515 = Path(__file__).parents[3] / "shared/data/surveys/Well_1515_directional.csv"
HEADER = "md_m,incl_deg,azim_deg\n"


def written(folder: Path, text: str) -> Path:
    path = folder / "s.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_columns_of_usual_names(tmp_path: Path) -> None:
    reading = read_survey(written(tmp_path, HEADER + "0,0,0\n30,,50\n60,3,350\n"))
    assert (reading.rows, reading.dropped) == (3, {"incl_deg": 1})
    assert reading.survey.depth.tolist() == [0, 60]
    assert reading.survey.azimuth.tolist() == [0, 350]
    assert reading.notes[1] == "depth: md_m, unit m (column and unit assumed by name)"


def test_units(tmp_path: Path) -> None:
    path = written(tmp_path, "a,b,c\n0,0,0\n100,0.1,1\n")
    survey = read_survey(path, depth="a:ft", inclination="b:rad", azimuth="c:rad").survey
    np.testing.assert_allclose(survey.depth, [0, 30.48], rtol=1e-15)
    np.testing.assert_allclose(survey.inclination, np.degrees([0, 0.1]), rtol=1e-15)
    np.testing.assert_allclose(survey.azimuth, np.degrees([0, 1]), rtol=1e-15)


@pytest.mark.parametrize(
    ("text", "choice", "message"),
    [
        (HEADER + "0,0,0\n30,1,0\n30,2,0\n", {}, "column md_m, line 4: 30 m after 30 m: must increase"),
        (HEADER + "30,0,0\n\n20,1,0\n", {}, "column md_m, line 4: 20 m after 30 m: must increase"),
        (HEADER + "0,0,0\n,1,0\n-5,1,0\n", {}, "column md_m, line 4: -5 m after 0 m: must increase"),
        (HEADER + "0,0,0\n30,180.5,0\n", {}, "column incl_deg, line 3: 180.5 deg: must be in [0, 180]"),
        (HEADER + "0,-1,0\n30,1,0\n", {}, "column incl_deg, line 2: -1 deg: must be in [0, 180]"),
        (HEADER + "0,1,400\n30,1,0\n", {}, "column azim_deg, line 2: 400 deg: must be in [-360, 360]"),
        (HEADER + "0,1,nan\n30,1,0\n", {}, "column azim_deg, line 2: nan: must be finite"),
        (HEADER + "0,1,0\n", {}, "stations: 1: must be 2 or more"),
        (HEADER + "0,1,0\n", {"depth": "MD:ft"}, "column 'MD': not in the file, which has md_m, incl_deg, azim_deg"),
        (HEADER + "0,1,0\n", {"depth": "md_m:deg"},
         "column md_m: unit 'deg': measures angle, must be a unit of length: m, cm, mm, ft, ftUS, in, 0.1in"),
    ],
)  # fmt: skip
def test_bad_file(tmp_path: Path, text: str, choice: dict[str, Any], message: str) -> None:
    path = written(tmp_path, text)
    with pytest.raises(ValueError) as caught:  # noqa: PT011 - the whole text is compared
        read_survey(path, **choice)
    assert str(caught.value) == f"{path}: {message}"


def test_well_1515() -> None:
    if not WELL_1515.exists():
        pytest.skip("shared data not beside the project: no Well_1515 survey")
    survey = read_survey(WELL_1515, depth="MD:ft", inclination="Incl:deg", azimuth="Azim:deg").survey
    assert survey.depth.size == 83
    np.testing.assert_allclose(survey.depth[:3], [0, 76.2, 152.4], rtol=1e-15)
