"""The addresses of the page's server.

    /  /app.js  /app.css                    the page, from the package, compressed
    /ws                                     handshake and state as text, values as binary (protocol.py)
    /api/vertex/K  /api/section.csv         values of one vertex, of the vertices of a section
    /api/summary                            volume, washout and gaps of a section
    /api/history                            the length of the wall over time
    /api/curve?name=                        a curve along the hole
    /api/channels.svg?theme=                the channels of the rig and their lines by time
    /api/pick  /api/picks.csv               put or delete a pick; read or add a table of picks
    /api/export.html                        a section and the page, as one file
    /api/print.pdf                          a section as a PDF, if the scene has `Scene.draw_pages`
    /api/section.glb                        a section as a mesh, if the scene has `Scene.write_mesh`
    /api/section.las                        its logs, if the scene has `Scene.write_logs`
    /healthz                                whether the server runs, and how many vertices and pages it has

Several wells have a page of their own at / (`WellsApp`), which reads

    /api/wells                              name, address and head of each well

and all of the above for each well below /w/0/, /w/1/ ...

`AccessControl` checks every request. A page that is opened before the wall begins shows what the sources are doing; the
addresses below /api then answer 503.
"""

from __future__ import annotations

import asyncio
import contextlib
import gzip
import hashlib
import json
import math
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator, Mapping, MutableMapping, Sequence
from typing import Any, Protocol
from urllib.parse import quote

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, PlainTextResponse, Response
from starlette.routing import BaseRoute, Mount, Route, WebSocketRoute
from starlette.types import ASGIApp
from starlette.websockets import WebSocketDisconnect

from helibore.base.connections import Connections
from helibore.base.errors import InputError
from helibore.base.identity import Access
from helibore.base.limits import limit
from helibore.logs.picks import Pick, Picks, pick_of
from helibore.settings.template import Template
from helibore.viewer import exports
from helibore.viewer.access import AccessControl
from helibore.viewer.channel_strip import channel_strip
from helibore.viewer.client import Client
from helibore.viewer.downloads import Downloads
from helibore.viewer.html_export import html_export
from helibore.viewer.page_files import TYPES, WELLS, files_of_page, no_page, page
from helibore.viewer.protocol import BadMessageError, handshake, picks_message, read_subscription, state_message
from helibore.viewer.scene import Scene

TICK = 0.05  # seconds: a growing wall is sent at most 20 times a second; the first change is sent at once
MOST_PAGES = 64
MOST_TEXT = 8192  # characters of a message from a page, bytes of a pick
MOST_TABLE = 1 << 21  # bytes of a table of picks
MOST_PICTURE = 1 << 24  # bytes of a picture to print
NOT_BEGUN = "no sample has come yet: there is no wall to show"
Endpoint = Callable[[Request], Awaitable[Response]]


class Socket(Protocol):
    """The connection to a page: Starlette's WebSocket, or the frame of a notebook."""

    async def accept(self) -> None: ...
    async def close(self, code: int, reason: str) -> None: ...
    async def receive(self) -> MutableMapping[str, Any]: ...
    async def send_text(self, text: str) -> None: ...
    async def send_bytes(self, message: bytes) -> None: ...


def application(shown: Scene | Sequence[Scene], access: Access, connections: Connections | None = None) -> ASGIApp:
    """Return the ASGI application that shows a scene, or several wells, to who has the token of ``access``."""
    app = WebApp(shown) if isinstance(shown, Scene) else WellsApp(shown)
    return AccessControl(Starlette(routes=app.routes(), lifespan=app.lifespan), access, connections)


