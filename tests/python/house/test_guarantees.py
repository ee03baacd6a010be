"""docs/guarantees.md and docs/promises.md: each numbered sentence names its tests, and each of them exists."""

from __future__ import annotations

import re

import pytest
from locations import ROOT

PAGES = {name: (ROOT / "docs" / name).read_text() for name in ("guarantees.md", "promises.md")}
NAMED = sorted(set(re.findall(r"(\w+\.(?:py|cpp))::(\w+)", "".join(PAGES.values()))))


@pytest.mark.parametrize(("file", "test"), NAMED)
def test_a_named_test_exists(file, test):
    (path,) = (ROOT / "tests").rglob(file)
    define = r"^def" if file.endswith(".py") else r"^(?:template <class Set>\n)?(?:void|int)|^\[\[maybe_unused\]\] void"
    assert re.search(rf"(?:{define}) {test}\(", path.read_text(), flags=re.MULTILINE)


@pytest.mark.parametrize("page", PAGES)
def test_each_sentence_is_numbered_in_order_and_names_a_test(page):
    promised = re.split(r"## Not (?:guaranteed|promised)", PAGES[page])[0]
    sentences = re.split(r"^(?=\d+\. )", promised, flags=re.MULTILINE)[1:]
    assert [int(sentence.partition(".")[0]) for sentence in sentences] == list(range(1, len(sentences) + 1))
    assert [sentence[:40] for sentence in sentences if not re.search(r"\.(?:py|cpp)::\w", sentence)] == []
