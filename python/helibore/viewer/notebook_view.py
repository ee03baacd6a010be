"""The page in a notebook: a frame that exchanges messages with the kernel through the notebook, without a port.

    page in a frame  <--port-->  web/notebook.js  <--comm-->  NotebookView  <-->  WebApp.serve

A running cell blocks the kernel, so the frame first shows a section of the wall that is enclosed in its HTML. A saved
notebook shows the card of the wall, its short summary; the frame, while it exists, hides the card. Importing this
module needs the extra ``notebook``.
"""

from __future__ import annotations

import asyncio
import atexit
import threading
import uuid
from collections.abc import MutableMapping
from typing import Any

from helibore.base.errors import needs

with needs("", "notebook"):
    import anywidget
    import traitlets
    from starlette.applications import Starlette

from helibore.viewer.html_export import html_export
from helibore.viewer.page_files import files_of_page, page
from helibore.viewer.scene import Scene
from helibore.viewer.web_app import WebApp

MOST_ENCLOSED = 100_000  # vertices of the enclosed section, about 800 kB


class NotebookView(anywidget.AnyWidget):
    """The widget of a `Viewer` in a notebook. Its traits follow what the user does on the page; ``observe`` them.

    Picks go to ``wall.picks``.

    Attributes
    ----------
    depths : tuple of float
        Top and bottom of the section in view, metres; before the page has drawn, the ends of the whole wall. Set them
        to move the section.
    cursor : tuple or None
        Depth in metres and toolface in degrees of the point that the user clicked; the toolface is None for a point
        on the depth axis. None before the first click.
    """

    _esm = (page("notebook.js") or b"").decode()
    _page = traitlets.Unicode().tag(sync=True)
    _still = traitlets.Unicode().tag(sync=True)
    depths = traitlets.Tuple(traitlets.Float(), traitlets.Float()).tag(sync=True)
    cursor = traitlets.Any(None).tag(sync=True)

    _thread: threading.Thread | None = None

    def __init__(self, scene: Scene) -> None:
        level, shape = scene.levels[0], scene.shape
        start, height = shape.start_depth, shape.pitch / level.sectors
        stop = start + min(level.size, MOST_ENCLOSED) * height
        enclosed = "".join(html_export(scene, files_of_page(), start, stop, hosted=True))
        depths = tuple(sorted((start, start + (level.size - 1) * height)))
        super().__init__(_page=enclosed, _still=f"helibore-{uuid.uuid4().hex}", depths=depths)
        self._app = WebApp(scene)
        self._requests = Starlette(routes=self._app.routes())
        self._frames: dict[str, _Frame] = {}
        self._tasks: set[asyncio.Task[None]] = set()
        # The loop runs in a thread of its own: a kernel calls from its main thread, or from its thread for widgets.
        self._loop = asyncio.new_event_loop()
        self._app.begin(self._loop)
        self._thread = threading.Thread(target=self._run, name="helibore-view-notebook", daemon=True)
        self._thread.start()
        atexit.register(self.close)
        self.on_msg(lambda _, content, __: self._loop.call_soon_threadsafe(self._receive, content))

    def still(self, card: str) -> str:
        """Return the card of the wall as HTML, for an output that the frame hides."""
        return f'<div class="{self._still}">{card}</div>'

    def _repr_mimebundle_(self, **kwargs: Any) -> Any:
        """Return the view with an empty text: a notebook without a kernel would show a text below the card."""
        bundle = super()._repr_mimebundle_(**kwargs)
        return bundle and (bundle[0] | {"text/plain": ""}, bundle[1])

    def _receive(self, content: dict[str, Any]) -> None:
        """Act on what a frame sends: that it opens, a message of the protocol, a request, or that it closes."""
        view = str(content.get("view"))
        if content.get("open"):
            self._leave(view)
            frame = self._frames[view] = _Frame(self, view)
            self._start(self._app.serve(frame))
        elif "text" in content and view in self._frames:
            self._frames[view].received.put_nowait({"type": "websocket.receive", "text": content["text"]})
        elif content.get("closed"):
            self._leave(view)
        elif "address" in content:
            self._start(self._answer(view, content))

    def _run(self) -> None:
        self._loop.run_forever()
        self._loop.run_until_complete(self._end())
        self._loop.close()

    async def _end(self) -> None:
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        await self._loop.shutdown_default_executor()

    def _start(self, work: Any) -> None:
        task = self._loop.create_task(work)
        self._tasks.add(task)  # a loop holds only weak references to tasks
        task.add_done_callback(self._tasks.discard)

    async def _answer(self, view: str, question: dict[str, Any]) -> None:
        """Answer a request of the page as the server would."""
        path, _, query = question["address"].partition("?")
        version = {"version": "3.0", "spec_version": "2.4"}
        scope = {"type": "http", "asgi": version, "http_version": "1.1", "method": question["method"], "headers": [],
                 "scheme": "http", "path": f"/{path}", "query_string": query.encode(), "root_path": ""}  # fmt: skip
        sent: list[MutableMapping[str, Any]] = []

        async def receive() -> MutableMapping[str, Any]:
            return {"type": "http.request", "body": question["body"].encode(), "more_body": False}

        async def send(message: MutableMapping[str, Any]) -> None:
            sent.append(message)

        try:
            await self._requests(scope, receive, send)
        except Exception as error:  # a bug: without an answer, the page would wait for ever
            sent = [{"status": 500, "headers": []}, {"body": f"{error!r}: this is a bug in helibore\n".encode()}]
        headers = {name.decode(): value.decode() for name, value in sent[0]["headers"]}
        body = b"".join(message.get("body", b"") for message in sent[1:])
        self.send({"view": view, "id": question["id"], "status": sent[0]["status"], "headers": headers}, [body])

    def _leave(self, view: str) -> None:
        if view in self._frames:
            self._frames.pop(view).received.put_nowait({"type": "websocket.disconnect"})

    def close(self) -> None:
        """Disconnect the frames and remove the widget. May be called twice."""
        atexit.unregister(self.close)
        if self._thread and self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join()
        super().close()


class _Frame:
    """One frame of the page, as the websocket that `WebApp.serve` expects."""

    def __init__(self, widget: NotebookView, view: str) -> None:
        self._widget, self._view = widget, view
        self.received: asyncio.Queue[MutableMapping[str, Any]] = asyncio.Queue()

    async def accept(self) -> None:
        """Do nothing: a frame that has sent ``open`` is connected."""

    async def close(self, code: int, reason: str) -> None:
        self._widget.send({"view": self._view, "close": code, "reason": reason})

    async def receive(self) -> MutableMapping[str, Any]:
        return await self.received.get()

    async def send_text(self, text: str) -> None:
        self._widget.send({"view": self._view, "text": text})

    async def send_bytes(self, message: bytes) -> None:
        self._widget.send({"view": self._view}, [message])
