"""The page without a server in a browser: it shows a wall, asks no machine, and lives on after bad input."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from locations import WEB
from patience import PATIENCE
from screen import NEEDS_BROWSER, new_tab

import helibore as hb

PAGE = WEB.parents[3] / "build" / "page" / "helibore.html"
EXAMPLES = WEB.parents[3] / "examples" / "files"

pytestmark = [
    *NEEDS_BROWSER,
    pytest.mark.skipif(not PAGE.exists(), reason="the page is not built: ./develop page builds it"),
]


def until(page: Any, condition: str) -> None:
    """Wait for a condition; the page's policy forbids `wait_for_function`."""
    end = time.monotonic() + PATIENCE
    while not page.evaluate(f"Boolean({condition})"):
        assert time.monotonic() < end, f"never: {condition}"
        time.sleep(0.05)


class Offline:
    """The page in a tab of its own, with what it asked for and what went wrong."""

    def __init__(self, browser: Any, address: str = "") -> None:
        self.page = new_tab(browser)
        self.requests: list[str] = []
        self.errors: list[str] = []
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("console", lambda said: self.errors.append(said.text) if said.type == "error" else None)
        self.page.goto(f"{PAGE.as_uri()}{address}")
        until(self.page, "document.getElementById('version').textContent")

    def open(self, file: Path) -> str:
        """Open a file; return why the page refuses it, or ''."""
        self.page.set_input_files("#file", str(file))
        until(self.page, "['trouble', 'columns'].some((id) => !document.getElementById(id).hidden)")
        return str(self.page.inner_text("#trouble")) if self.page.is_visible("#trouble") else ""

    def wall(self) -> Any:
        """The frame with the wall, once it has drawn."""
        self.page.wait_for_selector("#wall.shown")
        frame = self.page.frames[-1]
        until(frame, "window.__wall?.ready")
        return frame


@pytest.fixture
def offline(browser: Any) -> Iterator[Offline]:
    one = Offline(browser)
    yield one
    one.page.close()


def test_a_demo_by_address_shows_a_wall_with_its_figures_and_asks_no_machine(browser: Any) -> None:
    one = Offline(browser, "#demo")
    frame = one.wall()
    until(frame, "document.getElementById('foot').innerText.includes('Volume')")
    until(frame, "window.__wall.app.curves.offered.length > 15")
    until(frame, "window.__wall.app.zones.length")
    assert "Washed out" in frame.inner_text("#foot")
    assert frame.inner_text("#zones").count("%") == len(frame.evaluate("window.__wall.app.zones"))
    until(frame, "[...window.__wall.app.store.levels[0].tiles.values()].some((of) => of.texels.some((v) => v >> 12))")
    mesh = frame.evaluate("fetch('api/section.glb?start=2001&stop=2009').then((of) => of.text())")
    assert mesh.startswith("glTF")
    frame.evaluate("window.__wall.app.selection.rig()")
    assert "helibore live" in frame.inner_text("#notice")
    assert not frame.evaluate("window.__wall.app.view.rig")
    assert {url.split(":")[0] for url in one.requests} == {"file", "blob"}
    assert one.errors == []
    one.page.close()


def test_bad_input_gets_one_sentence_and_the_page_lives(offline: Offline, tmp_path: Path) -> None:
    bad = {"a.las": b"\0\1\2" * 99, "b.wall": b"PK\3\4" + bytes(60), "c.csv": b"depth_m,gamma_api\n1,2\n"}
    for name, content in bad.items():
        (tmp_path / name).write_bytes(content)
    assert "binary" in offline.open(tmp_path / "a.las")
    assert "truncated or damaged" in offline.open(tmp_path / "b.wall")
    assert offline.open(tmp_path / "c.csv") == ""
    offline.page.fill("#bit", "8.5")
    offline.page.click("#show")
    offline.page.wait_for_selector("#trouble:visible")
    assert "radius or diameter" in offline.page.inner_text("#trouble")
    assert offline.open(EXAMPLES / "xy_caliper.csv") == ""
    offline.page.click("#show")
    assert offline.wall().evaluate("window.__wall.app.store.end") > 0
    assert offline.errors == []


@pytest.mark.parametrize(
    ("lost", "said"),
    [
        ("delete window.WebAssembly", "no WebAssembly"),
        ("HTMLCanvasElement.prototype.getContext = () => null", "WebGL"),
    ],
)
def test_a_browser_that_lacks_something_gets_one_sentence(browser: Any, lost: str, said: str) -> None:
    page = browser.new_context().new_page()
    page.set_default_timeout(1000 * PATIENCE)
    page.add_init_script(lost)
    page.goto(PAGE.as_uri())
    if "WebGL" in said:
        until(page, "document.getElementById('version').textContent")
        page.click("#examples button")
        until(page, "!document.getElementById('columns').hidden")
        page.click("#show")
        page.wait_for_selector("#wall.shown")
        frame = page.frames[-1]
        until(frame, "document.getElementById('notice')")
        until(frame, f"document.body.innerText.includes('{said}')")
    else:
        page.wait_for_selector("#trouble:visible")
        assert said in page.inner_text("#trouble")
    page.context.close()


