"""The page's server: a handful of addresses, one websocket, and the checks before any of them.

    /  /app.js  /app.css  /licences.txt     the page, from the package
    /ws                                     greeting and state as text, values as binary (messages.py)
    /api/vertex/K  /api/section.csv         exact values of one vertex, of a section
    /api/history                            when the wall was how long
    /api/snapshot.html                      a section with its page, as one file
    /healthz                                alive

Every request passes `Guard` (guard.py). A page may come before the wall has begun: it is told what the sources
are doing, and greeted when there is something to see.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import math
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from importlib import resources
from typing import Any

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp
from starlette.websockets import WebSocket, WebSocketDisconnect

from helibore.viewer import exports
from helibore.viewer.client import BadMessageError, Client, read_subscription
from helibore.viewer.greeting import greeting, state
from helibore.viewer.guard import LOOPBACK, Guard
from helibore.viewer.long_answers import LongAnswers
from helibore.viewer.scene import Scene
from helibore.viewer.snapshot import snapshot

TICK = 0.05  # seconds between two sends of news: at most 20 a second for a growing wall, the first one at once
MOST_CLIENTS = 64
MOST_TEXT = 8192  # bytes of a message from a page
NOT_BEGUN = "no sample has come yet: there is no wall to show"
TYPES = {
    "index.html": "text/html; charset=utf-8",
    "app.js": "text/javascript; charset=utf-8",
    "app.css": "text/css; charset=utf-8",
    "licences.txt": "text/plain; charset=utf-8",
}


def page(name: str) -> bytes | None:
    """Return a file of the built page, or None where the package was built without it."""
    file = resources.files("helibore.viewer").joinpath("page", name)
    return file.read_bytes() if file.is_file() else None


def no_page() -> str:
    """Return why there is no page, as the build left it, and how to get one."""
    file = resources.files("helibore.viewer").joinpath("no-page.txt")
    reason = file.read_text("utf-8").strip().rstrip(".") if file.is_file() else "its files are missing"
    return (
        f"This helibore was built without its page: {reason}. Everything else works. For the page: install Node.js 18 "
        "or newer with npm, then helibore again from its sources, pip install --force-reinstall --no-deps ."
    )


def application(scene: Scene, token: str | None = None, hosts: tuple[str, ...] = LOOPBACK) -> ASGIApp:
    """Return the ASGI application that shows `scene`."""
    hub, answers = Hub(scene), LongAnswers()
    routes = [
        Route("/", _page_file("index.html")),
        *(Route(f"/{name}", _page_file(name)) for name in ("app.js", "app.css", "licences.txt")),
        Route("/healthz", _health(scene, hub)),
        *(
            Route(f"/api/{name}", _once_begun(scene, answer))
            for name, answer in (
                ("vertex/{k:int}", _vertex(scene)),
                ("section.csv", _section(answers, scene)),
                ("history", _history(scene)),
                ("snapshot.html", _snapshot(answers, scene)),
            )
        ),
        WebSocketRoute("/ws", hub.serve),
    ]
    return Guard(Starlette(routes=routes, lifespan=hub.lifespan), token, hosts)


class Hub:
    """The pages that are connected, and the loop's side of waking them."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.pages: set[_Page] = set()
        self.loop: asyncio.AbstractEventLoop | None = None
        self.woken = False

    @contextlib.asynccontextmanager
    async def lifespan(self, _: Starlette) -> AsyncIterator[None]:
        self.loop = asyncio.get_running_loop()
        self.scene.on_change = self.wake
        yield
        self.scene.on_change = lambda: None
        self.loop = None

    def wake(self) -> None:
        """Tell every page that something changed; from any thread, at the cost of one flag while one is pending."""
        if self.woken or self.loop is None:
            return
        self.woken = True
        with contextlib.suppress(RuntimeError):  # the loop closed between the check and here
            self.loop.call_soon_threadsafe(self._wake_pages)

    def _wake_pages(self) -> None:
        self.woken = False
        for one in self.pages:
            one.wake.set()

    async def serve(self, socket: WebSocket) -> None:
        """Serve one page until it leaves."""
        await socket.accept()
        if len(self.pages) >= MOST_CLIENTS:
            await socket.close(4429, f"{MOST_CLIENTS} pages are connected already")
            return
        one = _Page(self.scene, socket)
        self.pages.add(one)
        with self.scene.lock:
            self.scene.marks.append(one.mark)
        sender = asyncio.create_task(one.send_all())
        try:
            await one.receive_all()
        except BadMessageError as error:
            with contextlib.suppress(RuntimeError, WebSocketDisconnect):
                await socket.close(4400, str(error)[:120])
        except WebSocketDisconnect:
            pass
        finally:
            sender.cancel()
            await asyncio.gather(sender, return_exceptions=True)
            self.pages.discard(one)
            with self.scene.lock:
                self.scene.marks.remove(one.mark)


