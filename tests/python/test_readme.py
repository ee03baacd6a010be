"""The programs on the README's page run as they stand there."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text()
IMAGES = ROOT.parent / "shared/data/lwd-images"
F12 = ROOT.parent / "shared/data/calipers/volve_F-12_2010_pfcs_xy_caliper.csv.gz"


def block(language: str, having: str) -> str:
    blocks = re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)
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
    source = tmp_path / "main.cpp"
    source.write_text(block("cpp", "int main"))
    warnings = ("-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-std=c++20")
    subprocess.run(["c++", *warnings, "-I", ROOT / "cpp/include", source], check=True)


def test_real_hole(tmp_path: Path) -> None:
    if not F12.exists():
        pytest.skip("shared/data/calipers is not beside the project: no Volve F-12 caliper")
    for having in ("-o f12.glb", "--from-settings"):
        for line in block("sh", having).replace("\\\n", " ").replace(F12.name, str(F12)).splitlines():
            subprocess.run([sys.executable, "-m", *shlex.split(line)], cwd=tmp_path, check=True, capture_output=True)
    assert (tmp_path / "f12.glb").read_bytes()[:4] == b"glTF"
    assert (tmp_path / "again.glb").read_bytes() == (tmp_path / "f12-larger.glb").read_bytes()


def test_every_place_named_is_there() -> None:
    for name in ("develop", "cpp/DESIGN.md", "CHANGELOG.md", "LICENSE", "docs/helibore-demo.png", "tests/consumer"):
        assert name in README
        assert (ROOT / name).exists(), name
