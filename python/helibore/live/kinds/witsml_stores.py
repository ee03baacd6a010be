"""WITSML stores, polled over HTTPS."""

from __future__ import annotations

from helibore.live.model.store_reader import StoreReader
from helibore.live.rules.kinds import Position, Report, SourceKind
from helibore.live.rules.source_tables import StoreTable
from helibore.live.rules.sources import StoreSource
from helibore.live.wire.store import StoreClient
from helibore.live.wire.transport import Opener


class WitsmlStores(SourceKind[StoreSource, StoreReader]):
    """WITSML stores."""

    schemes = ("https",)
    table = StoreTable
    source = StoreSource
    reader = StoreReader
    longest_wait = 60.0
    answers = True
    resumes = True

    def open(self, source: StoreSource, position: Position, report: Report) -> Opener:  # noqa: ARG002
        return StoreClient(source, position)


KIND = WitsmlStores()
