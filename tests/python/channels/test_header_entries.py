"""The header of a log: company, datum, mud, bit ... wherever a format keeps them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import helibore as hb
from helibore.base.tables import LogColumn, LogTable
from helibore.channels.header_entries import NAMES, log_header
from helibore.files.log_writing import save_table

LAS2 = """~Version
VERS. 2.0 :
WRAP. NO :
~Well
STRT.M 100 :
STOP.M 101 :
STEP.M 1 :
NULL. -999.25 :
WELL. A-1 : Well
DATE.DD/MM/YYYY21/05/2007 : Date
RUN.MD12 : No form of a date
EKB.M 54.9 : Kelly bushing
~Parameter
BS.IN 8.5 : Bit size
DFT. OBM : Drilling fluid type
WELL. A-1 of the parameters : Well
RMF.OHMM 0.2 : Mud filtrate
~Curve
DEPT.M :
GR.GAPI :
~ASCII
100 1
101 2
"""

LAS3 = """~Version
VERS. 3.0 :
WRAP. NO :
DLM. COMMA :
~Well
STRT.M 100 :
STOP.M 101 :
STEP.M 1 :
NULL. -999.25 :
WELL. A-1 : Well
DATE.DD-MMM-YYYY21-MAY-2007 : Date
~Log_Parameter
BS.IN 8.5 : Bit size {F4.1}
PDAT. MSL : Permanent datum
~Drilling_Parameter
MUD. WBM : Mud
~Log_Definition
DEPT.M : Depth
GR.GAPI : Gamma
~Log_Data | Log_Definition
100,1
101,2
"""


@pytest.mark.parametrize(
    ("text", "header"),
    [
        (LAS2, {"well": "A-1", "date": "21/05/2007", "kb": "54.9 M", "bit": "8.5 IN", "mud": "OBM"}),
        (LAS3, {"well": "A-1", "date": "21-MAY-2007", "datum": "MSL", "bit": "8.5 IN", "mud": "WBM"}),
        (
            "# Well: A-1\n# 3 rows\n# mud: OBM; 1.2 s.g.: heavy\nmd_m,GR\n100,1\n101,2\n",
            {"well": "A-1", "mud": "OBM; 1.2 s.g.: heavy"},
        ),
    ],
)
def test_where_files_keep_it(tmp_path: Path, text: str, header: dict[str, str]) -> None:
    (tmp_path / "f").write_text(text)
    found = hb.open(tmp_path / "f").set()
    assert log_header([found.header]) == header
    if text.startswith("~"):
        assert [found.header[name] for name in ("STRT", "STOP", "NULL")] == ["100", "101", "-999.25"]
        assert not [remark for remark in found.remarks if "truncated" in remark]


@pytest.mark.parametrize("ending", ["las", "csv", "parquet", "dlis"])
def test_what_is_written_is_read_back(tmp_path: Path, ending: str) -> None:
    header = {name: f"{name} 1 of A; B" for name in NAMES}
    columns = [LogColumn("DEPT", "m", "Depth", np.arange(3.0)), LogColumn("DEQ", "m", "Diameter", np.full(3, 0.2))]
    save_table(LogTable(columns, {"basis": "measured"}), tmp_path / f"w.{ending}", header=header)
    with hb.open(tmp_path / f"w.{ending}") as file:
        assert log_header(each.header for each in file.sets) == header


def test_a_damaged_parameter_does_not_block_the_frames(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    dlis: Any = pytest.importorskip("dlisio.dlis")
    columns = [LogColumn("DEPT", "m", "Depth", np.arange(3.0)), LogColumn("DEQ", "m", "Diameter", np.full(3, 0.2))]
    save_table(LogTable(columns, {"basis": "measured"}), tmp_path / "w.dlis", header={"mud": "OBM", "well": "A-1"})

    def values(self: Any) -> Any:
        if self.name == "MUD":
            raise RuntimeError("unknown representation code")
        return ["measured"]

    monkeypatch.setattr(dlis.Parameter, "values", property(values))
    with hb.open(tmp_path / "w.dlis") as file:
        header = file.sets[0].header
        assert (header["well"], header["BASIS"], "MUD" in header) == ("A-1", "measured", False)
        assert file["DEQ"].values.tolist() == [0.2] * 3
