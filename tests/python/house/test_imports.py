"""The files of the package import each other without a circle; imports in functions and for typing count."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from locations import ROOT

PACKAGE = ROOT / "python"


def modules() -> dict[str, Path]:
    """Every module of the package by its dotted name."""
    names = {}
    for path in (PACKAGE / "helibore").rglob("*.py"):
        parts = path.relative_to(PACKAGE).with_suffix("").parts
        names[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return names


def imports(path: Path, known: dict[str, Path]) -> Iterator[str]:
    """The modules of the package that a file imports anywhere."""
    for node in ast.walk(ast.parse(path.read_text())):
        found: list[str] = []
        if isinstance(node, ast.Import):
            found = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: a relative import"
            found = [f"{node.module}.{alias.name}" for alias in node.names]
        for name in found:
            while name and name not in known:
                name = name.rpartition(".")[0]
            if name:
                yield name


def test_no_file_imports_itself_by_way_of_others() -> None:
    known = modules()
    assert len(known) > 50
    left = {name: set(imports(path, known)) - {name, "helibore"} for name, path in known.items()}
    while free := [name for name, needs in left.items() if not needs & left.keys()]:
        for name in free:
            del left[name]
    assert not left, f"these files are in a circle, or import one: {left}"


def test_below_the_root_only_the_core_is_imported_from_it() -> None:
    """`from helibore import _core`; any other name would load the whole package from within."""
    known = modules()
    for name, path in known.items():
        if name in ("helibore", "helibore.__main__"):
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and node.module == "helibore":
                assert [alias.name for alias in node.names] == ["_core"], f"{path}:{node.lineno}"
            if isinstance(node, ast.Import) and not name.startswith("helibore.cli"):
                assert "helibore" not in [alias.name for alias in node.names], f"{path}:{node.lineno}"


def test_the_root_of_the_package_holds_four_files() -> None:
    tracked = {path.name for path in (PACKAGE / "helibore").iterdir() if path.is_file() and path.suffix != ".so"}
    assert tracked == {"__init__.py", "__main__.py", "_core.pyi", "py.typed"}


def test_every_source_of_the_core_lies_in_a_folder() -> None:
    assert not [path for path in (ROOT / "cpp" / "src").iterdir() if path.is_file()]


def test_the_library_names_no_option_of_the_command_line() -> None:
    """Its texts name settings. Only ``cli`` knows options; ``settings`` declares them."""
    option = re.compile(r"""[ (`"'](--(?:[a-z]+-)*[a-z]+(?=[ =`"',.;)])|-s (?:[a-z_]+[.=]|"$))""")
    library = [path for path in modules().values() if not {"cli", "settings"} & set(path.relative_to(PACKAGE).parts)]
    found = [
        f"{path.relative_to(PACKAGE)}: {match[1]}"
        for path in library
        for line in path.read_text().splitlines()
        for match in option.finditer(line)
        if "->" not in line and match[1] not in NOT_OURS
    ]
    assert not found


NOT_OURS = ("--help", "--force-reinstall", "--no-deps")
"""Options that texts of the library may name: of pip, and the one that shows the help."""
