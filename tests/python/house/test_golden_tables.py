"""The tables of golden texts: one for each folder of tests, with nothing that no test says."""

from __future__ import annotations

import ast
import tomllib

import pytest
from golden_texts import Golden, basic, write
from locations import ROOT

TABLES = sorted(ROOT.glob("tests/python/*/golden.toml"))


@pytest.mark.parametrize("table", TABLES, ids=lambda path: path.parent.name)
def test_every_text_belongs_to_a_test(table):
    for file, tests in tomllib.loads(table.read_text()).items():
        nodes = ast.walk(ast.parse((table.parent / f"{file}.py").read_text()))
        there = {node.name for node in nodes if isinstance(node, ast.FunctionDef)}
        assert {test.partition("[")[0] for test in tests} <= there, f"{file}.py"


def test_another_text_place_or_number_of_texts_fails():
    table = ["depth[1] = nan: must be finite"]
    for said in ("depth[1] = nan: must be real", "depth[2] = nan: must be finite", ""):
        with pytest.raises(AssertionError):
            Golden(table, "")(said)
    golden = Golden(table, "/somewhere")
    golden(table[0])
    with pytest.raises(AssertionError):
        golden("one more")


def test_a_table_is_read_as_it_was_written(tmp_path):
    said = ['a "quoted" \\ text', "two\nlines \x7f\x00\t", "", "é\u2028"]
    assert [tomllib.loads(f"x = {basic(text)}")["x"].removeprefix("\n") for text in said] == said
    (tmp_path / "test_some.py").write_text("def test_here(golden): ...\n")
    write(tmp_path, {"test_some": {"test_here[0-a]": said, "test_gone": ["x"]}, "test_other": {"test_here": ["x"]}})
    assert tomllib.loads((tmp_path / "golden.toml").read_text()) == {"test_some": {"test_here[0-a]": said}}
