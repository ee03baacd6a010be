"""WITSML stores, polled over HTTPS."""

from __future__ import annotations

from helibore.live.kinds.kind import Position, Report, SourceKind
from helibore.live.model.events import EventBook
from helibore.live.model.store_reader import StoreReader
from helibore.live.rules.depth_limits import DepthLimits
from helibore.live.rules.sources import StoreSource
from helibore.live.wire.store import StoreClient
from helibore.live.wire.transport import Opener


class WitsmlStores(SourceKind[StoreSource, StoreReader]):
    """WITSML stores."""

    schemes = ("https",)
    table = StoreSource
    longest_wait = 60.0
    answers = True
    resumes = True
    message, word, nothing = "row", "curve", "answers come, and none of them can be read"

    def open(self, source: StoreSource, position: Position, report: Report) -> Opener:  # noqa: ARG002
        return StoreClient(source, position)

    def reader(self, source: StoreSource, events: EventBook, limits: DepthLimits) -> StoreReader:
        return StoreReader(source, events, limits)

    def position(self, reader: StoreReader) -> tuple[str, str] | None:
        return reader.last


KIND = WitsmlStores()
