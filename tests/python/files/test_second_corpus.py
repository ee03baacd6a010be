"""A second corpus of files: heads in two lines, cells over several lines, footers, pages, and numbers of many programs.

It was written before the readers knew these layouts. The truth of an entry is what its text says: values by position
or name of a column, units, the count of rows, and the survey in metres and degrees.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import helibore as hb

FT = 0.3048
MD, INC, AZI = [0.0, 100.5, 200.25], [0.0, 5.25, 10.5], [0.0, 45.5, 46.25]
REFUSED = ([], [], [])


@dataclass
class Entry:
    """A file of the corpus: its content and its truth."""

    content: bytes
    cols: dict[int | str, list[float]] = field(default_factory=dict)
    survey: tuple[list[float], list[float], list[float]] | None = None
    units: dict[int | str, str] = field(default_factory=dict)
    rows: int | None = None


FILES: dict[str, Entry] = {}


def add(name: str, content: str | bytes, cols: Any = None, **truth: Any) -> None:
    FILES[name] = Entry(content if isinstance(content, bytes) else content.encode(), cols or {}, **truth)


# --- Excel, four locales and more
add(
    "excel_us_two_heads.csv",
    "Well A-7,,,\nSurvey,,,Calc\nMD,Inc,Azi,TVD\n(ft),(deg),(deg),(ft)\n0,0,0,0\n1000.5,5.25,45.5,999\n",
    {0: [0, 1000.5], 1: [0, 5.25], 2: [0, 45.5], 3: [0, 999]},
    survey=([0, 1000.5 * FT], [0, 5.25], [0, 45.5]),
)
add(
    "excel_two_line_names.csv",
    "Measured,Hole,Hole\nDepth,Deviation,Azimuth\nm,deg,deg\n0,0,0\n100.5,5.25,45.5\n",
    {0: [0, 100.5], 1: [0, 5.25], 2: [0, 45.5]},
    survey=([0, 100.5], [0, 5.25], [0, 45.5]),
)
add(
    "excel_two_line_names_units.csv",
    "Measured;Hole;Hole\nDepth (m);Deviation (deg);Azimuth (deg)\n0;0;0\n100,5;5,25;45,5\n",
    {0: [0, 100.5], 1: [0, 5.25], 2: [0, 45.5]},
    survey=([0, 100.5], [0, 5.25], [0, 45.5]),
)
add(
    "excel_de_newline_in_cell.csv",
    '"Teufe\n[m]";"Neigung\n[°]";"Azimut\n[°]"\r\n0,00;0,00;0,00\r\n100,50;5,25;45,50\r\n',
    {0: [0, 100.5], 1: [0, 5.25], 2: [0, 45.5]},
    survey=([0, 100.5], [0, 5.25], [0, 45.5]),
)
add(
    "excel_us_newline_in_cell.csv",
    'MD (m),Inc (deg),Azi (deg),Remark\r\n0,0,0,"tied on\nto surface"\r\n100.5,5.25,45.5,\r\n'
    '200.25,10.5,46.25,"ok, last"\r\n',
    {0: MD, 1: INC, 2: AZI},
    survey=(MD, INC, AZI),
)
add(
    "excel_fr_nbsp.csv",
    "Profondeur (m);Inclinaison (°);Azimut (°)\n0,00;0,00;0,00\n1\u00a0000,50;5,25;45,50\n".encode("cp1252"),
    {0: [0, 1000.5], 1: [0, 5.25], 2: [0, 45.5]},
    survey=([0, 1000.5], [0, 5.25], [0, 45.5]),
)
add(
    "excel_no_minus.csv",
    "MD (m);Inc (deg);Azi (deg);N (m)\n0,0;0,0;0,0;0,0\n100,5;5,25;45,5;−12,5\n",
    {3: [0, -12.5]},
    survey=([0, 100.5], [0, 5.25], [0, 45.5]),
)
add(
    "excel_br_points.csv",
    "MD (m);Inc (deg);Azi (deg)\n999,5;5,25;45,5\n1.000,5;5,5;45,25\n",
    {0: [999.5, 1000.5]},
    survey=([999.5, 1000.5], [5.25, 5.5], [45.5, 45.25]),
)
add(
    "excel_in_lakh.csv",
    'MD (ft),Easting (m)\n"1,000.50","12,34,567.25"\n"2,000.50","12,34,568.25"\n',
    {0: [1000.5, 2000.5], 1: [1234567.25, 1234568.25]},
)
add(
    "excel_accounting.csv",
    "MD (m),C1 (in),SHIFT (m)\n1500.25,9.5,(12.50)\n1500.75,9.25,3.25\n",
    {0: [1500.25, 1500.75], 2: [-12.5, 3.25]},
)
add(
    "excel_percent.csv",
    "MD (m),C1 (in),COVER\n1500.25,9.5,12.5%\n1500.75,9.25,100%\n",
    {0: [1500.25, 1500.75], 1: [9.5, 9.25]},
)
add(
    "excel_footer_average.csv",
    "MD (m),C1 (in),RB (deg)\n1500.25,9.5,0\n1500.75,9.25,120.5\nAverage,9.375,60.25\n",
    {0: [1500.25, 1500.75], 1: [9.5, 9.25]},
    rows=2,
)
add(
    "excel_footer_text.csv",
    "MD (m),C1 (in),RB (deg)\n1500.25,9.5,0\n1500.75,9.25,120.5\n\nPrepared by J. Smith\n",
    {0: [1500.25, 1500.75], 1: [9.5, 9.25]},
    rows=2,
)
add(
    "excel_footer_commas.csv",
    "MD (m),C1 (in),RB (deg)\n1500.25,9.5,0\n1500.75,9.25,120.5\n,,\n,,\n",
    {0: [1500.25, 1500.75, nan, nan], 1: [9.5, 9.25, nan, nan]},
)
add(
    "excel_footer_note_commas.csv",
    "MD (m),C1 (in),RB (deg)\n1500.25,9.5,0\n1500.75,9.25,120.5\n,,\nNote: bit size 8.5 in,,\n",
    {0: [1500.25, 1500.75], 1: [9.5, 9.25]},
)
add(
    "excel_gap_rows.csv",
    "MD (m),C1 (in),RB (deg)\n1500.25,9.5,0\n,,\n1500.75,9.25,120.5\n",
    {0: [1500.25, nan, 1500.75]},
)
add(
    "excel_from_column_b.csv",
    ",,,\n,MD (m),Inc (deg),Azi (deg)\n,0,0,0\n,100.5,5.25,45.5\n",
    survey=([0, 100.5], [0, 5.25], [0, 45.5]),
)
add(
    "excel_trailing_tabs.txt",
    "MD (m)\tC1 (in)\tRB (deg)\t\t\n1500.25\t9.5\t0\t\t\n1500.75\t9.25\t120.5\t\t\n".encode("utf-16"),
    {0: [1500.25, 1500.75], 1: [9.5, 9.25]},
)
add(
    "excel_date_us.csv",
    "Date,Time,MD (m),C1 (in)\n3/14/2021,2:05:00 PM,1500.25,9.5\n3/14/2021,2:05:10 PM,1500.75,9.25\n",
    {2: [1500.25, 1500.75], 3: [9.5, 9.25]},
)
add(
    "excel_group_row_merged.csv",
    ",Caliper,,Survey,\nDepth,CALX,CALY,INC,AZI\nm,in,in,deg,deg\n0,9.5,8.5,0,0\n100.5,9.25,8.25,5.25,45.5\n",
    {0: [0, 100.5], 1: [9.5, 9.25], 2: [8.5, 8.25]},
    survey=([0, 100.5], [0, 5.25], [0, 45.5]),
)
# --- Petrel
add(
    "petrel_trace_full.dev",
    "# WELL TRACE FROM PETREL \n# WELL NAME:              A-7\n# DEFINITIVE SURVEY:      run 2\n"
    "# WELL HEAD X-COORDINATE: 456979.06370000 (m)\n# WELL HEAD Y-COORDINATE: 6782712.41230000 (m)\n"
    "# WELL DATUM (KB, Kelly bushing, from MSL): 54.90000000 (m)\n# WELL TYPE:              OIL\n"
    "# MD AND TVD ARE REFERENCED (=0) AT WELL DATUM AND INCREASE DOWNWARDS\n"
    "# ANGLES ARE GIVEN IN DEGREES\n# XYZ TRACE IS GIVEN IN COORDINATE SYSTEM WGS84\n"
    "# AZIMUTH REFERENCE TRUE NORTH\n# DX DY ARE GIVEN IN GRID NORTH IN m-UNITS\n"
    "# DEPTH (Z, TVD) GIVEN IN m-UNITS\n"
    "#======================================================================\n"
    "      MD              X              Y             Z           TVD           DX           DY        "
    " AZIM_TN       INCL         DLS         AZIM_GN\n"
    "#======================================================================\n"
    " 0.0000000000 456979.06 6782712.41 54.9 0.0 0.0 0.0 0.0 0.0 0.0 358.5\n"
    " 100.5 456979.2 6782712.6 -45.5 100.4 0.1 0.2 45.5 5.25 1.57 44.0\n"
    " 200.25 456985.2 6782718.6 -144.5 199.4 6.1 6.2 46.25 10.5 1.57 44.75\n",
    survey=(MD, INC, AZI),
)
add(
    "petrel_survey.txt",
    "# Deviation survey from Petrel\nMD INCL AZIM\n0 0 0\n100.5 5.25 45.5\n200.25 10.5 46.25\n",
    {0: MD, 1: INC, 2: AZI},
)
add(
    "petrel_quoted.txt",
    'BEGIN HEADER\nMD\nC1\nType\nEND HEADER\n1500.25 9.5 "Horizon one"\n1500.75 9.25 "Other"\n',
    {0: [1500.25, 1500.75], 1: [9.5, 9.25]},
)
# --- Techlog
add(
    "techlog_ascii.txt",
    "WELL\tDataset\tMD\tC1\tRB\n\t\tm\tin\tdega\nA-7\tCAL\t1500.25\t9.5\t0\nA-7\tCAL\t1500.75\t9.25\t120.5\n",
    {2: [1500.25, 1500.75], 3: [9.5, 9.25]},
    units={2: "m", 3: "in"},
)
add(
    "techlog_family.csv",
    "MD,C1,RB\nm,in,dega\nMeasured Depth,Caliper,Relative Bearing\n1500.25,9.5,0\n1500.75,9.25,120.5\n"
    "1501.5,-9999,359\n",
    {0: [1500.25, 1500.75, 1501.5], 1: [9.5, 9.25, nan]},
    units={0: "m", 1: "in"},
)
add(
    "techlog_missing.csv",
    "MD,C1,RB\nm,in,dega\n1500.25,9.5,0\n1500.75,-9999,120.5\n",
    {0: [1500.25, 1500.75], 1: [9.5, nan]},
)
# --- Landmark, Compass
add(
    "compass_three_heads.txt",
    "Survey Report - Geographic\nCompany: ACME\nWell:    A-7\n\nMeasured                       Vertical\n"
    "  Depth     Incl.     Azim.     Depth    Northings\n"
    "  (ft)      (deg)     (deg)     (ft)       (ft)\n\n"
    "    0.00     0.00      0.00      0.00      0.00 N\n"
    " 1000.50     5.25     45.50    999.10     12.30 N\n",
    {0: [0, 1000.5], 1: [0, 5.25], 2: [0, 45.5]},
    survey=([0, 1000.5 * FT], [0, 5.25], [0, 45.5]),
)
add(
    "compass_two_heads.txt",
    "Company: ACME\n\nMeasured                       Vertical\n  Depth     Incl.     Azim.     Depth\n"
    "  (ft)      (deg)     (deg)     (ft)\n\n    0.00     0.00      0.00      0.00\n"
    " 1000.50     5.25     45.50    999.10\n",
    {0: [0, 1000.5], 1: [0, 5.25], 2: [0, 45.5]},
    survey=([0, 1000.5 * FT], [0, 5.25], [0, 45.5]),
)
add(
    "compass_pages.txt",
    "Company: ACME\nMD      Inc     Azi     TVD\n(usft)  (°)     (°)     (usft)\n0.00  0.00  0.00  0.00\n"
    "1,000.50  5.25  45.50  999.10\n\f\nCompany: ACME\nMD      Inc     Azi     TVD\n"
    "(usft)  (°)     (°)     (usft)\n2,000.50  10.50  46.25  1,980.10\n\n"
    "COMPASS 5000.1 Build 81   Page 2\n",
    {0: [0, 1000.5, 2000.5]},
    rows=3,
)
add(
    "landmark_footer.txt",
    "! OpenWorks export\n    MD      C1     RB\n   (M)    (IN)   (DEG)\n1500.25 9.5 0\n"
    "1500.75 9.25 120.5\n! end of data\n",
    {0: [1500.25, 1500.75], 1: [9.5, 9.25]},
    rows=2,
)
add(
    "driller_words.csv",
    "Station,Depth,Inc,Azi,Comment\n,ft,deg,deg,\n1,0,0,0,Tie-on\n2,1000.5,5.25,45.5,MWD\n",
    survey=([0, 1000.5 * FT], [0, 5.25], [0, 45.5]),
)
# --- IP, Geolog
add(
    "ip_ascii.txt",
    "Well Name :  A-7\nDepth Units : M\n\n   DEPTH        C1          C2\n"
    "  Metres      Inches      Inches\n 1500.2500      9.5000      8.5000\n"
    " 1500.7500      9.2500   -999.0000\n",
    {0: [1500.25, 1500.75], 1: [9.5, 9.25]},
    units={0: "metres"},
)
add(
    "geolog_dat.txt",
    "* Geolog export\n* WELL A-7\nDEPTH C1 C2\nMETRES IN IN\n1500.25 9.5 8.5\n1500.75 9.25 -999.25\n",
    {0: [1500.25, 1500.75], 1: [9.5, 9.25], 2: [8.5, nan]},
)
add(
    "geolog_units_second.csv",
    "DEPTH,C1,C2\nMETRES,INCHES,INCHES\n1500.25,9.5,8.5\n1500.75,9.25,-9999\n",
    {0: [1500.25, 1500.75], 1: [9.5, 9.25], 2: [8.5, nan]},
)
add(
    "percent_comments.txt",
    "% MATLAB export\n% well A-7\nDEPT\tC1\tC2\n1500.25\t9.5\t8.5\n1500.75\t9.25\t8.25\n",
    {0: [1500.25, 1500.75], 1: [9.5, 9.25], 2: [8.5, 8.25]},
)
add(
    "slash_comments.csv",
    "// export 2021\n// depth in m\nDEPT,C1,C2\n1500.25,9.5,8.5\n1500.75,9.25,8.25\n",
    {0: [1500.25, 1500.75], 1: [9.5, 9.25], 2: [8.5, 8.25]},
)
add(
    "comment_at_end.csv",
    "DEPT,C1,C2\n1500.25,9.5,8.5\n1500.75,9.25,8.25\n# end of file\n",
    {0: [1500.25, 1500.75], 1: [9.5, 9.25], 2: [8.5, 8.25]},
    rows=2,
)
# --- WellCAD, CoreWall, IODP, contractors
add(
    "wellcad_semicolon.csv",
    "Depth;Caliper;Tilt\nm;mm;deg\n1500,25;220,5;1,5\n1500,75;220,4;1,5\n",
    {0: [1500.25, 1500.75], 1: [220.5, 220.4]},
)
add("wellcad_waf.waf", "Depth,0.00 us,4.00 us,8.00 us\nm, , ,\n1500.25,1,2,3\n1500.75,4,5,6\n", {0: [1500.25, 1500.75]})
add(
    "corewall.csv",
    'Exp,Site,Hole,Depth CSF-A (m),Caliper (in)\n"344","U1413",C,10.25,9.5\n"344","U1413",C,10.75,9.25\n',
    {3: [10.25, 10.75], 4: [9.5, 9.25]},
)
add(
    "ldeo.dat",
    "Hole: 1256D\nLeg: 206\nTOP DEPTH: 10.25\n\nDEPTH_WSF   HCAL   C2\n(m)   (in)   (in)\n"
    "10.2500   9.5000   8.5000\n10.7500   9.2500   -999.2500\n",
    {0: [10.25, 10.75], 1: [9.5, 9.25], 2: [8.5, nan]},
)
add(
    "robertson.csv",
    "DEPTH[m],C1[mm],C2[mm]\n10.25,220.5,219.5\n10.75,220.25,219.25\n",
    {0: [10.25, 10.75], 1: [220.5, 220.25]},
)
add(
    "mount_sopris.txt",
    "Depth\tCaliper\tNat-Gamma\nft\tinch\tcps\n10.25\t9.5\t55\n10.75\t9.25\t56\n",
    {0: [10.25, 10.75], 1: [9.5, 9.25]},
    units={0: "ft", 1: "inch"},
)
add(
    "reflex_dip.csv",
    "Station,Depth (m),Dip (deg),Azimuth (deg)\n1,0,-90,0\n2,100.5,-84.75,45.5\n",
    {1: [0, 100.5]},
    survey=([0, 100.5], [0, 5.25], [0, 45.5]),
)
add("imdex_incl_negative.csv", "Depth (m),Inclination (deg),Azimuth (deg)\n0,-60,12\n100.5,-60.5,13\n", survey=REFUSED)
add("gyro_gon.csv", "MD (m),Inc (gon),Azi (gon)\n0,0,0\n100.5,10,50\n", survey=([0, 100.5], [0, 9], [0, 45]))
add(
    "dms_hyphen.csv",
    "MD (m),Inc,Azi\n0,0-00-00,0-00-00\n100.5,5-15-00,45-30-00\n",
    survey=([0, 100.5], [0, 5.25], [0, 45.5]),
)
add(
    "bearing_words.csv",
    "MD (m),Inc (deg),Azi\n0,0,N 0 E\n100.5,5.25,S44°30'E\n",
    survey=([0, 100.5], [0, 5.25], [0, 135.5]),
)
add(
    "bearing_blanks.csv",
    "MD (m),Inc (deg),Azi\n0,0,N 0.0 E\n100.5,5.25,N45.5E\n",
    survey=([0, 100.5], [0, 5.25], [0, 45.5]),
)
add(
    "fortran_d.txt",
    "DEPT C1 C2\n1.50025D+03 9.5D+00 8.5D+00\n1.50075D+03 9.25D+00 8.25D+00\n",
    {0: [1500.25, 1500.75], 1: [9.5, 9.25]},
)
# --- languages and statistics programs
add(
    "r_write_table.txt",
    '"MD" "C1" "C2"\n"1" 1500.25 9.5 8.5\n"2" 1500.75 9.25 8.25\n',
    {"MD": [1500.25, 1500.75], "C1": [9.5, 9.25]},
)
add(
    "r_write_csv.csv",
    '"","MD","C1","C2"\n"1",1500.25,9.5,NA\n"2",1500.75,9.25,8.25\n',
    {"MD": [1500.25, 1500.75], "C1": [9.5, 9.25], "C2": [nan, 8.25]},
)
add(
    "pandas_index.csv",
    ",MD,C1,C2\n0,1500.25,9.5,8.5\n1,1500.75,9.25,8.25\n",
    {"MD": [1500.25, 1500.75], "C1": [9.5, 9.25]},
)
add(
    "pandas_multiindex.csv",
    ",MD,C1\n,m,in\n0,1500.25,9.5\n1,1500.75,9.25\n",
    {"MD": [1500.25, 1500.75], "C1": [9.5, 9.25]},
    units={"MD": "m", "C1": "in"},
)
add(
    "pandas_multiindex_name.csv",
    ",MD,C1\n,m,in\nrow,,\n0,1500.25,9.5\n1,1500.75,9.25\n",
    {"MD": [1500.25, 1500.75], "C1": [9.5, 9.25]},
)
add(
    "mixed_newlines.csv",
    b"DEPT,C1,C2\r\n1500.25,9.5,8.5\n1500.75,9.25,8.25\r\n",
    {0: [1500.25, 1500.75], 1: [9.5, 9.25]},
)
add(
    "bom_inside.csv",
    b"\xef\xbb\xbf\xef\xbb\xbfDEPT,C1,C2\r\n1500.25,9.5,8.5\r\n1500.75,9.25,8.25\r\n",
    {"DEPT": [1500.25, 1500.75]},
)
add(
    "concatenated.csv",
    "DEPT,C1,C2\n1500.25,9.5,8.5\nDEPT,C1,C2\n1500.75,9.25,8.25\n",
    {0: [1500.25, 1500.75], 1: [9.5, 9.25]},
    rows=2,
)
# --- LAS
WELL = "~V\nVERS. 2.0:\nWRAP. NO:\n~W\nSTRT.M 10:\nSTOP.M 11:\nSTEP.M 1:\nNULL. -999.25:\n"
CURVES = "~C\nDEPT.M:\nC1.IN:\nC2.IN:\n"
ROWS = "10 9.5 8.5\n11 9.25 8.25\n"
TRUTH = {0: [10, 11], 1: [9.5, 9.25], 2: [8.5, 8.25]}
add("las_commas_and_blanks.las", WELL + CURVES + "~A\n10, 9.5, 8.5\n11, 9.25, 8.25\n", TRUTH)
add(
    "las_null_9999.las", WELL + CURVES + "~A\n10 9.5 8.5\n11 -9999 8.25\n", {0: [10, 11], 1: [9.5, nan], 2: [8.5, 8.25]}
)
add(
    "las_concatenated.las",
    WELL + CURVES + "~A\n" + ROWS + WELL.replace("10:", "12:") + CURVES + "~A\n12 9 8\n13 9.1 8.1\n",
    {0: [10, 11]},
)
add("las_footer.las", WELL + CURVES + "~A\n" + ROWS + "END OF FILE\n", TRUTH, rows=2)
add("las_footer_hash.las", WELL + CURVES + "~A\n" + ROWS + "# end\n\n", TRUTH, rows=2)
add(
    "las_unit_feet_word.las",
    WELL.replace(".M", ".FEET") + CURVES.replace("DEPT.M", "DEPTH.FEET") + "~A\n" + ROWS,
    TRUTH,
    units={0: "feet"},
)
add("las_tilde_ascii.las", WELL + CURVES + "~ASCII LOG DATA\n" + ROWS, TRUTH)
add("las_parameter_after.las", WELL + CURVES + "~A\n" + ROWS + "~P\nBS.IN 8.5:\n", TRUTH)
add(
    "las_api_codes.las",
    WELL + "~CURVE INFORMATION\n DEPT.M   00 001 00 00 : 1  DEPTH\n"
    " C1  .IN   45 280 13 01 : 2  CALIPER 1-3\n C2  .IN   45 280 24 01 : 3 CALIPER 2-4\n~A\n" + ROWS,
    TRUTH,
)
add(
    "las_colon_in_time.las",
    WELL + "~C\nDEPT.M:\nC1.IN:\nTIME.S : hh:mm:ss\n~A\n10 9.5 12:00:01\n11 9.25 12:00:02\n",
    {0: [10, 11], 1: [9.5, 9.25]},
)
add("las_no_colon.las", WELL + "~C\nDEPT.M\nC1.IN\nC2.IN\n~A\n" + ROWS, TRUTH)
add(
    "las3_quotes.las",
    WELL.replace("VERS. 2.0", "VERS. 3.0").replace("~W", "DLM. COMMA:\n~W")
    + '~C\nDEPT.M:\nC1.IN:\nNOTE. : {S}\n~ASCII\n10,9.5,"sand, fine"\n11,9.25,"shale"\n',
    {0: [10, 11], 1: [9.5, 9.25]},
)
# --- others
add(
    "html.xls",
    "<html><table><tr><td>MD</td><td>C1</td></tr><tr><td>1</td><td>9.5</td></tr></table></html>",
    {},
    survey=REFUSED,
)
add("records.json", '[{"MD": 1500.25, "C1": 9.5}, {"MD": 1500.75, "C1": 9.25}]', {"MD": [1500.25, 1500.75]})
add(
    "one_decimal_comma_ambiguous.csv", "MD (m);C1 (in)\n1,234;9,500\n1,235;9,250\n", {0: [1.234, 1.235], 1: [9.5, 9.25]}
)
add(
    "us_thousands_ambiguous.csv",
    'MD (m),C1 (mm)\n"1,234","9,500"\n"1,235","9,250"\n',
    {0: [1234, 1235], 1: [9500, 9250]},
)
add(
    "blanks_negative_runs.txt",
    "DEPT C1 N\n1500.25 9.5-999.25\n1500.75 9.25 8.25\n",
    {0: [1500.25, 1500.75], 1: [9.5, 9.25], 2: [nan, 8.25]},
)

REFUSALS = {
    "compass_three_heads.txt": "reading.layouts",
    "reflex_dip.csv": "inclination",
    "imdex_incl_negative.csv": "inclination",
    "dms_hyphen.csv": "is not a number",
    "html.xls": "HTML",
}
"""Files with two readings or none: what the error says."""


@pytest.mark.parametrize("name", FILES)
def test_a_file_is_right_or_refused(tmp_path: Path, name: str) -> None:
    entry = FILES[name]
    path = tmp_path / name
    path.write_bytes(entry.content)
    if name in REFUSALS:
        with pytest.raises(hb.InputError, match=REFUSALS[name]):
            hb.open(path).survey()
        return
    opened = hb.open(path)
    one = opened.set()
    for key, values in entry.cols.items():
        column = one.channels[key].name if isinstance(key, int) else key
        np.testing.assert_array_equal(one.numbers(column), values, err_msg=column)
    for key, unit in entry.units.items():
        assert (one.channels[key] if isinstance(key, int) else one[key]).unit.lower() == unit
    assert entry.rows in (None, one.rows)
    if entry.survey is not None:
        survey = opened.survey()
        found = (survey.depth, survey.inclination, survey.azimuth)
        for values, wanted in zip(found, entry.survey, strict=True):
            np.testing.assert_allclose(values, wanted, atol=1e-9)