class WebApp:
    """The endpoints, and the pages that are connected."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.downloads = Downloads("downloads", limit("downloads"))
        self.prints = Downloads("prints", limit("prints"))
        self.connections: set[_Connection] = set()
        self.loop: asyncio.AbstractEventLoop | None = None
        self.wake_pending = False

    def routes(self) -> list[BaseRoute]:
        """Return the routes of every address."""
        files = [Route("/", self.file), *(Route(f"/{name}", self.file) for name in TYPES)]
        api: dict[str, Endpoint] = {
            "vertex/{k:int}": self.vertex,
            "section.csv": self.section,
            "curve": self.curve,
            "channels.svg": self.channels,
            "summary": self.summary,
            "history": self.history,
            "export.html": self.export,
            "section.glb": self.mesh_section,
            "section.las": self.logs_section,
        }

        def when_begun(endpoint: Endpoint) -> Endpoint:
            async def checked(request: Request) -> Response:
                return await endpoint(request) if self.scene.begun else PlainTextResponse(NOT_BEGUN + "\n", 503)

            return checked

        begun = [Route(f"/api/{path}", when_begun(endpoint)) for path, endpoint in api.items()]
        begun += [
            Route("/api/pick", when_begun(self.change_pick), methods=["PUT", "DELETE"]),
            Route("/api/print.pdf", when_begun(self.print_section), methods=["GET", "POST"]),
            Route("/api/picks.csv", when_begun(self.picks_table), methods=["GET", "POST"]),
        ]
        return [*files, Route("/healthz", self.health), *begun, WebSocketRoute("/ws", self.serve)]

    def begin(self, loop: asyncio.AbstractEventLoop) -> None:
        """Use the event loop ``loop`` from now on: changes of the scene wake its connections."""
        self.loop, self.scene.on_change = loop, self.wake

    @contextlib.asynccontextmanager
    async def lifespan(self, _: Starlette) -> AsyncIterator[None]:
        self.begin(asyncio.get_running_loop())
        yield
        self.scene.on_change = lambda: None
        self.loop = None

    def wake(self) -> None:
        """Wake every connection because the scene changed; from any thread. Until they wake, more calls do nothing."""

        def wake_connections() -> None:
            self.wake_pending = False
            for connection in self.connections:
                connection.wake.set()

        if not self.wake_pending and self.loop is not None:
            self.wake_pending = True
            with contextlib.suppress(RuntimeError):  # the loop was closed since the check
                self.loop.call_soon_threadsafe(wake_connections)

    async def serve(self, socket: Socket) -> None:
        """Serve one page over its WebSocket until it disconnects or breaks the protocol."""
        await socket.accept()
        if len(self.connections) >= MOST_PAGES:
            await socket.close(4429, f"{MOST_PAGES} pages are connected already")
            return
        connection = _Connection(self.scene, socket)
        self.connections.add(connection)
        with self.scene.lock:
            self.scene.listeners.append(connection.mark)
        sender = asyncio.create_task(connection.send_all())
        try:
            await connection.receive_all()
        except BadMessageError as error:
            with contextlib.suppress(RuntimeError, WebSocketDisconnect):
                await socket.close(4400, str(error)[:120])
        except WebSocketDisconnect:
            pass
        finally:
            sender.cancel()
            await asyncio.gather(sender, return_exceptions=True)
            self.connections.discard(connection)
            with self.scene.lock:
                self.scene.listeners.remove(connection.mark)

    async def file(self, request: Request) -> Response:
        return file_answer(request, request.url.path.rpartition("/")[2] or "index.html")

    async def health(self, _: Request) -> Response:
        vertices = self.scene.levels[0].size if self.scene.begun else 0
        built = page("app.js") is not None
        return JSONResponse({"vertices": vertices, "pages": len(self.connections), "page_built": built})

    async def vertex(self, request: Request) -> Response:
        k = request.path_params["k"]
        with self.scene.lock:
            if k >= self.scene.levels[0].size:
                return PlainTextResponse(f"vertex {k}: the wall has {self.scene.levels[0].size} vertices\n", 404)
            return JSONResponse(exports.vertex(self.scene, k))

    async def curve(self, request: Request) -> Response:
        name = request.query_params.get("name", "")
        with self.scene.lock:
            curve = self.scene.curves.get(name)
        if curve is None:
            return PlainTextResponse(f"curve {name[:80]!r}: no curve has this name\n", 404)
        return Response(await asyncio.to_thread(exports.curve_bytes, curve), media_type="application/octet-stream")

    async def channels(self, request: Request) -> Response:
        theme = request.query_params.get("theme", "")
        picture = await asyncio.to_thread(lambda: channel_strip(self.scene.read_channels(), theme))
        return Response(picture, media_type="image/svg+xml")

    async def history(self, _: Request) -> Response:
        with self.scene.lock:
            return JSONResponse(self.scene.history.as_columns())

    async def summary(self, request: Request) -> Response:
        if self.scene.summarize is None:
            return JSONResponse(None)
        try:
            ends = sorted(exports.section_ends(request.query_params))
        except ValueError as error:
            return PlainTextResponse(f"{error}\n", 400)
        return JSONResponse(await asyncio.to_thread(self.scene.summarize, *ends))

    async def change_pick(self, request: Request) -> Response:
        """Add or replace the pick that a page sends as JSON (PUT), or delete the pick with ``?key=`` (DELETE)."""
        if request.method == "DELETE":
            key = request.query_params.get("key", "")
            return await self._change_picks(lambda picks: picks.remove_key(key))
        try:
            pick = pick_of(json.loads(await _body(request, MOST_TEXT)))
        except (ValueError, RecursionError) as error:
            return PlainTextResponse(f"{error}\n", 400)
        return await self._change_picks(lambda picks: picks.put(pick))

    async def picks_table(self, request: Request) -> Response:
        """Return the picks as a table (GET), or add the picks of a table (POST).

        The answer to POST is JSON: the keys of the picks that were added and replaced, and how many were not changed.
        """
        if request.method == "GET":
            with self.scene.lock:
                text = self.scene.picks.table(self.scene.path)
            return Response(
                text, media_type="text/csv", headers={"content-disposition": "attachment; filename=picks.csv"}
            )
        try:
            read = Picks.parse((await _body(request, MOST_TABLE)).decode("utf-8-sig"), self.scene.path)
        except ValueError as error:
            return PlainTextResponse(f"{error}\n", 400)

        merged: list[list[Pick]] = []
        answer = await self._change_picks(lambda picks: merged.extend(picks.merge(read)))
        if answer.status_code != 200:
            return answer
        added, replaced = ([pick.key for pick in picks] for picks in merged)
        unchanged = len(read) - len(added) - len(replaced)
        return JSONResponse({"added": added, "replaced": replaced, "unchanged": unchanged})

    async def _change_picks(self, change: Callable[[Picks], object]) -> Response:
        try:
            await asyncio.to_thread(self.scene.change_picks, change)
        except ValueError as error:
            return PlainTextResponse(f"{error}\n", 400)
        except OSError as error:
            return PlainTextResponse(f"the picks were not saved: {error}\n", 500)
        return PlainTextResponse("")

    async def section(self, request: Request) -> Response:
        query = request.query_params

        def write() -> Iterator[str]:
            return exports.section_csv(self.scene, *exports.section_ends(query))

        return await self.downloads.start(write, "text/csv", _file_name("section", query, "csv"))

    async def export(self, request: Request) -> Response:
        query = request.query_params
        if page("app.js") is None:
            return PlainTextResponse(no_page() + "\n", 503)

        def write() -> Iterator[str]:
            return html_export(self.scene, files_of_page(), *exports.section_ends(query), query.get("address", ""))

        return await self.downloads.start(write, TYPES["index.html"], _file_name("wall", query, "html"), whole=True)

    async def print_section(self, request: Request) -> Response:
        """Return the section as a PDF; the body of POST is a PNG of the wall in 3-D, drawn below the tracks.

        The query may have the arrangement of the tracks as the text of a template, and ``picks=off``.
        """
        query, draw = request.query_params, self.scene.draw_pages
        if draw is None:
            return PlainTextResponse("this server cannot print\n", 404)
        try:
            picture = [exports.checked_picture(await _body(request, MOST_PICTURE))] if request.method == "POST" else []
            arranged: dict[str, Any] = {"template": Template.parse(query["template"])} if "template" in query else {}
            arranged |= {"with_picks": False} if query.get("picks") == "off" else {}
        except ValueError as error:
            return PlainTextResponse(f"{error}\n", 400)

        def write(start: float, stop: float) -> bytes:
            return draw(start, stop, query.get("units", "mm"), exports.print_scale(query), *picture, **arranged)

        return await self.drawn(write, query, "application/pdf", _file_name("log", query, "pdf"))

    async def mesh_section(self, request: Request) -> Response:
        query, write = request.query_params, self.scene.write_mesh
        if write is None:
            return PlainTextResponse("this server has no wall to mesh\n", 404)
        return await self.drawn(write, query, "model/gltf-binary", _file_name("section", query, "glb"))

    async def logs_section(self, request: Request) -> Response:
        query, write = request.query_params, self.scene.write_logs
        if write is None:
            return PlainTextResponse("this server measures no logs\n", 404)
        return await self.drawn(write, query, "text/plain", _file_name("section", query, "las"))

    async def drawn(
        self, write: Callable[[float, float], bytes], query: Mapping[str, str], media_type: str, name: str
    ) -> Response:
        """Return what ``write`` makes of the section that the request states, as a file; see `Downloads.busy`."""
        if (busy := self.prints.busy()) is not None:
            return busy
        self.prints.running += 1
        try:
            start, stop = sorted(exports.section_ends(query))
            body = await asyncio.to_thread(write, start, stop)
        except (ValueError, ImportError) as error:
            return PlainTextResponse(f"{error}\n", 400)
        finally:
            self.prints.running -= 1
        return Response(body, media_type=media_type, headers={"content-disposition": f"attachment; filename={name}"})


class WellsApp:
    """The page of several wells, and below ``/w/0/``, ``/w/1/`` ... the addresses of each well's own page."""

    def __init__(self, scenes: Sequence[Scene]) -> None:
        self.apps = [WebApp(scene) for scene in scenes]

    def routes(self) -> list[BaseRoute]:
        """Return the routes of every address."""
        files = [Route("/", self.file), *(Route(f"/{name}", self.file) for name in ("wells.js", "app.css"))]
        own = [Mount(f"/w/{number}", routes=app.routes()) for number, app in enumerate(self.apps)]
        return [*files, Route("/api/wells", self.wells), Route("/healthz", self.health), *own]

    @contextlib.asynccontextmanager
    async def lifespan(self, _: Starlette) -> AsyncIterator[None]:
        async with contextlib.AsyncExitStack() as stack:
            for app in self.apps:
                await stack.enter_async_context(app.lifespan(_))
            yield

    async def file(self, request: Request) -> Response:
        return file_answer(request, request.url.path.strip("/") or "wells.html")

    async def wells(self, _: Request) -> Response:
        """Return name, address and length of each well, and north, east and down of its head, null without a path.

        Of a well that waits for its first data, return null.
        """
        listed: list[dict[str, Any] | None] = []
        for number, scene in enumerate(app.scene for app in self.apps):
            if not scene.begun:
                listed.append(None)
                continue
            level, path = scene.levels[0], scene.path
            length = abs(level.size * scene.shape.pitch / level.sectors)
            head = None if path is None else path.head
            listed.append({"name": scene.shape.well, "address": f"w/{number}/", "length": length, "head": head})
        return JSONResponse(listed)

    async def health(self, _: Request) -> Response:
        scenes = [app.scene for app in self.apps]
        pages = sum(len(app.connections) for app in self.apps)
        vertices = sum(scene.levels[0].size for scene in scenes if scene.begun)
        return JSONResponse({"vertices": vertices, "pages": pages, "page_built": page("wells.js") is not None})


