"""The rules for names, units and missing values, as data for the page that needs no server: it reads what Python reads.

``./develop page`` runs this module and puts the result into the page.
"""

from __future__ import annotations

import json
import sys
from typing import Any

from helibore.base import units
from helibore.base.nulls import NULLS
from helibore.channels.plausibility import LIKELY_NULLS
from helibore.channels.roles import NAMES_FILE
from helibore.files.headings import AMBIGUOUS, SPELLINGS
from helibore.files.number_rows import NULL_TEXTS
from helibore.samples.bit_sizes import LARGE_BITS, SMALL_BITS
from helibore.settings.role_settings import ROLES
from helibore.settings.wall_settings import Settings
from helibore.wall.wall_columns import LARGEST_CHANGE, NEAR_DEPTH, NEAR_TOOLFACE


def rules() -> dict[str, Any]:
    """Return the rules; ``rules.js`` of the page names the members."""
    usual = Settings(bit_diameter=0.2)
    sizes = sorted({*SMALL_BITS, *LARGE_BITS})
    return {
        "names": json.loads(NAMES_FILE.read_text("utf-8")),
        "units": units.table(),
        "roles": dict(ROLES),
        "spellings": sorted(SPELLINGS),
        "ambiguous": sorted(AMBIGUOUS),
        "nulls": list(NULLS),
        "null_texts": list(NULL_TEXTS),
        "likely_nulls": list(LIKELY_NULLS),
        "small_bits": list(SMALL_BITS),
        "large_bits": list(LARGE_BITS),
        "sizes": [[f"{size:g} in", size] for size in sizes],
        "measured": [NEAR_DEPTH, NEAR_TOOLFACE, usual.gap_reach, usual.largest_gap, LARGEST_CHANGE],
    }


if __name__ == "__main__":
    json.dump(rules(), sys.stdout, separators=(",", ":"))
