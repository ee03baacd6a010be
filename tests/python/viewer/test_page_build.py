"""The page's build, as CMake does it for a wheel: with Node.js the page of these sources, without it a sentence and a
package that works. No compiler is needed: the page's folder is configured alone."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest
from locations import WEB
from patience import PATIENCE

from helibore.viewer.page_files import page

PROJECT = (
    f'cmake_minimum_required(VERSION 3.25)\nproject(page LANGUAGES NONE)\nadd_subdirectory("{WEB.as_posix()}" web)\n'
)
FILES = ["app.css", "app.js", "index.html", "more.js", "notebook.js", "wells.html", "wells.js"]

cmake = shutil.which("cmake")
pytestmark = pytest.mark.skipif(cmake is None, reason="the page's build is not tried: cmake is not on the path")


def install(folder: Path, *defines: str) -> Path:
    """Configure, build and install the page alone; return helibore/viewer as a wheel would have it."""
    (folder / "CMakeLists.txt").write_text(PROJECT)
    build, prefix = folder / "build", folder / "installed"
    for command in (
        [cmake, "-S", folder, "-B", build, "-G", "Ninja", *(f"-D{define}" for define in defines)],
        [cmake, "--build", build],
        [cmake, "--install", build, "--prefix", prefix],
    ):
        done = subprocess.run([*map(str, command)], capture_output=True, text=True, timeout=PATIENCE, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    return prefix / "viewer"


@pytest.mark.parametrize(
    ("defines", "reason"),
    [
        (("HELIBORE_NODE=", "HELIBORE_NPM="), "Node.js 18 or newer and npm were not there"),
        (("HELIBORE_PAGE=OFF",), "HELIBORE_PAGE was OFF"),
    ],
)
def test_without_node_the_reason_is_in_the_package(tmp_path: Path, defines: tuple[str, ...], reason: str) -> None:
    viewer = install(tmp_path, *defines)
    assert sorted(path.name for path in viewer.rglob("*")) == ["no-page.txt"]
    assert (viewer / "no-page.txt").read_text() == f"{reason}\n"


@pytest.mark.skipif(shutil.which("node") is None, reason="Node.js is not here")
def test_an_npm_that_cannot_install_is_no_error(tmp_path: Path) -> None:
    npm = tmp_path / "npm"
    npm.write_text("#!/bin/sh\necho 'npm error network: no such host' >&2\nexit 1\n")
    npm.chmod(0o755)
    viewer = install(tmp_path, f"HELIBORE_NPM={npm}")
    said = (viewer / "no-page.txt").read_text()
    assert said == "npm could not install what it is made of: npm error network: no such host\n"


@pytest.mark.skipif(page("app.js") is None, reason="the page is not built: Node.js 18 was not there")
def test_with_node_the_page_is_that_of_these_sources(tmp_path: Path) -> None:
    viewer = install(tmp_path)
    if (viewer / "no-page.txt").is_file():
        pytest.skip((viewer / "no-page.txt").read_text())
    assert sorted(path.name for path in (viewer / "page").iterdir()) == FILES
    for name in FILES:
        assert (viewer / "page" / name).read_bytes() == page(name), f"{name}: the installed page is of other sources"
