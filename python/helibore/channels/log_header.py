"""The header of a log, what hole it is of: company, well, field ..., from the headers of the files it is made from."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

NAMES = {
    "company": ("COMP", "COMPANY", "OPERATOR"),
    "well": ("WELL", "WELL_NAME", "UWI"),
    "field": ("FLD", "FIELD", "FIELD_NAME"),
    "location": ("LOC", "LOCATION"),
    "date": ("DATE", "LOG_DATE", "LOGDATE"),
    "datum": ("DATUM", "PDAT", "EREF", "ELEVATION"),
    "bit": ("BS", "BIT", "BITSIZE"),
    "mud": ("MUD", "DFT", "MUD_TYPE"),
    "remarks": ("REM", "REMARKS", "COMMENT"),
}
"""Entries of a header, and the names that files have for them, in upper case."""


def log_header(headers: Iterable[Mapping[str, str]]) -> dict[str, str]:
    """Return the entries that the headers of files hold, the first that is not empty of each."""
    found: dict[str, str] = {}
    for header in headers:
        upper = {name.upper(): " ".join(str(text).split()) for name, text in header.items()}
        for entry, names in NAMES.items():
            text = next((upper[name] for name in names if upper.get(name)), "")
            if text and text.lower() not in ("none", "unknown"):
                found.setdefault(entry, text)
    return found
