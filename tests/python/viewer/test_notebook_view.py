"""The viewer in a notebook without a notebook: what a frame sends and receives, and that a script ends well.

`python tests/slow/notebook.py` drives JupyterLab.
"""

from __future__ import annotations

import json
import queue
import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from patience import PATIENCE

import helibore as hb
from helibore.viewer.page_files import page

pytest.importorskip("anywidget")
NEEDS_PAGE = pytest.mark.skipif(page("notebook.js") is None, reason="needs the page, which Node.js 18 or later builds")


def made_wall() -> hb.Wall:
    wall = hb.Wall(bit_diameter=0.216, sectors=16, pitch=0.1, start_depth=100.0)
    k = np.arange(3000)
    wall.append(100 + k * 0.001, k * 37.0, np.full(3000, 0.11))
    return wall


@NEEDS_PAGE
def test_a_frame_gets_the_wall_its_growth_and_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    wall = made_wall()
    with hb.view(wall, inline=True) as viewer:
        widget = viewer.widget
        assert widget is not None
        assert (viewer.url, repr(viewer)) == ("", "Viewer(in a notebook)")
        assert widget.depths == pytest.approx((100.0, wall.depth[-1]))
        assert '"hosted":true' in widget._page
        sent: queue.Queue[tuple[dict[str, Any], list[bytes]]] = queue.Queue()
        monkeypatch.setattr(widget, "send", lambda content, buffers=(): sent.put((content, list(buffers))))

        def tell(**content: Any) -> None:
            widget._handle_custom_msg({"view": "a", **content}, [])

        def next_sent() -> tuple[dict[str, Any], list[bytes]]:
            return sent.get(timeout=PATIENCE)

        def next_bytes() -> tuple[dict[str, Any], list[bytes]]:
            return next(part for part in iter(next_sent, None) if part[1])  # a state may come at any time

        tell(open=True)
        handshake = json.loads(next_sent()[0]["text"])
        assert (handshake["type"], handshake["vertices"]) == ("handshake", len(wall))
        assert json.loads(next_sent()[0]["text"])["type"] == "state"
        next_bytes()  # frames of the path
        wanted = {"tiles": [[0, 1]], "focus": 0, "mask": 0}
        tell(text=json.dumps({"session": handshake["session"], "subscribe": wanted}))
        content, [message] = next_bytes()
        assert content == {"view": "a"}
        assert int.from_bytes(message[12:16], "little") == len(wall)
        tell(id="q", method="GET", address="api/summary?start=100.5&stop=102.5", body="")
        content, [body] = next(part for part in iter(next_sent, None) if "id" in part[0])
        assert (content["id"], content["status"]) == ("q", 200)
        assert "volume" in json.loads(body)
        monkeypatch.setattr(viewer.scene, "summarize", lambda *_: 1 / 0)
        tell(id="r", method="GET", address="api/summary?start=100.5&stop=102.5", body="")
        content, [body] = next(part for part in iter(next_sent, None) if "id" in part[0])
        assert (content["id"], content["status"]) == ("r", 500)
        assert body.startswith(b"ZeroDivisionError"), "the page receives the error, and does not wait for ever"
        viewer.update(wall.append(np.linspace(103, 104, 1000), np.arange(1000) * 37.0, np.full(1000, 0.11)))
        sizes = (int.from_bytes(parts[0][16:20], "little") for _, parts in iter(next_sent, None) if parts)
        assert next(size for size in sizes if size == len(wall))


@NEEDS_PAGE
def test_depths_begin_with_the_whole_wall(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where the page encloses less of it."""
    monkeypatch.setattr("helibore.viewer.notebook_view.MOST_ENCLOSED", 100)
    wall = made_wall()
    with hb.view(wall, inline=True) as viewer:
        assert viewer.widget is not None
        assert viewer.widget.depths == pytest.approx((100.0, wall.depth[-1]))


@NEEDS_PAGE
def test_a_saved_notebook_has_no_text_in_the_place_of_the_widget() -> None:
    formatters = pytest.importorskip("IPython.core.formatters")
    with hb.view(made_wall(), inline=True) as viewer:
        data, _ = formatters.format_display_data(viewer.widget)
    assert data["text/plain"] == ""
    assert "application/vnd.jupyter.widget-view+json" in data


@NEEDS_PAGE
def test_a_viewer_that_nobody_opens_closes_twice() -> None:
    viewer = hb.view(made_wall(), inline=True)
    viewer.close()
    viewer.close()


def test_a_script_that_does_not_close_the_viewer_ends_well() -> None:
    script = (
        "import numpy as np, helibore as hb; k = np.arange(60_000)\n"
        "samples = hb.Caliper(k * 5e-4, k * 37.0, 0.11 + 0 * k)\n"
        "wall = hb.reconstruct(samples, bit_diameter=0.216, sectors=64, pitch=0.1)\n"
        "viewer = hb.view(wall)\n"
    )
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stderr) == (0, "")


def test_without_a_notebook_view_serves() -> None:
    with hb.view(made_wall()) as viewer:
        assert viewer.widget is None
        assert viewer.url.startswith("http://127.0.0.1:")
