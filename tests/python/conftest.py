"""Fixtures that several files of tests share."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import settings

from helibore.settings import wall_settings

pytest.register_assert_rewrite("golden_texts")
from golden_texts import golden, pytest_addoption, pytest_configure, pytest_sessionfinish  # noqa: E402

__all__ = ["golden", "pytest_addoption", "pytest_configure", "pytest_sessionfinish"]

# The files that take longest, browsers aside: --dist loadfile gives whole files to the workers, in the order collected.
LONG = {
    "test_cpp.py",
    "test_eccentering.py",
    "test_files_tables.py",
    "test_plot.py",
    "test_readme.py",
    "test_reprocess.py",
}

wall_settings.USUAL = "inverse-distance"  # a fit for each wall would take a second; test_automatic.py has the default
settings.register_profile("without deadlines", deadline=None)  # an example may take long on a loaded machine
settings.load_profile("without deadlines")


@pytest.fixture(scope="module", autouse=True)
def the_dead_of_this_module() -> None:
    """Forget threads that died in an earlier module; tests of one module may share a server."""
    from patience import DEAD

    DEAD.clear()


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


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with what takes longest, so that no worker has a long file left when the others are done."""
    first = {item.path for item in items if item.path.name in LONG or item.get_closest_marker("browser")}
    items.sort(key=lambda item: item.path not in first)
