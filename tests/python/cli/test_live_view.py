"""``helibore live --view``: the page grows with the wall, in a real browser where there is one."""

from __future__ import annotations

import contextlib
import json
import re
import socket
import subprocess
import sys
import time
import urllib.request
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from live_servers import configured, frames, free_port, until
from live_wires import Clock
from patience import PATIENCE

import helibore as hb
from helibore.cli import cli
from helibore.live.alarms import Alarm
from helibore.live.rules.configuration import parse
from helibore.live.wire import wits
from helibore.simulation.rig import Rig

pytest.importorskip("uvicorn", reason="the page is served by the extra 'view'")
from screen import NEEDS_BROWSER, Screen  # (needs the extra)

WALL = "[wall]\nbit_diameter = 0.216\nstart_depth = 100.0\nsectors = 16\n"
HOST = WALL + '[source.host]\naddress = "host"\nunits = "metric"\n'


def pushed(live: hb.Live, top: float, count: int = 200):
    k = np.arange(count)
    return live.append_samples(top + 0.005 * k, k * 37.0 % 360, np.full(count, 0.11))


def health(url: str) -> dict[str, Any]:
    with urllib.request.urlopen(url.replace("/?", "/healthz?")) as answer:
        found: dict[str, Any] = json.loads(answer.read())
        return found


@pytest.fixture
def needs_page() -> None:
    from helibore.viewer.page_files import page

    if page("app.js") is None:
        pytest.skip("the page was not built: Node.js 18 is missing")


@pytest.mark.usefixtures("needs_page")
def test_the_page_waits_for_the_first_vertex_and_follows_the_wall_and_the_path():
    from helibore.cli.live_view import Window

    with Window("well-7") as window:
        scene = window.scene
        assert health(window.url)["vertices"] == 0
        assert scene.state.sources == "Reading the journal."
        live = hb.Live(parse(HOST))
        window.follow(live)
        window.refresh({"host": "not started", "mwd": "connected to rig"})
        said = re.sub(r", since [^\n]*", "", scene.state.sources)
        assert said.split("\n")[:3] == ["host: not started", "mwd: connected to rig", "0 samples received."]
        assert scene.state.sources.count("Check that") == 1
        alarm = Alarm("refused", "mwd", 0, 0, "no sample was usable for 120 s")
        live.model.counts |= {"received": 12, "not drawn": 12}
        window.refresh({"mwd": "connected to rig"}, [alarm])
        text = "12 samples received, 12 refused.\nrefused mwd: no sample was usable for 120 s, since "
        assert text in scene.state.sources
        assert not scene.begun
        window.show(pushed(live, 100.0))
        window.refresh({"host": "not started"})
        assert scene.state.sources == "host: not started"
        assert scene.state.lost == (), "what a host pushes needs no connection"
        first = health(window.url)["vertices"]
        assert first == len(live.wall)
        assert not scene.frames.surveyed
        window.show(pushed(live, 101.0))
        until(lambda: health(window.url)["vertices"] == len(live.wall) > first)
        window.show(live.append_stations([0.0, 90.0], [0.0, 0.0], [0.0, 0.0]))
        window.show(live.append_stations([101.0], [30.0], [90.0]))
        window.refresh({})
        until(lambda: abs(scene.frames.centre[:, 1]).max() > 0.1)  # the hole turns east
        assert scene.frames.surveyed
        window.show(pushed(live, 101.9, 40_000))  # 200 m below the last station: the path is drawn on
        window.refresh({})
        until(lambda: health(window.url)["vertices"] == len(live.wall) > 20_000)
        assert time.time() - 60 < scene.state.newest <= time.time()
    assert scene.state.ended


