"""A fixed corpus of small hostile files: none ends the process, takes 5 s or 500 MB; refusals say where and why.

The test lowers the limit of unpacked bytes, so that bombs are small and cheap. The full size is a command of its own:

python tests/python/hostile/corpus.py FOLDER          write the files
python tests/python/hostile/open_all.py FOLDER        open them; time and memory of each
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from corpus import ESC, write

for library in ("pyarrow", "lasio", "dlisio", "python_calamine", "fsspec"):
    pytest.importorskip(library)

OPENED = {
    "angles.csv", "blank.csv", "blanks.las", "decimal.csv", "digits.csv", "equal5000.las", "escape.csv", "escape.json",
    "escape.las", "escape.npz", "exponent.csv", "format.las", "formula.csv", "image.csv", "line.csv",
    "logs.json", "mixed.csv", "named.csv", "nan.json", "null.las", "ones.las", "picks-columns.csv",
    "picks-formula.csv", "ragged.las", "sections.las", "sep.csv", "unicode.csv",
}  # fmt: skip
"""Files that are odd, but may be opened; every other file must be refused."""


def test_a_hundred_hostile_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HELIBORE_LIMIT_UNPACKED", str(1 << 20))
    names = write(tmp_path)
    assert len(names) > 100
    command = [sys.executable, str(Path(__file__).with_name("open_all.py")), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    lines = [line.partition("\t") for line in done.stdout.splitlines()]
    found = {name: json.loads(rest) for name, _, rest in lines if rest}
    assert (done.returncode, set(found)) == (0, set(names)), done.stdout.splitlines()[-1] + done.stderr
    assert done.stderr == ""
    wrong = []
    for name, (outcome, text, _, _) in found.items():
        place, colon, rule = text.partition(": ")
        if outcome == "opened":
            refused = name in OPENED
        else:
            named = name.partition(".")[0] in place or name.startswith(("manifest-", "journal-"))
            refused = outcome == "InputError" and named and bool(colon) and len(rule) > 5 and name not in OPENED
        if not refused or "S3CRETS" in text or ESC[0] in text or "Traceback" in text or len(text) > 5000:
            wrong.append((name, outcome, text[:200]))
    assert not wrong, wrong
    limited = [text for _, text, _, _ in found.values() if re.search(r"HELIBORE_LIMIT_[A-Z]+ raises this", text)]
    assert len(limited) >= 10
