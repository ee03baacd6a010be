"""Files that invite a wrong reading: heads that mislead, rows that look like notes, notes that look like rows.

Each opens with the values that its text states, or is refused; none opens wrong. REFUSED stands for a survey that must
not be found.
"""

from __future__ import annotations

from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_second_corpus import Entry

import helibore as hb

REFUSED = ([], [], [])
FILES: dict[str, Entry] = {}


def add(name: str, content: str, cols: Any = None, **truth: Any) -> None:
    FILES[name] = Entry(content.encode(), cols or {}, **truth)


# heads that could mislead
add("vertical_only.csv", "Vertical,,\nDepth,Incl,Azim\n0,0,0\n100.5,5.25,45.5\n", {0: [0, 100.5]}, survey=REFUSED)
add(
    "two_lines_tvd_first.csv",
    "True Vertical,Measured,Hole,Hole\nDepth (m),Depth (m),Inclination (deg),Azimuth (deg)\n"
    "0,0,0,0\n99.5,100.5,5.25,45.5\n",
    {0: [0, 99.5], 1: [0, 100.5]},
    survey=([0, 100.5], [0, 5.25], [0, 45.5]),
)
add(
    "planned_actual.csv",
    "Planned,,,Actual,,\nMD,INC,AZI,MD,INC,AZI\n0,0,0,0,0,0\n100,5,45,100.5,5.25,45.5\n",
    {3: [0, 100.5]},
    survey=REFUSED,
)
add(
    "three_line_names.csv",
    "Measured,Hole,Hole\nDepth,Incl.,Azim.\nRKB,,\nm,deg,deg\n0,0,0\n100.5,5.25,45.5\n",
    {0: [0, 100.5], 1: [0, 5.25]},
)
add(
    "title_with_numbers.csv",
    "Report 12,,,2021\nMD (m),Inc (deg),Azi (deg),DLS\n0,0,0,0\n100.5,5.25,45.5,1.5\n",
    {0: [0, 100.5]},
    survey=([0, 100.5], [0, 5.25], [0, 45.5]),
)
add(
    "key_value_titles.csv",
    "Well,A-7\nBit size,8.5\nDatum,KB\nMD (m),C1 (in),C2 (in)\n10,9.5,8.5\n11,9.25,8.25\n",
    {0: [10, 11], 1: [9.5, 9.25], 2: [8.5, 8.25]},
    rows=2,
)
add(
    "key_value_padded.csv",
    "Well,A-7,\nBit size,8.5,\nDatum,KB,\nMD (m),C1 (in),C2 (in)\n10,9.5,8.5\n11,9.25,8.25\n",
    {0: [10, 11], 1: [9.5, 9.25], 2: [8.5, 8.25]},
    rows=2,
)
add(
    "key_value_semicolon.csv",
    "Bohrung;A-7\nTeufe [m];C1 [mm];C2 [mm]\n10,5;220,5;219,5\n11,5;220,4;219,4\n",
    {0: [10.5, 11.5], 1: [220.5, 220.4]},
    rows=2,
)
add("one_row.csv", "MD (m),C1 (in),C2 (in)\n10,9.5,8.5\n", {0: [10], 1: [9.5]}, rows=1)
add("one_row_footer.csv", "MD (m),C1 (in),C2 (in)\n10,9.5,8.5\nEnd of report\n", {0: [10], 1: [9.5]}, rows=1)
add(
    "sectors_header_numbers.csv",
    "Depth,0,90,180,270\n10,110,111,112,113\n11,110,111,112,113\n",
    {0: [10, 11], 1: [110, 110]},
    rows=2,
)
add(
    "names_with_units_and_units.csv",
    "MD,CAL 1,CAL 2\n[m],[mm],[mm]\n10,220.5,219.5\n11,220.4,219.4\n",
    {0: [10, 11], 1: [220.5, 220.4]},
    units={1: "mm"},
)
add(
    "units_with_unknown.csv",
    "MD,C1,GR,DT\nm,in,gAPI,us/ft\n10,9.5,55,80\n11,9.25,56,81\n",
    {0: [10, 11], 3: [80, 81]},
    units={1: "in"},
)
add("units_all_unknown.csv", "MD,POR,SW\nfathom,frac,frac\n10,.2,.3\n11,.21,.31\n", {1: [0.2, 0.21]})
add(
    "descr_row.csv",
    "DEPT,C1\nDepth,Caliper\nm,in\n10,9.5\n11,9.25\n",
    {0: [10, 11], 1: [9.5, 9.25]},
    units={0: "m", 1: "in"},
)
add(
    "type_row.csv",
    "DEPT,C1\nm,in\nfloat,float\n10,9.5\n11,9.25\n",
    {0: [10, 11], 1: [9.5, 9.25]},
    units={0: "m", 1: "in"},
)
add("bool_column.csv", "DEPT,C1,OK\n10,9.5,TRUE\n11,9.25,FALSE\n", {0: [10, 11], 1: [9.5, 9.25]}, rows=2)
add(
    "flag_text_last.csv",
    "DEPT,C1,FLAG\n10,9.5,good\n11,9.25,bad\n12,,bad\n",
    {0: [10, 11, 12], 1: [9.5, 9.25, nan]},
    rows=3,
)
add("text_first_col_last_empty.csv", "WELL,DEPT,C1\nA-7,10,9.5\nA-7,11,9.25\nA-7,,\n", {1: [10, 11, nan]}, rows=3)
add("well_column_total.csv", "WELL,DEPT,C1\nA-7,10,9.5\nA-7,11,9.25\nTotal,21,18.75\n", {1: [10, 11]}, rows=2)
add("nan_tail.csv", "DEPT,C1,NOTE\n10,9.5,a\n11,nan,b\nnan,nan,c\n", {0: [10, 11, nan]}, rows=3)
add("null_tail.txt", "DEPT C1 NOTE\n10 9.5 a\n11 9.25 b\n- - c\n", {0: [10, 11, nan]}, rows=3)
add("cut_row.csv", "DEPT,C1,C2\n10,9.5,8.5\n11,9.2", survey=REFUSED)
add("cut_row_minus.csv", "DEPT,C1,C2\n-10,9.5,8.5\n-9,9.5,8.5\n-", survey=REFUSED)
add("cut_row_text.csv", "WELL,DEPT,C1\nA-7,10,9.5\nA-7,11,9.25\nA-", survey=REFUSED)
add("middle_text.csv", "DEPT,C1,C2\n10,9.5,8.5\nRun 2 starts here\n11,9.25,8.25\n", survey=REFUSED)
add("middle_header_other_units.csv", "DEPT,C1\nm,in\n10,9.5\nDEPT,C1\nft,mm\n11,220\n", survey=REFUSED)
add("second_table.csv", "DEPT,C1\n10,9.5\n11,9.25\n\nDEPT,GR,RT\n10,55,2\n11,56,3\n", survey=REFUSED)
add("second_table_same_width.csv", "DEPT,C1\n10,9.5\n11,9.25\n\nTOP,BASE\n1000,1010\n1010,1020\n", survey=REFUSED)
add(
    "inch_quotes.csv",
    'DEPT,C1,CASING\n10,9.5,9 5/8" casing\n11,9.25,9 5/8" casing\n',
    {0: [10, 11], 1: [9.5, 9.25]},
    rows=2,
)
add("inch_quotes_one.csv", 'DEPT,C1,CASING\n10,9.5,9 5/8" casing\n11,9.25,none\n', {0: [10, 11]}, rows=2)
add(
    "quoted_lines_three.csv",
    'DEPT,NOTE,C1\n10,"a\nb\nc",9.5\n11,"d ""x""\ne",9.25\n',
    {0: [10, 11], 2: [9.5, 9.25]},
    rows=2,
)
add("hash_null.csv", "DEPT,C1\n#N/A,9.5\n11,9.25\n", {0: [nan, 11]}, rows=2)
add("percent_col.csv", "DEPT,C1,COV\n10,9.5,50%\n11,9.25,60%\n", {0: [10, 11]}, rows=2)
add("star_names.txt", "*MD *INC *AZI\n0 0 0\n100.5 5.25 45.5\n", {0: [0, 100.5]})
add("exclamation_header.txt", "!DEPT C1 C2\n10 9.5 8.5\n11 9.25 8.25\n", {"DEPT": [10, 11]})
add("percent_header.csv", "%DEPT,C1,C2\n10,9.5,8.5\n11,9.25,8.25\n", {"DEPT": [10, 11]})
add("d_text.csv", "DEPT,ZONE\n10,1D2\n11,3D4\n", {0: [10, 11]})
add("labels_bracket.csv", "DEPT,FIG,C1\n10,(1),9.5\n11,(2),9.25\n", {0: [10, 11]})
add("bracket_some.csv", "DEPT,DIFF\n10,(1.5)\n11,2.5\n", {1: [-1.5, 2.5]})
add("en_dash.csv", "DEPT,DIFF\n10,\u20131.5\n11,2.5\n", survey=REFUSED)
add("lakh_plain_mixed.csv", 'DEPT,X\n10,"12,34,567"\n11,"1,234,567"\n', {})
add("ip_port.csv", "DEPT,V\n10,1.2.3\n11,1.2.4\n", {0: [10, 11]})
add("gon_grad.csv", "MD (m),Inc (grad),Azi (grad)\n0,0,0\n100,10,50\n", survey=REFUSED)
add("thousands_dot_ambig.csv", "MD (m);C1 (mm)\n1.234;220.5\n1.235;220.4\n", {0: [1.234, 1.235]})
add("page_footer_values.txt", "DEPT C1 C2\n10 9.5 8.5\nPage 1 of 2\n11 9.25 8.25\nPage 2 of 2\n", {0: [10, 11]}, rows=2)
add("page_column.csv", "DEPT,C1,Page 1\n10,9.5,1\n11,9.25,1\n", {0: [10, 11]}, rows=2)
add("note_with_page.csv", "DEPT,C1,NOTE\n10,9.5,see page 3\n11,9.25,see page 4\n", {0: [10, 11]}, rows=2)
add("max_row_top.csv", "DEPT,C1,C2\nMax,9.5,8.5\n10,9.5,8.5\n11,9.25,8.25\n", survey=REFUSED)
add(
    "projected_last.csv",
    "MD (m),Inc (deg),Azi (deg),Type\n0,0,0,MWD\n100.5,5.25,45.5,MWD\n110,5.5,46,Projected\n",
    {0: [0, 100.5, 110]},
    survey=([0, 100.5, 110], [0, 5.25, 5.5], [0, 45.5, 46]),
)
add(
    "bit_projection_word.csv",
    "MD (m),Inc (deg),Azi (deg)\n0,0,0\n100.5,5.25,45.5\nProjection to bit,,\n110,5.5,46\n",
    survey=REFUSED,
)
WELL = "~V\nVERS. 2.0:\nWRAP. NO:\n~W\nSTRT.M 10:\nSTOP.M 12:\nSTEP.M 1:\nNULL. -999.25:\n"
CURVES = "~C\nDEPT.M:\nC1.IN:\nC2.IN:\n"
add("las_percent_comment.las", WELL + CURVES + "~A\n% note\n10 9.5 8.5\n11 9.25 8.25\n", {0: [10, 11]})
add("las_text_col_end.las", WELL + CURVES + "ZONE.:\n~A\n10 9.5 8.5 SAND\n11 9.25 8.25 END\n", {0: [10, 11]}, rows=2)
add("las_cut.las", WELL + CURVES + "~A\n10 9.5 8.5\n11 9.25\n", survey=REFUSED)
add("las_comma_decimal_blank.las", WELL + CURVES + "~A\n10,0 9,5 8,5\n11,0 9,25 8,25\n", {0: [10, 11], 1: [9.5, 9.25]})
add("las_comma_blank_decimal.las", WELL + CURVES + "~A\n10,0, 9,5, 8,5\n11,0, 9,25, 8,25\n", survey=REFUSED)
add("las_two_a.las", WELL + CURVES + "~A\n10 9.5 8.5\n~A\n11 9.25 8.25\n", survey=REFUSED)
add("json_columns.json", '{"MD":[10,11],"C1":[9.5,null]}', {"MD": [10, 11], "C1": [9.5, nan]})
add(
    "json_split.json",
    '{"columns":["MD","C1"],"index":[0,1],"data":[[10,9.5],[11,9.25]]}',
    {"MD": [10, 11], "C1": [9.5, 9.25]},
)
add("json_nested.json", '[{"MD":10,"C":{"a":1}}]', survey=REFUSED)
add("json_pandas_default.json", '{"MD":{"0":10,"1":11},"C1":{"0":9.5,"1":9.25}}', {"MD": [10, 11], "C1": [9.5, 9.25]})
add("json_bool.json", '[{"MD":10,"OK":true},{"MD":11,"OK":false}]', {"MD": [10, 11]})
add("semicolon_comment.txt", ";DEPT C1 C2 by tool\nDEPT C1 C2\n10 9.5 8.5\n11 9.25 8.25\n", {0: [10, 11]})
add(
    "md_dot_leader.txt",
    "Depth ......: 10 m\nWell ......: A-7\n\nDEPT C1 C2\n10 9.5 8.5\n11 9.25 8.25\n",
    {"DEPT": [10, 11]},
)
add(
    "fixed_blank_cells.txt", "DEPT    C1    C2\n10.0   9.5   8.5\n11.0         8.25\n12.0   9.0   8.0\n", survey=REFUSED
)
add(
    "blank_names_units_side.txt",
    "DEPT[m] CAL[in] GR[gAPI]\n10 9.5 55\n11 9.25 56\n",
    {0: [10, 11]},
    units={0: "m", 1: "in"},
)
add("crlf_quotes.csv", '"DEPT","C1"\r\n"10","9.5"\r\n"11","9.25"\r\n', {0: [10, 11]})
add("pipe_md.txt", "| DEPT | C1 |\n|------|----|\n| 10 | 9.5 |\n| 11 | 9.25 |\n", {"DEPT": [10, 11]})
add("excel_gen_date.csv", "DEPT,DATE\n10,44197.5\n11,44197.6\n", {0: [10, 11]})


