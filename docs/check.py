"""Checks the built site: every public name is in it, no page asks for a network, no markup is left raw.

Every page has the list of all pages at its left. Where Chromium and playwright are installed, some pages are laid out
at 1280 and 390 pixels: nothing of them is cut. The notebooks of docs/notebooks have the output that the build has just
got, and each page of one shows its wall.
"""

from __future__ import annotations

import html
import inspect
import json
import re
import shutil
import sys
from importlib.util import find_spec
from pathlib import Path

from sphinx.util.inventory import InventoryFile

import helibore

PAGES = 18
"""Entries of the list of pages."""
LAID_OUT = ("index.html", "analyst.html", "developer.html", "reference/python.html", "reference/cpp.html")
"""Pages with long lines of code, wide tables and long names."""
CUT = """() => [...document.querySelectorAll('html, .bd-article-container, .bd-article pre')]
  .filter(of => of.scrollWidth > of.clientWidth + 1)
  .map(of => `${of.tagName.toLowerCase()}, ${of.scrollWidth - of.clientWidth} pixels: ${of.innerText.slice(0, 40)}`)
  .slice(0, 3)"""
"""What is wider than its box, in the page's own language; tables scroll in boxes of their own."""


def public_names() -> set[str]:
    """The names of the package, and the methods and properties of its classes."""
    names = set()
    for name in set(dir(helibore)) - {"__version__", "plot", "simulation"}:
        of = getattr(helibore, name)
        names.add(f"helibore.{name}")
        if inspect.isclass(of) and not issubclass(of, BaseException):
            members = {member: what for member, what in vars(of).items() if not member.startswith("_")}
            names |= {
                f"helibore.{name}.{member}"
                for member, what in members.items()
                if callable(what) or type(what) is property
            }
    return names


def problems(site: Path) -> list[str]:
    """One line for each thing that is wrong."""
    inventory = InventoryFile.loads((site / "objects.inv").read_bytes(), uri="")
    documented = {name for kind in inventory.data.values() for name in kind}
    found = [f"{name} is not in the reference" for name in sorted(public_names() - documented)]
    for page in sorted(site.rglob("*.html")):
        text = page.read_text(encoding="utf-8")
        place = page.relative_to(site)
        for request in re.findall(r"<(?:script|img|link)[^>]+(?:src|href)=\"(https?://[^\"]+)", text):
            found.append(f"{place} asks for {request}")
        if text.count('"toctree-l1') < PAGES and "bd-sidebar-primary" in text:
            found.append(f"{place} has no list of the pages")
        prose = html.unescape(re.sub(r"<(pre|code|script|style)\b.*?</\1>|<[^>]+>", " ", text, flags=re.DOTALL))
        for raw in re.findall(r":(?:class|func|meth|py:\w+):`|``|\{eval-rst|:::|\$\$", prose):
            found.append(f"{place} shows raw markup: {raw}")
    return found


def printed(notebook: Path) -> list[list[str]]:
    """The words that each cell of a notebook printed or returned, without the colours and spaces of a terminal."""
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    texts = []
    for cell in cells:
        outputs = cell.get("outputs", [])
        texts.append("".join("".join(of.get("text", of.get("data", {}).get("text/plain", ""))) for of in outputs))
    return [re.findall(r"[\w.%]+", re.sub(r"\x1b\[[0-9;]*m", "", text)) for text in texts]


def problems_of_notebooks(site: Path) -> list[str]:
    """One line for each notebook that prints something else than its saved output, or shows no picture."""
    found = []
    for saved in sorted((Path(__file__).parent / "notebooks").glob("*.ipynb")):
        executed = site.parent / "jupyter_execute/notebooks" / saved.name
        if printed(saved) != printed(executed):
            found.append(f"docs/notebooks/{saved.name} prints something else now: cp {executed} docs/notebooks")
        if "data:image/png" not in (site / f"notebooks/{saved.stem}.html").read_text(encoding="utf-8"):
            found.append(f"notebooks/{saved.stem}.html shows no wall")
    return found


def problems_of_layout(site: Path) -> list[str]:
    """One line for each thing that is cut at the width of a small laptop or a phone; none without a browser."""
    chromium = shutil.which("chromium-headless-shell") or shutil.which("chromium")
    if chromium is None or find_spec("playwright") is None:
        return []
    from playwright.sync_api import sync_playwright

    found = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        for width in (1280, 390):
            page = browser.new_page(viewport={"width": width, "height": 900})
            for name in LAID_OUT:
                page.goto((site / name).absolute().as_uri())
                found += [f"{name}, {width} pixels wide, is cut: {each}" for each in page.evaluate(CUT)]
        browser.close()
    return found


if __name__ == "__main__":
    site = Path(sys.argv[1])
    wrong = problems(site) + problems_of_notebooks(site) + problems_of_layout(site)
    print("\n".join(wrong))
    sys.exit(bool(wrong))
