"""A Chromium whose window can be hidden, over its own protocol.

Playwright keeps every page of its own as if it were in front (it emulates focus), so nothing is ever hidden there. Here
the browser is spoken to directly: one websocket, a command and its answer at a time.
"""

from __future__ import annotations

import itertools
import json
from types import TracebackType
from typing import Any

from live_servers import until
from patience import PATIENCE
from screen import Chromium


class Tabs:
    """A browser with one page."""

    def __init__(self, url: str) -> None:
        self._browser = Chromium("--window-size=1366,868", url)
        self._numbers = itertools.count(1)
        self._connect()

    def _connect(self) -> None:
        from websockets.sync.client import connect

        self._socket = connect(self._browser.socket, max_size=None).__enter__()
        self._page = next(t["targetId"] for t in self._call("Target.getTargets")["targetInfos"] if t["type"] == "page")
        attached = self._call("Target.attachToTarget", targetId=self._page, flatten=True)
        self._session: str = attached["sessionId"]

    def _call(self, method: str, session: str | None = None, **params: Any) -> dict[str, Any]:
        number = next(self._numbers)
        self._socket.send(
            json.dumps(
                {"id": number, "method": method, "params": params, **({"sessionId": session} if session else {})}
            )
        )
        while (answer := json.loads(self._socket.recv(PATIENCE))).get("id") != number:
            pass
        assert "error" not in answer, answer
        result: dict[str, Any] = answer["result"]
        return result

    def evaluate(self, expression: str) -> Any:
        """Return what a script gives, once its promise is kept."""
        asked = {"expression": expression, "awaitPromise": True, "returnByValue": True}
        answer = self._call("Runtime.evaluate", self._session, **asked)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def hide(self) -> None:
        """Minimize the window of the page."""
        self._resize("minimized", "hidden")

    def show(self) -> None:
        """Bring the page back."""
        self._resize("normal", "visible")

    def _resize(self, state: str, becomes: str) -> None:
        window = self._call("Browser.getWindowForTarget", targetId=self._page)["windowId"]
        self._call("Browser.setWindowBounds", windowId=window, bounds={"windowState": state})
        until(lambda: self.evaluate("document.visibilityState") == becomes)

    def __enter__(self) -> Tabs:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._socket.close()
        self._browser.close()