@pytest.mark.usefixtures("needs_page")
def test_the_page_knows_why_radii_are_not_used_and_shows_those_of_a_reaming_pass():
    from helibore.cli.live_view import Window

    caliper = 'caliper = { toolface = ["5010"], radius = ["5020"], offset = 2.0 }\n'
    rig = 'items = { bit_depth = "0108", hole_depth = "0110", rotation = "0120", activity = "0107" }\n'
    clock = Clock()
    live = hb.Live(parse(f'{WALL}[source.rig]\naddress = "host"\nunits = "metric"\n{rig}{caliper}'), clock=clock)

    def said(window: Window, bit: float, hole: float, rpm: int, activity: int = 2) -> str:
        for turn in range(20):
            clock.step(0.1)
            items = [(107, str(activity)), (108, f"{bit + turn / 100:.2f}"), (110, f"{hole:.2f}"), (120, str(rpm))]
            window.show(live.receive("rig", wits.frame([*items, (5010, str(turn * 37 % 360)), (5020, "108")])))
        window.refresh({})
        return window.scene.state.unused

    with Window("well-7") as window:
        window.follow(live)
        for tenth in range(1030, 1080, 2):
            assert said(window, tenth / 10, tenth / 10 + 0.2, 90) == ""
        newest = window.scene.state.newest
        assert said(window, 108.0, 108.2, 0) == "sliding: radii not used"
        window.refresh({})
        assert window.scene.state.unused == "sliding: radii not used", "none came since"
        live.receive("rig", wits.frame([(108, "108.00"), (110, "108.2"), (120, "90")]))
        window.refresh({})
        assert window.scene.state.unused == "", "it turns again: should no radius come, there is another reason"
        assert said(window, 105.0, 108.2, 0) == "not turning: radii not used"
        assert window.scene.state.newest == newest
        assert said(window, 104.0, 108.2, 60, activity=4) == ""
        assert live.model.apart["main"].values.size > 0
        assert window.scene.state.newest > newest, "a reaming pass is shown"
        assert said(window, 108.2, 108.4, 90) == ""


def is_shown_old(window: Any, age: float) -> bool:
    """Whether the bit depth that the page shows with the next refresh came so many seconds ago, to a second."""
    began = time.time()
    window.refresh({})
    return bool(began - 1 <= window.scene.state.received + age <= time.time() + 1)


@pytest.mark.usefixtures("needs_page")
def test_the_age_on_the_page_is_that_of_the_bit_depth_whatever_else_comes():
    from helibore.cli.live_view import Window

    clock = Clock()
    with Window("well-7") as window:
        items = 'items = { bit_depth = "0108", hole_depth = "0110" }\n'
        live = hb.Live(parse(f'{WALL}[source.rig]\naddress = "host"\nunits = "metric"\n{items}'), clock=clock)
        window.follow(live)
        live.receive("rig", wits.frame([(108, "120.00"), (110, "130.00")]))
        clock.step(40)
        assert is_shown_old(window, 40)
        came = window.scene.state.received
        live.receive("rig", wits.frame([(110, "130.00")]))
        window.refresh({})
        assert window.scene.state.received == came, "a frame without a bit depth"
        live.receive("rig", wits.frame([(108, "120.00")]))
        assert is_shown_old(window, 0), "the same depth, sent again"


@pytest.mark.usefixtures("needs_page")
@pytest.mark.parametrize(
    ("activity", "hole", "bit", "age"),
    [(3, 130.0, "", 0), (8, 130.0, "", 40), (2, 130.0, "", 40), (3, 130.4, "", 40), (3, 130.0, "393.70", 40)],
    ids=["in slips", "running in", "drilling", "the hole becomes deeper", "in feet, and refused"],
)
def test_a_bit_depth_is_not_old_while_the_string_hangs_still_and_other_items_come(activity, hole, bit, age):
    """A rig that sends the bit depth when it changes only sends none during a connection."""
    from helibore.cli.live_view import Window

    clock = Clock()
    with Window("well-7") as window:
        items = 'items = { bit_depth = "0108", hole_depth = "0110", activity = "0107" }\n'
        live = hb.Live(parse(f'{WALL}[source.rig]\naddress = "host"\nunits = "metric"\n{items}'), clock=clock)
        window.follow(live)
        live.receive("rig", wits.frame([(107, "9"), (108, "120.00"), (110, "130.00")]))
        clock.step(40)
        window.refresh({})
        live.receive("rig", wits.frame([(107, str(activity)), *([(108, bit)] if bit else []), (110, f"{hole:.2f}")]))
        assert is_shown_old(window, age)
        clock.step(30)
        window.refresh({})
        assert window.scene.state.received <= time.time() - 25, "nothing comes"


