"""The header of a log: entries that files state under many names, and a project under these."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from helibore.settings.declared import Declared


@dataclass(frozen=True, kw_only=True)
class Header(Declared, group="header"):
    """The header of prints, reports and tables; an entry that is not stated is as the files state it."""

    company: Annotated[str, "Company for which the hole was logged."] = ""
    well: Annotated[str, "Name of the well; the title of a print."] = ""
    field: Annotated[str, "Field."] = ""
    location: Annotated[str, "Location of the well."] = ""
    service: Annotated[str, "Service company that logged the hole."] = ""
    run: Annotated[str, "Number of the run."] = ""
    date: Annotated[str, "Date of the log."] = ""
    datum: Annotated[str, "What depths count from."] = ""
    kb: Annotated[str, "Elevation of the kelly bushing."] = ""
    gl: Annotated[str, "Elevation of the ground."] = ""
    bit: Annotated[str, "Bit size, as a text."] = ""
    mud: Annotated[str, "Mud."] = ""
    remarks: Annotated[str, "Remarks."] = ""
