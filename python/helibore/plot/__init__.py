"""Pictures of a wall on paper: logs at a true scale, cross sections, shaded bodies; PNG, SVG and PDF.

    figure = hb.plot.log(wall, title="F-12", scale=200)      # a matplotlib figure, to go on with
    hb.plot.save(figure, "f12.png")
    hb.plot.save(hb.plot.pages(wall, title="F-12"), "f12.pdf")

    content.py    what is shown            tracks.py    depth, caliper, images       paper.py   millimetres
    log.py        where it stands          sections.py  cross sections               raster.py  cells to pixels
    overview.py   the same for a screen    solid.py     shaded bodies                save.py    files
    header.py     what must be said        scales.py    numbers on axes              calipers.py  diameters

matplotlib comes with the extra ``plot`` and is imported when something is drawn.
"""

from __future__ import annotations

from helibore.plot.content import Drawing, Look
from helibore.plot.log import PAPERS, log, pages
from helibore.plot.overview import overview
from helibore.plot.save import rendered, save

__all__ = ["PAPERS", "Drawing", "Look", "log", "overview", "pages", "rendered", "save"]
