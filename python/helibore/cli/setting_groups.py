"""All groups of settings, those of a live wall included; `./develop settings` writes what follows from them."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from helibore.settings import listing
from helibore.settings.groups import GROUPS


def every_group() -> dict[str, type[Any]]:
    """Return the declared class of each group: those of a well and what is made from it, then those of a live wall."""
    from helibore.live.rules.live_groups import live_groups

    return GROUPS | live_groups()


if __name__ == "__main__":
    root = Path(sys.argv[1])
    (root / "docs/reference/settings.md").write_text(listing.page(every_group()), encoding="utf-8")
    (root / "python/helibore/settings/keywords.py").write_text(listing.keywords(), encoding="utf-8")
