"""The core's reader of rows of numbers: each number as Python reads it, or no row at all."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helibore._core import read_number_rows

NUMBER = st.one_of(
    st.floats(-1e9, 1e9).map(repr),
    st.floats(-(2.0**53), 2.0**53, exclude_min=True, exclude_max=True).map(lambda value: f"{value:.17g}"),
    st.from_regex(r"[+-]?([0-9]{1,12}\.?[0-9]{0,12}|\.[0-9]{1,20})(e-?[0-9]{1,2})?", fullmatch=True),
)
BLANK = st.sampled_from([" ", "   ", "\t", " \t "])


def by_python(text: str, columns: int, comments: bool) -> np.ndarray:
    """Read the rows by ``split`` and ``float``; no number if there is anything else."""
    lines = [line.strip(" \t") for line in text.split("\n")]
    rows = [line.split() for line in lines if line and not (comments and line.startswith("#"))]
    try:
        values = np.array([[float(cell) for cell in row] for row in rows if len(row) == columns])
    except ValueError:
        return np.empty((columns, 0))
    fits = len(values) == len(rows) and bool((np.abs(values) < 2**53).all())
    return values.T if fits and values.size else np.empty((columns, 0))


@settings(max_examples=60, deadline=None)
@given(st.data(), st.integers(1, 4), st.booleans())
def test_rows_are_read_as_python_reads_them(data: st.DataObject, columns: int, comments: bool) -> None:
    row = st.lists(NUMBER, min_size=columns, max_size=columns)
    rows = data.draw(st.lists(st.one_of(row, row, row, row, st.just([]), st.just(["#", "5"])), max_size=6))
    text = "\n".join(data.draw(BLANK) * data.draw(st.booleans()) + data.draw(BLANK).join(cells) for cells in rows)
    text += data.draw(st.sampled_from(["", "\n", " \n", "\n\n"]))
    found = read_number_rows(text, columns, comments)
    assert found.tobytes() == by_python(text, columns, comments).tobytes()
    assert found.shape[0] == columns


@pytest.mark.parametrize(
    "cell",
    ["", "x", "1x", "1,5", "nan", "inf", "-inf", "1e400", "0x1", "1_0", "--1", "+-1", "-", ".", "1e",
     "9007199254740992", "-9007199254740993", "1d5", "\N{ARABIC-INDIC DIGIT ONE}", "1\x0b2", "1 2", "1\0", "1\r"],
)  # fmt: skip
def test_a_cell_that_is_no_plain_number_refuses_all_rows(cell: str) -> None:
    assert read_number_rows("1 2\n3 4\n", 2, False).tolist() == [[1.0, 3.0], [2.0, 4.0]]
    assert read_number_rows(f"1 2\n{cell} 4\n", 2, False).size == 0
    assert read_number_rows(f"1 2\n3 {cell}", 2, False).size == 0


def test_edges_of_a_text() -> None:
    assert read_number_rows("", 3, True).shape == (3, 0)
    assert read_number_rows("\n\n# 1 2\n", 2, True).shape == (2, 0)
    assert read_number_rows("1", 0, True).size == 0
    assert read_number_rows("-0 1.", 2, False).tobytes() == np.array([-0.0, 1.0]).tobytes()
    assert read_number_rows("\n" * 1000 + "5", 1, False).tolist() == [[5.0]]
    assert read_number_rows("1 2 # 3", 2, True).size == 0