@pytest.mark.usefixtures("needs_page")
def test_the_server_knows_which_hole_the_sensor_saw_and_whether_the_string_was_tripped_since():
    from helibore.cli.live_view import Window

    caliper = 'caliper = { toolface = ["5010"], radius = ["5020"], offset = 12.0 }\n'
    rig = 'items = { bit_depth = "0108", hole_depth = "0110", rotation = "0120" }\n'
    clock = Clock()
    live = hb.Live(parse(f'{WALL}[source.rig]\naddress = "host"\nunits = "metric"\n{rig}{caliper}'), clock=clock)

    def said(window: Window, bit: float, hole: float, *, sees: bool = False) -> tuple[float, bool]:
        items = [(108, f"{bit:.2f}"), (110, f"{hole:.2f}"), (120, "90")]
        for turn in range(20 if sees else 1):
            clock.step(0.1)
            radius = [(5010, str(turn * 37 % 360)), (5020, "108")] if sees else []
            window.show(live.receive("rig", wits.frame(items + radius)))
        window.refresh({})
        return window.scene.state.seen_hole, window.scene.state.tripped

    with Window("well-7") as window:
        window.follow(live)
        for tenth in range(1130, 1180):
            seen = said(window, tenth / 10, tenth / 10, sees=True)
        assert seen == (pytest.approx(117.9, abs=0.3), False)
        for tenth in range(1180, 1221, 5):
            assert said(window, tenth / 10, tenth / 10) == (seen[0], False), "drilled without a radius"
        assert said(window, 125.0, 125.0) == (pytest.approx(seen[0] + 3.0), False), "another depth of the same hole"
        said(window, 122.0, 122.0)
        assert said(window, 117.0, 122.0) == seen, "lifted for a connection"
        assert said(window, 111.0, 122.0) == (seen[0], True)
        assert said(window, 120.0, 122.0) == (seen[0], True), "it ran in"
        assert said(window, 120.0, 122.05) == (seen[0], True), "a depth that is not steady is no new hole"
        assert said(window, 122.0, 122.0) == (seen[0], True)
        assert said(window, 122.1, 122.1) == (seen[0], False)
    with Window("well-7") as window:  # started again
        window.follow(live)
        assert said(window, 122.2, 122.2) == (pytest.approx(seen[0], abs=0.3), False)
    with Window("well-7") as window:
        window.follow(live)
        assert said(window, 119.0, 122.2)[1], "off bottom at the start"


@pytest.mark.usefixtures("needs_page")
@pytest.mark.parametrize(("units", "page"), [("metric", "mm"), ("fps", "ft")])
def test_a_page_begins_with_the_units_of_the_rig(units, page):
    from helibore.cli.live_view import Window

    rig = f'[source.rig]\naddress = "host"\nunits = "{units}"\nitems = {{ bit_depth = "0108" }}\n'
    mwd = '[source.mwd]\naddress = "host"\nunits = "metric"\nitems = { rotation = "0120" }\n'
    with Window("well-7") as window:
        window.follow(hb.Live(parse(f"{WALL}{mwd}{rig}")))
        window.refresh({})
        assert window.scene.state.units == page


@pytest.mark.usefixtures("needs_page")
def test_the_page_goes_on_with_another_hole():
    from helibore.cli.live_view import Window

    with Window("well-7") as window:
        live = hb.Live(parse(HOST))
        window.follow(live)
        window.show(pushed(live, 100.0, 1000))
        window.refresh({})
        until(lambda: health(window.url)["vertices"] == len(live.wall))
        mother = len(live.wall)
        window.show(live.reconfigure(parse(HOST + '[hole]\nname = "ST1"\nkickoff = 102.0\n')))
        assert 0 < len(live.wall) < mother
        window.show(pushed(live, 102.0, 100))  # before the page knows of the hole
        window.refresh({})
        until(lambda: health(window.url)["vertices"] == len(live.wall) < mother)
        window.show(pushed(live, 102.5, 2000))
        until(lambda: health(window.url)["vertices"] == len(live.wall) > mother)


@pytest.mark.usefixtures("needs_page")
def test_the_page_knows_at_once_which_sources_are_not_connected():
    from helibore.cli.live_view import Window

    rig = '[source.rig]\naddress = "tcp://127.0.0.1:9872"\nunits = "metric"\n'
    rig += '[source.rig.items]\nbit_depth = { item = "0108", unit = "m" }\n'
    with Window() as window:
        window.follow(hb.Live(parse(HOST + rig)))
        for state, lost in {
            "waiting to connect: refused": ("rig",), "connecting": ("rig",), "stopped: access denied": ("rig",),
            "connected to 127.0.0.1": (), "waiting for the disk": (), "ended": (),
        }.items():  # fmt: skip
            window.refresh({"host": "not started", "rig": state})
            assert window.scene.state.lost == lost, state


