"""Draws the pictures of the documentation, or compares those in ``docs`` with what is drawn now.

    python docs/pictures.py [FOLDER]     draws demo, log and, where Chromium is, the viewer
    python docs/pictures.py --check      draws demo and log elsewhere, and names those that look different

Two pictures look the same if they have one size and if, of the means over 4 x 4 pixels, at most one in 200 differs by
more than a tenth of full brightness in a colour: another version of matplotlib may draw an edge of a letter otherwise.
"""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

DOCS = Path(__file__).parent
SQUARE, MOST, SHARE = 4, 25, 0.005


def run(*words: str) -> None:
    """Run a verb of helibore."""
    subprocess.run([sys.executable, "-m", "helibore", *words], check=True)


def draw(folder: Path) -> list[str]:
    """Draw the pictures that take a few seconds; return their names."""
    run("demo", "-q", "-o", str(folder))
    with tempfile.TemporaryDirectory() as hole:
        run("simulate", hole, "-q")
        (command,) = re.findall(
            r"^(helibore plot [^`]*helibore-log.png)$", (DOCS / "analyst.md").read_text(), re.MULTILINE
        )
        words = shlex.split(command.replace("\\\n", " ").replace("hole/", f"{hole}/"))
        run(*words[1:-1], str(folder / words[-1]), "-q")
    return ["helibore-demo.png", "helibore-log.png"]


def look_alike(one: Path, other: Path) -> bool:
    """Return whether two pictures look the same."""
    first, second = (Image.open(path).convert("RGB") for path in (one, other))
    if first.size != second.size:
        return False
    squares = (np.asarray(each.reduce(SQUARE), dtype=int) for each in (first, second))
    return float((np.abs(next(squares) - next(squares)).max(axis=2) > MOST).mean()) <= SHARE


def main() -> int:
    if sys.argv[1:] != ["--check"]:
        folder = Path(*sys.argv[1:2]) if sys.argv[1:] else DOCS
        draw(folder)
        for beside in ("helibore-demo.glb", "helibore-log.png.toml"):
            (folder / beside).unlink()
        if shutil.which("chromium"):
            subprocess.run([sys.executable, DOCS / "viewer_picture.py", folder / "helibore-viewer.png"], check=True)
        return 0
    with tempfile.TemporaryDirectory() as now:
        others = [name for name in draw(Path(now)) if not look_alike(DOCS / name, Path(now) / name)]
    for name in others:
        print(f"docs/{name} looks different now: python docs/pictures.py")
    return bool(others)


if __name__ == "__main__":
    sys.exit(main())
