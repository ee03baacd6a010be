"""The files of the built page, and what to say where there are none."""

from __future__ import annotations

from importlib import resources

from helibore.base.errors import InputError

TYPES = {
    "index.html": "text/html; charset=utf-8",
    "app.js": "text/javascript; charset=utf-8",
    "more.js": "text/javascript; charset=utf-8",
    "app.css": "text/css; charset=utf-8",
}
"""Files of the page of a well."""

WELLS = {"wells.html": TYPES["index.html"], "wells.js": TYPES["app.js"]}
"""Files of the page of several wells."""


def page(name: str) -> bytes | None:
    """Return a file of the built page, or None if the package was built without it."""
    file = resources.files("helibore.viewer").joinpath("page", name)
    return file.read_bytes() if file.is_file() else None


def no_page() -> str:
    """Return why there is no page, as the build noted it, and how to get one."""
    file = resources.files("helibore.viewer").joinpath("no-page.txt")
    reason = file.read_text("utf-8").strip().rstrip(".") if file.is_file() else "its files are missing"
    return (
        f"This helibore was built without its page: {reason}. Everything else works. For the page: install Node.js 18 "
        "or newer with npm, then helibore again from its sources, pip install --force-reinstall --no-deps ."
    )


def files_of_page() -> dict[str, str]:
    """Return the files of the page, texts by name; raise InputError if the package was built without its page."""
    if page("app.js") is None:
        raise InputError("page", no_page())
    return {name: (page(name) or b"").decode() for name in TYPES}


def offline_page() -> bytes:
    """Return the page that needs no server; raise InputError if the package was built without it."""
    found = page("helibore.html")
    if found is None:
        rule = "this helibore was built without it: ./develop page in a clone builds it, with Node.js 18 or newer"
        raise InputError("the page without a server", rule)
    return found
