"""See a wall in a browser: `hb.view(wall)` in a script or notebook, `helibore view FILE` in a shell.

    feed.py      reads a wall that grows        client.py       what a page has not received
    scene.py     what is shown                  web_app.py      addresses and websocket
    levels.py    the wall and its overview      page_server.py  the server's thread
    messages.py  the bytes                      web/            the page

The page needs no other machine and gets every new quad once, in about 12 bytes. Serving needs the extra ``view``; this
module itself imports NumPy only.
"""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from helibore.base.errors import InputError
from helibore.images.normalization import image_scale
from helibore.trajectory.survey import Path
from helibore.viewer.feed import Feed, ViewedWall
from helibore.viewer.scene import Attribute

if TYPE_CHECKING:
    from helibore.viewer.page_server import PageServer

__all__ = ["Attribute", "Viewer", "attributes_of", "view"]


class Viewer:
    """A wall on a page, made by `view`. Call `update` after every append and `close` at the end.

    Attributes
    ----------
    url : str
        Address of the page, with its token if there is one.
    scene : Scene
        What is shown; `Scene.update_state` sets bit depth, time of the newest sample and more.
    """

    def __init__(self, feed: Feed, server: PageServer) -> None:
        self._feed, self._server = feed, server
        self.scene = feed.scene
        self.url = server.url

    def update(self, change: Any = None, attributes: Mapping[str, npt.ArrayLike] | None = None) -> None:
        """Show what an append changed. Returns at once; another thread does the work.

        Parameters
        ----------
        change
            What `Wall.append` returned. None: everything is compared, and differences are sent.
        attributes
            Values of attributes that were named when the viewer was made, one per quad of the wall as it is now. Only
            values of changed vertices are read: ``viewer.update(change, {"GR": image.on(wall)})``.
        """
        self._feed.update(change, attributes)

    def set_path(self, path: Path | None) -> None:
        """Place the wall along a new or corrected path; the wall itself is not sent again."""
        self._feed.set_path(path)

    def set_attribute(self, name: str, values: npt.ArrayLike) -> None:
        """Set one value per quad of an attribute that was named when the viewer was made."""
        self._feed.set_attribute(name, values)

    def wait(self) -> None:
        """Serve until Ctrl-C."""
        self._server.wait()

    def close(self) -> None:
        """Stop serving and free the port. May be called twice."""
        self._feed.close()
        self._server.close()

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _repr_html_(self) -> str:
        return f'<iframe src="{self.url}" style="width: 100%; height: 720px; border: 0" title="helibore"></iframe>'

    def __repr__(self) -> str:
        return f"Viewer({self.url})"


def view(
    wall: ViewedWall,
    *,
    path: Path | None = None,
    attributes: Mapping[str | Attribute, npt.ArrayLike] | None = None,
    well: str = "",
    host: str = "127.0.0.1",
    port: int = 0,
    token: str | None = None,
    browser: bool = False,
) -> Viewer:
    """Show a wall on a page in the browser, growing or finished.

    Parameters
    ----------
    wall
        A `helibore.Wall`. The viewer reads it and never changes it.
    path
        Its `helibore.Path`; None is a straight vertical hole.
    attributes
        Values to colour by, one per quad (quad k has the number of its first vertex), by name or by `Attribute`. None:
        `attributes_of` the wall.
    well
        The well's name, for the page.
    host, port
        Address to serve on. Port 0 takes a free one.
    token
        Secret that the address must carry. Required if other machines can reach `host`.
    browser
        Open the page in the default browser.

    Returns
    -------
    Viewer
        Already serving. In a notebook it displays itself as a frame.

    Raises
    ------
    MissingExtraError
        Without the extra: ``needs starlette: pip install "helibore[view]"``.
    InputError
        If the wall has no vertex or reaches beyond `path`, if an attribute's length is not the number of vertices or
        quads, or if `host` needs a token.
    OSError
        If the port is in use; the text names it.
    """
    from helibore.viewer.page_server import PageServer

    values = attributes_of(wall) if attributes is None else attributes
    feed = Feed(wall, path=path, attributes=values, well=well)
    server = PageServer(feed.scene, host=host, port=port, token=token)
    feed.start()
    if browser:
        import webbrowser

        webbrowser.open(server.url)
    return Viewer(feed, server)


def attributes_of(wall: Any) -> dict[str | Attribute, npt.ArrayLike]:
    """Return the images and attributes of a wall, one value a quad; images in the colours of `helibore.plot`."""
    values: dict[str | Attribute, npt.ArrayLike] = {}
    for name, image in getattr(wall, "images", {}).items():
        attribute = Attribute.usual(name, image.unit)
        with contextlib.suppress(InputError):  # constant, or without a value: the feed finds limits
            scale = image_scale(image)
            attribute = Attribute(name, image.unit, scale.low, scale.high, scale.log, scale.color_map)
        values[attribute] = image.on(wall)
    others: Any = getattr(wall, "attributes", {})
    for name in others:
        quads = max(len(wall) - wall.settings.sectors - 1, 0)
        values[Attribute(name, others.units.get(name, ""))] = others.whole(name, wall.start_depth, quads)
    return values
