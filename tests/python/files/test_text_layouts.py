"""Rules for the layout of texts: those of helibore, and a file of the user that comes first."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from golden_texts import Golden

import helibore as hb

REPORT = """Survey Report - Geographic
Measured                       Vertical
  Depth     Incl.     Azim.     Depth    Northings
  (ft)      (deg)     (deg)     (ft)       (ft)

    0.00     0.00      0.00      0.00      0.00 N
 1000.50     5.25     45.50    999.10     12.30 N
"""
"""A report whose northings have a letter, so that rows have more cells than names."""

RULES = """
[[layouts]]
name = "report of our contractor"
line = '^Survey Report'
names = ["MD", "INC", "AZI", "TVD", "NORTH", "SIDE"]
units = ["ft", "deg", "deg", "ft", "ft", ""]
rows_after = '^\\s*\\(ft\\)'
delimiter = "blanks"
"""


def rules(folder: Path, text: str) -> Path:
    path = folder / "rules.toml"
    path.write_text(text)
    return path


def test_a_layout_of_the_user(tmp_path: Path) -> None:
    path = tmp_path / "report.txt"
    path.write_text(REPORT)
    with pytest.raises(hb.InputError, match=r"reading\.layouts"):
        hb.open(path)
    opened = hb.open(path, layouts=rules(tmp_path, RULES))
    survey = opened.survey()
    np.testing.assert_allclose(survey.depth, [0, 1000.5 * 0.3048])
    np.testing.assert_array_equal(survey.inclination, [0, 5.25])
    np.testing.assert_array_equal(survey.azimuth, [0, 45.5])
    assert "read by the layout 'report of our contractor'" in opened.set().remarks


def test_a_project_names_the_rules_relative_to_itself(tmp_path: Path) -> None:
    (tmp_path / "w.csv").write_text("@@ export of our program\nMD (m),C1 (mm),RB (deg)\n" +
                                    "".join(f"{10 + at / 10},200,{40 * at % 360}\n" for at in range(60)) +
                                    "Ende der Datei 17,1,2\n")  # fmt: skip
    rules(tmp_path, 'comments = ["@@"]\nfooters = ["ende"]\n')
    (tmp_path / "well.toml").write_text(
        "caliper = 'w.csv'\n[reading]\nlayouts = 'rules.toml'\n[wall]\nbit_diameter = '200mm'\n"
        "[columns]\ndepth = 'MD (m)'\ntoolface = 'RB (deg)'\ndiameter = ['C1 (mm)@0']\n"
    )
    np.testing.assert_allclose(hb.reconstruct(tmp_path / "well.toml").radius, 0.1, atol=1e-12)


@pytest.mark.parametrize(
    "text",
    ["comment = ['#']\n", "comments = '#'\n", "[[layouts]]\nname = 'a'\n", "[[layouts]]\nname = 'a'\nline = '('\n",
     "[[layouts]]\nname = 'a'\nline = 'b'\nnames = ['MD']\nunits = ['m', 'm']\n", "never_rows = ['(']\n", "a = \n",
     "[[layouts]]\nname = 'a'\nline = 'b'\n", "[[units]]\ncomment = 'm'\ncolumns = ['MD']\n",
     "[[layouts]]\nname = 'a'\nline = 'b'\nnames = ['MD']\ndelimiter = ':'\n"],
)  # fmt: skip
def test_rules_that_break_a_rule_are_refused(tmp_path: Path, text: str, golden: Golden) -> None:
    (tmp_path / "w.csv").write_text("MD,C1\n1,2\n")
    with golden.raises():
        hb.open(tmp_path / "w.csv", layouts=rules(tmp_path, text))
