"""docs/guarantees.md: each numbered sentence names its tests, and each of them exists."""

from __future__ import annotations

import re

import pytest
from locations import ROOT

PAGE = (ROOT / "docs/guarantees.md").read_text()
NAMED = sorted(set(re.findall(r"(test_\w+\.py)::(test_\w+)", PAGE)))
SENTENCES = re.split(r"^(?=\d+\. )", PAGE.partition("## Not guaranteed")[0], flags=re.MULTILINE)[1:]


@pytest.mark.parametrize(("file", "test"), NAMED)
def test_a_named_test_exists(file, test):
    (path,) = (ROOT / "tests/python").rglob(file)
    assert f"\ndef {test}(" in path.read_text()


def test_each_sentence_is_numbered_in_order_and_names_a_test():
    assert [int(sentence.partition(".")[0]) for sentence in SENTENCES] == list(range(1, len(SENTENCES) + 1))
    assert [sentence[:40] for sentence in SENTENCES if "::test_" not in sentence] == []
