"""Answers that take long to write: a section as a table or as a page. A few at a time, each given up when nobody reads.

Such an answer holds a copy of its section until it is sent (`Scene.still`), so what the server spends on all of them is
bounded by `MOST`, and a browser that stops reading keeps a place for `STALLED` seconds.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator, Callable, Iterator

from starlette.responses import PlainTextResponse, Response, StreamingResponse
from starlette.types import Message, Receive, Scope, Send

MOST = 2
STALLED = 60.0  # seconds


class LongAnswers:
    """The places for long answers; used by the server's loop alone."""

    def __init__(self, most: int = MOST, stalled: float = STALLED) -> None:
        self.most, self.stalled = most, stalled
        self.taken = 0

    async def give(
        self, write: Callable[[], Iterator[str]], media_type: str, name: str, *, at_once: bool = False
    ) -> Response:
        """Return the answer that sends what `write` yields as a file; 503 where no place is free, 400 on ValueError."""
        if self.taken >= self.most:
            told = f"{self.most} sections are being written already: try again when one of them is done\n"
            return PlainTextResponse(told, 503, headers={"retry-after": "5"})
        self.taken += 1
        try:
            pieces = await asyncio.to_thread(write)
            if at_once:
                return _Written(self, _one_by_one(await asyncio.to_thread(list, unhurried(pieces))), media_type, name)
            return _Written(self, unhurried(pieces), media_type, name)
        except BaseException as error:
            self.taken -= 1
            if isinstance(error, ValueError):
                return PlainTextResponse(f"{error}\n", 400)
            raise


def unhurried(pieces: Iterator[str]) -> Iterator[bytes]:
    """Yield the pieces encoded, and rest after each as long as it took: a producer in this process gets its turns."""
    while True:
        began = time.monotonic()
        piece = next(pieces, None)
        if piece is None:
            return
        encoded = piece.encode()
        time.sleep(time.monotonic() - began)
        yield encoded


async def _one_by_one(pieces: list[bytes]) -> AsyncIterator[bytes]:
    for piece in pieces:
        yield piece


class _Written(StreamingResponse):
    """Pieces sent one by one; its place is free again when it is sent or given up."""

    def __init__(
        self, places: LongAnswers, pieces: Iterator[bytes] | AsyncIterator[bytes], media_type: str, name: str
    ) -> None:
        disposition = {"content-disposition": f"attachment; filename={name}"}
        super().__init__(pieces, media_type=media_type, headers=disposition)
        self.places = places

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def sending(message: Message) -> None:
            await asyncio.wait_for(send(message), self.places.stalled)

        try:
            await super().__call__(scope, receive, sending)
        finally:
            self.places.taken -= 1
