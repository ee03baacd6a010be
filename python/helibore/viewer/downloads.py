"""Downloads that take long to write: a section as a table or as a page.

A download holds a frozen copy of its section until it is sent, so at most `MOST` run at a time. A browser that stops
reading holds its download open for at most `STALLED` seconds; then the download is given up.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Iterable, Iterator

from starlette.responses import PlainTextResponse, Response, StreamingResponse
from starlette.types import Message, Receive, Scope, Send

MOST = 2
STALLED = 60.0  # seconds


class Downloads:
    """Limits the downloads that run at a time; only the server's event loop uses this class."""

    def __init__(self, most: int = MOST, stalled: float = STALLED) -> None:
        self.most, self.stalled = most, stalled
        self.running = 0

    async def start(
        self, write: Callable[[], Iterator[str]], media_type: str, name: str, *, whole: bool = False
    ) -> Response:
        """Return a response that sends the chunks of ``write`` as a file.

        The response is 503 if `most` downloads are running, and 400 if ``write`` raises a ValueError. If ``whole`` is
        True, the whole file is written to memory before the first byte is sent.
        """
        if self.running >= self.most:
            busy = f"the server already writes {self.most} sections: try again when one of them is done\n"
            return PlainTextResponse(busy, 503, headers={"retry-after": "5"})
        self.running += 1
        try:
            chunks: Iterable[bytes] = encoded(await asyncio.to_thread(write))
            if whole:
                chunks = await asyncio.to_thread(list, chunks)
            return _Download(self, chunks, media_type, name)
        except BaseException as error:
            self.running -= 1
            if isinstance(error, ValueError):
                return PlainTextResponse(f"{error}\n", 400)
            raise


def encoded(chunks: Iterator[str]) -> Iterator[bytes]:
    """Yield the chunks as bytes; sleep after each chunk as long as it took, to leave half a core free."""
    while True:
        began = time.monotonic()
        chunk = next(chunks, None)
        if chunk is None:
            return
        bytes_ = chunk.encode()
        time.sleep(time.monotonic() - began)
        yield bytes_


class _Download(StreamingResponse):
    """Sends the chunks; lets another download start when they are sent or the browser stops reading."""

    def __init__(self, downloads: Downloads, chunks: Iterable[bytes], media_type: str, name: str) -> None:
        disposition = {"content-disposition": f"attachment; filename={name}"}
        super().__init__(chunks, media_type=media_type, headers=disposition)
        self.downloads = downloads

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def limited(message: Message) -> None:
            await asyncio.wait_for(send(message), self.downloads.stalled)

        try:
            await super().__call__(scope, receive, limited)
        finally:
            self.downloads.running -= 1
