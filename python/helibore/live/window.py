"""``helibore live --view``: the viewer's page beside the live wall.

    server's drawing thread --show(update)--> Feed of the viewer (a thread of its own) --> pages
    command's loop ---------refresh()-------> page opened with the first vertex; bit depth, path, images

The page shows layer ``main``. A path that ends above the wall is drawn on straight; one that begins below its top, or
none, is a vertical hole. What the page looks like is ``helibore/viewer``; nothing of it is loaded without ``--view``.
"""

from __future__ import annotations

import socket
import time
from typing import TYPE_CHECKING, Any

from helibore.live.live import Live
from helibore.live.model import Update

if TYPE_CHECKING:
    from helibore.survey import Path
    from helibore.viewer import Viewer

AHEAD = 100.0
"""Metres the shown path goes on below the wall, for what is drilled next."""


def check_window(port: int) -> None:
    """Find out before the start what would keep the page from being served.

    Raises
    ------
    ModuleNotFoundError
        Without the extra ``view``; the text names it.
    ValueError
        If the package was built without the page.
    OSError
        If the port is taken.
    """
    from helibore.viewer.command import check_page

    check_page()
    socket.create_server(("127.0.0.1", port)).close()


class Window:
    """A page that follows a live wall.

    Parameters
    ----------
    live
        What is shown.
    well
        Its name on the page.
    serving
        ``host``, ``port``, ``token`` of `helibore.view`.
    """

    def __init__(self, live: Live, well: str = "", **serving: Any) -> None:
        self._live, self._well, self._serving = live, well, serving
        self._viewer: Viewer | None = None
        self._path_moved = True
        self._newest: float | None = None
        self._path_stop = float("inf")

    @property
    def url(self) -> str:
        """Where the page is; "" before the first vertex."""
        return self._viewer.url if self._viewer else ""

    def show(self, update: Update) -> None:
        """Note what changed; returns at once."""
        if update.path_from is not None:
            self._path_moved = True
        if change := update.changes.get("main"):
            self._newest = time.time()
            if self._viewer:
                self._viewer.update(change)

    def refresh(self) -> bool:
        """Open the page when there is a wall, follow the bit and the path; returns whether the page was opened.

        To be called a few times a second.
        """
        if not len(self._live.wall):
            return False
        opened = self._viewer is None
        if opened:
            self._open()
        elif self._path_moved or self._path_stop < self._span()[1]:
            self._follow_path()
        bit = self._live.model.rig.tracks["bit_depth"].value[-1:].tolist()
        assert self._viewer is not None
        self._viewer.scene.state(bit_depth=bit[0] if bit else None, newest=self._newest)
        return opened

    def close(self) -> None:
        """Say on the page that the run has ended, and stop serving."""
        if self._viewer:
            self._viewer.scene.state(ended=True)
            self._viewer.close()

    def _open(self) -> None:
        from helibore.viewer import view

        self._path_moved = False
        self._viewer = view(self._live.wall, path=self._path(), well=self._well, **self._serving)
        self._viewer.update()  # what was drawn while it opened

    def _follow_path(self) -> None:
        assert self._viewer is not None
        self._path_moved = False
        self._viewer.set_path(self._path())

    def _span(self) -> tuple[float, float]:
        """Shallowest and deepest vertex, metres."""
        wall = self._live.wall
        end = wall.start_depth + (len(wall) - 1) * wall.settings.pitch / wall.settings.sectors
        return min(wall.start_depth, end), max(wall.start_depth, end)

    def _path(self) -> Path | None:
        """The path so far, far enough for the wall and what comes next; None where it cannot carry the wall."""
        top, bottom = self._span()
        path = self._live.model.stations.reaching(bottom + AHEAD)
        if path is None or path.start_depth > top:
            self._path_stop = float("inf")
            return None
        self._path_stop = path.stop_depth
        return path
