"""The reference is complete: every public name, method and argument is explained; every header is included."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from typing import Any

from locations import ROOT

import helibore as hb

HEADERS = ROOT / "cpp/include/helibore"
MADE_BY = {
    "Surface": "Wall.surface", "Volume": "Wall.volume", "Path": "Survey.path", "Viewer": "view", "LogFile": "open",
    "LogSet": "LogFile.set", "Drift": "Wall.drift",
}  # fmt: skip
"""Classes whose constructor is not public: what makes them."""


def public() -> Iterator[tuple[str, Any]]:
    """The names of the package, and the methods and properties of its classes."""
    for name in sorted(set(dir(hb)) - {"__version__", "plot", "simulation"}):
        of = getattr(hb, name)
        yield name, of
        if inspect.isclass(of) and not issubclass(of, BaseException):
            for member, what in vars(of).items():
                if not member.startswith("_") and (callable(getattr(of, member)) or isinstance(what, property)):
                    yield f"{name}.{member}", what
    for module in (hb.plot, hb.simulation):
        for name in module.__all__:
            yield f"{module.__name__.removeprefix('helibore.')}.{name}", getattr(module, name)


def arguments(name: str, of: Any) -> list[str]:
    method = "." in name and name[0].isupper() and not isinstance(of, staticmethod)
    of = of.__func__ if isinstance(of, classmethod | staticmethod) else of
    if not callable(of) or name in MADE_BY or (inspect.isclass(of) and issubclass(of, BaseException)):
        return []
    return list(inspect.signature(of).parameters)[method:]


def test_every_public_name_and_argument_is_explained() -> None:
    names = list(public())
    unexplained = []
    for name, of in names:
        text = inspect.getdoc(of.fget if isinstance(of, property) else of) or ""
        unexplained += [name] if len(text) < 12 else []
        unexplained += [f"{name}({each})" for each in arguments(name, of) if not re.search(rf"\b{each}\b", text)]
    assert unexplained == []
    assert len(names) > 100


def test_tab_completion_shows_every_public_name() -> None:
    stated = (
        (ROOT / "python/helibore/__init__.py").read_text().partition("if TYPE_CHECKING:")[2].partition("__getattr__")[0]
    )
    names = re.findall(r"import (?:\w+ as )?(\w+)(?:  #.*)?$", stated, re.MULTILINE)
    assert len(names) > 20
    assert {*names, "__version__"} == set(dir(hb))


def test_numbers_have_units_and_arrays_have_shapes() -> None:
    """An explanation of what returns numbers says what they are in; of an array, its shape."""
    unit = r"[Mm]etre|degree|\bm\b|\bdeg\b|second|[Ss]hare|number|index|ratio|\bNaN\b|int64|count|float64"
    lacking = []
    for name, of in public():
        of = of.fget if isinstance(of, property) else getattr(of, "__func__", of)
        returned = str(getattr(of, "__annotations__", {}).get("return", ""))
        text = inspect.getdoc(of) or ""
        if returned in ("Floats", "Integers", "Mask") and not re.search(r"\([\w, +*/-]+\)|shape", text):
            lacking.append(f"{name}: shape")
        if returned in ("Floats", "float") and not re.search(unit, text):
            lacking.append(f"{name}: unit")
    assert lacking == []


def test_every_header_is_in_the_documentation() -> None:
    pages = (ROOT / "docs/reference/cpp.md").read_text() + (ROOT / "docs/embedding.md").read_text()
    shown = set(re.findall(r"literalinclude\} \.\./(?:\.\./)?cpp/include/helibore/(\S+)", pages))
    assert shown == {path.name for path in HEADERS.iterdir()}


def test_every_function_of_the_c_interface_has_a_comment_and_is_counted() -> None:
    """Above a function or a group of functions, or beside it."""
    text = (HEADERS / "helibore.h").read_text()
    groups = [group for group in re.split(r"\n\s*\n", text) if re.search(r"^HB_API ", group, re.MULTILINE)]
    assert [group[:60] for group in groups if "/*" not in group] == []
    functions = re.findall(r"HB_API .*?(hb_\w+)\(", text)
    stated = re.search(r"exports the (\d+) functions", (ROOT / "docs/embedding.md").read_text())
    assert int(stated[1]) == len(functions)


def test_the_citation_names_the_version() -> None:
    assert f"\nversion: {hb.__version__}\n" in (ROOT / "CITATION.cff").read_text()
