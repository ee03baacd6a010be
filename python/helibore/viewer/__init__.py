"""Show walls in a browser: `hb.view(wall)` in a script or notebook, `helibore view FILE` in a shell.

    feed.py      reads a wall that grows        client.py         what a page has not received
    scene.py     what is shown                  web_app.py        addresses and websocket
    levels.py    the wall and its overview      page_server.py    the server's thread
    texels.py    what is kept of a vertex       notebook_view.py  a notebook's widget
    protocol.py  the messages                   web/              the page

The page needs no other machine and receives a new quad in about 12 bytes. A server needs the extra ``view``; a widget
in a notebook needs the extra ``notebook``. Importing this module needs neither of the two extras.
"""

from __future__ import annotations

import contextlib
import importlib.util
import math
import os
import sys
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats
from helibore.base.atomic_file import write_whole
from helibore.base.color_limits import wall_limit
from helibore.base.errors import InputError
from helibore.base.identity import Access, find_token
from helibore.base.tables import refuse_table
from helibore.base.units import MILLIMETRE
from helibore.images.normalization import image_scale
from helibore.images.sector_image import SectorImage
from helibore.logs.curves import ScalarCurve, curves_of
from helibore.logs.picks import can_save
from helibore.settings.template import Template, TemplateTrack
from helibore.trajectory.references import Reference
from helibore.trajectory.survey import Path
from helibore.viewer.feed import Feed, ViewedWall, first_vertex
from helibore.viewer.scene import Attribute

if TYPE_CHECKING:
    import tempfile

    from helibore.logs.zone_criteria import Criteria
    from helibore.settings.output_settings import RigidBody
    from helibore.viewer.notebook_view import NotebookView
    from helibore.viewer.page_server import PageServer
    from helibore.wall.wall import Wall

MOST_PLANNED = 500
"""Points of a planned path that a page gets."""
OTHER_WELL = 10.0
"""Metres between two paths at one depth from which they are of two wells."""
__all__ = ["Attribute", "Viewer", "WellsViewer", "attributes_of", "view", "view_wells"]


class Viewer:
    """A wall on a page, made by `view`. Call `update` after every append; call `close` to stop.

    Attributes
    ----------
    url : str
        Address of the page, with its token; empty in a notebook's widget.
    widget : NotebookView or None
        In a notebook: the widget, whose traits ``depths`` and ``cursor`` follow what the user does on the page.
    scene : Scene
        What is shown; `Scene.update_state` sets bit depth, time of the newest sample and more.
    """

    def __init__(
        self, feed: Feed, server: PageServer | None = None, widget: NotebookView | None = None, card: str = ""
    ) -> None:
        self._feed, self._server, self.widget, self._card = feed, server, widget, card
        self.scene = feed.scene
        self.url = server.url if server else ""
        self._opened: tempfile.TemporaryDirectory[str] | None = None

    def update(self, change: Any = None, attributes: Mapping[str, npt.ArrayLike] | None = None) -> None:
        """Show what an append changed. Returns at once; another thread does the work.

        Parameters
        ----------
        change
            What `Wall.append` returned. None: all vertices are compared, and the vertices that differ are sent.
        attributes
            Values of attributes that were named when the viewer was made, one for each quad or vertex that the wall has
            at this call. Only values of changed vertices are read: ``viewer.update(change, {"GR": image.on(wall)})``.

        Raises
        ------
        InputError
            If an attribute was not named when the viewer was made, or has another number of values.
        """
        self._feed.update(change, attributes)

    def set_path(self, path: Path | None) -> None:
        """Place the wall along a new or corrected path; raise InputError if it does not reach all of the wall."""
        self._feed.set_path(path)

    def set_attribute(self, name: str, values: npt.ArrayLike) -> None:
        """Set the values of an attribute that was named when the viewer was made: one for each quad or vertex.

        There may be fewer values if the wall has grown since they were made. Raises InputError if there are more
        values, or if no attribute of this name was named.
        """
        self._feed.set_attribute(name, values)

    def save(self, filename: str | os.PathLike[str], start: float | None = None, stop: float | None = None) -> None:
        """Write the page with what it shows now as one HTML file, whole or not at all; it needs no server.

        Parameters
        ----------
        filename
            The file; an existing one is replaced.
        start, stop
            Measured depths of the section in the file, metres. None: the ends of the wall. The picks in it and the
            overview are those of the whole wall.

        Raises
        ------
        InputError
            If the section has more than a million vertices or does not reach the wall, or if the package was built
            without its page.
        OSError
            If the file cannot be written; an existing file then does not change.
        """
        from helibore.viewer.html_export import html_export
        from helibore.viewer.page_files import files_of_page

        self._feed.find_zones()
        section = -math.inf if start is None else start, math.inf if stop is None else stop
        chunks = html_export(self.scene, files_of_page(), *section)
        write_whole(filename, lambda file: file.writelines(chunk.encode() for chunk in chunks))

    def wait(self) -> None:
        """Serve until Ctrl-C; in a notebook's widget, return at once."""
        if self._server:
            self._server.wait()

    def close(self) -> None:
        """Stop serving and free the port. May be called twice."""
        self._feed.close()
        if self._opened:
            self._opened.cleanup()
        if self._server:
            self._server.close()
        if self.widget:
            self.widget.close()

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _repr_html_(self) -> str:
        return f'<iframe src="{self.url}" style="width: 100%; height: 720px; border: 0" title="helibore"></iframe>'

    def _ipython_display_(self) -> None:
        from IPython.display import HTML, display

        if self.widget is None:
            display(HTML(self._repr_html_()))
        else:
            display(HTML(self.widget.still(self._card)), self.widget)

    def __repr__(self) -> str:
        return f"Viewer({self.url or 'in a notebook'})"


