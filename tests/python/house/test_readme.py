"""The programs of README.md and of the pages in docs run as they stand there."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from locations import ROOT

README = (ROOT / "README.md").read_text()
PAGES = README + "".join(path.read_text() for path in sorted(ROOT.glob("docs/*.md")))
IMAGES = ROOT.parent / "shared/data/lwd-images"
F12 = ROOT.parent / "shared/data/calipers/volve_F-12_2010_pfcs_xy_caliper.csv.gz"

REAL = {F12.name: F12, "P11-A-02.las": IMAGES / "P11-A-02_Composite_MEM_Image_NF.las"}


def block(language: str, having: str) -> str:
    blocks = re.findall(rf"```{language}\n(.*?)```", PAGES, re.DOTALL)
    return next(text for text in blocks if having in text)


def test_python(tmp_path: Path) -> None:
    subprocess.run([sys.executable, "-W", "error", "-c", block("python", "reconstruct")], cwd=tmp_path, check=True)
    assert (tmp_path / "well.glb").stat().st_size > 10_000


def test_python_from_files(tmp_path: Path) -> None:
    subprocess.run([sys.executable, "-m", "helibore", "simulate", ".", "--to", "2002m", "-q"], cwd=tmp_path, check=True)
    program = "import helibore as hb\n" + block("python", "prepare")
    subprocess.run([sys.executable, "-W", "error", "-c", program], cwd=tmp_path, check=True)


def test_python_images_from_files(tmp_path: Path) -> None:
    if not IMAGES.is_dir():
        pytest.skip("shared/data/lwd-images is not beside the project")
    program = "import numpy as np\nimport helibore as hb\n" + block("python", "ABDC")
    for short in ("P11-A-02.las", "15_9-F-15_D.json"):
        stem, ending = short.split(".")
        (whole,) = IMAGES.glob(f"{stem}_*.{ending}")
        program = program.replace(short, str(whole))
    program += "assert len(wall.surface().attributes) == 4\n"
    subprocess.run([sys.executable, "-W", "error", "-c", program], cwd=tmp_path, check=True)
    assert (tmp_path / "f15d.glb").stat().st_size > 1_000_000


def test_cpp(tmp_path: Path) -> None:
    live = (
        "#include <helibore/live.hpp>\nusing Column = std::vector<double>;\ntemplate <class T> void draw(const T&) {}\n"
    )
    columns = "depth, toolface, radius, time, station_depth, inclination, azimuth"
    live += f"void host(Column {columns.replace(', ', ', Column ')}) {{\n{block('cpp', 'Live live')}}}\n"
    source = tmp_path / "main.cpp"
    source.write_text(block("cpp", "int main") + live)
    warnings = ("-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-std=c++20")
    subprocess.run(["c++", *warnings, "-I", ROOT / "cpp/include", source], check=True)


def commands(having: str, folder: Path) -> None:
    """Run the lines of a block in a folder, on the real files they name; the pictures of a long well on 5 m of it."""
    text = block("sh", having).replace("\\\n", " ")
    for short, whole in REAL.items():
        text = text.replace(short, str(whole))
    for command in text.replace("&&", "\n").splitlines():
        words = shlex.split(command, comments=True)
        if words[1] in ("plot", "report"):
            words += ["--to", "3085" if "f12.wall" in words else "1955" if "--gauge" in words else "2005"]
        subprocess.run([sys.executable, "-m", *words], cwd=folder, check=True, capture_output=True)


def test_real_hole(tmp_path: Path) -> None:
    if not F12.exists() or not IMAGES.is_dir():
        pytest.skip("shared/data is not beside the project: no Volve F-12 caliper, no images")
    for having in ("-o f12.glb", "-o f12-larger.glb", "helibore simulate hole", "--gauge", "-o helibore-log.png"):
        commands(having, tmp_path)
    made = {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()}
    assert made["f12.glb"][:4] == b"glTF"
    assert made["again.glb"] == made["f12-larger.glb"]
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
