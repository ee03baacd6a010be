"""Proofs that helibore is a good guest: ``python tests/slow/guest.py [languages|ways|overhead|...]``.

languages  builds and installs the library, then builds and runs the host of tests/consumer in C, C++, Python, C#
           (mono), Pascal and Rust: all print the same; a language without its compiler is skipped by name
ways       a host's project takes helibore in by find_package, add_subdirectory and FetchContent, beside another GLM and
           odd GLM macros, and without CMake by pkg-config and by plain -lhelibore
overhead   an append of 1,000 through the C interface takes at most 2 % longer than in C++
wheel      ./develop wheel, from two folders: the same bytes; its speed beside that of the g++ build; the source
           distribution, built and installed by pip
aarch64    builds the C++ tests for AArch64 and runs them under qemu: the same bits, every law
windows    builds library, tests and the host in C with MinGW and runs them under Wine: the same bits and numbers
day        24 hours of live data through the C interface: 10 samples a second, polled after each packet of a second, a
           station every 30 minutes, an image row every 10 seconds; memory is flat beyond samples, vertices and rows

On Debian: apt-get install mono-mcs mono-runtime libmono-system4.0-cil fp-compiler rustc g++-aarch64-linux-gnu qemu-user
g++-mingw-w64-x86-64-posix wine wine64
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import re
import shutil
import statistics
import subprocess
import sys
import time
from ctypes import byref, c_double, c_int64
from pathlib import Path

ROOT = Path(__file__).parents[2]
CONSUMER = ROOT / "tests" / "consumer"
BUILD = ROOT / "build" / "guest"


def run(*command: str | Path, cwd: Path = ROOT, **environment: str) -> str:
    done = subprocess.run(
        list(map(str, command)), env={**os.environ, **environment}, cwd=cwd, capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}")
    return done.stdout


def build(name: str, *options: str, tests: list[str] | None = None) -> Path:
    folder = BUILD / name
    run("cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", *options)
    targets = ["--target", "helibore", "helibore_c", *tests] if tests else []
    run("cmake", "--build", folder, "-j2", *targets)
    return folder


def installed() -> Path:
    prefix = BUILD / "installed"
    run("cmake", "--install", build("release"), "--prefix", prefix)
    return prefix


def languages() -> None:
    prefix = installed()
    (library,) = prefix.glob("lib*/libhelibore.so")
    where, made = library.parent, BUILD / "hosts"
    shutil.rmtree(made, ignore_errors=True)
    run("cmake", "-S", CONSUMER, "-B", made, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}")
    run("cmake", "--build", made)
    expected = run(made / "host")
    print(expected, end="")
    print("C++:", run(made / "consumer").strip())

    def other(language: str, needs: str, compile_: list[str | Path], start: list[str | Path]) -> None:
        if not shutil.which(needs):
            print(f"{language}: skipped, no {needs}")
            return
        if compile_:
            run(*compile_)
        same = run(*start, LD_LIBRARY_PATH=str(where)).replace("\r", "") == expected
        print(f"{language}: {'the same' if same else 'DIFFERENT'}")
        if not same:
            sys.exit(1)

    other("Python", sys.executable, [], [sys.executable, CONSUMER / "host.py", library])
    assembly = made / "host.exe"
    other("C#", "mcs", ["mcs", f"-out:{assembly}", CONSUMER / "host.cs"], ["mono", assembly])
    pascal = ["fpc", f"-Fl{where}", f"-FE{made}", f"-o{made / 'pascal'}", CONSUMER / "host.pas"]
    other("Pascal", "fpc", pascal, [made / "pascal"])
    other("Rust", "rustc", ["rustc", "-L", where, CONSUMER / "host.rs", "-o", made / "rust"], [made / "rust"])


def ways() -> None:
    """The other GLM is this machine's with another version; the host gives its folder and macros to the core, too."""
    prefix, made = installed(), BUILD / "ways"
    shutil.rmtree(made, ignore_errors=True)
    glm = made / "glm"
    shutil.copytree("/usr/include/glm", glm / "glm")
    header = glm / "glm/detail/setup.hpp"
    text = header.read_text()
    header.write_text(re.sub(r"(#define GLM_VERSION_(?:MAJOR|PATCH)\s+)\d+", r"\g<1>7", text))
    expected, bits = run(sys.executable, CONSUMER / "host.py", next(prefix.glob("lib*/libhelibore.so"))), ""
    for way in ("find_package", "add_subdirectory", "FetchContent"):
        for host_glm in ("", glm):
            folder = made / f"{way}{'-glm' if host_glm else ''}"
            options = [f"-DWAY={way}", f"-DHELIBORE_SOURCE={ROOT}", f"-DCMAKE_PREFIX_PATH={prefix}"]
            options += [f"-DHOST_GLM={host_glm}", "-DCMAKE_BUILD_TYPE=Release"]
            run("cmake", "-S", CONSUMER / "ways", "-B", folder, "-G", "Ninja", *options)
            run("cmake", "--build", folder, "-j2")
            bits = bits or run(folder / "beside_glm")
            same(f"{folder.name}, C++", run(folder / "beside_glm"), bits)
            same(f"{folder.name}, C", run(folder / "host"), expected)
    library = next(prefix.glob("lib*/libhelibore.so")).parent
    flags = run("pkg-config", "--cflags", "--libs", library / "pkgconfig/helibore.pc").split()
    plain = [f"-I{prefix}/include", f"-L{library}", "-lhelibore"]
    for way, given in (("pkg-config", flags), ("plain -lhelibore", plain)):
        run("cc", CONSUMER / "host.c", "-o", made / "host", *given)
        same(way, run(made / "host", LD_LIBRARY_PATH=str(library)), expected)