def view(
    wall: ViewedWall,
    *,
    path: Path | None = None,
    plan: Path | None = None,
    attributes: Mapping[str | Attribute, npt.ArrayLike] | None = None,
    curves: Iterable[ScalarCurve] = (),
    template: Template | None = None,
    reference: Reference | None = None,
    picks_file: str | os.PathLike[str] | None = None,
    beside: Mapping[str, Wall] | None = None,
    criteria: Criteria | None = None,
    string: Iterable[RigidBody] = (),
    well: str = "",
    host: str = "127.0.0.1",
    port: int = 0,
    token: str | None = None,
    browser: bool = False,
    inline: bool | None = None,
) -> Viewer:
    """Show a wall, growing or finished, on a page in the browser or in a notebook.

    Parameters
    ----------
    wall
        A `helibore.Wall`. The viewer reads it and never changes it.
    path
        The `helibore.Path` of the hole; None: that of the wall. Without either, the page draws the hole straight down.
    plan
        The `helibore.Path` as it was planned: a dashed line beside the hole, and in its plan.
    attributes
        Values to colour by, one for each quad or vertex (quad k begins at vertex k), by name or by `Attribute`; at most
        16. None: the images and attributes of the wall.
    curves
        Curves along the hole that the page offers besides those of `Wall.logs`: gamma ray, rate of penetration ... If
        the page is wide enough, it begins with the first two.
    template
        Which tracks the page shows at first, in which order and how wide.
    reference
        The direction of toolface 0, for a hole without a path: the page then names the sides of the hole. None: the
        reference that the images of the wall state, if they state one.
    picks_file
        The file in which the page saves picks, as `Picks.save` does. ``wall.picks`` has the picks in any case. If the
        file's folder cannot be written, the page says so, and that its button *Download* saves the picks.
    beside
        Other walls by name (other wells, or passes of the same well). At the depths of `wall`, the page offers for
        each of these walls radius minus bit radius as an image, in the colours of `wall`, its radius minus that of
        `wall` as another, and C1 and C2 as curves.
        Without `template` the page begins with the radius images of `wall` and of the first three of these walls.
    criteria
        Criteria of the zones; None: the defaults of `Wall.zones`.
    string
        The rigid bodies of a string, as `Wall.passage` takes them. The page draws them in the hole with the bit, with
        the clearance and its 95 % interval at the tightest place. They can be dragged.
    well
        The well's name, for the page.
    host, port
        Address to serve on. Port 0: a free port.
    token
        Secret that every request must carry, as the address of the page does. None: the environment variable
        HELIBORE_TOKEN, or else a random token.
    browser
        Open the page in the default browser.
    inline
        True: a widget in a notebook, which needs no port. False: a server. None: a widget in a Jupyter notebook if
        anywidget is installed and neither `port`, `token` nor `browser` is given, else a server.

    Returns
    -------
    Viewer
        The viewer, which serves the page already. As the last value of a cell, the viewer displays itself.

    Raises
    ------
    MissingExtraError
        If a library of the extra is missing.
    InputError
        If the wall has no vertex, has more than 2048 sectors or reaches beyond `path`; if an attribute's length is not
        the number of vertices or quads, if there are more than 16 attributes, or two with the same name; if `port` is
        not from 0 to 65535, or `token` is empty; with `inline`, if the package was built without its page.
    OSError
        If the port is in use; the text names it.
    """
    from helibore.wall.wall import Wall

    refuse_table(wall, "wall")
    path = getattr(wall, "path", None) if path is None else path
    values: dict[str | Attribute, npt.ArrayLike] = dict(attributes_of(wall) if attributes is None else attributes)
    curves = list(curves)
    if beside:
        others = [of_other(wall, path, name, other) for name, other in beside.items()]
        values |= {key: one for columns, _ in others for key, one in columns.items()}
        curves += [curve for _, own in others for curve in own]
        template = template or _side_by_side([str(next(iter(columns)).name) for columns, _ in others])
    feed = Feed(
        wall, path=path, attributes=values, well=well, reference=reference, criteria=criteria, string=tuple(string)
    )
    if isinstance(wall, Wall):
        feed.scene.picks, feed.scene.intervals = wall.picks, wall.intervals
    if plan is not None:
        feed.scene.plan = plan.position(np.linspace(plan.start_depth, plan.stop_depth, MOST_PLANNED))
    feed.scene.picks_file = picks_file
    feed.scene.saves_picks = picks_file is None or can_save(picks_file)
    feed.scene.set_curves(curves)
    feed.scene.template = template
    if inline is None:
        inline = not (port or token or browser) and _in_notebook()
    if inline:
        from helibore.viewer.notebook_view import NotebookView

        viewer = Viewer(feed, widget=NotebookView(feed.scene), card=getattr(wall, "_repr_html_", str)())
    else:
        from helibore.viewer.page_server import PageServer

        viewer = Viewer(feed, PageServer(feed.scene, Access(host, find_token(token)), port=port))
    feed.start()
    if browser:
        from helibore.viewer.browser import open_page

        viewer._opened = open_page(viewer.url)
    return viewer


