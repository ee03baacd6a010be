"""Downloads that take long to write: a section as a table, as a page or as a print.

A download holds a frozen copy of its section until it is sent, so the limit ``downloads`` says how many run at a time;
``prints`` does for prints. A browser that stops reading holds its download open for at most `STALLED` seconds; then the
download is given up.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Iterable, Iterator

from starlette.responses import PlainTextResponse, Response, StreamingResponse
from starlette.types import Message, Receive, Scope, Send

from helibore.base.limits import limit_variable

STALLED = 60.0  # seconds


class Downloads:
    """Lets at most ``most`` downloads run, the limit ``name``; only the server's event loop uses this class."""

    def __init__(self, name: str, most: int, stalled: float = STALLED) -> None:
        self.name, self.most, self.stalled = name, most, stalled
        self.running = 0

    def busy(self) -> Response | None:
        """Return the answer 503 if `most` downloads are running, else None."""
        if self.running < self.most:
            return None
        text = f"the server already writes {self.most} {self.name}: try again when one of them is done"
        raised = f"{limit_variable(self.name)} raises this number"
        return PlainTextResponse(f"{text}; {raised}\n", 503, headers={"retry-after": "5"})

    async def start(
        self, write: Callable[[], Iterator[str]], media_type: str, name: str, *, whole: bool = False
    ) -> Response:
        """Return a response that sends the chunks of ``write`` as a file.

        The response is that of `busy`, and 400 if ``write`` raises a ValueError. If ``whole`` is True, the whole file
        is written to memory before the first byte is sent.
        """
        if (busy := self.busy()) is not None:
            return busy
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
