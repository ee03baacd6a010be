"""The rules for names, units, missing values, logs and picks, as data for the page that needs no server.

``./develop page`` runs this module and puts the result into the page.
"""

from __future__ import annotations

import json
import sys
from dataclasses import MISSING, fields
from typing import Any

import numpy as np

from helibore.base import units
from helibore.base.decimals import DECIMALS, USUAL_DECIMALS
from helibore.base.harmless import FORMULA
from helibore.base.nulls import NULLS
from helibore.channels.plausibility import LIKELY_NULLS
from helibore.channels.roles import NAMES_FILE
from helibore.files.headings import AMBIGUOUS, SPELLINGS
from helibore.files.number_rows import NULL_TEXTS
from helibore.logs import picks
from helibore.logs.log_columns import COLUMNS
from helibore.samples.bit_sizes import LARGE_BITS, SMALL_BITS
from helibore.samples.caliper import BASIS_TEXT
from helibore.settings.role_settings import ROLES
from helibore.settings.wall_settings import Settings
from helibore.wall.estimates import FEW_BOXES, FEWEST_SAMPLES, MOST_COMPARISONS, MOST_UNMEASURED
from helibore.wall.uncertainty import NORMAL_95, TARGETS
from helibore.wall.wall_columns import LARGEST_CHANGE, NEAR_DEPTH, NEAR_TOOLFACE


def rules() -> dict[str, Any]:
    """Return the rules; ``rules.js`` of the page names the members."""
    usual = Settings(bit_diameter=0.2)
    sizes = sorted({*SMALL_BITS, *LARGE_BITS})
    random = np.random.default_rng(0).bit_generator.state["state"]  # of the samples that are left out
    return {
        "names": {name: value for name, value in json.loads(NAMES_FILE.read_text("utf-8")).items() if name != "about"},
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
        "columns": [[one.name, one.mnemonic, one.unit, one.description] for one in COLUMNS],
        "decimals": {"other": USUAL_DECIMALS, **DECIMALS},
        "picks": {
            "columns": picks.COLUMNS,
            "dips": picks.DERIVED,
            "texts": picks.TEXTS,
            "limits": picks.LIMITS,
            "classes": picks.CLASSES,
            "aliases": picks.ALIASES,
            "place": picks.PLACE,
            "most": picks.MOST,
            "longest": picks.LONGEST_NOTE,
            "formula": FORMULA.pattern,
            "defaults": {one.name: one.default for one in fields(picks.Pick) if one.default is not MISSING},
        },
        "bases": BASIS_TEXT,
        "left_out": {
            "random": [str(random["state"]), str(random["inc"])],
            "targets": TARGETS,
            "fewest": FEWEST_SAMPLES,
            "boxes": FEW_BOXES,
            "comparisons": MOST_COMPARISONS,
            "normal": NORMAL_95,
            "unmeasured": MOST_UNMEASURED,
        },
        "measured": [NEAR_DEPTH, NEAR_TOOLFACE, usual.gap_reach, usual.largest_gap, LARGEST_CHANGE],
    }


if __name__ == "__main__":
    json.dump(rules(), sys.stdout, separators=(",", ":"))