@pytest.mark.usefixtures("needs_page")
@pytest.mark.parametrize("thread", ["page", "feed"])
def test_the_death_of_a_thread_of_the_page_ends_the_command_with_an_error(tmp_path, monkeypatch, thread):
    from helibore.cli import live_view

    (tmp_path / "rig.wits").write_bytes(b"".join(frames(50)))
    (tmp_path / "rig.toml").write_text(configured(f"file://{tmp_path}/rig.wits"))
    real = live_view.Window.refresh

    def refresh(window, *arguments):
        real(window, *arguments)
        if thread == "page":
            window._server._server.should_exit = True
        elif window._feed:
            window._feed.close()

    monkeypatch.setattr(live_view.Window, "refresh", refresh)
    arguments = ["live", str(tmp_path / "rig.toml"), "--journal", str(tmp_path / "j"), "-q", "--view"]
    result = CliRunner().invoke(cli, [*arguments, "--seconds", "60"])
    assert result.exit_code != 0
    assert f"alarm_failure: thread {thread} died: RuntimeError: it ended" in result.output


@pytest.mark.usefixtures("needs_page")
def test_images_of_the_rig_are_on_the_page() -> None:
    from helibore.cli.live_view import Window

    with Window("well-7") as window:
        live = hb.Live(parse(HOST))
        window.follow(live)
        window.show(pushed(live, 100.0))
        window.refresh({})
        assert window.scene.shape.attributes == ()
        depth = 100.0 + 0.1 * np.arange(9)
        rows = np.add.outer(20.0 * np.arange(9), np.arange(8.0))
        window.show(live.append_image("GR", depth, rows, "gAPI", origin="edge", reference="high-side"))
        until(lambda: window.refresh({}) or (window.scene.levels[0].columns and shown(window, live)))
        (attribute,) = window.scene.shape.attributes
        assert (attribute.name, attribute.unit, attribute.color_map) == ("GR", "gAPI", "gamma")
        until(lambda: "GR" in window.scene.state.ranges)  # the feed's thread sets it after the values
        low, high = window.scene.state.ranges["GR"]
        assert 0 <= low < high <= 167
        window.show(pushed(live, 101.0))
        window.show(live.append_image("GR", depth + 0.9, rows, "gAPI"))
        until(lambda: window.refresh({}) or shown(window, live))


@pytest.mark.usefixtures("needs_page")
def test_a_wall_that_grows_while_its_page_begins_is_shown_by_the_next_refresh(monkeypatch) -> None:
    from helibore.cli.live_view import Window

    with Window("well-7") as window:
        live = hb.Live(parse(HOST))
        window.follow(live)
        window.show(pushed(live, 100.0))
        depth = 100.0 + 0.1 * np.arange(9)
        window.show(live.append_image("GR", depth, np.ones((9, 8)), "gAPI", origin="edge", reference="high-side"))
        path = window._path
        monkeypatch.setattr(window, "_path", lambda: window.show(pushed(live, 101.0)) or path())
        window.refresh({})
        assert health(window.url)["vertices"] == 0
        monkeypatch.undo()
        window.refresh({})
        until(lambda: health(window.url)["vertices"] == len(live.wall))


@pytest.mark.browser
@pytest.mark.usefixtures("needs_page")
@NEEDS_BROWSER[1]
def test_a_live_image_is_coloured_on_an_open_page_and_its_sides_are_named(browser: Any) -> None:
    from helibore.cli.live_view import Window

    with Window("well-7") as window:
        live = hb.Live(parse(HOST))
        window.follow(live)
        window.show(pushed(live, 100.0, 400))
        window.refresh({})
        screen = Screen(browser, window.url, "#sec=4&quantity=GR")
        assert "GR" not in screen.evaluate("window.__wall.app.selection.quantities.map(({ id }) => id)")
        depth = 100.0 + 0.1 * np.arange(20)
        rows = np.add.outer(20.0 * (np.arange(20) % 5), 10.0 * np.arange(8.0))
        live.append_image("GR", depth, rows, "gAPI", origin="edge", reference="high-side")
        until(lambda: window.refresh({}) or "GR" in window.scene.state.ranges)
        quantity = "window.__wall.app.selection.quantity"
        screen.until(f"{quantity}?.id === 'GR' && Number.isFinite({quantity}.low)")
        screen.until("[...__wall.app.store.levels[0].tiles.values()].some((t) => t.columns[0]?.some(Number.isFinite))")
        screen.settle()
        texts = [label["text"] for label in screen.evaluate("document.getElementById('ink').labels")]
        assert "GR [gAPI]" in texts
        assert {"U", "R", "D", "L", "no survey"} <= set(texts)
        pixels = screen.pixels("image").reshape(-1, 4)[:, :3]
        yellow = (pixels[:, 0].astype(int) - pixels[:, 2]) > 60  # of the gamma map; no value is grey
        assert yellow.mean() > 0.1
        screen.close()


