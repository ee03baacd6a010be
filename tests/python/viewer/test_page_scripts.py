"""The page's own tests (protocol, store, maths), run by Node's test runner as part of this suite."""

from __future__ import annotations

import shutil
import subprocess

import pytest
from locations import WEB
from patience import PATIENCE

NODE = shutil.which("node")


@pytest.mark.skipif(NODE is None, reason="Node.js is not here: the page's own tests need it")
def test_the_pages_own_tests_pass() -> None:
    assert NODE is not None
    files = sorted(str(path) for path in (WEB / "tests").glob("*.test.js"))
    assert files
    run = subprocess.run(
        [NODE, "--test", *files], cwd=WEB, capture_output=True, text=True, timeout=PATIENCE, check=False
    )
    assert run.returncode == 0, run.stdout + run.stderr