class WellsViewer:
    """Several wells on one page, made by `view_wells` from feeds by well and a server. Call `close` to stop.

    Attributes
    ----------
    url : str
        Address of the page, with its token.
    scenes : dict of Scene
        What is shown of each well, by its name.
    """

    def __init__(self, feeds: Mapping[str, Feed], server: PageServer) -> None:
        self._feeds, self._server, self.url = feeds, server, server.url
        self.scenes = {name: feed.scene for name, feed in feeds.items()}
        self._opened: tempfile.TemporaryDirectory[str] | None = None

    def update(self, well: str, change: Any = None) -> None:
        """Show ``change``, which an append to the wall of ``well`` returned, as `Viewer.update` does."""
        self._feeds[well].update(change)

    def wait(self) -> None:
        """Serve until Ctrl-C."""
        self._server.wait()

    def close(self) -> None:
        """Stop serving and free the port. May be called twice."""
        for feed in self._feeds.values():
            feed.close()
        if self._opened:
            self._opened.cleanup()
        self._server.close()

    def __enter__(self) -> WellsViewer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"WellsViewer({self.url})"


def view_wells(
    walls: Mapping[str, Wall],
    *,
    picks_files: Mapping[str, str | os.PathLike[str]] | None = None,
    criteria: Criteria | None = None,
    host: str = "127.0.0.1",
    port: int = 0,
    token: str | None = None,
    browser: bool = False,
) -> WellsViewer:
    """Show the walls of several wells together: in one scene, and side by side with their tops joined.

    The page shows the ``path``, ``images``, ``attributes``, ``intervals`` and ``picks`` of each wall, and opens each
    well's own page. Wells are placed by the ``head`` of their paths; wells without one stand side by side, and the page
    says so.

    Parameters
    ----------
    walls
        The walls by the names of their wells, in the order of the section.
    picks_files
        The files in which the page saves picks, by well, as in `view`.
    criteria
        Criteria of the zones; None: the defaults of `Wall.zones`.
    host, port, token, browser
        As in `view`.

    Returns
    -------
    WellsViewer
        The viewer, which serves the page already.

    Raises
    ------
    MissingExtraError
        If a library of the extra is missing.
    InputError
        If there is no wall or `view` would refuse one of them; if `picks_files` names a well that has no wall; if
        `port` is not from 0 to 65535, or `token` is empty.
    OSError
        If the port is in use; the text names it.
    """
    from helibore.viewer.page_server import PageServer

    if not walls:
        raise InputError("walls", "must have at least one wall")
    files = dict(picks_files or {})
    if unknown := sorted(files.keys() - walls.keys()):
        raise InputError("picks_files", "must name wells of walls", ", ".join(unknown))
    feeds = {}
    for name, wall in walls.items():
        feeds[name] = Feed(wall, path=wall.path, attributes=attributes_of(wall), well=name, criteria=criteria)
        scene = feeds[name].scene
        scene.picks, scene.intervals = wall.picks, wall.intervals
        scene.picks_file, scene.saves_picks = files.get(name), name not in files or can_save(files[name])
    scenes = [feed.scene for feed in feeds.values()]
    viewer = WellsViewer(feeds, PageServer(scenes, Access(host, find_token(token)), port=port))
    for feed in feeds.values():
        feed.start()
    if browser:
        from helibore.viewer.browser import open_page

        viewer._opened = open_page(viewer.url)
    return viewer


