"""The C++ side from outside: its own tests, installed headers, and a project that finds the package."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import live_pushes
import pytest
from locations import ROOT

import helibore

CXX = os.environ.get("CXX", "c++")


def run(*command: str | Path) -> str:
    """Run a program of this environment or the system; its output is the failure's text."""
    where = os.pathsep.join([sysconfig.get_path("scripts"), os.environ.get("PATH", "")])
    program = shutil.which(str(command[0]), path=where)
    assert program is not None, f"{command[0]} is missing: it comes with the extra: pip install 'helibore[test]'"
    environment = {**os.environ, "PATH": where}
    done = subprocess.run([program, *command[1:]], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{' '.join(map(str, command))}\n{done.stdout[-8000:]}\n{done.stderr[-8000:]}"
    return done.stdout


@pytest.fixture(scope="module")
def build() -> Path:
    """The core and its tests, compiled with warnings as errors; kept between runs."""
    build = ROOT / "build" / "cpp"
    options = ("-DHELIBORE_TESTS=ON", "-DHELIBORE_WARNINGS_AS_ERRORS=ON", "-DCMAKE_BUILD_TYPE=Release")
    run("cmake", "-S", ROOT, "-B", build, "-G", "Ninja", *options)
    run("cmake", "--build", build, "-j2")
    return build


def test_ctest(build: Path) -> None:
    run("ctest", "--test-dir", build, "--output-on-failure", "--no-tests=error", "--timeout", "300")


@pytest.fixture(scope="module", params=["cmake --install", "wheel"])
def prefix(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the package is installed: by CMake, and by pip inside the Python package."""
    if request.param == "wheel":
        places = [*helibore.__path__, str(Path(sysconfig.get_path("platlib")) / "helibore")]
        return next(Path(place) for place in places if (Path(place) / "lib/cmake/helibore").is_dir())
    installed = tmp_path_factory.mktemp("installed")
    run("cmake", "--install", request.getfixturevalue("build"), "--prefix", installed)
    return installed


@pytest.fixture(scope="module")
def consumer(prefix: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The programs of a project that finds the package there."""
    built = tmp_path_factory.mktemp("consumer")
    run("cmake", "-S", ROOT / "tests/consumer", "-B", built, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}")
    run("cmake", "--build", built)
    return built


def test_a_project_finds_the_package(consumer: Path) -> None:
    assert run(consumer / "consumer") == "1567 quads, radius 0.11 to 0.11 m\n"


def test_a_host_in_cpp_has_the_bits_of_python(consumer: Path) -> None:
    """The same samples, stations and image rows pushed through helibore::Live and hb.Live: every number they tell."""
    pushes = live_pushes.pushes()
    reported = subprocess.run(
        [consumer / "live"], input="".join(push.text for push in pushes), capture_output=True, text=True, check=True
    ).stdout
    assert reported.splitlines() == live_pushes.reported_by_python(pushes)


def test_installed_headers(prefix: Path) -> None:
    """The public headers and no others, and none lets a host see GLM."""
    installed, public = prefix / "include/helibore", ROOT / "cpp/include/helibore"
    assert {h.name: h.read_text() for h in installed.iterdir()} == {h.name: h.read_text() for h in public.iterdir()}
    assert not [header for header in installed.iterdir() if "glm" in header.read_text().lower()]


@pytest.mark.parametrize("header", sorted((ROOT / "cpp/include/helibore").glob("*.hpp")), ids=lambda path: path.name)
def test_a_public_header_compiles_alone(header: Path) -> None:
    warnings = ("-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Werror")
    options = ("-std=c++20", "-fsyntax-only", "-x", "c++", "-include", header, "-I", header.parents[1])
    run(CXX, *warnings, *options, os.devnull)


# What pybind11 makes of a class: its metaclass, and an __init__ that refuses where there is no constructor.
ALLOWED = ("Path", "Stations", "Survey", "Wall", "WitsParser")


def test_the_stub_of_the_extension_is_right(tmp_path: Path) -> None:
    """What type checkers read is what the extension has: every name, argument and default."""
    pytest.importorskip("mypy")
    settings, allowed = tmp_path / "mypy.ini", tmp_path / "allowed.txt"
    settings.write_text("[mypy]\n")
    allowed.write_text("".join(f"helibore._core.{name}\n" for name in ALLOWED))
    options = ("--mypy-config-file", settings, "--allowlist", allowed)
    run(sys.executable, "-m", "mypy.stubtest", "helibore._core", *options)
