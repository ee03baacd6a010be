"""Fixtures that several files of tests share."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import settings

settings.register_profile("without deadlines", deadline=None)  # an example may take long on a loaded machine
settings.load_profile("without deadlines")


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    """Chromium with software GL, one process for all tests of a worker."""
    from screen import Chromium

    process = Chromium()
    yield process
    process.close()


@pytest.fixture(scope="module")
def browser(chromium: Any) -> Iterator[Any]:
    """A connection to the browser for a module: Playwright's event loop must end before another module starts one."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        connected = playwright.chromium.connect_over_cdp(chromium.address)
        yield connected
        connected.close()
