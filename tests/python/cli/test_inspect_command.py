"""``helibore inspect``: the table of a file's channels."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from command import run

from helibore.cli.inspect_page import share
from helibore.files.raw_set import Channel


@pytest.mark.parametrize(
    ("missing", "total", "text"),
    [
        (0, 200, "0"),
        (1, 200, "1 (0.5 %)"),
        (30, 200, "30 (15 %)"),
        (199, 200, "199 (99.5 %)"),
        (200, 200, "200 (100 %)"),
    ],
)
def test_the_share_of_missing_values_is_a_plain_number(missing: int, total: int, text: str) -> None:
    values = np.where(np.arange(total) < missing, np.nan, 1.0)
    assert share(Channel("X", "m", "", values, (), None, values.shape, False)) == text


def test_a_channel_without_values_is_shown(tmp_path: Path) -> None:
    rows = "\n".join(f"{1000 + row / 10},," for row in range(50))
    (tmp_path / "c.csv").write_text(f"depth_m,A_in,B_in\n{rows}\n")
    result = run("inspect", tmp_path / "c.csv")
    assert result.exit_code == 0, result.output
    assert result.stdout.count("no values") == result.stdout.count("50 (100 %)") == 2
