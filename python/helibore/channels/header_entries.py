"""The header of a log: company, well, field and more, as the files that the log is made from state them.

``helibore.files.las`` reads the header of a LAS file, and ``helibore.files.log_writing`` writes it from these entries.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

NAMES = {
    "company": ("COMP", "COMPANY", "CN", "OPERATOR"),
    "well": ("WELL", "WELL_NAME", "WN", "NAMEWELL", "UWI"),
    "field": ("FLD", "FIELD", "FIELD_NAME", "FN"),
    "location": ("LOC", "LOCATION", "FL"),
    "service": ("SRVC", "SERVICE", "SERVICE_COMPANY"),
    "run": ("RUN", "RUN_NUMBER", "RUNN"),
    "date": ("DATE", "LOG_DATE", "LOGDATE"),
    "datum": ("DATUM", "PDAT", "LMF", "DREF", "EREF", "ELEVATION"),
    "kb": ("EKB", "KB", "ELEV_KB"),
    "gl": ("EGL", "GL", "ELEV_GL"),
    "bit": ("BS", "BIT", "BITSIZE", "BIT_SIZE"),
    "mud": ("MUD", "DFT", "MUD_TYPE"),
    "remarks": ("REM", "REMARKS", "COMMENT", "R1"),
}
"""For each entry of a header, the names that files have for it, in upper case.

``kb`` and ``gl`` are the elevations of kelly bushing and ground.
"""


def log_header(headers: Iterable[Mapping[str, str]]) -> dict[str, str]:
    """Return every entry of a log header that a file states; if several files state an entry, the first file counts.

    The texts "none" and "unknown" count as not stated.
    """
    found: dict[str, str] = {}
    for header in headers:
        upper = {name.upper(): " ".join(str(text).split()) for name, text in header.items()}
        for entry, names in NAMES.items():
            text = next((upper[name] for name in names if upper.get(name)), "")
            if text and text.lower() not in ("none", "unknown"):
                found.setdefault(entry, text)
    return found
