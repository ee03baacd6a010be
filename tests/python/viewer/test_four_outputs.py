"""Page, print, report and terminal say the same of a wall: the same numbers, words and colours, of 20 walls."""

from __future__ import annotations

import re
from typing import Any, NamedTuple

import numpy as np
import pytest
from made_wall import BIT
from screen import NEEDS_BROWSER, Screen, new_tab

import helibore as hb
from helibore.cli.lines import summary_lines, zone_lines
from helibore.logs.zone_criteria import MEASURES
from helibore.plot import html_report
from helibore.plot.content import Content, Drawing, content_of
from helibore.plot.paper import Sheet
from helibore.plot.print_header import facts
from helibore.plot.zone_list import draw_zones

pytestmark = NEEDS_BROWSER

TOP, LENGTH = 2000.0, 8.0
KINDS = ("washout", "breakout", "key seat", "undergauge", "")
UNITS = ("mm", "in", "ft")
CODES = {"W": "washout", "B": "breakout", "K": "key seat", "U": "undergauge"}


class Said(NamedTuple):
    """A zone as an output shows it: None where the output does not show it."""

    kind: str
    start: float
    stop: float
    size: float
    sure: str
    face: str | None
    edge: str


def radius(kind: str, size: float, depth: np.ndarray, toolface: np.ndarray) -> np.ndarray:
    """The radius of a hole with one zone of this kind around its middle, and a small breakout at its end."""
    angle = np.radians(toolface)
    middle, end = np.abs(depth - TOP - 3) < 1, np.abs(depth - TOP - 7) < 0.5
    shapes = {
        "washout": 1 + 0.2 * np.cos(angle),
        "breakout": np.exp(-((np.abs(np.sin(angle)) / 0.4) ** 2)),
        "key seat": np.where(np.cos(angle) > 0, np.exp(-((np.sin(angle) / 0.3) ** 2)), 0.0),
        "undergauge": -0.4 - 0.1 * np.cos(3 * angle),
        "": 0.0 * angle,
    }
    return BIT / 2 + size * middle * shapes[kind] + 0.014 * end * shapes["breakout"]


