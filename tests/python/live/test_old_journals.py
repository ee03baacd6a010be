"""A journal and a checkpoint of revision 56ff07e9: WITS, a store, a host's pushes, a change of configuration."""

from __future__ import annotations

import json
import shutil
import tarfile
from pathlib import Path

import numpy as np
import pytest

from helibore import Live, _core
from helibore.live.journal.journal import segments
from helibore.live.journal.session_header import headers
from helibore.live.rules.configuration import parse

STORED = Path(__file__).parent / "data" / "journal_56ff07e9.tar.xz"


def _crc(values) -> int:
    return _core.crc32c(np.ascontiguousarray(values).data)


def bits(live) -> dict:
    """What the journal gives, with a checksum for each array."""
    rows = {name: rows.arrays() for name, rows in sorted(live.images.items())}
    return {
        "layers": {
            name: [len(wall), wall.sample_count, _crc(wall.radius), _crc(wall.nearest), _crc(wall.support)]
            for name, wall in live.layers.items()
        },
        "images": {name: [len(depth), _crc(depth), _crc(values)] for name, (depth, values) in rows.items()},
        "path": _crc(live.path.position(np.array([50.0, 97.0, 100.0, 103.0]))),
        "stations": live.model.stations.rows().tolist(),
        "counts": dict(sorted(live.model.counts.items())),
        "events": {f"{source} {rule}": n for (source, rule), n in sorted(live.model.events.counts.items())},
        "passes": len(live.passes),
    }


@pytest.fixture
def folder(tmp_path):
    with tarfile.open(STORED) as archive:
        archive.extraction_filter = getattr(tarfile, "data_filter", None)  # Python 3.11.2 of Debian has none
        archive.extractall(tmp_path / "journal")
    return tmp_path / "journal"


def test_an_old_journal_has_the_bits_it_had(folder):
    expected = json.loads((folder / "expected.json").read_text())
    assert bits(Live.replay(folder)) == expected


def test_an_old_checkpoint_goes_on_with_the_bits_it_had(folder, tmp_path):
    expected = json.loads((folder / "expected.json").read_text())
    [text] = {header["configuration"] for _, header in headers(list(segments(folder))[-1])}
    shutil.copytree(folder, tmp_path / "again")
    with Live(parse(text), tmp_path / "again") as live:
        assert live.model.events.counts["", "checkpoint"] == 0, "the checkpoint was not used"
        assert bits(live) == expected


def test_the_stored_meaning_does_not_change_a_byte(folder):
    found = [header for segment in segments(folder) for _, header in headers(segment)]
    assert len({header["configuration"] for header in found}) == 2
    for header in found:
        assert parse(header["configuration"]).meaning() == header["meaning"]
