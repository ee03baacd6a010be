"""Open a page in the default browser without its token in a command line, which all users of a machine can read."""

from __future__ import annotations

import html
import tempfile
import webbrowser
from pathlib import Path

OPENING = (
    '<!doctype html><meta charset="utf-8"><title>helibore</title><meta http-equiv="refresh" content="0;url={url}">'
    '<a href="{url}">helibore</a>'
)


def open_page(url: str) -> tempfile.TemporaryDirectory[str]:
    """Open a page; return the folder with the file by which the browser finds it, for this user only."""
    folder = tempfile.TemporaryDirectory(prefix="helibore-")
    file = Path(folder.name) / "wall.html"
    file.write_text(OPENING.format(url=html.escape(url)), encoding="utf-8")
    webbrowser.open(file.as_uri())
    return folder