def test_a_file_of_two_gigabytes_is_refused_before_it_is_read(offline: Offline) -> None:
    size = "Object.defineProperty(File.prototype, 'size', { get: () => 2 ** 31, configurable: true })"
    offline.page.evaluate(f"{size} && null")
    assert "2048 MB; this page reads files of up to 512 MB" in offline.open(EXAMPLES / "caliper.csv")
    offline.page.evaluate("delete File.prototype.size")
    assert offline.open(EXAMPLES / "caliper.csv") == ""


def test_roles_units_angles_and_the_reference_can_be_chosen(offline: Offline, tmp_path: Path) -> None:
    rows = [(2000 + 0.1 * row, 7.0 * row % 360, 216 + row % 9, 219 + row % 5) for row in range(120)]
    lines = [",".join(f"{cell:.2f}" for cell in row) for row in rows]
    for name, head in (("own.csv", "A,B,C,D"), ("known.csv", "MD_m,RB_deg,CALX_mm,CALY_mm")):
        (tmp_path / name).write_text("\n".join([head, *lines]) + "\n")
    assert offline.open(tmp_path / "own.csv") == ""
    chosen = {"A": ("depth", "m"), "B": ("toolface", "deg"), "C": ("diameter", "mm"), "D": ("diameter", "mm")}
    for name, (role, unit) in chosen.items():
        offline.page.select_option(f"[aria-label='What {name} is']", role)
        offline.page.select_option(f"[aria-label='Unit of {name}']", unit)
    offline.page.select_option("[aria-label='What B counts from']", "north")
    offline.page.fill("[aria-label='Degrees from the toolface to D']", "90")
    offline.page.fill("#bit", "8.5")
    offline.page.click("#show")
    frame = offline.wall()
    assert frame.evaluate("window.__wall.app.path.reference") == "north"
    asked = "fetch('api/summary?start=2000&stop=2011.9').then((of) => of.json()).then((of) => of.greatest_diameter)"
    greatest = frame.evaluate(asked)
    with hb.open(tmp_path / "known.csv") as log:
        wanted = hb.reconstruct(log, bit_diameter=0.2159).summary(start=2000.0, stop=2011.9)
    assert greatest == pytest.approx(wanted.greatest_diameter.value, abs=1e-12)
    assert offline.errors == []


def test_downloads_and_picks_are_those_of_the_wall(offline: Offline, tmp_path: Path) -> None:
    assert offline.open(EXAMPLES / "caliper.csv") == ""
    offline.page.click("#show")
    frame = offline.wall()
    pick = {"key": "k1", "kind": "bed", "depth": 1500.5, "toolface": 90, "apparent_dip": 30, "radius": None}
    frame.evaluate("(pick) => window.__wall.app.picking.change([{ key: pick.key, pick }])", pick)
    until(frame, "!window.__wall.app.picking.unsaved.size")
    table = frame.evaluate("fetch('api/picks.csv').then((answer) => answer.text())")
    (picked,) = hb.Picks.parse(table)
    assert (picked.key, picked.kind, picked.depth, picked.apparent_dip) == ("k1", "bed", 1500.5, 30.0)
    assert (
        frame.evaluate(
            "fetch('api/pick', { method: 'PUT', body: '{\"kind\": \"bed\"}' }).then((answer) => answer.status)"
        )
        == 400
    )
    rows = frame.evaluate("fetch('api/section.csv?start=-1e6&stop=1e6').then((answer) => answer.text())").splitlines()
    assert len(rows) == 1 + frame.evaluate("window.__wall.app.store.levels[0].size")
    with offline.page.expect_download() as download:
        offline.page.click("#save")
    saved = tmp_path / "saved.html"
    download.value.save_as(saved)
    offline.page.goto(saved.as_uri())
    until(offline.page, "window.__wall?.ready")
    assert offline.page.evaluate("window.__wall.app.picking.kept.length") == 1
    assert offline.page.evaluate("window.__wall.app.figures.summary.volume") > 0
    assert offline.errors == []


def test_a_survey_places_the_wall_as_the_package_places_it(offline: Offline, tmp_path: Path) -> None:
    stations = {"depth": [0.0, 900.0, 1800.0, 4000.0], "inclination": [2.0, 30.0, 55.0, 80.0]}
    stations["azimuth"] = [10.0, 40.0, 45.0, 90.0]
    rows = zip(*stations.values(), strict=True)
    survey = tmp_path / "survey.csv"
    survey.write_text("MD_m,INCL_deg,AZIM_deg\n" + "".join(f"{a},{b},{c}\n" for a, b, c in rows))
    assert offline.open(EXAMPLES / "caliper.csv") == ""
    offline.page.set_input_files("#survey", str(survey))
    until(offline.page, "document.getElementById('surveyWhat').textContent.includes('stations')")
    offline.page.click("#show")
    frame = offline.wall()
    until(frame, "window.__wall.app.path.surveyed")
    at, centre, high, down = frame.evaluate(
        "(({ store, path }) => [store.end, path.at(store.end).centre, path.at(store.end).high, path.tvd(store.end)])"
        "(window.__wall.app)"
    )
    path = hb.Survey(*stations.values()).path()
    assert centre == pytest.approx(path.position(at).tolist(), abs=2e-3)  # linear between frames two metres apart
    assert high == pytest.approx(path.frame(at)[0].tolist(), abs=1e-4)
    assert down == pytest.approx(path.position(at)[2], abs=2e-3)
    assert offline.errors == []