add("no_head_text.csv", "10,9.5,SAND\n11,9.25,SHALE\n", {0: [10, 11], 1: [9.5, 9.25]}, rows=2)
add("no_head_text_first.csv", "A-7,10,9.5\nA-7,11,9.25\n", {1: [10, 11], 2: [9.5, 9.25]}, rows=2)
add("no_head_dates.txt", "2021-03-04 12:00 10 9.5\n2021-03-05 12:10 11 9.25\n", {2: [10, 11]}, rows=2)
add("angles_beside_a_name.csv", "WELL,0,90,180\nA-7,110,111,112\nA-7,113,114,115\n", {1: [110, 113]}, rows=2)
add("psql.txt", " md (m) | c1\n--------+------\n   10.0 |  9.5\n   11.5 | 9.25\n(2 rows)\n", {0: [10, 11.5]}, rows=2)
add(
    "markdown.md", "| MD | C1 |\n|---:|:--|\n| 10 | 9.5 |\n| 11 | 9.25 |\n", {"MD": [10, 11], "C1": [9.5, 9.25]}, rows=2
)
add("sections.txt", "[Header]\nWell=A-7\n[Data]\nMD,C1,C2\n10,9.5,8.5\n11,9,8\n", {"MD": [10, 11]}, rows=2)
add("las_semicolons.las", WELL + CURVES + "~A\n10;9.5;8.5\n11;9.25;8.25\n", {0: [10, 11], 1: [9.5, 9.25]})
add("las_end.las", WELL + CURVES + "~A\n10 9.5 8.5\n11 9.25 8.25\n***** END *****\n", {0: [10, 11]}, rows=2)
add("las_dashes.las", WELL + CURVES + "~A\n-------\n10 9.5 8.5\n11 9.25 8.25\n", {0: [10, 11]}, rows=2)
add("pages.txt", "ACME  Page 1\nMD C1\n10 9.5\n11 9\nACME  Page 2\nMD C1\n12 9\n13 8\n", {0: [10, 11, 12, 13]}, rows=4)
add("pages_of_other_units.txt", "MD C1\nM IN\n10 9.5\n11 9\nMD C1\nFT MM\n12 220\n", survey=REFUSED)
add("below_range.csv", "MD (m),INC (deg),AZI (deg)\n0,<0.5,0\n10,1,2\n", survey=REFUSED)