class _Connection:
    """One connected page: a task that receives and a task that sends."""

    def __init__(self, scene: Scene, socket: Socket) -> None:
        self.scene, self.socket = scene, socket
        self.wake = asyncio.Event()
        self.client: Client | None = None
        self.sent_state: dict[str, Any] = {}
        self.sent_picks: list[tuple[str, Pick]] | None = None
        self.sent_curves: Any = ()
        self.sent_at = -math.inf  # time on the clock of the loop

    def mark(self, level: int, start: int, stop: int, measured: bool) -> None:
        if self.client is not None and self.client.session == self.scene.session:
            self.client.mark(level, start, stop, measured)

    async def send_all(self) -> None:
        """Send what is pending, nearest first: requested tiles at once, other changes at most once every `TICK`."""
        clock = asyncio.get_running_loop().time
        with contextlib.suppress(WebSocketDisconnect, RuntimeError):
            while True:
                await self._send_text()
                while (message := self._next_message()) is not None:
                    await self.socket.send_bytes(message)
                    self.sent_at = clock()
                await self.wake.wait()
                if self.client is not None and not self.client.requested:
                    await asyncio.sleep(self.sent_at + TICK - clock())
                self.wake.clear()

    async def _send_text(self) -> None:
        """Send the handshake if the page or the wall is new, and the state and the picks if they changed."""
        texts = []
        with self.scene.lock:
            if self.scene.begun and (self.client is None or self.client.session != self.scene.session):
                self.client = Client(self.scene)
                texts.append(json.dumps(handshake(self.scene)))
                self.sent_picks, self.sent_curves = None, ()
            state = state_message(self.scene)
            curves = state.pop("curves")
            picks = None if self.client is None else [(pick.key, pick) for pick in self.scene.picks]
            picks_text = json.dumps(picks_message(self.scene)) if picks != self.sent_picks else ""
        if state != self.sent_state or curves != self.sent_curves:
            changed = [row for row in curves if row not in self.sent_curves]
            texts.append(json.dumps({**state, "curves": changed}, separators=(",", ":")))
            self.sent_state, self.sent_curves = state, curves
        if picks_text:
            self.sent_picks = picks
            texts.append(picks_text)
        for text in texts:
            await self.socket.send_text(text)

    def _next_message(self) -> bytes | None:
        with self.scene.lock:
            return None if self.client is None else self.client.next_message()

    async def receive_all(self) -> None:
        """Read acks and subscriptions until the page disconnects; raise BadMessageError for any other message."""
        while True:
            message = await self.socket.receive()
            if message["type"] == "websocket.disconnect":
                return
            text = message.get("text")
            if text is None or len(text) > MOST_TEXT:
                raise BadMessageError(f"a page sends text of at most {MOST_TEXT} bytes")
            try:
                content = json.loads(text)
            except (ValueError, RecursionError) as error:
                raise BadMessageError("not JSON") from error
            self._receive(content)
            self.wake.set()

    def _receive(self, content: Any) -> None:
        with self.scene.lock:
            if not isinstance(content, dict) or self.client is None:
                raise BadMessageError("a message must be an object, sent after the handshake")
            if content.get("session") != self.client.session:
                return  # the message is about the previous wall
            if "ack" in content:
                self.client.acknowledge(content["ack"] if type(content["ack"]) is int else -1)
            elif "subscribe" in content:
                self.client.subscribe(read_subscription(content["subscribe"], len(self.scene.shape.attributes)))
            else:
                raise BadMessageError("a message must be ack or subscribe")


