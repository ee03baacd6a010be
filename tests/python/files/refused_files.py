"""What a file that must be refused says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import helibore as hb


def refused(path: Path, rule: str) -> None:
    """Check that reading the numbers of a file fails with its name and this rule; TIME holds texts."""

    def read_all() -> None:
        for one in hb.open(path).sets:
            for channel in one:
                if channel.name != "TIME":
                    one.numbers(channel.name)

    with pytest.raises(ValueError, match=re.escape(rule)) as caught:
        read_all()
    assert str(caught.value).startswith(path.name)