def same(what: str, found: str, expected: str) -> None:
    print(f"{what}: {'the same' if found == expected else f'DIFFERENT: {found}'}", flush=True)
    if found != expected:
        sys.exit(1)


def overhead() -> None:
    prefix = installed()
    library = next(prefix.glob("lib*/libhelibore.so"))
    program = BUILD / "overhead"
    source = ROOT / "tests/slow/overhead.cpp"
    libraries = [library, library.with_suffix(".a"), f"-Wl,-rpath,{library.parent}", "-pthread"]
    run("c++", "-O2", "-std=c++20", source, f"-I{prefix}/include", *libraries, "-o", program)
    print(run(program), end="")


REBUILD = """
import random, time
import helibore as hb
rows = random.Random(1)
n = 240000
caliper = hb.Caliper([1000 + i / 2000 for i in range(n)], [rows.uniform(0, 360) for _ in range(n)],
                     [0.11 + rows.uniform(0, 0.01) for _ in range(n)])
times = []
for _ in range(5):
    began = time.process_time()
    hb.reconstruct(caliper, bit_diameter=0.216)
    times.append(time.process_time() - began)
print(min(times))
"""


def wheel() -> None:
    """The second folder is a clone of the commit; its wheel has the same name and the same bytes."""
    other = BUILD / "clone"
    shutil.rmtree(other, ignore_errors=True)
    run("git", "clone", "-q", ROOT, other)
    sums = []
    for folder in (ROOT, other):
        for old in folder.glob("dist/helibore-*manylinux*.whl"):
            old.unlink()
        print(run(folder / "develop", "wheel", cwd=folder), end="")
        (found,) = folder.glob("dist/helibore-*manylinux_2_28_x86_64.whl")
        sums.append(hashlib.sha256(found.read_bytes()).hexdigest())
        print(f"{sums[-1]}  {found.name}, {found.stat().st_size / 1e6:.2f} MB")
    print("two folders:", "the same bytes" if len(set(sums)) == 1 else "OTHER BYTES")
    speeds()
    source_distribution()
    if len(set(sums)) != 1:
        sys.exit(1)


def speeds() -> None:
    """Processor time of a batch of 240,000 in fresh processes in turn: the wheel, and the g++ build here."""
    portable, here = BUILD.parent / "wheel/empty/bin/python", [sys.executable, "-c", REBUILD]
    times: list[list[float]] = [[], []]
    for _ in range(5):
        times[0].append(float(run(portable, "-c", REBUILD, PYTHONPATH="")))
        times[1].append(float(run(*here, PYTHONPATH=str(ROOT / "python"))))
    ratio = statistics.median(a / b for a, b in zip(*times, strict=True))
    print(f"a batch of 240,000: {min(times[0]):.3f} s by the wheel, {min(times[1]):.3f} s by g++, ratio {ratio:.3f}")


def source_distribution() -> None:
    """As from a package index: archive, wheel, empty environment."""
    made, environment = BUILD / "sdist", BUILD / "sdist/environment"
    shutil.rmtree(made, ignore_errors=True)
    run(sys.executable, "-m", "build", "--sdist", "--no-isolation", "-o", made, ROOT)
    (archive,) = made.glob("*.tar.gz")
    run(sys.executable, "-m", "venv", environment)
    run(environment / "bin/pip", "install", "-q", archive)
    print(
        f"{archive.name}, {archive.stat().st_size / 1e6:.1f} MB:",
        run(environment / "bin/helibore", "--version"),
        end="",
    )
    licences = run(environment / "bin/python", "-c", LICENCES).split()
    print("licences:", *licences)
    if {"LICENSE", "fdlibm.txt", "glm.txt", "pybind11.txt"} - set(licences):
        sys.exit(1)


LICENCES = """
from importlib.metadata import files
print(*(file.name for file in files("helibore") if "licenses" in file.parts))
"""


def run_tests(folder: Path, names: list[str]) -> None:
    these = f"^({'|'.join(names)})$"
    print(run("ctest", "--test-dir", folder, "--no-tests=error", "--timeout", "3000", "-R", these), end="")


