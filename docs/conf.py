"""The documentation site: `./develop docs` writes it to build/docs. No page asks for a network."""

from collections.abc import Mapping
from importlib.metadata import version as installed
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parent.parent


def take_figure(_block: Any, of: Mapping[str, Any], gallery: Mapping[str, Any]) -> str:
    """Save what an example calls ``figure``; those of hb.plot are not pyplot's, which the gallery looks for."""
    from sphinx_gallery.scrapers import figure_rst

    figure = of["example_globals"].pop("figure", None)
    if figure is None:
        return ""
    path = next(of["image_path_iterator"])
    figure.savefig(path, dpi=100, bbox_inches=None if not hasattr(figure.canvas, "manager") else "tight")
    result: str = figure_rst([path], gallery["src_dir"])
    return result


project, author, copyright = "helibore", "helibore contributors", "helibore contributors"  # noqa: A001
release = version = installed("helibore")
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_click",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["gallery/*.ipynb", "gallery/*.py", "gallery/*.md5", "gallery/*.json", "*.py"]
templates_path = ["_templates"]
OFFLINE = ROOT / "build" / "page" / "helibore.html"
"""The page without a server; the site offers it if `./develop page` has built it."""
if OFFLINE.exists():
    tags.add("page")  # type: ignore[name-defined] # noqa: F821 # Sphinx defines it
    html_extra_path = [str(OFFLINE)]
html_static_path, html_css_files = ["_static"], ["site.css"]
smartquotes = False  # they turn --option into a dash
default_role = "code"
html_title = "helibore"
html_theme = "pydata_sphinx_theme"
html_theme_options = {
    "show_prev_next": False,
    "navbar_center": [],
    "navbar_end": ["theme-switcher"],
    "secondary_sidebar_items": [],  # its headings stand among the pages on the left; code needs the room
    "footer_start": ["copyright"],
    "footer_end": [],
    "pygments_light_style": "tango",
}
html_sidebars = {"**": ["pages"]}
html_show_sourcelink = False
myst_heading_anchors = 3
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 120
nb_ipywidgets_js: dict[str, dict[str, str]] = {}  # they would come from a network
# Pages link to files of the repository, and classes share names of attributes.
suppress_warnings = ["config.cache", "myst.xref_missing", "ref.python"]
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented_params"  # settings.md explains declared settings
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_ivar = True
sphinx_gallery_conf = {
    "examples_dirs": str(ROOT / "examples"),
    "gallery_dirs": "gallery",
    "download_all_examples": False,
    "show_memory": False,
    "capture_repr": ("_repr_html_",),  # not what the last call of a picture returns, such as [Text(0.5, 0, 'east, m')]
    "show_signature": False,
    "image_scrapers": (take_figure,),
    "write_computation_times": False,  # a page that asks for a network
    "remove_config_comments": True,
    "abort_on_example_error": True,
    "within_subsection_order": "FileNameSortKey",
}
