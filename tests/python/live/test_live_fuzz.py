"""The fuzzer's random inputs, a few of them; and the page of guarantees names tests that exist."""

from __future__ import annotations

import re
import shutil
import subprocess

import pytest
from locations import ROOT


@pytest.mark.skipif(shutil.which("c++") is None, reason="there is no C++ compiler here")
def test_fuzzed(tmp_path):
    names = "acquire/wits.cpp", "base/error.cpp"
    fuzz = [ROOT / "tests/cpp/fuzz" / name for name in ("driver.cpp", "wits.cpp")]
    flags = ["-std=c++20", "-O0", *(f"-I{ROOT / folder}" for folder in ("cpp/include", "cpp/src", "tests/cpp"))]
    sources = [*fuzz, *(ROOT / "cpp/src" / name for name in names)]
    subprocess.run(["c++", *flags, *sources, "-o", tmp_path / "fuzz_wits"], check=True)
    subprocess.run([tmp_path / "fuzz_wits", "-runs=500", "-seed=1"], check=True, cwd=tmp_path)


def test_every_guarantee_names_a_test_that_exists():
    page = (ROOT / "docs/guarantees.md").read_text()
    sentences = re.findall(r"^(\d+)\. (.*?)(?=^\d+\. |^$)", page, re.MULTILINE | re.DOTALL)
    assert [int(number) for number, _ in sentences] == list(range(1, len(sentences) + 1))
    assert len(sentences) >= 40
    for number, text in sentences:
        named = re.findall(r"`(test_\w+\.py)::(\w+)`", text)
        assert named, number
        for file, name in named:
            assert f"def {name}(" in next((ROOT / "tests/python").rglob(file)).read_text(), (number, name)