def file_answer(request: Request, name: str) -> Response:
    """Return a file of the built page; a page asks for its other files with the token of the request."""
    body = page(name)
    if body is None:
        return PlainTextResponse(no_page() + "\n", 503)
    if name.endswith(".html") and (token := request.query_params.get("token")):
        body = _with_token(body, token)
    tag = f'"{hashlib.sha256(body).hexdigest()}"'
    headers = {"ETag": tag, "Vary": "Accept-Encoding"}
    if request.headers.get("If-None-Match") == tag:
        return Response(status_code=304, headers=headers)
    if "gzip" in request.headers.get("Accept-Encoding", ""):
        body, headers["Content-Encoding"] = gzip.compress(body), "gzip"
    return Response(body, media_type=(TYPES | WELLS)[name], headers=headers)


def _with_token(html: bytes, token: str) -> bytes:
    """Return the page so that it asks for its other files with the token, as for all else."""
    for name in ("app.js", "wells.js", "app.css"):
        html = html.replace(f'"{name}"'.encode(), f'"{name}?token={quote(token, safe="")}"'.encode())
    return html


async def _body(request: Request, most: int) -> bytes:
    """Return the body of a page's request; raise InputError if it has more than ``most`` bytes."""
    body = bytearray()
    async for chunk in request.stream():
        body += chunk
        if len(body) > most:
            raise InputError("body", f"must be at most {most} bytes")
    return bytes(body)


def _file_name(what: str, query: Any, ending: str) -> str:
    """Return the name of a download (``section-1200.0-1300.0.csv``), without depths if the query states none."""
    try:
        return f"{what}-{'-'.join(f'{depth:.1f}' for depth in exports.section_ends(query))}.{ending}"
    except ValueError:
        return f"{what}.{ending}"
