"""The C++ side from outside: its own tests, installed headers, and a project that finds the package."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import live_pushes
import pytest
from locations import ROOT
from patience import PATIENCE

import helibore

CC, CXX = os.environ.get("CC", "cc"), os.environ.get("CXX", "c++")
C_HEADER = ROOT / "cpp/include/helibore/helibore.h"


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
    run("sh", ROOT / "tests/cpp/compile.sh")
    return ROOT / "build/cpp"


def test_ctest(build: Path) -> None:
    run("ctest", "--test-dir", build, "--output-on-failure", "--no-tests=error", "--timeout", str(int(PATIENCE)))


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


# What the hosts in C, Python and, by tests/slow/guest.py, other languages print.
HOST = """\
1000 samples, 1 changed ranges, settled to 304
1000 samples, 1 changed ranges, settled to 624
1000 samples, 1 changed ranges, settled to 944
1000 samples, 2 changed ranges, settled to 1264
1000 samples, 1 changed ranges, settled to 1584
1600 vertices, 1567 quads, first at 142.868517 161.169107 963.727388
toolface[17] = -inf: must be finite
"""
NAMES = """close instruction_set last_error live_append_image live_append_samples live_append_stations live_create
live_event live_image live_path live_poll live_wall path_create path_read path_settings_init preparation_init
prepare prepared_get prepared_samples prepared_suspects ranges settings_init
use_runner version wall_angular_gaps wall_append wall_arm_zones wall_create wall_estimate wall_get wall_interpolate
wall_logs wall_passage wall_read wall_samples wall_sigma wall_surface wall_volume wall_zones wits_create wits_feed
wits_items zone_criteria_init"""


def test_the_shared_library_exports_the_names_of_its_header(build: Path) -> None:
    listed = run("nm", "-D", "--defined-only", build / "cpp/libhelibore.so")
    exported = {line.split()[-1].split("@")[0] for line in listed.splitlines()} - {"HELIBORE_0.1"}
    assert exported == {f"hb_{name}" for name in NAMES.split()}
    assert exported == set(re.findall(r"\b(hb_\w+)\(", C_HEADER.read_text()))


# Bytes and members of each struct; they change with the minor version only.
STRUCTS = {
    "hb_settings": (280, 29),
    "hb_path_settings": (48, 8),
    "hb_wall_state": (40, 6),
    "hb_change": (40, 6),
    "hb_update": (72, 6),
    "hb_sigma_rule": (56, 8),
    "hb_preparation": (40, 7),
    "hb_prepared_state": (72, 10),
    "hb_zone_criteria": (88, 12),
}


def test_the_structs_of_the_header_are_frozen(tmp_path: Path) -> None:
    text = C_HEADER.read_text()
    bodies = dict(re.findall(r"typedef struct (\w+) \{(.*?)\} \1;", text, flags=re.DOTALL))
    assert {name: len(re.findall(r"^ .*?;", body, flags=re.MULTILINE)) for name, body in bodies.items()} == {
        name: members for name, (_, members) in STRUCTS.items()
    }
    sizes = (f"typedef char size_of_{name}[sizeof({name}) == {size} ? 1 : -1];" for name, (size, _) in STRUCTS.items())
    source = tmp_path / "sizes.c"
    source.write_text(f'#include "{C_HEADER}"\n' + "\n".join(sizes) + "\n")
    run(CC, "-fsyntax-only", source)


def test_hosts_in_c_and_python(prefix: Path, consumer: Path, tmp_path: Path) -> None:
    """They find the library by CMake, by pkg-config (or plain -lhelibore where that is missing) and by its name."""
    if not (prefix / "include/helibore" / C_HEADER.name).exists():
        return  # a wheel has no shared library
    (library,) = prefix.glob("lib*/libhelibore.so")
    flags = [f"-I{prefix}/include", f"-L{library.parent}", "-lhelibore"]
    if shutil.which("pkg-config"):
        flags = run("pkg-config", "--cflags", "--libs", library.parent / "pkgconfig/helibore.pc").split()
    flags += [f"-Wl,-rpath,{library.parent}", "-Wall", "-Wextra", "-Werror"]
    run(CC, "-std=c99", ROOT / "tests/consumer/host.c", "-o", tmp_path / "host", *flags)
    assert run(consumer / "host") == HOST
    assert run(consumer / "host_allocator") == HOST + "all memory given back\n"
    assert run(tmp_path / "host") == HOST
    assert run(sys.executable, ROOT / "tests/consumer/host.py", library) == HOST


def test_a_host_of_the_first_header_works_with_the_newest_library(prefix: Path, tmp_path: Path) -> None:
    if not (prefix / "include/helibore" / C_HEADER.name).exists():
        return  # a wheel has no shared library
    (library,) = prefix.glob("lib*/libhelibore.so")
    first = ROOT / "tests/consumer/first_header"
    assert (first / "helibore/helibore.h").read_text() != C_HEADER.read_text()
    flags = [f"-I{first}", f"-L{library.parent}", "-lhelibore", f"-Wl,-rpath,{library.parent}"]
    run(CC, "-std=c99", ROOT / "tests/consumer/host.c", "-o", tmp_path / "host", *flags)
    assert run(tmp_path / "host") == HOST


@pytest.mark.parametrize("standard", ["c89", "c99", "c11", "c17"])
def test_the_c_header_compiles_alone(standard: str) -> None:
    warnings = ("-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Wstrict-prototypes", "-Werror")
    run(CC, f"-std={standard}", *warnings, "-fsyntax-only", "-include", C_HEADER, "-x", "c", os.devnull)


def test_the_opening_lines_of_the_c_header_compile(tmp_path: Path) -> None:
    lines = re.findall(r"^       (.*)\n", C_HEADER.read_text().partition("#ifndef")[0], flags=re.MULTILINE)
    source = tmp_path / "opening.c"
    arguments = "int64_t n, const double* depth, const double* toolface, const double* radius"
    includes = f'#include <stdio.h>\n#include "{C_HEADER}"\n'
    source.write_text(f"{includes}void host({arguments});\nvoid host({arguments}) {{\n" + "\n".join(lines) + "\n}\n")
    run(CC, "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only", source)


def test_installed_headers(prefix: Path) -> None:
    """The public headers and no others, and none lets a host see GLM."""
    installed, public = prefix / "include/helibore", set(C_HEADER.parent.iterdir())
    if not (installed / C_HEADER.name).exists():  # a wheel has no shared library
        public -= {C_HEADER}
    assert {h.name: h.read_text() for h in installed.iterdir()} == {h.name: h.read_text() for h in public}
    assert not [header for header in installed.iterdir() if "glm" in header.read_text().lower()]


def test_installed_licences(prefix: Path) -> None:
    """Those of the code in the libraries; pybind11 is in the Python extension alone."""
    if (prefix / "include/helibore" / C_HEADER.name).exists():  # a wheel has them in its metadata
        licences = [ROOT / "LICENSE", *(ROOT / "cpp/licenses").glob("[!p]*.txt")]
        installed = [path for path in (prefix / "share/doc/helibore").rglob("*") if path.is_file()]
        assert {path.name: path.read_text() for path in installed} == {path.name: path.read_text() for path in licences}


@pytest.mark.parametrize("header", sorted(C_HEADER.parent.iterdir()), ids=lambda path: path.name)
def test_a_public_header_compiles_alone(header: Path) -> None:
    warnings = ("-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Werror")
    options = ("-std=c++20", "-fsyntax-only", "-x", "c++", "-include", header, "-I", header.parents[1])
    run(CXX, *warnings, *options, os.devnull)


# What pybind11 makes of a class: its metaclass, and an __init__ that refuses where there is no constructor.
ALLOWED = ("Path", "PointSamples", "SectionLibraries", "Stations", "Survey", "Wall", "WallLock", "WitsParser")


def test_the_stub_of_the_extension_is_right(tmp_path: Path) -> None:
    """What type checkers read is what the extension has: every name, argument and default."""
    pytest.importorskip("mypy")
    settings, allowed = tmp_path / "mypy.ini", tmp_path / "allowed.txt"
    settings.write_text("[mypy]\n[mypy-helibore,helibore.*]\nfollow_imports = skip\n")  # the stub needs NumPy alone
    allowed.write_text("".join(f"helibore._core.{name}\n" for name in ALLOWED))
    options = ("--mypy-config-file", settings, "--allowlist", allowed)
    run(sys.executable, "-m", "mypy.stubtest", "helibore._core", *options)
