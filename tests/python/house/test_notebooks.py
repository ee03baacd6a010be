"""The saved notebooks of docs/notebooks: small, without a widget's state, and with a picture that needs no kernel."""

from __future__ import annotations

import json

import pytest
from locations import ROOT

NOTEBOOKS = sorted(ROOT.glob("docs/notebooks/*.ipynb"))


def test_there_are_three():
    assert len(NOTEBOOKS) == 3


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_saved_notebook_is_small_and_shows_its_wall_without_a_kernel(path):
    text = path.read_text()
    notebook = json.loads(text)
    outputs = [output for cell in notebook["cells"] for output in cell.get("outputs", [])]
    assert len(text) < 120_000
    assert "widget" not in text
    assert "widgets" not in notebook["metadata"]
    assert [output for output in outputs if output["output_type"] == "error" or output.get("name") == "stderr"] == []
    sizes = [(kind, len(json.dumps(of))) for output in outputs for kind, of in output.get("data", {}).items()]
    assert [(kind, size) for kind, size in sizes if size > (80_000 if kind == "image/png" else 30_000)] == []
    assert any("data:image/png" in "".join(output.get("data", {}).get("text/html", "")) for output in outputs)
    code = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert [cell["execution_count"] for cell in code] == list(range(1, len(code) + 1))
