"""Whole sentences that helibore says, in one table for each folder of tests: ``golden.toml``.

    golden(report)                     the next text of this test in the table is that of ``report``
    with golden.raises(): prepare()    an InputError, and its text is the next one of the table
    with golden.raises("spikes"): ...  the same, and its place is "spikes"

    [test_preparation]
    "test_bad_settings[settings0-spikes]" = ["spikes = 0: must be finite and above 0"]

`./develop texts FOLDER` runs the tests of a folder and writes what they said; read its differences before you commit
them. Tests themselves assert places, rules and values, or facts of two or three words.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from helibore.base.errors import InputError

Table = dict[str, dict[str, list[str]]]
SAID = pytest.StashKey[dict[Path, Table]]()


@cache
def table(folder: Path) -> Table:
    """The texts of a folder by file and test."""
    path = folder / "golden.toml"
    return tomllib.loads(path.read_text()) if path.exists() else {}


def joined(line: object) -> str:
    """A line of a report, (step, sentence), as one text."""
    return ": ".join(map(str, line)) if isinstance(line, tuple) else str(line)


class Golden:
    """The texts of one test in the table, in the order in which the test compares them."""

    def __init__(self, expected: list[str] | None, temporary: str) -> None:
        self.expected, self.temporary = expected, temporary
        self.said: list[str] = []

    def __call__(self, said: object) -> None:
        """Compare a text, or the lines of a list, with the next text of the table; only note it for a new table."""
        text = "\n".join(map(joined, said)) if isinstance(said, list | tuple) else str(said)
        text = text.replace(self.temporary, "TMP") if self.temporary else text
        self.said.append(text)
        if self.expected is not None:
            assert [text] == self.expected[len(self.said) - 1 : len(self.said)]

    @contextmanager
    def raises(
        self, place: str | None = None, kind: type[BaseException] = InputError
    ) -> Iterator[pytest.ExceptionInfo[Any]]:
        """Expect an error, at ``place`` if given, whose text is the next one of the table."""
        with pytest.raises(kind) as caught:
            yield caught
        assert place in (None, getattr(caught.value, "place", None))
        self(caught.value)


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Iterator[Golden]:
    """The texts of this test in the table of its folder; a test that passes has compared all of them."""
    temporary = str(request.getfixturevalue("tmp_path")) if "tmp_path" in request.fixturenames else ""
    folder, file, test = request.path.parent, request.path.stem, request.node.name
    if request.config.getoption("--renew-texts"):
        own = Golden(None, temporary)
        yield own
        request.config.stash[SAID].setdefault(folder, {}).setdefault(file, {})[test] = own.said
        return
    own, failed = Golden(table(folder).get(file, {}).get(test, []), temporary), request.session.testsfailed
    yield own
    if own.said and request.session.testsfailed == failed:  # a test that was skipped has said nothing
        assert own.said == own.expected


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--renew-texts", action="store_true", help="write what the tests say into golden.toml")


def pytest_configure(config: pytest.Config) -> None:
    config.stash[SAID] = {}


def pytest_sessionfinish(session: pytest.Session) -> None:
    for folder, said in session.config.stash[SAID].items():
        write(folder, said)


def basic(text: str) -> str:
    """A string of TOML; one of several lines stands as it is read."""

    def escaped(line: str) -> str:
        line = json.dumps(line, ensure_ascii=False)[1:-1]
        return "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in line)

    lines = [escaped(line) for line in text.split("\n")]
    return f'"{lines[0]}"' if len(lines) == 1 else '"""\n{}"""'.format("\n".join(lines))


def write(folder: Path, said: Table) -> None:
    """Write what tests said into the table of their folder; leave out tests that are no longer there."""
    whole = {file: {**table(folder).get(file, {}), **said.get(file, {})} for file in {*table(folder), *said}}
    sections = []
    for file, tests in sorted(whole.items()):
        source = (folder / f"{file}.py").read_text() if (folder / f"{file}.py").exists() else ""
        there = {test: texts for test, texts in sorted(tests.items()) if f"def {test.partition('[')[0]}(" in source}
        entries = [
            f"{basic(test)} = [{basic(texts[0])}]"
            if len(texts) == 1
            else f"{basic(test)} = [\n" + "".join(f"  {basic(text)},\n" for text in texts) + "]"
            for test, texts in there.items()
            if texts
        ]
        sections += [f"[{file}]\n" + "\n".join(entries) + "\n"] if entries else []
    (folder / "golden.toml").write_text("\n".join(sections))
