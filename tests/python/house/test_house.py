"""The rules of the house that a machine can check."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
from locations import ROOT

CORE = sorted([*ROOT.glob("cpp/src/**/*.?pp"), *ROOT.glob("cpp/include/helibore/*.hpp")])
BINDINGS = sorted(ROOT.glob("python/bindings/*.?pp"))
PYTHON = sorted(ROOT.glob("python/helibore/**/*.py"))


def code(path: Path) -> str:
    """The text of a file without comments and texts in quotes."""
    text = path.read_text()
    if path.suffix == ".py":
        return re.sub(r'("""(?:.|\n)*?"""|"[^"\n]*"|#.*)', "", text)
    return re.sub(r'(//.*|"(?:[^"\\\n]|\\.)*")', "", text)


def lines_with(pattern: str, files: list[Path]) -> Iterator[str]:
    for path in files:
        for number, line in enumerate(code(path).splitlines(), 1):
            if re.search(pattern, line):
                yield f"{path.relative_to(ROOT)}:{number}: {line.strip()}"


def test_there_is_something_to_check() -> None:
    assert min(len(CORE), len(BINDINGS), len(PYTHON)) > 5


@pytest.mark.parametrize(
    ("what", "pattern"),
    [
        ("Python", r"Python\.h|pybind11|PyObject"),
        ("printing", r"<iostream>|<cstdio>|<print>|\bstd::c(out|err|log)\b|\bf?printf\b|\bputs\b"),
        ("the environment", r"\bgetenv\b|\benviron\b"),
        ("ending the host", r"\babort\(|\bexit\(|\bterminate\(|\bassert\("),
        ("OpenMP", r"#pragma omp|<omp\.h>"),
        ("the machine's thread count", r"hardware_concurrency"),
    ],
    ids=lambda value: value if " " in value or value.isalpha() else "",
)
def test_the_core_keeps_clear_of(what: str, pattern: str) -> None:
    assert not list(lines_with(pattern, CORE)), f"cpp/ uses {what}"


def test_the_core_has_no_globals_that_change() -> None:
    """Static, thread-local and namespace-scope variables are constants, but for handles and the host's runner."""
    changing = r"\bthread_local\b|^\s*static\s+(?!const|constexpr|_assert)[\w:<>, ]+\s+\w+\s*(=|;|\{)"
    assert {line.split(":")[0] for line in lines_with(changing, CORE)} == {
        "cpp/src/c/handles.cpp",
        "cpp/src/base/runner.cpp",
    }
    assert not list(
        lines_with(r"^(inline\s+)?(std::\w+(<.*>)?|bool|int|double|Index|auto|long)\s+\w+\s*(=|;|\{)", CORE)
    )


def test_glm_stays_in_cpp_src() -> None:
    outside = [path for path in [*CORE, *BINDINGS] if ROOT / "cpp/src" not in path.parents]
    assert not list(lines_with(r"\bglm\b", outside))


def test_bindings_release_python_before_they_loop_and_hold_no_algorithm() -> None:
    assert not list(lines_with(r"std::sort|std::sqrt|\bwhile\b", [p for p in BINDINGS if p.name != "arrays.hpp"]))


def test_bindings_release_python_so_that_a_program_may_end_meanwhile() -> None:
    """``gil.hpp`` says why; pybind11's own class ends the program then, now and then."""
    assert not list(lines_with(r"\bgil_scoped_(release|acquire)\b|\bPyEval_(Save|Restore)Thread\b",
                               [path for path in BINDINGS if path.name != "gil.hpp"]))  # fmt: skip


@pytest.mark.parametrize("call", ["asarray", "ascontiguousarray", "asanyarray"])
def test_one_file_takes_arrays(call: str) -> None:
    """In the package and all its sub-packages."""
    own = [path for path in PYTHON if path != ROOT / "python" / "helibore" / "base" / "arrays.py"]
    assert not list(lines_with(rf"\bnp\.{call}\(", own))


