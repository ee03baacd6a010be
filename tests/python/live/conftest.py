"""What all tests of the live wall share."""

from __future__ import annotations

import os

import pytest


@pytest.fixture(autouse=True)
def _no_syncs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let this process not wait for the disk: no test ends the power, and those that simulate it count the calls."""
    monkeypatch.setattr(os, "fsync", lambda _: None)
    monkeypatch.setattr(os, "fdatasync", lambda _: None)
