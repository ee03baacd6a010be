"""Readers are shown public names only: those of ``helibore``, ``helibore.plot`` and ``helibore.simulation``.

README, the pages and notebooks of docs, the examples and the docstrings of public names are read. Pages for those who
change helibore (ARCHITECTURE, CONTRIBUTING, docstrings of modules) may name any file.
"""

from __future__ import annotations

import ast
import inspect
import json
import re
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest
from locations import ROOT
from test_reference import public

import helibore as hb

PAGES = [ROOT / "README.md", *sorted(ROOT.glob("docs/**/*.md"))]
NOTEBOOKS = sorted(ROOT.glob("docs/notebooks/*.ipynb"))
PROGRAMS = sorted([*ROOT.glob("examples/**/*.py"), *ROOT.glob("docs/*.py")])
MODULES = {"helibore": hb, "helibore.plot": hb.plot, "helibore.simulation": hb.simulation}
NO_NAMES = {"h", "hpp", "html", "json", "cdx", "service", "live", "connections", "cli"}
"""What follows ``helibore.`` in names of files, of loggers, and of the command line, which sphinx-click reads."""


def exported(module: ModuleType) -> set[str]:
    return set(dir(hb)) if module is hb else set(module.__all__)


def is_public(*names: str) -> bool:
    """Whether names joined by dots lead from the package to something public."""
    at: object = hb
    for name in names:
        if isinstance(at, ModuleType) and name not in exported(at):
            return False
        if not (isinstance(at, ModuleType) or inspect.isclass(at)):
            return True  # an attribute of a value, which running the page shows
        if name.startswith("_") or not (hasattr(at, name) or name in getattr(at, "__annotations__", ())):
            return False
        at = getattr(at, name, None)
    return True


def hidden_in_text(text: str) -> Iterator[str]:
    """Names that a text gives in prose or code and that are not public."""
    for found in re.finditer(r"(?<![\w./~-])(?:hb|helibore)((?:\.[A-Za-z_]\w*)+)", text):
        names = found[1].split(".")[1:]
        if names[0] not in NO_NAMES and not names[0].startswith("__") and not is_public(*names):
            yield found[0]


def hidden_in_program(text: str) -> Iterator[str]:
    """What a program imports from the package and is not public."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            named = [alias.name for alias in node.names if alias.name.split(".")[0] == "helibore"]
            yield from (name for name in named if name not in MODULES)
        elif isinstance(node, ast.ImportFrom) and str(node.module).split(".")[0] == "helibore":
            module = MODULES.get(str(node.module))
            for name in (alias.name for alias in node.names):
                if module is None or name not in exported(module):
                    yield f"{node.module}.{name}"


def python_of(path: Path) -> Iterator[str]:
    """The programs of a page, a notebook or a file."""
    text = path.read_text()
    if path.suffix == ".md":
        yield from re.findall(r"^```python\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)
    elif path.suffix == ".ipynb":
        cells = json.loads(text)["cells"]
        code = ("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
        yield from (re.sub(r"^[!%].*$", "", text, flags=re.MULTILINE) for text in code)
    else:
        yield text


@pytest.mark.parametrize("path", [*PAGES, *NOTEBOOKS, *PROGRAMS], ids=lambda path: path.name)
def test_pages_and_examples_use_public_names(path: Path) -> None:
    programs = list(python_of(path))
    assert [name for program in programs for name in hidden_in_program(program)] == []
    assert list(hidden_in_text(path.read_text() if path.suffix == ".md" else "\n".join(programs))) == []


def test_docstrings_of_public_names_send_readers_to_public_names() -> None:
    found = []
    for name, of in public():
        of = of.fget if isinstance(of, property) else of
        text = inspect.getdoc(of) or ""
        examples = "\n".join(re.findall(r"^\s*(?:>>>|\.\.\.) (.*)$", text, re.MULTILINE))
        imported = re.findall(r"from (helibore[\w.]*) import (\w+)", examples)
        found += [f"{name}: {hidden}" for hidden in hidden_in_text(text)]
        found += [f"{name}: {module}" for module, _ in imported if module not in MODULES]
    assert found == []


def test_a_name_that_is_not_public_is_found() -> None:
    program = "import helibore.wall\nfrom helibore.wall.wall import Wall\nfrom helibore import Wall, Nothing\n"
    text = "`hb.Wall.append`, `hb.open`, `hb.Wall.nothing`, `helibore.wall.wall.Wall`, helibore.h, `hb.Wall._core`"
    assert list(hidden_in_program(program)) == ["helibore.wall", "helibore.wall.wall.Wall", "helibore.Nothing"]
    assert list(hidden_in_text(text)) == ["hb.Wall.nothing", "helibore.wall.wall.Wall", "hb.Wall._core"]


def test_the_reference_shows_every_public_name() -> None:
    text = (ROOT / "docs/reference/python.md").read_text()
    shown = set(re.findall(r"^\.\. auto\w+:: (?:helibore\.(?:plot\.)?)?(\w+)$", text, re.MULTILINE))
    names = {name for module in MODULES.values() for name in exported(module)}
    assert names - shown == {"__version__", "plot", "simulation", "COLOR_MAPS", "PAPERS"}
