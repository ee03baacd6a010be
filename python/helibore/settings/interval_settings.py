"""The settings of a file of formation tops, casings, a mud log or other intervals."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from helibore.settings.declared import Declared, Rule

CHECKSUM = Rule("must be 64 hexadecimal digits", lambda text: re.fullmatch(r"([0-9a-f]{64})?", text) is not None)


@dataclass(frozen=True)
class IntervalInput(Declared, group="intervals"):
    """A table of formation tops, casings, a mud log or other intervals."""

    file: Annotated[Path, "File, relative to the project."]
    blake2b: Annotated[str, CHECKSUM, "Checksum of its bytes, in hexadecimal."] = ""
    well: Annotated[str | None, "Well whose rows are read. None: that of the header, or the only one of the file."] = (
        None
    )
    unit: Annotated[Literal["m", "ft", "ftUS"] | None, "Unit of the depths. None: that which the file states."] = None