@pytest.mark.parametrize("name", FILES)
def test_no_file_opens_wrong(tmp_path: Path, name: str) -> None:
    entry = FILES[name]
    path = tmp_path / name
    path.write_bytes(entry.content)
    if entry.survey == REFUSED:
        with pytest.raises(hb.InputError):
            hb.open(path).survey()
    if not entry.cols:
        return
    opened = hb.open(path)
    one = opened.set()
    for key, values in entry.cols.items():
        column = one.channels[key].name if isinstance(key, int) else key
        np.testing.assert_array_equal(one.numbers(column), values, err_msg=column)
    for key, unit in entry.units.items():
        assert (one.channels[key] if isinstance(key, int) else one[key]).unit == unit
    assert entry.rows in (None, one.rows)
    if entry.survey not in (None, REFUSED):
        survey = opened.survey()
        found = (survey.depth, survey.inclination, survey.azimuth)
        for values, wanted in zip(found, entry.survey or (), strict=True):
            np.testing.assert_allclose(values, wanted, atol=1e-9)


def test_points_beside_decimal_commas_are_named(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("MD (m);C1 (mm)\n1.234;220,5\n1.235;220,4\n")
    with pytest.raises(hb.InputError, match="option decimal"):
        hb.open(tmp_path / "t.csv").set().numbers("C1 (mm)")
    opened = hb.open(tmp_path / "t.csv", decimal=",").set()
    assert opened.numbers("C1 (mm)").tolist() == [220.5, 220.4]
    assert any("if it is a mark of thousands, write 1234" in remark for remark in opened.remarks)


def test_a_data_section_that_is_not_read_is_a_loss(tmp_path: Path) -> None:
    (tmp_path / "w.las").write_bytes(FILES["las_two_a.las"].content)
    with pytest.raises(hb.InputError, match="only a part can be read"):
        hb.open(tmp_path / "w.las", strict=True)