class _Page:
    """One connected page: a task that receives and a task that sends."""

    def __init__(self, scene: Scene, socket: WebSocket) -> None:
        self.scene, self.socket = scene, socket
        self.wake = asyncio.Event()
        self.client: Client | None = None
        self.told = ""
        self.sent = -math.inf  # when the last news went out, on the loop's clock

    def mark(self, level: int, start: int, stop: int) -> None:
        if self.client is not None and self.client.session == self.scene.session:
            self.client.mark(level, start, stop)

    async def send_all(self) -> None:
        """Send what is dirty, nearest first, whenever there is room: news every `TICK` at most, answers at once."""
        clock = asyncio.get_running_loop().time
        with contextlib.suppress(WebSocketDisconnect, RuntimeError):
            while True:
                await self._greet()
                while (message := self._take()) is not None:
                    await self.socket.send_bytes(message)
                    self.sent = clock()
                await self.wake.wait()
                if self.client is not None and not self.client.asked:
                    await asyncio.sleep(self.sent + TICK - clock())
                self.wake.clear()

    async def _greet(self) -> None:
        """Say hello to a new page or a new wall once there is one, and tell the state where it changed."""
        with self.scene.lock:
            hello = None
            if self.scene.begun and (self.client is None or self.client.session != self.scene.session):
                self.client = Client(self.scene)
                hello = greeting(self.scene)
            told = json.dumps(state(self.scene))
        if hello is not None:
            await self.socket.send_text(json.dumps(hello))
        if told != self.told:
            self.told = told
            await self.socket.send_text(told)

    def _take(self) -> bytes | None:
        with self.scene.lock:
            return None if self.client is None else self.client.take()

    async def receive_all(self) -> None:
        """Read acknowledgements and subscriptions; anything else ends the connection with a sentence."""
        while True:
            message = await self.socket.receive()
            if message["type"] == "websocket.disconnect":
                return
            text = message.get("text")
            if text is None or len(text) > MOST_TEXT:
                raise BadMessageError(f"a page sends text of at most {MOST_TEXT} bytes")
            try:
                said = json.loads(text)
            except (ValueError, RecursionError) as error:
                raise BadMessageError("not JSON") from error
            self._hear(said)
            self.wake.set()

    def _hear(self, said: Any) -> None:
        with self.scene.lock:
            if not isinstance(said, dict) or self.client is None:
                raise BadMessageError("must be an object, after the greeting")
            if said.get("session") != self.client.session:
                return  # meant for the wall before this one
            if "ack" in said:
                self.client.acknowledge(said["ack"] if type(said["ack"]) is int else -1)
            elif "subscribe" in said:
                self.client.subscribe(read_subscription(said["subscribe"], len(self.scene.helix.attributes)))
            else:
                raise BadMessageError("neither ack nor subscribe")


Endpoint = Callable[[Request], Any]


def _once_begun(scene: Scene, answer: Endpoint) -> Endpoint:
    async def answer_or_wait(request: Request) -> Response:
        if not scene.begun:
            return PlainTextResponse(NOT_BEGUN + "\n", 503)
        response: Response = await answer(request)
        return response

    return answer_or_wait


def _page_file(name: str) -> Endpoint:
    async def answer(_: Request) -> Response:
        body = page(name)
        if body is None:
            return PlainTextResponse(no_page() + "\n", 503)
        return Response(body, media_type=TYPES[name])

    return answer


def _health(scene: Scene, hub: Hub) -> Endpoint:
    async def answer(_: Request) -> Response:
        vertices = scene.levels[0].size if scene.begun else 0
        return JSONResponse({"vertices": vertices, "pages": len(hub.pages), "page_built": page("app.js") is not None})

    return answer


def _vertex(scene: Scene) -> Endpoint:
    async def answer(request: Request) -> Response:
        k = request.path_params["k"]
        with scene.lock:
            if k >= scene.levels[0].size:
                return PlainTextResponse(f"vertex {k}: the wall has {scene.levels[0].size}\n", 404)
            return JSONResponse(exports.vertex(scene, k))

    return answer


def _history(scene: Scene) -> Endpoint:
    async def answer(_: Request) -> Response:
        with scene.lock:
            return JSONResponse(scene.history.as_columns())

    return answer


def _snapshot(answers: LongAnswers, scene: Scene) -> Endpoint:
    async def answer(request: Request) -> Response:
        if page("app.js") is None:
            return PlainTextResponse(no_page() + "\n", 503)

        def write() -> Iterator[str]:
            files = {name: (page(name) or b"").decode() for name in TYPES}
            start, stop = exports.ends(query)
            return snapshot(scene, files, start, stop, query.get("address", ""))

        query = request.query_params
        return await answers.give(write, TYPES["index.html"], _named("wall", query, "html"), at_once=True)

    return answer


def _section(answers: LongAnswers, scene: Scene) -> Endpoint:
    async def answer(request: Request) -> Response:
        query = request.query_params
        return await answers.give(
            lambda: exports.section(scene, *exports.ends(query)), "text/csv", _named("section", query, "csv")
        )

    return answer


def _named(what: str, query: Mapping[str, str], ending: str) -> str:
    """Return a file's name, with the depths of its section where they are numbers."""
    try:
        return f"{what}-{'-'.join(f'{depth:.1f}' for depth in exports.ends(query))}.{ending}"
    except ValueError:
        return f"{what}.{ending}"