def shown(window: Any, live: hb.Live) -> bool:
    """Whether the page's values are those of the image as it is now."""
    wanted = live.image("GR").on(live.wall).astype(np.float32)
    with window.scene.lock:
        level = window.scene.levels[0]
        return level.size == len(live.wall) and np.array_equal(level.columns[0][: wanted.size], wanted, equal_nan=True)


def test_without_the_extra_nothing_starts_and_the_error_names_it(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "uvicorn", None)
    (tmp_path / "rig.toml").write_text(HOST)
    ran = CliRunner().invoke(cli, ["live", str(tmp_path / "rig.toml"), "--journal", str(tmp_path / "j"), "--view"])
    assert ran.exit_code == 2, ran.output
    assert 'needs uvicorn: pip install "helibore[view]"' in ran.output
    assert not (tmp_path / "j").exists()


@pytest.mark.usefixtures("needs_page")
def test_a_port_that_is_taken_is_told_before_a_journal_is_begun(tmp_path):
    (tmp_path / "rig.toml").write_text(HOST)
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        ran = CliRunner().invoke(cli, ["live", str(tmp_path / "rig.toml"), "--journal", str(tmp_path / "j"), "--view",
                                       "--view-port", port])  # fmt: skip
    assert ran.exit_code == 2, ran.output
    assert f"127.0.0.1 port {port}: Address already in use; give another port, or 0" in ran.output
    assert not (tmp_path / "j").exists()


@pytest.mark.browser
@pytest.mark.usefixtures("needs_page")
@NEEDS_BROWSER[1]
def test_a_played_rig_grows_on_the_page(tmp_path, browser):
    port = free_port()
    (tmp_path / "rig.toml").write_text(Rig("em", 2000.0, 2000.5, 0.0).configuration(f"tcp://127.0.0.1:{port}"))
    command = [sys.executable, "-m", "helibore"]
    rig = [*command, "simulate", "--wits", f"listen://127.0.0.1:{port}", "--to", "2020m", "--speed", "20",
           "--telemetry", "em"]  # fmt: skip
    wall = [*command, "live", str(tmp_path / "rig.toml"), "--journal", str(tmp_path / "j"), "--view",
            "--token", "s3"]  # fmt: skip
    with (
        subprocess.Popen(rig, stdout=subprocess.DEVNULL) as played,
        subprocess.Popen(wall, stdout=subprocess.PIPE, text=True) as running,
        contextlib.ExitStack() as ending,
    ):
        ending.callback(played.kill)  # a test that failed waits for neither
        ending.callback(running.kill)
        assert running.stdout is not None
        reported = re.search(r"http://\S+", running.stdout.readline())
        assert reported
        assert "s3" not in reported[0], "it is no terminal"
        screen = Screen(browser, reported[0].replace("...", "s3"), grows=True)
        first = screen.stats()["size"]
        screen.until(f"window.__wall.stats.size > {first} + 200")
        assert screen.evaluate("window.__wall.app.selection.quantities.find(({ id }) => id === 'GR').map") == "gamma"
        screen.until("[...__wall.app.store.levels[0].tiles.values()].some((t) => t.columns[0]?.some(Number.isFinite))")
        bit, hole = screen.evaluate("[window.__wall.app.bitDepth, window.__wall.app.holeDepth]")
        assert 2000 < bit <= hole < 2020.1
        screen.close()
        played.terminate()
        running.terminate()
        out, _ = running.communicate(timeout=PATIENCE)
    assert "samples drawn" in out
    assert running.returncode == 0