def made(number: int) -> hb.Wall:
    """The wall of this number: five kinds of zone, whole turns or four arms, growing sizes, the last four with gaps."""
    kind, size = KINDS[number % 5], 0.013 + 0.0017 * number
    depth = np.arange(TOP, TOP + LENGTH, 0.1 / 48)
    arm = None
    toolface = depth * 3600 % 360
    if 5 <= number < 10:  # four arms that turn slowly
        depth = np.repeat(np.arange(TOP, TOP + LENGTH, 0.05), 4)
        arm = np.tile([0, 1, 2, 3], depth.size // 4)
        toolface = (12 * depth + 90 * arm) % 360
    kept = (np.abs(depth - TOP - 5) > 0.4) if number >= 16 else np.full(depth.shape, True)
    caliper = hb.Caliper(
        depth[kept], toolface[kept], radius(kind, size, depth, toolface)[kept], arm=None if arm is None else arm[kept]
    )
    return hb.reconstruct(caliper, bit_diameter=BIT, sectors=32)


def color(text: str) -> str:
    """rgb(176, 52, 8) as #b03408."""
    red, green, blue = map(int, re.findall(r"\d+", text)[:3])
    return f"#{red:02x}{green:02x}{blue:02x}"


def numbers(text: str) -> list[float]:
    return [float(one) for one in re.findall(r"[-+]?\d+(?:\.\d+)?", text.replace("−", "-").replace(",", ""))]


PAGE = """[...document.querySelectorAll('#zones button')].map((row) => {
  const sign = getComputedStyle(row.firstChild);
  return [[...row.children].map((e) => e.textContent), sign.backgroundColor, sign.outlineColor, row.title];
})"""


SECTION = "[...document.querySelectorAll('#section dt')].map((e) => [e.textContent, e.nextElementSibling.textContent])"


def on_page(screen: Screen) -> list[Said]:
    found = []
    for (letter, kind, ends, size, sure), face, edge, title in screen.evaluate(PAGE):
        assert CODES[letter] == kind
        assert title.startswith(f"{kind}, {sure} sure")
        assert f" {MEASURES[kind].replace(' - ', ' − ')} " in title
        solid = not face.endswith(", 0)")
        start, stop = numbers(ends.replace("–", " "))
        shown = color(face) if solid else None
        found.append(Said(kind, start, stop, numbers(size)[0], sure, shown, shown or color(edge)))
    return found


def in_print(content: Content) -> list[Said]:
    from matplotlib.colors import to_hex

    sheet = Sheet(210.0, 100.0, 72)
    draw_zones(sheet, content, 10.0, 10.0, 190.0)
    texts = [text.get_text() for text in sheet.figure.texts[2:]]
    rows = [texts[at : at + 6] for at in range(0, len(texts), 6)]
    found = []
    for (letter, kind, ends, size, _, sure), sign in zip(rows, sheet.figure.artists, strict=True):
        assert CODES[letter] == kind
        start, stop = numbers(ends.replace("–", " "))
        face = to_hex(sign.get_facecolor())
        shown = None if face == "#ffffff" else face
        found.append(Said(kind, start, stop, numbers(size)[0], sure, shown, to_hex(sign.get_edgecolor())))
    return found


SIGN = re.compile(r'<b class="sign" style="background:(\S+);color:\S+;border-color:(\S+)">(\w)</b>')


def in_report(text: str) -> list[Said]:
    zones = text.split('id="zones"')[1].split("</section>")[0]
    found = []
    for row in re.findall(r"<tr><td.*?</tr>", zones):
        cells = re.findall(r"<td[^>]*>(.*?)</td>", row)
        sign = SIGN.match(cells[0])
        assert sign
        face, edge, letter = sign.groups()
        said = re.match(r"([a-z ]+) (\d+ %)( \(not sure\))?, ([^,]*?) (\S+) (mm|in), ", cells[0][sign.end() :].strip())
        assert said, cells[0]
        kind, sure, unsure, measure, size, _ = said.groups()
        assert measure == MEASURES[kind].replace(" - ", " − ")
        assert CODES[letter] == kind
        assert bool(unsure) == (face == "white")
        shown = None if unsure else face
        found.append(Said(kind, numbers(cells[1])[0], numbers(cells[2])[0], numbers(size)[0], sure, shown, edge))
    return found


def close(a: Said, b: Said, size: float, depth: float = 0.051) -> bool:
    """Whether two outputs say the same of a zone: words and colours the same, numbers as near as their digits allow."""
    numbers_fit = abs(a.start - b.start) <= depth and abs(a.stop - b.stop) <= depth and abs(a.size - b.size) <= size
    return numbers_fit and (a.kind, a.sure, a.face, a.edge) == (b.kind, b.sure, b.face, b.edge)


def test_page_print_report_and_terminal_say_the_same_of_twenty_walls(
    browser: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(html_report, "_pictures", lambda _: "")
    seen, screen = set(), None
    for number in range(20):
        wall, unit = made(number), UNITS[number % 3]
        content = content_of(wall, Drawing(unit=unit, polar=(), body=()))
        report = html_report.page(wall, unit=unit, polar=(), body=())
        summary = wall.summary()
        terminal = dict[str, str]()
        for label, text in [*summary_lines(summary), *zone_lines(content.zones, summary, unit)]:
            terminal[label] = terminal.get(label, "") + f"{text}\n"
        with hb.view(wall) as viewer:
            address = f"#md={TOP + LENGTH / 2}&sec={LENGTH + 1}&theme=light&units={unit}"
            if screen is None:
                screen = Screen(browser, viewer.url, address, (1366, 768), drawn=False)
            else:
                screen.goto(viewer.url + address)
            screen.until("window.__wall?.ready && window.__wall.app.figures.summary")
            screen.settle()
            page = on_page(screen)
            section = dict(screen.evaluate(SECTION))
        printed, reported = in_print(content), in_report(report) if content.zones.zones else []
        digits = 0.56 if unit == "mm" else 0.056
        where = f"wall {number}, {unit}:\n{page}\n{printed}\n{reported}"
        assert len(page) == len(printed) == len(reported) == len(content.zones.zones), where
        for a, b, c in zip(page, printed, reported, strict=True):
            assert close(a, b, digits), where
            assert close(b, c, digits / 9), where
        seen |= {(one.kind, one.face is None) for one in page}
        header = {label: text for label, text, _ in facts(content)}
        metre = content.drawing.depth_unit.metres
        feet = {kind: f"{summary.kinds.get(kind, 0.0) / metre:.1f}" for kind in KINDS}
        for kind, metres in summary.kinds.items():
            of_kind = [one for one in page if one.kind == kind]
            for text in (header["Zones"], report):
                assert f"{kind} {feet[kind]} {content.drawing.depth_unit.name}" in text
            unsure = sum(one.face is None for one in of_kind)
            said = f"{len(of_kind)} {kind}, {metres:.1f} m" + (f" ({unsure} not sure)" if unsure else "")
            assert re.search(rf"(^|; ){re.escape(said)}(;|$)", terminal["zones"], re.MULTILINE)
        hole = re.search(r"Hole volume</th><td>(.*?)</td>", report)
        diameter = re.search(r"Diameter</th><td>(.*?)</td>", report)
        assert hole
        assert diameter
        assert section["Volume"] == hole[1].split(";")[0]
        amount, against = re.match(r"(.*?m³)(?: \(.*?\))? over .*, (.*) against the bit", terminal["volume"]).groups()
        assert section["Volume"].startswith(f"{amount} over ")
        assert section["Against the bit"].replace("−", "-") == against
        assert hole[1].endswith(f"; {against} against the bit")
        assert section["Washed out"].startswith(f"{feet['washout']} ")
        measured = re.search(r"Measured</th><td>(.*?) %", report)
        assert measured
        assert numbers(section["Measured"])[0] == pytest.approx(float(measured[1]), abs=0.056)
        # The section is the whole wall, whose mean diameter the terminal prints, too.
        size_unit = Drawing(unit=unit).size_unit
        assert diameter[1].startswith(f"{summary.mean_text(size_unit)} mean, ")
        assert {"in", "mm"} & set(re.findall(r"[a-z]+", diameter[1])) == {size_unit}
        assert summary.mean_text().split(" in")[0].strip() in terminal["diameter"]
    assert screen is not None
    screen.close()
    assert {kind for kind, _ in seen} == set(KINDS[:4])
    assert {hollow for _, hollow in seen} == {True, False}


def test_a_long_note_of_a_pick_does_not_widen_the_report(browser: Any) -> None:
    depth = np.arange(1000.0, 1010.0, 0.01)
    wall = hb.reconstruct(
        hb.Caliper(depth, depth * 3600 % 360, np.full(depth.size, 0.11)), bit_diameter=0.216, sectors=32
    )
    wall.picks = [hb.Pick(kind="note", depth=1005.0, toolface=0.0, note="core plug 14, oil stain, " * 3)]
    tab = new_tab(browser)
    tab.set_viewport_size({"width": 1366, "height": 768})
    tab.set_content(html_report.page(wall, body=(), polar=(), dpi=30))
    wide, room = tab.evaluate(
        "[document.querySelector('#picks table'), document.querySelector('#picks')].map((e) => e.offsetWidth)"
    )
    tab.close()
    assert wide <= room