def of_other(
    wall: ViewedWall, path: Path | None, name: str, other: Wall
) -> tuple[dict[Attribute, npt.ArrayLike], list[ScalarCurve]]:
    """Return values of ``other`` at the vertices of ``wall``, by attribute, and the curves C1 and C2 of ``other``.

    The first are its radii minus the radius of its bit, the second its radii minus those of ``wall``, both in metres.
    The second are left out if ``other`` is of another well, by their paths.
    """
    first = first_vertex(wall)
    own = wall.vertices(first, first + len(wall))
    over = own.radius - 0.5 * wall.settings.bit_diameter
    of = wall.settings  # the same limit, hence the same colours, for all walls
    limit = wall_limit(over, of.sectors, of.pitch, MILLIMETRE)
    attribute = Attribute(f"Over bit {name}", "m", -limit, limit, color_map="over-bit")
    radius = other.at(own.depth, own.toolface).radius
    values: dict[Attribute, npt.ArrayLike] = {attribute: radius - 0.5 * other.settings.bit_diameter}
    if not _lie_apart(path, other.path, own.depth):
        values[Attribute(f"{name} less this", "m", color_map="difference")] = radius - own.radius
    curves = [replace(one, name=f"{one.name} {name}") for one in curves_of(other.logs()) if one.name in ("C1", "C2")]
    return values, curves


def _lie_apart(one: Path | None, other: Path | None, depths: Floats) -> bool:
    """Return whether two paths are of two wells: at one of ``depths``, they are more than `OTHER_WELL` metres apart."""
    if one is None or other is None or not depths.size:
        return False
    top = max(float(depths.min()), one.start_depth, other.start_depth)
    bottom = min(float(depths.max()), one.stop_depth, other.stop_depth)
    if top > bottom:
        return False
    shared = np.linspace(top, bottom, 50)
    return bool((np.linalg.norm(one.position(shared) - other.position(shared), axis=1) > OTHER_WELL).any())


def _side_by_side(names: list[str]) -> Template:
    """Return a template with the wall's own radius, the first three of the images ``names``, and the caliper."""
    images = [TemplateTrack("image", name) for name in ("Radius", *names[:3])]
    return Template("mm", None, (*images, TemplateTrack("caliper")))


def _in_notebook() -> bool:
    """Return whether this runs in a Jupyter kernel that has anywidget."""
    shell = sys.modules.get("IPython")
    kernel = getattr(shell.get_ipython(), "kernel", None) if shell else None  # also None in a terminal
    return kernel is not None and importlib.util.find_spec("anywidget") is not None


def attributes_of(wall: Any) -> dict[str | Attribute, npt.ArrayLike]:
    """Return the images and attributes of a wall, one value for each quad; images in the colours of `helibore.plot`."""
    values: dict[str | Attribute, npt.ArrayLike] = {}
    for name, image in getattr(wall, "images", {}).items():
        attribute = replace(Attribute.usual(name, image.unit), rows=even_rows(image))
        with contextlib.suppress(InputError):  # a constant or empty image: the feed chooses the limits
            scale = image_scale(image)
            attribute = Attribute(name, image.unit, scale.low, scale.high, scale.log, scale.color_map, attribute.rows)
        values[attribute] = image.on(wall)
    others: Any = getattr(wall, "attributes", {})
    for name in others:
        quads = max(len(wall) - wall.settings.sectors - 1, 0)
        of = others.whole(name, wall.start_depth, quads)
        attribute = Attribute(name, others.units.get(name, ""))
        if name == "sigma" and np.isfinite(of).any():  # the colours of the print
            most = math.ceil(np.nanpercentile(of, 98) / (0.1 * MILLIMETRE)) * 0.1 * MILLIMETRE
            attribute = replace(attribute, low=0.0, high=max(most, 0.1 * MILLIMETRE), color_map="viridis")
        values[attribute] = of
    return values


def even_rows(image: SectorImage) -> tuple[float, float] | None:
    """Return the upper edge of the first row and a row's height; None if rows are uneven."""
    step = float(np.median(np.diff(image.depth))) if image.depth.size > 1 else 0.0
    if step <= 0:
        return None
    count = round((image.depth[-1] - image.depth[0]) / step)
    step = float(image.depth[-1] - image.depth[0]) / count
    place = (image.depth - image.depth[0]) / step
    return (float(image.depth[0]) - step / 2, step) if np.abs(place - np.rint(place)).max() < 0.1 else None