def test_no_hash_table_of_numpy_ends_a_program() -> None:
    """`distinct` of base/arrays.py says why; with an index, a count or an axis, np.unique sorts."""
    assert not list(lines_with(r"\bnp\.unique\((?!.*(return_|axis=))", PYTHON))


def test_one_file_names_the_types_of_arrays() -> None:
    """The one set of names is that of base/arrays.py: ``Floats``, ``Integers``, ``Mask`` and so on."""
    stub = ROOT / "python/helibore/_core.pyi"
    others = [path for path in [*PYTHON, stub, *ROOT.glob("bench/**/*.py"), *ROOT.glob("tests/**/*.py")]
              if path.name != "arrays.py"]  # fmt: skip
    assert not list(lines_with(r"\bNDArray\[", others))


def test_develop_speaks_to_the_pip_of_debian_12() -> None:
    """Which is 23.0: it knows --config-settings, and -C only from 23.1 on."""
    calls = re.findall(r"^.*pip (?:install|wheel).*$", (ROOT / "develop").read_text(), re.MULTILINE)
    assert calls
    assert not [line for line in calls if re.search(r'[ "]-C', line)]


@pytest.mark.parametrize(
    ("newer", "pattern"), [("NumPy 2.0", r"\bcopy=None\b"), ("click 8.4", r"\(click\.ParamType\[")]
)
def test_the_oldest_versions_that_pyproject_allows_will_do(newer: str, pattern: str) -> None:
    assert not list(lines_with(pattern, PYTHON)), f"only from {newer} on"


def test_only_units_knows_the_inch() -> None:
    """In Python; the pages of the viewer have theirs in units.js."""
    elsewhere = [path for path in PYTHON if path.name != "units.py"]
    assert not list(lines_with(r"\b0?\.0254\b|\b25\.4\b|\b0\.3048\b", elsewhere))
    page = sorted(path for path in ROOT.glob("python/helibore/viewer/web/src/*.js") if path.name != "units.js")
    assert page
    assert not list(lines_with(r"\b0?\.0254\b|\b25\.4\b", page))


def test_no_two_files_and_no_two_classes_of_the_package_have_one_name() -> None:
    names = [path.name for path in PYTHON if path.name != "__init__.py"]
    names += [name for path in PYTHON for name in re.findall(r"^class (\w+)", path.read_text(), re.MULTILINE)]
    assert [name for name, count in Counter(names).items() if count > 1] == []


def test_a_file_that_a_text_names_exists() -> None:
    """Comments, docstrings and the pages for developers point to files by name; a renamed one takes them along."""
    folders = ("web", "web/src", "web/offline")
    web = [path for folder in folders for path in ROOT.glob(f"python/helibore/viewer/{folder}/*.js")]
    pages = [ROOT / name for name in ("ARCHITECTURE.md", "CONTRIBUTING.md", "cpp/DESIGN.md")]
    tests = [*ROOT.glob("tests/**/*.?pp"), *ROOT.glob("tests/**/*.py"), *ROOT.glob("bench/**/*.py")]
    there = {path.name for path in [*CORE, *BINDINGS, *PYTHON, *web, *tests]}
    other = {"app.js", "Node.js", "geometric.hpp", "vec3.hpp"}  # of the built page, no file, of GLM
    named = re.compile(r"(?<![\w./{}*-])((?:\w+/)*)(\w+\.(?:py|hpp|cpp|js|mjs))\b")
    lost = [
        f"{path.relative_to(ROOT)}: {found[0]}"
        for path in [*CORE, *BINDINGS, *PYTHON, *web, *pages]
        for found in named.finditer(path.read_text())
        if found[2] not in there | other
        or (found[1].startswith(("cpp/", "python/")) and not (ROOT / found[0]).exists())
    ]
    assert not lost


def test_actions_are_pinned_by_digest() -> None:
    """A tag can be moved to other code; a digest cannot."""
    for file in (ROOT / ".github" / "workflows").glob("*.yml"):
        for used in re.findall(r"uses:\s*(\S+)", file.read_text()):
            assert re.fullmatch(r"[\w./-]+@[0-9a-f]{40}", used), f"{file.name}: {used}"
