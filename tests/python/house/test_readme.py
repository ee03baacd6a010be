"""Every block of README.md and of the pages in docs runs as it stands there, or is read by what will read it.

Shell: verbs of helibore run, those that would wait are read with all their options; of other programs, what they name
is there. Python runs. TOML is read by its own reader. What a block needs and does not make is a
public file where that is beside the project, else it is simulated (stand_ins). Blocks that the documentation build
reads (``{toctree}`` and the like) fail there; ini and yaml are those of cli/test_live_service.py.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np
import pytest
from locations import ROOT, SHARED
from stand_ins import write_stand_ins

import helibore as hb
from helibore.cli import cli
from helibore.files.text_layouts import rules_of
from helibore.live.rules.configuration import parse
from helibore.runs.manifest import read_jobs
from helibore.runs.project import read_project
from helibore.settings.role_settings import MapOfRoles
from helibore.settings.toml_reading import TomlSource, read_table
from helibore.simulation.rig import Rig

README, DOCS = ROOT / "README.md", ROOT / "docs"
NAMES = ("index", "analyst", "signing", "driller", "live", "wells", "televiewer", "developer")
PAGES = (README, *(DOCS / f"{name}.md" for name in NAMES))
ALL = sorted({*PAGES, *DOCS.rglob("*.md"), ROOT / "CONTRIBUTING.md"})
IMAGES = SHARED / "lwd-images"
REAL = {
    "volve_F-12_2010_pfcs_xy_caliper.csv.gz": SHARED / "calipers/volve_F-12_2010_pfcs_xy_caliper.csv.gz",
    "P11-A-02.las": IMAGES / "P11-A-02_Composite_MEM_Image_NF.las",
    "15_9-F-15_D.json": IMAGES / "15_9-F-15_D__WL_RAW_BHPR-CAL-DEN-GR-MECH-NEU-REMP_MWD_2.json",
}
WAITING = ("view", "live", "reprocess")
"""Verbs that serve, listen or start processes: their options are read, and other tests run them."""


@dataclass(frozen=True)
class Block:
    """A fenced block: its page and line, its language, its text."""

    page: Path
    line: int
    language: str
    text: str

    def __str__(self) -> str:
        return f"{self.page.relative_to(ROOT)}:{self.line} ({self.language})"


def blocks(page: Path) -> list[Block]:
    text = page.read_text()
    found = re.finditer(r"^```([\w+{}-]*)[^\n]*\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)
    return [Block(page, text.count("\n", 0, of.start()) + 1, of[1], of[2]) for of in found]


def words_of(text: str) -> Iterator[list[str]]:
    """The words of each command of a block of shell."""
    for line in text.replace("\\\n", " ").splitlines():
        for command in re.split(r" && | \| ", line):
            if words := shlex.split(command, comments=True):
                yield words


def run_helibore(words: list[str]) -> None:
    """Run a verb, on a few metres; read the options of one that would wait."""
    verb, *options = (word.replace("preparation.deepest=3240", "preparation.deepest=3110") for word in words)
    command = cli.get_command(click.Context(cli), verb)
    assert command is not None, verb
    if (verb in WAITING and "--check" not in options) or "--wits" in options:
        command.make_context(verb, options)
        return
    if verb == "cement" and hb.load("f12.wall").samples.depth.max() < 3230:  # the stand-in ends above the casing
        command.make_context(verb, options)
        return
    if verb in ("plot", "report"):
        options += [
            "--to",
            "3081" if "f12.wall" in options else "1955" if "--gauge" in options else "2002",
            "--dpi",
            "50",
        ]
    if verb == "simulate":
        options += ["--to", "2010m"]
    if (verb, options[0]) == ("journal", "archive"):
        options.append("--help")  # a short journal has no checkpoints, and archiving it is refused
    cli.main([verb, *options], standalone_mode=False)


def check_program(words: list[str]) -> None:
    """Check that what a command of another program names is there: in develop, pyproject.toml, the folders, a test."""
    program, *rest = words
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    if program == "./develop":
        assert re.search(rf"^    (\w+ \| )?{rest[0]}( \| \w+)?\)", (ROOT / "develop").read_text(), re.MULTILINE), rest
    elif program == "pip":
        named = re.findall(r"\[([\w,]+)\]", " ".join(rest))
        assert [of for group in named for of in group.split(",") if of not in extras] == []
    elif program == "python":
        assert (ROOT / (rest[1].replace(".", "/") + ".py" if rest[0] == "-m" else rest[0])).exists()
    elif program in ("cmake", "cc"):  # built and run by this test
        assert "def test_hosts_in_c_and_python(" in (ROOT / "tests/python/house/test_cpp.py").read_text()
    else:
        assert program in ("apt-get", "tee", "dask", "kill", "git"), program


def run_shell(block: Block, known: set[tuple[str, ...]]) -> None:
    """Run the commands of a block that no block before it had."""
    for words in words_of(block.text):
        if tuple(words) in known:
            continue
        known.add(tuple(words))
        if words[0] == "helibore":
            run_helibore(words[1:])
        else:
            check_program(words)


def frames_of_a_rig() -> bytes:
    """What a rig sends, and beside it the configurations that the page of live data names."""
    rig = Rig("em", 2500.0, 2501.0, 0.0)
    pushed = '[source.rig]\naddress = "values"\nunits = "metric"\n'
    pushed += "".join(f'show.{name.upper()} = {{ name = "{name}", unit = "m" }}\n' for name in ("bit", "hole", "rpm"))
    for name in ("rig.toml", "corrected.toml"):
        Path(name).write_text(rig.configuration("host").replace("[source.rig]", "[source.mwd]") + pushed)
    return b"".join(frame for _, frame in rig.frames())


def given(block: Block) -> dict[str, object]:
    """What a program of a page expects to be there."""
    names: dict[str, object] = {"__name__": "__main__", "hb": hb, "np": np}
    if block.page.name == "live.md":
        depth, toolface = np.arange(2501.0, 2502.0, 0.01), np.arange(100) * 37.0
        names |= {"chunk": frames_of_a_rig(), "depth": depth, "toolface": toolface, "radius": np.full(100, 0.11)}
        names |= {"time": np.arange(100.0), "values": np.ones((100, 4))}
    if "mean_diameter" in block.text:
        names |= {"depth": np.arange(107, 109, 0.01), "mean_diameter": np.full(200, 0.104)}
    if "hb.tune(caliper" in block.text:
        names["caliper"] = hb.open("caliper.csv").caliper()
    return names


def run_python(block: Block) -> None:
    if "Client(" not in block.text:
        exec(compile(block.text, str(block), "exec"), given(block))
        return
    from distributed import LocalCluster, default_client

    with LocalCluster(processes=False, n_workers=1, dashboard_address=":0") as cluster:
        text = block.text.replace("tls://host:8786", cluster.scheduler_address)
        exec(compile(text, str(block), "exec"), given(block))
        default_client().close()


def read_toml(block: Block) -> None:
    tree = tomllib.loads(block.text)
    if {"caliper", "survey"} & set(tree):
        Path("well.toml").write_text(block.text)
        Path("field.toml").write_text('unit = "in"\n[[track]]\nkind = "caliper"\n')
        assert read_project("well.toml").wall
    elif "layouts" in tree:
        Path("layouts.toml").write_text(block.text)
        assert rules_of(Path("layouts.toml").absolute()).layouts
    elif "names" in tree:
        assert read_table(MapOfRoles, tree, TomlSource(str(block))).names
    elif "well" in tree:
        Path("page.toml").write_text(block.text)
        for project in (Path(well["project"]) for well in tree["well"] if "project" in well):
            project.parent.mkdir(exist_ok=True)
            project.write_text(
                'caliper = "caliper.csv"\n[header]\nwell = "15/9-F-5"\n[wall]\nbit_diameter = "8 1/2in"\n'
            )
        assert [job.well for job in read_jobs("page.toml")] == [well.get("name", "15/9-F-5") for well in tree["well"]]
    else:
        wall = "" if "wall" in tree else "[wall]\nbit_diameter = 0.2\nstart_depth = 10.0\n"
        assert set(parse(wall + block.text).sources) == set(tree["source"])


def read_sql(block: Block) -> None:
    """The columns that the queries name are those of the tables that were written."""
    import pyarrow.parquet as parquet

    (logs, *_) = Path("walls/logs").rglob("*.parquet")
    columns = {*parquet.read_schema(logs).names, *parquet.read_schema("walls/catalogue.parquet").names, "well"}
    queries = re.sub(r"'[^']*'", "", block.text)
    assert set(re.findall(r"\w+", queries)) - columns == {
        "SELECT", "sum", "max", "FROM", "GROUP", "BY", "WHERE", "0", "9", "read_parquet", "union_by_name", "true",
    }  # fmt: skip


def read_cmake(block: Block) -> None:
    used = (ROOT / "tests/consumer/CMakeLists.txt").read_text().replace("helibore 0.1 CONFIG", "helibore CONFIG")
    package, target = re.findall(r"find_package\(.*?\)|helibore::\w+", block.text)
    assert package in used
    assert target in used


def compile_c(block: Block) -> None:
    """Only compiled: test_c.cpp runs the whole interface."""
    Path("block.c").write_text(block.text)
    flags = ["-std=c11", "-fsyntax-only", "-Wall", "-Wextra", "-Werror"]
    subprocess.run([os.environ.get("CC", "cc"), *flags, "-I", ROOT / "cpp/include", "block.c"], check=True)


def compile_cpp(block: Block) -> None:
    text = "#include <helibore/live.hpp>\n#include <helibore/surface.hpp>\n#include <helibore/wall.hpp>\n"
    if "int main" not in block.text:
        columns = "depth, toolface, radius, time, station_depth, inclination, azimuth".replace(", ", ", Column ")
        text += "using Column = std::vector<double>;\ntemplate <class T> void draw(const T&) {}\n"
        text += f"void host(Column {columns}) {{\n{block.text}}}\n"
    else:
        text += block.text
    Path("block.cpp").write_text(text)
    warnings = ("-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-std=c++20")
    subprocess.run([os.environ.get("CXX", "c++"), *warnings, "-I", ROOT / "cpp/include", "block.cpp"], check=True)


def leave(_block: Block) -> None:
    """Nothing: the build of the documentation, or cli/test_live_service.py, reads it."""


SHELL = ("sh", "console")
RUN: dict[str, Callable[[Block], None]] = {
    "python": run_python, "toml": read_toml, "sql": read_sql,
    "cmake": read_cmake, "cpp": compile_cpp, "c": compile_c, "json": lambda block: json.loads(block.text),
    "ini": leave, "yaml": leave,
}  # fmt: skip


def run_pages(pages: tuple[Path, ...]) -> None:
    known: set[tuple[str, ...]] = set()
    for page in pages:
        for block in sorted(blocks(page), key=lambda block: block.language == "sql"):  # of what Python writes below it
            if not block.language.startswith("{"):
                try:
                    if block.language in SHELL:
                        run_shell(block, known)
                    else:
                        RUN[block.language](block)
                except BaseException as error:
                    error.add_note(str(block))
                    raise


def test_every_block_has_what_runs_it() -> None:
    found = [block for page in ALL for block in blocks(page) if not block.language.startswith("{")]
    assert [str(block) for block in found if block.language not in {*RUN, *SHELL}] == []
    assert {block.page for block in found} - {*PAGES, DOCS / "embedding.md"} == set()
    assert len(found) > 30


def test_indented_commands_are_blocks() -> None:
    """An indented line is not run: commands stand in fenced blocks."""
    assert [
        line for page in ALL for line in re.findall(r"^    (?:helibore|\./develop|pip) .*$", page.read_text(), re.M)
    ] == []


def test_every_block_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_stand_ins(tmp_path)
    for name, path in REAL.items():
        if path.exists():
            (tmp_path / name).unlink()
            (tmp_path / name).symlink_to(path)
    shutil.copytree(ROOT / "examples/files", tmp_path, dirs_exist_ok=True)
    (tmp_path / "examples").mkdir()
    (tmp_path / "examples/files").symlink_to(ROOT / "examples/files")
    text = (tmp_path / "wells/manifest.toml").read_text()
    (tmp_path / "manifest.toml").write_text(text.replace("../", ""))
    frames_of_a_rig()
    run_pages((*PAGES, DOCS / "embedding.md"))
    made = {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()}
    assert made["again.glb"] == made["f12-larger.glb"]
    assert made["well.glb"][:4] == made["xy.glb"][:4] == b"glTF"
    assert {"f12.las", "hole.csv", "zones.csv", "f12.pdf", "images.pdf", "f12.html", "helibore-log.png"} < made.keys()


@pytest.mark.parametrize(
    "page",
    [*sorted(ROOT.glob("*.md")), ROOT / "cpp" / "DESIGN.md", *sorted(ROOT.glob("docs/*.md"))],
    ids=lambda page: page.name,
)
def test_every_link_and_path_leads_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", page.read_text()):
        assert (page.parent / target).exists(), target
    for path in re.findall(r"`((?:python|cpp|tests|bench|docs)/[\w/.]*)`", page.read_text()):
        assert (ROOT / path).exists(), path
