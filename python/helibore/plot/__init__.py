"""Pictures of a wall on paper: logs at a true scale, cross sections, shaded bodies; PNG, SVG and PDF.

    figure = hb.plot.log(wall, title="F-12", scale=200)      # a matplotlib figure
    hb.plot.save(figure, "f12.png")
    hb.plot.save(hb.plot.pages(wall, title="F-12"), "f12.pdf")

    content.py      what is shown           tracks.py          depth, caliper, images  paper.py         sheets, files
    log.py          where it stands         cross_sections.py  cross sections          raster.py        cells to pixels
    print_header.py facts about the hole    solid.py           shaded bodies           diameters.py     caliper curves
    html_report.py  the report              shading.py         their light             depth_scales.py  scales, axes
    zone_list.py    zones, worst first      picked.py          picks                 stress_rose.py   SHmax

matplotlib comes with the extra ``plot`` and is imported when something is drawn.
"""

from __future__ import annotations

from helibore.base.colors import COLOR_MAPS
from helibore.plot.content import Drawing
from helibore.plot.log import PAPERS, log, overview, pages
from helibore.plot.paper import rendered, save
from helibore.plot.stress_rose import stress_rose
from helibore.settings.print_settings import Look

__all__ = ["COLOR_MAPS", "PAPERS", "Drawing", "Look", "log", "overview", "pages", "rendered", "save", "stress_rose"]