def aarch64() -> None:
    """Not those of memory, which measure the emulator, nor the one that loads a library a thousand times."""
    emulator = "qemu-aarch64;-L;/usr/aarch64-linux-gnu"
    names = sorted(test.stem for test in (ROOT / "tests/cpp").glob("test_*.cpp"))
    names = [name for name in names if name != "test_unload" and "memory" not in name]
    folder = build(
        "aarch64",
        "-DCMAKE_SYSTEM_NAME=Linux",
        "-DCMAKE_SYSTEM_PROCESSOR=aarch64",
        "-DCMAKE_CXX_COMPILER=aarch64-linux-gnu-g++",
        f"-DCMAKE_CROSSCOMPILING_EMULATOR={emulator}",
        "-DCMAKE_CXX_FLAGS=-DHELIBORE_SMALL_TESTS",
        "-DHELIBORE_TESTS=ON",
        tests=names,
    )
    run_tests(folder, names)


def windows() -> None:
    """The tests that replace the allocator need std::aligned_alloc, which Windows lacks."""
    names = [f"test_{name}" for name in ("host_state", "bits", "path", "surface", "logs", "image", "wits", "wall")]
    folder = build(
        "windows",
        "-DCMAKE_SYSTEM_NAME=Windows",
        "-DCMAKE_SYSTEM_PROCESSOR=x86_64",
        "-DCMAKE_CXX_COMPILER=x86_64-w64-mingw32-g++-posix",
        "-DCMAKE_EXE_LINKER_FLAGS=-static",
        "-DCMAKE_CROSSCOMPILING_EMULATOR=wine",
        "-DHELIBORE_TESTS=ON",
        tests=names,
    )
    os.environ["WINEDEBUG"] = "-all"
    run_tests(folder, names)
    prefix = BUILD / "windows-installed"
    run("cmake", "--install", folder, "--prefix", prefix)
    host = prefix / "bin" / "host.exe"
    run(
        "x86_64-w64-mingw32-gcc",
        CONSUMER / "host.c",
        f"-I{prefix}/include",
        f"-L{prefix}/lib",
        "-lhelibore",
        "-o",
        host,
    )
    reported = run("wine", host).replace("\r", "")
    same = run(sys.executable, CONSUMER / "host.py", next(installed().glob("lib*/libhelibore.so"))) == reported
    print("The host in C under Wine prints", "what it prints on Linux" if same else f"other numbers:\n{reported}")
    if not same:
        sys.exit(1)


def day() -> None:
    """Prints memory after each two hours; fails if it grows beyond what is kept."""
    sys.argv[1] = str(next(installed().glob("lib*/libhelibore.so")))
    sys.path.insert(0, str(CONSUMER))
    import host

    class Update(ctypes.Structure):
        _fields_ = [("size", ctypes.c_uint32), ("reserved", ctypes.c_int32), ("change", host.Change)]
        _fields_ += [("path_from", c_double), ("images", c_int64), ("events", c_int64)]

    hb, check, numbers = host.hb, host.check, host.numbers
    settings, how, live, wall = host.made(host.Settings), host.made(host.PathSettings), c_int64(), c_int64()
    check(hb.hb_settings_init(byref(settings)))
    check(hb.hb_path_settings_init(byref(how)))
    settings.bit_diameter, settings.start_depth, how.extend = 0.216, 1000.0, 100.0
    check(hb.hb_live_create(byref(settings), byref(how), byref(live)))
    check(hb.hb_live_wall(live, byref(wall)))
    began, update, state, first, beyond = time.perf_counter(), host.made(Update), host.made(host.State), 0, 0
    row = numbers(range(16))
    for second in range(86400):
        times = [second + i / 10 for i in range(10)]
        depth = numbers(1000 + t * 20 / 3600 for t in times)  # 20 m an hour
        toolface, radius = numbers(t * 720 % 360 for t in times), numbers(0.11 + (t % 7) * 0.001 for t in times)
        check(hb.hb_live_append_samples(live, c_int64(10), depth, toolface, radius, numbers(times)))
        if second % 1800 == 0:
            station = [numbers([value]) for value in (depth[0], 5.0, 40.0)]
            check(hb.hb_live_append_stations(live, c_int64(1), *station))
        if second % 10 == 0:
            check(hb.hb_live_append_image(live, b"GR", b"gAPI", c_int64(1), 16, depth, row))
        check(hb.hb_live_poll(live, byref(update)))
        if second % 7200 == 7199:
            check(hb.hb_wall_get(wall, byref(state)))
            pages = int(Path("/proc/self/statm").read_text().split()[1])
            beyond = pages * 4096 - 32 * state.samples - 40 * state.vertices - 17 * 8 * second // 10
            first = first or beyond
            text = f"{state.samples} samples, {state.vertices} vertices, {pages * 4096 / 1e6:.1f} MB"
            seconds = time.perf_counter() - began
            print(f"{second // 3600 + 1:2} h: {text}, {beyond / 1e6:.1f} MB beyond these, {seconds:.0f} s", flush=True)
    check(hb.hb_close(wall))
    check(hb.hb_close(live))
    if beyond > first + 10e6:
        sys.exit("memory grows")


if __name__ == "__main__":
    proofs = {
        "languages": languages,
        "ways": ways,
        "overhead": overhead,
        "wheel": wheel,
        "aarch64": aarch64,
        "windows": windows,
        "day": day,
    }
    for proof in sys.argv[1:] or proofs:
        proofs[proof]()
