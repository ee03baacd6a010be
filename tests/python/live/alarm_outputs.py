"""Where ``helibore live`` shows an alarm: the browser's page, the metrics and stderr; `AlarmOutputs` reads them."""

from __future__ import annotations

import contextlib
import io
import sys
from typing import Any

import pytest
from patience import wait

from helibore.cli.live_log import LogWriter, logged
from helibore.cli.live_view import Window
from helibore.cli.prometheus_metrics import metrics
from helibore.live.alarms import Alarm
from helibore.live.server import Server


class AlarmOutputs(contextlib.ExitStack):
    """The page and the log of ``helibore live``, for one server after the other.

    ``page`` is the page that a browser has open; without it, the state that the page gets is read.
    """

    def __init__(self) -> None:
        super().__init__()
        self._log = io.StringIO()
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(sys, "stderr", self._log)
            self.writer: LogWriter = self.enter_context(logged(None, quiet=True))
        self.window = self.enter_context(Window("well-7"))
        self.page: Any = None

    def lacking(self, server: Server, alarm: Alarm) -> list[str]:
        """Return those of page, metrics and stderr that do not show an alarm with its text."""
        self.window.follow(server.live)
        self.window.refresh(server.states, server.alarms.active)
        line = f'helibore_alarm_active{{alarm="{alarm.rule}",source="{alarm.source}"}} 1.0'
        said = alarm.said(named=len(server.live.configuration.sources) > 1)
        shown = {"page": self._page_shows(said), "metrics": line in metrics(server)}
        begins = f"alarm_{alarm.rule}: {alarm.text}"
        with contextlib.suppress(AssertionError):  # a thread writes stderr
            wait(lambda: begins in self._log.getvalue(), lambda: begins, 0.001)
        shown["stderr"] = begins in self._log.getvalue()
        return [name for name, right in shown.items() if not right]

    def _page_shows(self, text: str) -> bool:
        if self.page is None:
            return text in self.window.scene.state.alarms
        with contextlib.suppress(AssertionError):
            wait(lambda: text.casefold() in self._page_text(), lambda: text, 0.02)
        return text.casefold() in self._page_text()

    def _page_text(self) -> str:
        return str(self.page.inner_text("body")).casefold()
