"""Rig mode: digits for three metres, follow locked, alarms of new zones; all kept over a reload."""

from __future__ import annotations

import re
import time
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from made_wall import MadeWall, gamma_and_resistivity
from screen import NEEDS_BROWSER, Screen

import helibore as hb
from helibore.viewer.channel_strip import ShownChannel, channel_strip

pytestmark = NEEDS_BROWSER


@pytest.fixture(autouse=True)
def standing_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stop the clocks of server and page: an age is the one that a test gives, however long the test takes."""
    now = time.time()
    monkeypatch.setattr(time, "time", lambda: now)
    monkeypatch.setattr(Screen, "now", now)


# The height of a digit as drawn, and what leaves its cell.
DIGITS = """[...document.querySelectorAll('#rig .digits')].map((at) => {
  const ink = document.createElement('canvas').getContext('2d');
  const { fontWeight, fontSize, fontFamily } = getComputedStyle(at);
  ink.font = `${fontWeight} ${fontSize} ${fontFamily}`;
  const { actualBoundingBoxAscent: height } = ink.measureText('0');
  const [inner, outer] = [at, at.parentElement].map((e) => e.getBoundingClientRect());
  return { text: at.textContent, height, fits: inner.right <= outer.right && inner.bottom <= outer.bottom };
})"""


CLIPPED = """[...document.querySelectorAll('#rig h2, #rig p')].filter((at) => {
  const [inner, outer] = [at, at.parentElement].map((e) => e.getBoundingClientRect());
  return inner.top < outer.top || inner.bottom > outer.bottom;
}).map((at) => at.textContent)"""


@pytest.mark.parametrize(("bit", "size"), [(1033.4, (1366, 768)), (12345.6, (1366, 768)), (1033.4, (3840, 2160))])
def test_digits_can_be_read_from_three_metres(browser: Any, bit: float, size: tuple[int, int]) -> None:
    with hb.view(MadeWall(20_000, start=round(bit - 28.0))) as viewer:
        viewer.scene.update_state(bit_depth=bit, hole_depth=bit + 40.5, newest=time.time())
        screen = Screen(browser, viewer.url, f"#md={bit:.0f}&sec=10", size, drawn=False)
        screen.keyboard.press("k")
        screen.until("window.__wall.app.figures.summary?.mean_diameter && window.__wall.app.zones.length")
        screen.settle()
        cells = screen.evaluate(DIGITS)
        assert len(cells) == 5
        assert min(cell["height"] for cell in cells) >= 77
        assert all(cell["fits"] for cell in cells)
        assert screen.evaluate(CLIPPED) == []
        texts = [cell["text"] for cell in cells]
        assert texts[0] == f"{bit:.1f} m"
        assert screen.inner_text("#rigBitMore") == f"40.5 m off bottom, hole {bit + 40.5:.1f} m"
        worst = screen.evaluate("window.__wall.app.zones.toSorted((a, b) => b.severity - a.severity)[0].measure")
        assert texts[2] == f"+{1000 * worst:.0f} mm ± not known"
        assert re.fullmatch(r"Worst going up: [a-z ]+, \d+ % sure", screen.inner_text("#rigWorstHead"))
        diameter = screen.evaluate("window.__wall.app.figures.summary.mean_diameter")
        assert texts[4] == f"{1000 * diameter:.0f} mm"
        screen.close()


OVER = """[...document.querySelectorAll('#rigBodies .note')].filter((at) => {
  const [inner, outer] = [at, at.parentElement].map((e) => e.getBoundingClientRect());
  return inner.top < outer.top || inner.bottom > outer.bottom || inner.right > outer.right;
}).map((at) => at.textContent)"""
CROSSED = """(() => {
  const cell = document.getElementById('rigBodies').getBoundingClientRect();
  const boxes = [...document.querySelectorAll('#rigBodies > *')].map((at) => {
    const range = document.createRange();
    range.selectNodeContents(at);
    return [at.textContent, range.getBoundingClientRect()];
  }).filter(([text]) => text);
  const over = (a, b, low, high) => Math.min(a[high], b[high]) - Math.max(a[low], b[low]);
  const cross = (a, b) => over(a, b, 'left', 'right') > 1 && over(a, b, 'top', 'bottom') > 0.3 * a.height;
  return boxes.flatMap(([text, a], i) => [
    ...(a.right > cell.right || a.bottom > cell.bottom + 2 ? [text] : []),
    ...boxes.slice(i + 1).filter(([, b]) => cross(a, b)).map(([other]) => `${text} x ${other}`),
  ]);
})()"""
ROWS = """[...document.querySelectorAll('#rigBodies .name')].map((at) => {
  const text = (nodes) => [...nodes].map((one) => one.textContent.trim()).filter(Boolean).join(' ');
  const [size, ...ways] = [at.nextSibling, at.nextSibling.nextSibling, at.nextSibling.nextSibling.nextSibling];
  const note = size.querySelector('.note')?.textContent ?? '';
  const numbers = [...size.childNodes].filter((one) => one.className !== 'note');
  return [at.firstChild.firstChild.textContent, note, text(numbers), ...ways.map((one) => text(one.childNodes))];
})"""
CELL = "(name) => ['Head', '', 'More'].map((part) => document.getElementById(name + part).textContent)"


def test_tight_hole_has_one_text_and_each_body_its_way_to_it(browser: Any) -> None:
    """A hole with a meter less than the bit by 8 mm at 2018, by 16 mm at 2003.5, and a string of three bodies."""
    depth = np.arange(2000.0, 2024.0, 0.002)
    radius = np.where(abs(depth - 2018) < 0.5, 0.104, np.where(abs(depth - 2003.5) < 0.5, 0.1, 0.1085))
    wall = hb.reconstruct(hb.Caliper(depth, depth * 9000 % 360, radius), bit_diameter=0.216)
    string = [
        hb.RigidBody(0.216, 0.3, 0, "bit"), hb.RigidBody(0.17, 2, 1, "collar"), hb.RigidBody(0.213, 1, 4, "stabiliser")
    ]  # fmt: skip
    with hb.view(wall, string=string) as viewer:
        scene = viewer.scene
        place = (2017.5, 2018.5, 0.208, 2018.8, "bit", 2018.4, 0)
        up = {"places": (place, (2003.0, 2004.0, 0.2, 2004.2, "bit", 2003.9, 0, 0.98, 0.0011, False))}
        bodies = ((2018.8, None), (None, None), (None, 2021.5))
        ahead = {"up": up, "down": None, "bodies": bodies, "moving": "up"}
        alarms = ("tight ahead: tight hole above the bit at 2020.0 m: from 2017.4 to 2018.6 m 208 mm pass at most",)
        alarms += ("tight: at 2018.10 m the diameter is 7.9 mm below the bit diameter",)
        scene.update_state(bit_depth=2020.0, hole_depth=2026.0, newest=time.time(), ahead=ahead, alarms=alarms)
        screen = Screen(browser, viewer.url, "#rig=1", (1366, 768), drawn=False)
        screen.until("document.getElementById('rigWorst').textContent.includes('mm')")
        assert [of.kind for of in wall.zones().zones].count("undergauge") == 2
        size = f"−{1000 * (0.216 - place[2]):.0f} mm"
        head, digits, more = screen.evaluate(f"({CELL})('rigWorst')")
        assert re.fullmatch(r"Worst of 2 going up: tight, \d+ % sure", head), "the worst leads, not the nearest"
        assert re.fullmatch(r"−16 mm ±\d", digits), "how sure its kind is stands there, how sure its size is here"
        assert more == "2003.0–2004.0 m, in 15.8 m", "the ends of the place, not of its zone"
        next_one = ["Next going up: sticks in", "1.2 m", f"bit, {size} at 2018.5 m"]
        assert screen.evaluate(f"({CELL})('rigWhere')") == next_one
        both = f"Tight −16 mm at 2003, {size} at 2018 m"
        assert screen.inner_text("#alarmText") == both, "two alarms, one place, one text; the other was found before"
        named = "window.__wall.app.renderer.look().zones.map(({ name, measure }) => [name, measure])"
        assert screen.evaluate(named) == [["tight", pytest.approx(-0.016)], ["tight", pytest.approx(-0.008)]], (
            "the picture says what the digits say"
        )
        rows = screen.evaluate(ROWS)
        assert [row[0] for row in rows] == ["stabiliser", "collar", "bit"], "as they hang"
        assert [row[3:] for row in rows] == [["none", "1.5 m"], ["none", "none"], ["1.2 m", "none"]]
        assert [int(re.search(r"[+−]?(\d+)", row[2])[1]) for row in rows] == pytest.approx([4, 38, 1], abs=1), (
            "the collar is in it"
        )
        assert screen.evaluate(CLIPPED) == []
        screen.evaluate("window.__wall.app.view.choose({ units: 'in' })")
        screen.until("document.querySelector('#rigBodies .size').textContent.includes('in')")
        assert screen.evaluate(OVER) == []
        screen.evaluate("window.__wall.app.view.choose({ units: 'mm' })")
        others = "no data rig: nothing for 20 s", "refused mwd: no sample was usable"
        worse = "tight: at 2003.50 m the diameter is 16.0 mm below the bit diameter"
        scene.update_state(alarms=(*others, worse, *alarms))
        screen.until("document.getElementById('alarmText').textContent.includes('more')")
        assert screen.inner_text("#alarmText").splitlines() == ["No data from rig", f"{both}, +1 more"], "all are named"
        scene.update_state(alarms=alarms)
        screen.keyboard.press("q")
        screen.keyboard.press("q")
        screen.settle()
        assert not screen.is_visible("#alarm"), "silenced are also the places that were found before the page began"
        screen.until("document.getElementById('rigWorst').textContent.startsWith('−16 mm')")
        scene.update_state(bit_depth=2018.4)
        screen.until("document.querySelector('#rigBodies .new')")
        assert screen.evaluate(ROWS)[2][3] == "now"
        assert screen.evaluate(f"({CELL})('rigWhere')")[:2] == ["Next: sticks", "now "]
        scene.update_state(bit_depth=2026.0, ahead=ahead | {"moving": "", "bodies": (*bodies[:2], (None, 2027.5))})
        screen.until("!document.querySelector('#rigWhereCell.new')")
        lacks = "document.querySelector('#rigBodies .lacks').textContent"
        screen.until(f"{lacks} === 'Hole not measured at 2024 m (collar), 2026 m (bit)'")
        assert [(row[0], row[4]) for row in screen.evaluate(ROWS)] == [("stabiliser", "1.5 m")], "beside measured hole"
        screen.keyboard.press("a")
        screen.settle()
        covered = """['rigBit', 'rigBodies', 'rigAge'].filter((id) => {
          const [a, b] = [id, 'alarmWhole'].map((one) => document.getElementById(one).getBoundingClientRect());
          return a.left < b.right && a.top < b.bottom;
        })"""
        assert screen.evaluate(covered) == []
        screen.close()


@pytest.mark.parametrize("size", [(390, 844), (820, 1180), (1024, 768)])
def test_a_number_stays_with_its_unit_and_a_long_name_keeps_its_width(browser: Any, size: tuple[int, int]) -> None:
    depth = np.arange(2000.0, 2024.0, 0.002)
    wall = hb.reconstruct(hb.Caliper(depth, depth * 9000 % 360, np.full(depth.size, 0.1085)), bit_diameter=0.216)
    name = "near-bit stabiliser 8 3/8 in"
    string = [hb.RigidBody(0.2, 0.3, 0, "bit"), hb.RigidBody(0.2127, 1.0, 1.0, name)]
    place = (2003.0, 2004.0, 0.2, 2004.2, name, 2003.9, 0)
    ahead = {"up": {"places": (place,)}, "down": None, "bodies": ((None, None), (2005.0, None)), "moving": "up"}
    with hb.view(wall, string=string) as viewer:
        state = {"bit_depth": 2022.0, "hole_depth": 2036.0, "newest": time.time(), "ahead": ahead}
        viewer.scene.update_state(**state)
        screen = Screen(browser, viewer.url, "#rig=1", size, drawn=False)
        screen.until("document.querySelector('#rigBodies .name')")
        screen.evaluate("window.__wall.app.view.choose({ units: 'ft' })")
        screen.until("document.querySelector('#rigBodies').textContent.includes('ft')")
        lines = """(which) => [...document.querySelectorAll(which)].filter((at) => {
          const range = document.createRange();
          range.selectNodeContents(at);
          const tops = [...range.getClientRects()].map(({ bottom }) => Math.round(bottom / 12));
          return Math.max(...tops) - Math.min(...tops) > 1;
        }).map((at) => at.textContent)"""
        assert screen.evaluate(f"({lines})('#rigBodies .size span, #alarmText nobr')") == []
        assert [one["text"] for one in screen.evaluate("ink.labels") if one["text"].startswith("start of")] == []
        narrow = "[...document.querySelectorAll('#rigBodies .name span')].map((at) => at.style.transform)"
        assert set(screen.evaluate(narrow)) == {""}
        assert screen.evaluate(CROSSED) == []
        if size == (1024, 768):
            viewer.scene.update_state(newest=time.time() - 900, received=time.time() - 900)
            screen.until("ink.labels.some(({ text }) => text.startsWith('▼ bit was'))")
            bit = "ink.labels.find(({ text }) => text.startsWith('▼ bit was')).right"
            image = "(({ image }) => image.left + image.width)(window.__wall.app.renderer.rects)"
            assert screen.evaluate(f"{bit} <= {image}")
        assert any(text.endswith(" ft") for text in screen.evaluate(
            "[...document.querySelectorAll('#alarmText nobr')].map((at) => at.textContent)"
        ))  # fmt: skip
        screen.close()


def test_the_worst_place_lies_ahead_and_its_distance_is_that_of_the_body_that_meets_it(browser: Any) -> None:
    """A wall to 1062 m, a bit at 1050 m, a key seat above its stabiliser and a larger washout below the bit."""
    string = [hb.RigidBody(0.2, 0.3, 0, "bit"), hb.RigidBody(0.2, 1.0, 12.0, "stabiliser")]
    of = {"severity": 3.0, "confidence": 0.9, "measured": None}
    seat = of | {"kind": "key seat", "start": 1030.0, "stop": 1034.0, "measure": 0.012}
    washout = of | {"kind": "washout", "start": 1055.0, "stop": 1056.0, "measure": 0.04, "severity": 9.0}
    behind = of | {"kind": "washout", "start": 1012.0, "stop": 1014.0, "measure": 0.03}
    ahead = {"up": None, "down": None, "bodies": ((None, None),) * 2, "moving": "up"}
    with hb.view(MadeWall(40_000), string=string) as viewer:
        scene = viewer.scene
        scene.update_state(bit_depth=1050.0, hole_depth=1090.0, newest=time.time(), ahead=ahead)
        screen = Screen(browser, viewer.url, "#rig=1", (1366, 768), drawn=False)
        screen.until("document.getElementById('rigWorstHead').textContent.includes('sure')")
        scene.update_state(zones=(behind, seat | {"within": 0.0021}, washout), zones_to=1062.0)
        head = "document.getElementById('rigWorstHead').textContent"
        screen.until(f"{head} === 'Worst going up: key seat, 90 % sure'")
        assert screen.evaluate(f"({CELL})('rigWorst')")[1:] == ["+12 mm ±3", "1030.0–1034.0 m, slot depth"]
        where = ["Next going up: key seat in", "3.0 m", "stabiliser, the worst place"]  # its upper end is at 1037 m
        assert screen.evaluate(f"({CELL})('rigWhere')") == where
        assert screen.evaluate("document.getElementById('rigWhereCell').className") == "new", "it may hold the string"
        assert screen.evaluate("window.__wall.app.view.top") < 1030, "it is in the picture"
        scene.update_state(ahead=ahead | {"moving": "down"})
        screen.until(f"{head} === 'Worst going down: washout, 90 % sure'")
        where = ["Next going down: washout in", "5.0 m", "bit, the worst place"]
        assert screen.evaluate(f"({CELL})('rigWhere')") == where
        scene.update_state(bit_depth=1045.0, ahead=ahead)
        screen.until("document.getElementById('rigWhere').textContent === 'now '")
        assert screen.inner_text("#rigWhereHead").endswith("going up: key seat"), "the stabiliser is in it"
        scene.update_state(bit_depth=1029.0, zones=(seat,))
        screen.until(f"!{head}.includes(':')")  # all bodies are past it
        near = (1042.0, 1043.0, 0.21, 1048.0, "bit", 1042.5, 0)
        far = (1057.0, 1058.0, 0.203, 1057.0, "bit", 1057.5, 0)
        sides = {
            "up": {"places": (near,)},
            "down": {"places": (far,)},
        }
        way = """[document.getElementById('rigBitHead').textContent,
          [...document.querySelectorAll('#rigBodies .on')].map((at) => at.textContent)]"""
        scene.update_state(bit_depth=1050.0, ahead=ahead | sides | {"moving": "", "hangs": True})
        screen.until(f"{head} === 'Worst going down: tight'")  # it hangs, and may move either way
        assert screen.evaluate(way) == ["Bit depth, at rest", ["up: sticks in", "down: sticks in"]]
        assert screen.inner_text("#rigWorst").startswith("−13 mm")
        assert screen.inner_text("#rigWorstMore").startswith("1057.0–1058.0 m, in 7.0 m")
        where = ["Next going up: sticks in", "2.0 m", "bit, −6 mm at 1043.0 m; bit down in 7.0 m"]
        assert screen.evaluate(f"({CELL})('rigWhere')") == where
        worst = "document.getElementById('rigWorst').textContent"
        sides = {"up": {"places": ((*near, 0.97, 0.0011, False),)}, "down": {"places": ((*far, 0.97, 0.0131, False),)}}
        scene.update_state(ahead=ahead | sides | {"moving": "", "hangs": True})
        screen.until(f"{worst} === '−13 mm ±14'")  # no less than it is
        assert screen.evaluate(head) == "Worst going down: tight, 97 % sure"
        assert screen.inner_text("#rigWorstMore") == "1057.0–1058.0 m, in 7.0 m"
        sides["down"] = {"places": ((*far, 0.97, 0.003, True),)}
        scene.update_state(ahead=ahead | sides | {"moving": "", "hangs": True})
        screen.until("document.getElementById('rigWorst').textContent === '−10 mm or tighter'")  # too little is sampled
        scene.update_state(received=time.time() - 30)
        screen.until("document.body.classList.contains('stale')")
        assert " in " not in screen.inner_text("#rigWorstMore"), "the bit may be elsewhere"
        scene.update_state(received=time.time())
        screen.until("!document.body.classList.contains('stale')")
        scene.update_state(bit_depth=1050.0, ahead=ahead | sides)
        screen.until(f"{head} === 'Worst going up: tight, 97 % sure'")
        assert screen.evaluate(way) == ["Bit depth, going up", ["up: sticks in"]]
        assert screen.evaluate(f"({CELL})('rigWhere')")[1:] == ["2.0 m", "bit, the worst place"]
        assert screen.evaluate(CLIPPED) == []
        screen.close()


def test_rig_mode_shows_the_bit_where_the_clearances_were_found_unless_it_moved_far(browser: Any) -> None:
    wall = MadeWall(20_000)
    bodies = [[0.216, 0.3, 0.0], [0.213, 1.0, 4.0]]
    hanging = [
        {"name": name, "clearance": 0.004, "low": 0.003, "high": 0.005, "depth": 1010.0, "at_most": False, "short": 0.0}
        for name in ("bit", "near-bit stabiliser")
    ]
    string = {"bodies": bodies, "why": "", "hanging": hanging, "bit": 1020.0}
    ahead = {"up": None, "down": None, "bodies": ((None, None), (1018.8, None)), "moving": "up"}
    ahead |= {"unseen": (((1005.0, 1010.0), None), ((1014.0, 1014.5), None))}
    with hb.view(wall) as viewer:
        viewer.scene.update_state(bit_depth=1020.0, hole_depth=1026.0, newest=time.time(), string=string, ahead=ahead)
        screen = Screen(browser, viewer.url, "#rig=1", (1366, 768), drawn=False)
        screen.until("document.querySelector('#rigBodies .name')")
        rows = screen.evaluate(ROWS)
        assert [row[3:] for row in rows] == [["≤1.2 m", "none"], ["– not known 1005–1010", "none"]]
        pale = "[...document.querySelectorAll('#rigBodies .soft')].map((at) => at.textContent.trim())"
        assert screen.evaluate(pale) == ["≤1.2 m", "none", "none"], "a bound is no distance that is free"
        assert screen.evaluate(OVER) == []
        depth = "document.getElementById('rigBit').textContent"
        viewer.scene.update_state(bit_depth=1019.6)
        screen.settle()
        assert screen.evaluate(depth) == "1020.0 m", "distances and clearances are those of one bit depth"
        assert screen.evaluate(ROWS)[0][1:3] == ["±1", "+4 mm"]
        viewer.scene.update_state(bit_depth=1019.4)
        screen.until(f"{depth} === '1019.4 m'")
        assert [row[1:4] for row in screen.evaluate(ROWS)] == [
            ["looking", "–", "≤0.6 m"],
            ["looking", "–", "– not known 1005–1010"],
        ]
        viewer.scene.update_state(string=string | {"bit": 1019.4})
        screen.until("!document.querySelector('#rigBodies').textContent.includes('looking')")
        screen.close()


def test_the_body_that_sticks_next_has_a_row_among_the_widest(browser: Any) -> None:
    sizes = {"top stabiliser": (0.19, 20.0), "stabiliser": (0.21, 10.0), "worn": (0.2, 5.0), "near-bit": (0.212, 2.0)}
    sizes["bit"] = 0.216, 0.0
    of = {"clearance": 0.004, "low": 0.003, "high": 0.005, "depth": 1010.0, "at_most": False, "short": 0.0}
    string = {"bodies": [[size, 0.5, at] for size, at in sizes.values()], "why": "", "bit": 1028.0}
    string["hanging"] = [of | {"name": name} for name in sizes]
    string["hanging"][2] |= {"clearance": 0.03, "low": 0.02, "high": 0.04}  # in a breakout
    place = (1002.0, 1004.0, 0.2, 1024.5, "bit", 1023.0, 4)
    up = {"places": (place,)}
    ahead = {"up": up, "down": None, "bodies": ((1024.5, None), *((None, None),) * 4), "moving": "up"}
    with hb.view(MadeWall(20_000)) as viewer:
        state = {"bit_depth": 1028.0, "hole_depth": 1040.0, "newest": time.time(), "string": string}
        viewer.scene.update_state(**state, ahead=ahead)
        screen = Screen(browser, viewer.url, "#rig=1", (1366, 768), drawn=False)
        screen.until("document.querySelector('#rigBodies .name')")
        own = ["stabiliser", "worn", "near-bit", "bit"]
        assert [row[0] for row in screen.evaluate(ROWS)] == own, "each stabiliser, wherever it stands"
        first = (*place[:4], "top stabiliser", *place[5:])
        viewer.scene.update_state(ahead=ahead | {"up": {"places": (first,)}})
        screen.until("document.querySelectorAll('#rigBodies .name').length === 5")
        assert screen.evaluate(ROWS)[0][::3] == ["top stabiliser", "3.5 m"]
        down = {"places": (first,)}
        viewer.scene.update_state(ahead=ahead | {"down": down})  # moving up, but a body hangs above a tight place
        screen.until("window.__wall.app.ahead.down")
        screen.settle()
        assert [row[0] for row in screen.evaluate(ROWS)] == ["top stabiliser", *own]
        assert screen.evaluate(CLIPPED) == []
        assert screen.evaluate(OVER) == []
        screen.close()


def test_what_is_said_of_the_way_ahead_ends_where_a_body_enters_unseen_hole(browser: Any) -> None:
    string = {"bodies": [[0.216, 0.3, 0.0], [0.213, 1.0, 4.0]], "why": "", "bit": 1010.0}
    string["hanging"] = [{"name": "bit"}, {"name": "stabiliser"}]
    place = (1028.0, 1029.0, 0.206, 1028.0, "bit", 1028.5, 0)
    down = {"places": (place,)}
    ahead = {"up": None, "down": None, "bodies": ((None, None),) * 2, "moving": "down"}
    gap = ((None, (1015.0, 1020.0)), (None, (1015.0, 1021.0)))
    state = {"bit_depth": 1010.0, "hole_depth": 1040.0, "tripped": True, "newest": time.time(), "string": string}
    with hb.view(MadeWall(20_000)) as viewer:
        scene, digits = viewer.scene, "document.getElementById('rigWorst').textContent"
        scene.update_state(**state, ahead=ahead | {"unseen": gap})
        screen = Screen(browser, viewer.url, "#rig=1", (1366, 768), drawn=False)
        screen.until("window.__wall.app.zones.length")
        scene.update_state(zones=(), zones_to=1031.0)
        screen.until(f"{digits} .startsWith('not known')")
        assert screen.inner_text("#rigWorstMore") == "too little seen in 1015.0–1020.0 m"
        unseen = ["Next going down: unseen hole in", "5.0 m"]
        assert screen.evaluate(f"({CELL})('rigWhere')") == [*unseen, "bit"]
        where = "document.getElementById('rigWhereCell').className"
        assert screen.evaluate(where) == "unknown", "hatched, as in the picture"
        scene.update_state(ahead=ahead | {"unseen": ((None, None),) * 2})
        screen.until(f"{digits}.startsWith('none')")
        assert re.match(r"\d\d % seen of 1005\.0–", screen.inner_text("#rigWorstMore"))
        scene.update_state(ahead=ahead | {"unseen": gap, "down": down})
        screen.until(f"{digits}.startsWith('−10 mm')")
        assert screen.evaluate(f"({CELL})('rigWhere')") == [*unseen, "bit; sticks in ≤18.0 m"], "before the tight place"
        assert screen.evaluate("document.getElementById('rigWhereCell').className") == "new", "it sticks on this way"
        up = {"places": ((1003.0, 1004.0, 0.206, 1004.3, "stabiliser", 1003.9, 1),)}
        scene.update_state(ahead=ahead | {"unseen": gap, "up": up, "moving": ""})
        other = "document.getElementById('rigWhereMore').textContent"
        screen.until(f"{other} === 'bit; stabiliser sticks going up in 5.7 m'")  # unseen hole is nearer, below
        scene.update_state(bit_depth=1016.0, ahead=ahead | {"unseen": gap, "down": down})
        screen.until("document.getElementById('rigWhere').textContent === 'now '")
        now = ["Next going down: unseen hole", "now ", "bit; sticks in ≤12.0 m"]
        assert screen.evaluate(f"({CELL})('rigWhere')") == now, "the bit is in it"
        assert screen.inner_text("#rigWorstMore") == "1028.0–1029.0 m, in ≤12.0 m"
        assert screen.evaluate("document.getElementById('rigWhereCell').className") == "new"
        slim = [[0.216, 0.3, 0.0], [0.213, 1.0, 4.0], [0.212, 1.0, 5.0], [0.2, 1.0, 6.0], [0.16, 40.0, 7.0]]
        scene.update_state(
            bit_depth=1026.0,
            string=string | {"bodies": slim, "hanging": [{"name": f"body {name}"} for name in "abcde"]},
            ahead=ahead
            | {"unseen": (*((None, None),) * 3, ((1005.0, 1019.5), None), ((980.0, 1000.0), None)), "moving": "up"},
        )
        screen.until("document.getElementById('rigWhereHead').textContent === 'Next going up: unseen hole'")
        assert screen.inner_text("#rigWhereMore") == "body d", (
            "a stabiliser that is slimmer than three others, and no collar"
        )
        of_bodies = "1020 m (body d), 1021 m (body c), 1022 m (body b), 1026 m (body a)"
        assert screen.inner_text("#rigBodies") == f"Hole not measured at {of_bodies}"
        assert screen.evaluate(CROSSED) == [], "all are on the screen"
        drilled = {"bit_depth": 1034.0, "hole_depth": 1034.0, "tripped": False}
        scene.update_state(**drilled, ahead=ahead | {"unseen": ((None, (1031.0, 1034.0)),) * 2})
        screen.until(f"{digits}.startsWith('none')")  # drilled, and the sensor follows
        screen.close()


def test_rows_name_a_key_seat_the_stabiliser_at_the_bit_and_bound_what_passes_at_most(browser: Any) -> None:
    names = "string stabiliser", "stabiliser", "near-bit", "bit"
    bodies = [[0.213, 1.0, 20.0], [0.212, 1.0, 12.0], [0.209, 1.0, 1.0], [0.216, 0.3, 0.0]]
    of = {"clearance": 0.003, "low": -0.001, "high": 0.007, "depth": 1010.0, "at_most": True, "short": 0.0}
    string = {"bodies": bodies, "why": "", "bit": 1028.0, "hanging": [of | {"name": name} for name in names]}
    ahead = {"up": None, "down": None, "bodies": ((1027.0, None), *((None, None),) * 3), "moving": "up"}
    ahead |= {"unseen": ((None, None),) * 4}
    of = {"severity": 3.0, "confidence": 0.9, "measured": None}
    seat = of | {"kind": "key seat", "start": 1018.0, "stop": 1022.0, "measure": 0.012}
    under = of | {"kind": "undergauge", "start": 1023.0, "stop": 1023.4, "measure": -0.001}
    with hb.view(MadeWall(20_000)) as viewer:
        state = {"bit_depth": 1028.0, "hole_depth": 1040.0, "newest": time.time(), "string": string, "ahead": ahead}
        viewer.scene.update_state(**state)
        screen = Screen(browser, viewer.url, "#rig=1", (1366, 768), drawn=False)
        screen.until("window.__wall.app.zones.length")
        viewer.scene.update_state(zones=(seat, under), zones_to=1031.0)
        screen.until("document.querySelector('#rigWorstHead').textContent === 'Worst going up: key seat, 90 % sure'")
        rows = screen.evaluate(ROWS)
        assert [row[0] for row in rows] == ["string stabiliser", "stabiliser", "near-bit", "bit"], (
            "also the slimmer one"
        )
        assert {tuple(row[1:3]) for row in rows} == {("at most", "≤+7 mm")}, "of the interval, the upper end"
        pale = "[...document.querySelectorAll('#rigBodies .name + .soft')].length"
        assert screen.evaluate(pale) == 4, "a bound is no room that is there"
        assert screen.evaluate("window.__wall.app.renderer.look().string.text") == "≤+7 mm"
        viewer.scene.update_state(bit_depth=1021.0, string=string | {"bit": 1021.0})
        screen.until("document.querySelectorAll('#rigBodies .new').length")
        held = (
            "[...document.querySelectorAll('#rigBodies .name.new')].map((at) => at.firstChild.firstChild.textContent)"
        )
        assert screen.evaluate(held) == ["near-bit", "bit"], "as on the card"
        viewer.scene.update_state(bit_depth=1028.0, string=string)
        screen.until("!document.querySelectorAll('#rigBodies .new').length")
        assert [row[3] for row in rows] == ["1.0 m", "none", "4.0 m key seat", "5.7 m key seat"]
        assert [row[4] for row in rows] == ["10.0 m key seat", "2.0 m key seat", "none", "none"]
        tags = "[...document.querySelectorAll('#rigBodies .name .note')].map((at) => at.textContent)"
        assert screen.evaluate(tags) == ["at bit"]
        assert screen.evaluate("document.querySelectorAll('#rigBodies .name')[2].textContent") == "near-bitat bit"
        assert screen.evaluate(OVER) == []
        wide = [one | {"high": 0.18} if one["name"] == "bit" else one for one in string["hanging"]]
        viewer.scene.update_state(string=string | {"hanging": wide})
        screen.until("document.querySelector('#rigBodies').textContent.includes('not measured')")
        assert screen.evaluate(ROWS)[3][1:3] == ["not measured", "–"], "no sample is beside it"
        assert screen.inner_text("#alarmText") == "Key seat +12 mm, 1018.0–1022.0 m", "the string passes the other zone"
        slim = [[0.2, 1.0, 20.0], [0.2, 1.0, 12.0], *bodies[2:]]  # bodies that pass the other zone meet it first
        viewer.scene.update_state(
            string=string | {"bodies": slim}, zones=(under | {"start": 1001.0, "stop": 1002.0, "measure": -0.008},)
        )
        screen.until("document.getElementById('rigWhereHead').textContent === 'Next going up: undergauge in'")
        assert screen.evaluate(f"({CELL})('rigWhere')")[1:] == ["25.7 m", "bit, the worst place"]
        screen.close()


def test_rig_mode_colours_what_may_hold_the_string_and_no_wide_hole(browser: Any) -> None:
    """New zones of a live wall with and without a tight one: card and banner say which is worse."""
    of = {"severity": 3.0, "confidence": 0.99, "measured": None}
    wide = of | {"kind": "washout", "start": 1012.0, "stop": 1016.0, "measure": 0.05}
    under = of | {"kind": "undergauge", "start": 1018.0, "stop": 1019.0, "measure": -0.008}
    with hb.view(MadeWall(20_000)) as viewer:
        viewer.scene.update_state(bit_depth=1014.0, hole_depth=1014.0, newest=time.time())
        screen = Screen(browser, viewer.url, "#rig=1", (1366, 768), drawn=False)
        screen.until("window.__wall.app.zones.length && window.__wall.app.newest")
        viewer.scene.update_state(zones=(), zones_to=1031.0)
        screen.until("!window.__wall.app.zones.length")
        viewer.scene.update_state(zones=(wide,))
        screen.until("!document.getElementById('alarm').hidden")
        banner = "getComputedStyle(document.getElementById('alarm')).backgroundColor"
        card = "document.getElementById('rigWorstCell').className"
        assert screen.inner_text("#alarmText") == "Washout +50 mm, 1012.0–1016.0 m"
        assert screen.evaluate(f"[{card}, {banner}]") == ["", "rgb(255, 255, 255)"]
        assert screen.evaluate(f"({CELL})('rigWhere')")[:2] == ["Next going up: washout", "here "], "nothing sticks now"
        viewer.scene.update_state(bit_depth=1020.0, hole_depth=1020.0, zones=(wide, under))
        screen.until(f"{card} === 'new'")
        assert screen.evaluate(banner) == "rgb(255, 138, 60)"
        screen.close()


def test_data_that_come_beside_hole_that_is_not_known_have_a_tick_and_no_green_lamp(browser: Any) -> None:
    string = {"bodies": [[0.216, 0.3, 0.0]], "why": "", "bit": 1028.0}
    hanging = [{"name": "bit", "clearance": 0.001, "low": -0.0005, "high": 0.0025, "depth": 1028.0}]
    ahead = {"up": None, "down": None, "bodies": ((None, None),), "moving": "up"}
    tick = """(({ textContent }, { visibility, backgroundColor }) => [textContent, visibility, backgroundColor])(
      rigLamp, getComputedStyle(rigLamp))""".replace("rigLamp", "document.getElementById('rigLamp')")
    card = "document.getElementById('rigWorstCell').className"
    with hb.view(MadeWall(20_000)) as viewer:
        state = {"bit_depth": 1028.0, "hole_depth": 1060.0, "newest": time.time(), "received": time.time()}
        unseen = ((((1005.0, 1015.0), None)),)
        viewer.scene.update_state(**state, string=string | {"hanging": hanging}, ahead=ahead | {"unseen": unseen})
        screen = Screen(browser, viewer.url, "#rig=1", (1366, 768), drawn=False)
        screen.until("window.__wall.app.zones.length")
        viewer.scene.update_state(zones=(), zones_to=1031.0)
        screen.until("document.getElementById('rigWorst').textContent === 'not known '")
        assert screen.evaluate("document.getElementById('rigLamp').className") == "live"
        assert screen.evaluate(f"[{tick}, {card}]") == [["✓", "visible", "rgba(0, 0, 0, 0)"], "unknown"]
        viewer.scene.update_state(ahead=ahead | {"unseen": ((None, None),)})
        screen.until("document.getElementById('rigWorst').textContent.startsWith('none')")
        (sign, _, colour), worst = screen.evaluate(f"[{tick}, {card}]")
        assert (sign, colour == "rgba(0, 0, 0, 0)", worst) == ("✓", False, "")
        head = "document.getElementById('rigWorstHead').textContent"
        assert screen.evaluate(head) == "Worst going up beyond −3 mm", "1.5 mm, and 1.5 of the size"
        assert re.fullmatch(r"\d\d % seen of 1000\.0–1028\.0 m", screen.inner_text("#rigWorstMore"))
        wide = [hanging[0] | {"low": -0.009, "high": 0.011}]
        viewer.scene.update_state(string=string | {"hanging": wide})
        screen.until(f"{head} === 'Worst going up beyond −12 mm'")
        screen.close()


def test_at_rest_each_way_names_its_body_and_each_place_is_named_once(browser: Any) -> None:
    """A bit inside a place that holds its stabiliser on the way up, too; a third place lies far below."""
    names = "bit", "stabiliser"
    string = {"bodies": [[0.216, 0.3, 0.0], [0.213, 1.0, 4.0]], "why": "", "bit": 1020.0}
    free = {"clearance": 0.004, "low": 0.003, "high": 0.005, "depth": 1010.0, "at_most": False, "short": 0.0}
    string["hanging"] = [free | {"name": name} for name in names]
    here, below = (
        (1013.0, 1014.0, 0.21, 1018.0, "stabiliser", 1017.5, 1),
        (1024.0, 1025.0, 0.207, 1024.0, "bit", 1024.5, 0),
    )
    deep = (1028.0, 1029.0, 0.208, 1028.0, "bit", 1028.5, 0)
    ahead = {"up": {"places": (here,)}, "down": {"places": (below, deep)}, "moving": ""}
    ahead |= {"bodies": ((None, 1024.0), (1018.0, None))}
    with hb.view(MadeWall(20_000)) as viewer:
        state = {"bit_depth": 1020.0, "hole_depth": 1030.0, "newest": time.time(), "string": string, "ahead": ahead}
        viewer.scene.update_state(**state)
        screen = Screen(browser, viewer.url, "#rig=1", (1366, 768), drawn=False)
        screen.until("window.__wall.app.zones.length")
        viewer.scene.update_state(zones=(), zones_to=1031.0)
        screen.until("!window.__wall.app.zones.length")
        screen.until("document.getElementById('rigWhereHead').textContent === 'Next going up: sticks in'")
        where = ["2.0 m", "stabiliser, −6 mm at 1014.0 m; bit down in 4.0 m"]
        assert screen.evaluate(f"({CELL})('rigWhere')")[1:] == where
        assert screen.inner_text("#alarmText") == "Tight −9 mm at 1024, −8 mm at 1028, −6 mm at 1013 m", "all three"
        of = {"kind": "undergauge", "severity": 2.0, "confidence": 0.9, "measured": None}
        parts = (1024.0, 1024.4, -0.009), (1024.5, 1024.9, -0.0102)
        zones = tuple(of | {"start": top, "stop": end, "measure": size} for top, end, size in parts)
        viewer.scene.update_state(zones=zones)
        screen.until("window.__wall.app.zones.length === 2")
        screen.settle()
        assert screen.inner_text("#alarmText") == "Tight −9 mm at 1024, −8 mm at 1028, −6 mm at 1013 m", "one place"
        assert screen.evaluate("window.__wall.app.renderer.look().zones.length") == 3
        viewer.scene.update_state(zones=())
        screen.until("!window.__wall.app.zones.length")
        held = {"clearance": -0.008, "low": -0.009, "high": -0.007, "depth": 1013.5}
        string["hanging"] = [free | {"name": "bit"}, free | held | {"name": "stabiliser"}]
        viewer.scene.update_state(string=string, ahead=ahead | {"down": {"places": (here, below, deep)}})
        screen.until("document.getElementById('rigWhere').textContent === 'now '")
        assert screen.inner_text("#rigWhereMore") == "stabiliser, at 1013.5 m; bit down in 4.0 m", (
            "the second place, too"
        )
        assert screen.inner_text("#alarmText") == "Tight −9 mm at 1024, −8 mm at 1028, −6 mm at 1013 m", "once"
        whole = (1000.0, 1031.0, 0.212, 1020.0, "bit", 1020.0, 0)
        viewer.scene.update_state(ahead=ahead | {"up": {"places": (whole,)}, "down": None, "moving": "up"})
        more = "document.getElementById('rigWorstMore').textContent"
        screen.until(f"{more} === '1000.0–1031.0 m: check caliper, bit'")  # the bit drilled all of it
        assert screen.evaluate(CLIPPED) == []
        screen.close()


@pytest.mark.parametrize("size", [(1366, 768), (820, 1180)])
def test_short_names_are_as_large_as_rows_and_screen_let_them(browser: Any, size: tuple[int, int]) -> None:
    free = {"clearance": 0.004, "low": 0.002, "high": 0.006, "depth": 1010.0, "at_most": False, "short": 0.0}
    bodies = {"bit": 0.0, "NB stab": 1.0, "stab 2": 9.0, "stab 3": 18.0}
    string = {"bodies": [[0.2127, 1.0, at] for at in bodies.values()], "why": "", "bit": 1028.0}
    string["hanging"] = [free | {"name": name} for name in bodies]
    with hb.view(MadeWall(20_000)) as viewer:
        viewer.scene.update_state(bit_depth=1028.0, hole_depth=1040.0, newest=time.time(), string=string)
        screen = Screen(browser, viewer.url, "#rig=1", size, drawn=False)
        screen.until("document.querySelectorAll('#rigBodies .name').length === 4")
        screen.settle()
        names = "[...document.querySelectorAll('#rigWorstHead, #rigBodies .name')]"
        sizes = screen.evaluate(f"{names}.map((at) => parseFloat(getComputedStyle(at).fontSize))")
        assert min(sizes) > 18, "pixels"
        lowest = (
            "Math.max(...[...document.querySelectorAll('#rigBodies *')].map((at) => at.getBoundingClientRect().bottom))"
        )
        assert screen.evaluate(lowest) <= size[1], "no row is cut"
        assert screen.evaluate(CROSSED) == []
        screen.close()


@pytest.mark.parametrize("size", [(1366, 768), (1920, 1080)])
def test_rows_of_a_long_string_of_which_most_hangs_above_the_wall_do_not_cross(
    browser: Any, size: tuple[int, int]
) -> None:
    bodies = {
        "bit": (0.216, 0.3, 0.0), "near-bit stabiliser": (0.2127, 1.0, 0.9), "stab 2": (0.2127, 1.2, 9.2),
        "stab 3": (0.2095, 1.2, 41.0), "stab 4": (0.2095, 1.2, 133.0), "roller reamer": (0.2127, 2.0, 245.0),
    }  # fmt: skip
    free = {"clearance": 0.004, "low": 0.002, "high": 0.006, "depth": 1010.0, "at_most": False, "short": 0.0}
    string = {"bodies": [list(of) for of in bodies.values()], "why": "", "bit": 1028.0}
    string["hanging"] = [{"name": name} | (free if of[2] < 20 else {}) for name, of in bodies.items()]
    place = (1014.0, 1015.0, 0.208, 1025.5, "stab 2", 1025.0, 2)
    rows = ((None, None), (1016.0, None), (1025.5, None), *((None, None),) * 3)
    ahead = {"up": {"places": (place,)}, "down": None, "bodies": rows, "moving": "up"}
    with hb.view(MadeWall(20_000)) as viewer:
        state = {"bit_depth": 1028.0, "hole_depth": 1040.0, "newest": time.time(), "string": string, "ahead": ahead}
        viewer.scene.update_state(**state)
        screen = Screen(browser, viewer.url, "#rig=1", size, drawn=False)
        screen.until("document.querySelectorAll('#rigBodies .name').length === 3")
        screen.settle()
        lacks = "Hole not measured at 782 m (roller reamer), 894 m (stab 4), 986 m (stab 3)"
        assert screen.inner_text("#rigBodies .lacks") == lacks
        assert screen.evaluate(CROSSED) == []
        long = [of | {"name": f"{of['name']} with a long tool joint"} for of in string["hanging"]]
        viewer.scene.update_state(string=string | {"hanging": [free | of for of in long]})
        screen.until("document.querySelectorAll('#rigBodies .name').length === 6")
        screen.settle()
        assert screen.evaluate(CROSSED) == []
        assert screen.evaluate(CLIPPED) == []
        assert screen.evaluate(OVER) == []
        screen.close()


def test_a_tight_place_far_below_is_named_over_hole_that_nobody_saw(browser: Any) -> None:
    """The bit runs in at 900 m; the wall is that of an earlier run, from 1000 m on."""
    string = {"bodies": [[0.216, 0.3, 0.0]], "why": "", "bit": 900.0, "hanging": [{"name": "bit"}]}
    ahead = {"up": None, "down": None, "bodies": ((None, None),), "moving": "down"}
    ahead |= {"unseen": ((None, None),)}
    under = {"severity": 3.0, "confidence": 0.9, "measured": None, "kind": "undergauge", "measure": -0.008}
    places = [under | {"start": start, "stop": start + 1.0} for start in (1020.0, 1024.0)]
    with hb.view(MadeWall(20_000)) as viewer:
        state = {"bit_depth": 900.0, "hole_depth": 1040.0, "newest": time.time(), "string": string, "ahead": ahead}
        viewer.scene.update_state(**state)
        screen = Screen(browser, viewer.url, "#rig=1", (1366, 768), drawn=False)
        screen.until("window.__wall.app.zones.length")
        viewer.scene.update_state(zones=places, zones_to=1031.0)
        screen.until("document.getElementById('rigWhereHead').textContent === 'Next going down: undergauge in'")
        assert screen.evaluate(f"({CELL})('rigWhere')")[1:] == ["120.0 m", "bit"]
        assert screen.inner_text("#rigWorst").strip() == "not known"
        assert screen.inner_text("#rigWorstMore") == "too little seen; undergauge −8 mm at 1020.0 m"
        viewer.scene.update_state(ahead=ahead | {"moving": "up"})
        screen.until("document.getElementById('rigWhereHead').textContent === 'Hole size'")
        screen.close()


def test_while_drilling_hole_below_the_sensor_is_not_said_to_be_unseen(browser: Any) -> None:
    """The wall ends at 1031 m, the bit is at 1036 m: the sensor has not reached the hole beside the stabiliser."""
    string = {"bodies": [[0.216, 0.3, 0.0], [0.213, 1.0, 2.0]], "why": "", "bit": 1036.0}
    string["hanging"] = [{"name": "bit"}, {"name": "stabiliser"}]
    ahead = {"up": None, "down": None, "bodies": ((None, None),) * 2, "moving": ""}
    ahead["unseen"] = (((1031.2, 1036.0), None), ((1031.2, 1034.0), None))
    digits = "document.getElementById('rigWorst').textContent"
    with hb.view(MadeWall(20_000)) as viewer:
        state = {"bit_depth": 1036.0, "hole_depth": 1036.0, "newest": time.time(), "string": string, "ahead": ahead}
        viewer.scene.update_state(**state)
        screen = Screen(browser, viewer.url, "#rig=1", (1366, 768), drawn=False)
        screen.until("window.__wall.app.zones.length")
        viewer.scene.update_state(zones=(), zones_to=1031.2)
        screen.until(f"{digits}.startsWith('none')")
        assert screen.inner_text("#rigBodies") == "Hole not measured at 1034 m (stabiliser), 1036 m (bit)", (
            "no heads over no rows"
        )
        viewer.scene.update_state(ahead=ahead | {"unseen": (((1030.0, 1036.0), None), ((1030.0, 1034.0), None))})
        screen.settle()
        assert screen.evaluate(digits).startswith("none"), "the wall has just got it"
        assert screen.inner_text("#rigBitHead") == "Bit depth, on bottom"
        sparse = (((1020.0, 1036.0), None), ((1020.0, 1036.0), None))
        viewer.scene.update_state(ahead=ahead | {"unseen": sparse})
        screen.until(f"{digits}.startsWith('not known')")
        end = screen.evaluate("window.__wall.app.store.span[1]")
        assert screen.inner_text("#rigWorstMore") == f"too little seen in 1020.0–{end:.1f} m", "but above it, it is"
        viewer.scene.update_state(ahead=ahead)
        screen.until(f"{digits}.startsWith('none')")
        viewer.scene.update_state(hole_depth=1044.0, newest=time.time())  # lifted for a connection
        screen.until("window.__wall.app.holeDepth === 1044")
        screen.settle()
        assert screen.evaluate(digits).startswith("none"), "the string has just drilled that hole"
        viewer.scene.update_state(hole_depth=1045.5, seen_hole=1044.0, received=time.time())
        screen.until("window.__wall.app.received")
        screen.evaluate("window.__wall.app.newest -= 30")
        screen.settle()
        assert screen.evaluate(digits).startswith("none"), "the tool sends seldom"
        viewer.scene.update_state(seen_hole=1043.0)  # 2.5 m drilled since the last radius: the sensor is blind
        screen.until(f"{digits}.startsWith('not known')")
        screen.reload()
        screen.until("window.__wall?.app?.zonesTo")
        screen.until(f"!/^(|–|looking.*)$/.test({digits})")
        assert screen.evaluate(digits).startswith("not known"), "the page remembers nothing"
        viewer.scene.update_state(newest=float("nan"), received=time.time())  # nor does a server that was started again
        screen.until("window.__wall.app.newest === null")
        lamp = "document.getElementById('rigLamp').className"
        screen.until(f"{lamp} === 'late' && {digits}.startsWith('not known')")

        def said(arrived: str, **state: Any) -> list[str]:
            """What stands there once the state has come: a page that says it wrongly fails at once."""
            viewer.scene.update_state(received=time.time(), newest=time.time(), **state)
            screen.until(f"(({{ ahead, tripped, seenHole }}) => {arrived})(window.__wall.app)")
            screen.settle()
            where = "document.getElementById('rigWhereHead').textContent"
            card = "document.getElementById('rigWorstCell').className"
            found: list[str] = screen.evaluate(f"[{digits}.trim(), {where}, {card}]")
            return found

        nothing, entered = ["none", "Hole size", ""], "Next going up: unseen hole"
        assert said("seenHole === 1044", hole_depth=1044.0, seen_hole=1044.0) == nothing
        assert said("tripped", tripped=True) == ["not known", entered, "unknown"], "no sensor passed where it ran in"
        assert said("!tripped", tripped=False) == nothing
        up = ahead | {"moving": "up"}
        pulled = ["none", entered, "unknown"]
        assert said("ahead.moving === 'up'", ahead=up) == pulled, "what was seen is known, what it pulls through is not"
        gaps = {"unseen": (((1020.0, 1022.0), None), ((1031.2, 1034.0), None))}
        assert said("ahead.unseen[0][0][0] === 1020", ahead=up | gaps)[0] == "not known", "above it, hole is not seen"
        screen.close()


def test_a_page_begins_with_the_units_of_its_source_until_the_user_chooses_others(browser: Any) -> None:
    depth = "document.getElementById('rigBit').textContent"
    with hb.view(MadeWall(20_000)) as viewer:
        viewer.scene.update_state(bit_depth=1020.0, hole_depth=1026.0, newest=time.time(), units="ft")
        screen = Screen(browser, viewer.url, "#rig=1", (1366, 768), drawn=False)
        screen.until(f"{depth} === '3346.5 ft'")
        assert "units" not in screen.address()
        assert screen.evaluate("document.getElementById('units').value") == "ft"
        screen.evaluate("window.__wall.app.view.choose({ units: 'mm' })")
        screen.until(f"{depth} === '1020.0 m'")
        assert "units=mm" in screen.address()
        screen.reload()
        screen.until(f"{depth} === '1020.0 m'")
        viewer.scene.update_state(bit_depth=1020.5)
        screen.until(f"{depth} === '1020.5 m'")
        screen.close()


def test_rig_mode_says_now_where_the_body_stands_if_it_is_sure_to_stick_there(browser: Any) -> None:
    string = {"bodies": [[0.213, 1.0, 4.0]], "why": "", "bit": 1020.0}
    of = {"name": "stabiliser", "clearance": -0.004, "low": -0.009, "depth": 1015.3, "at_most": False, "short": 0.0}
    place = (1013.0, 1018.0, 0.209, 1020.0, "stabiliser", 1019.7, 0)
    up = {"places": (place,)}
    ahead = {"up": up, "down": None, "bodies": ((1020.0, None),), "moving": "up"}
    with hb.view(MadeWall(20_000)) as viewer:
        state = {"bit_depth": 1020.0, "hole_depth": 1026.0, "newest": time.time(), "ahead": ahead}
        viewer.scene.update_state(string=string | {"hanging": [of | {"high": 0.001}]}, **state)
        screen = Screen(browser, viewer.url, "#rig=1", (1366, 768), drawn=False)
        screen.until("document.querySelector('#rigBodies .name')")
        screen.settle()
        assert screen.evaluate(f"({CELL})('rigWhere')")[:2] == ["Next going up: sticks in", "0.0 m"]
        assert screen.evaluate(ROWS)[0][3:] == ["0.0 m", "none"]
        red = "window.__wall.app.renderer.look().string.high < 0"
        colours = f"[document.querySelector('#rigBodies .name').className.trim(), {red}]"
        assert screen.evaluate(colours) == ["name", False], (
            "what is not surely beyond its limit has no colour of an alarm"
        )
        assert screen.evaluate("window.__wall.app.renderer.look().string.text") == "−4 mm", "beside where it is tight"
        surely = of | {"clearance": -0.002, "high": -0.0005}  # but by less than noise of the diameters may be
        viewer.scene.update_state(string=string | {"hanging": [surely]})
        screen.until("document.querySelector('#rigBodies .name.zone')")
        viewer.scene.update_state(string=string | {"hanging": [of | {"high": -0.002}]})
        screen.until("document.getElementById('rigWhere').textContent.includes('now')")
        now = ["Next: sticks", "now ", "stabiliser, at 1015.3 m"]
        assert screen.evaluate(colours) == ["new name", True]
        assert screen.evaluate(f"({CELL})('rigWhere')") == now
        assert screen.evaluate(ROWS)[0][3:] == ["now", "now"]
        received = time.time() - 30
        viewer.scene.update_state(received=received)
        screen.until("document.body.classList.contains('stale')")
        assert screen.evaluate(f"({CELL})('rigWhere')") == ["Next: not known", "– ", "no new bit depth"]
        assert screen.inner_text("#rigBitHead") == "Bit depth"
        assert screen.evaluate("window.__wall.app.renderer.look().oldBit"), "the picture says that the bit was there"
        assert screen.evaluate(ROWS) == [], "no dashes"
        assert screen.inner_text("#rigBodies") == "Clearances not known: no new bit depth"
        viewer.scene.update_state(received=time.time())
        screen.until("!document.body.classList.contains('stale')")
        assert screen.evaluate(f"({CELL})('rigWhere')") == now
        alarms = ("tight ahead: tight hole above the bit at 1020.0 m: from 1013.0 to 1018.0 m 209 mm pass at most",)
        scene, head = viewer.scene, "document.getElementById('rigWorstHead').textContent"
        scene.update_state(alarms=alarms, ahead=ahead | {"down": up, "moving": "down"})
        screen.until("window.__wall.app.ahead.moving === 'down'")
        screen.settle()
        assert screen.evaluate(head) == "Worst place: tight", "it sticks there on both ways"
        assert screen.inner_text("#alarmText").startswith("Tight above")
        scene.update_state(ahead=ahead | {"up": None, "down": up, "moving": "up"})
        screen.until(f"!{head}.endsWith('tight')")  # tripped out, what lies behind is not next
        screen.close()


def test_data_that_come_later_than_usual_turn_the_lamp_and_old_ones_pale_the_page(browser: Any) -> None:
    with hb.view(MadeWall(20_000)) as viewer:
        scene, now = viewer.scene, time.time()
        times = [now - 600 + 10 * step for step in range(60)]
        values = [90.0 + step % 7 for step in range(60)]
        scene.read_channels = lambda: [
            ShownChannel("WOB", "kN", 96.2, 1.0, "high", times, values),
            ShownChannel("<b>", "bar", -3.5, 700.0, "", [], []),
        ]
        scene.update_state(bit_depth=1033.4, newest=now - 240, received=now - 1, channels=7)
        screen = Screen(browser, viewer.url, "#md=1010&sec=10", drawn=False)
        screen.keyboard.press("k")
        screen.until("document.getElementById('rigChannels').naturalWidth > 0")
        assert screen.evaluate("document.getElementById('rigChannels').getBoundingClientRect().height") > 50
        lamp = "document.getElementById('rigLamp').className"
        scene.update_state(received=now)  # a second later
        screen.until(f"{lamp} === 'live' && !Number.isNaN(window.__wall.app.pace.usual)")
        assert screen.inner_text("#rigAgeMore") == "last radius 4 min old"  # bytes come, without a radius
        hangs = {"up": None, "down": None, "bodies": (), "moving": "", "hangs": True}
        scene.update_state(hole_depth=1040.0, ahead=hangs)
        screen.until("document.getElementById('rigAgeMore').textContent === 'at rest, last radius 4 min old'")
        assert screen.inner_text("#rigBitHead") == "Bit depth, at rest"
        scene.update_state(bit_depth=1040.0, ahead=hangs | {"same": 6})
        screen.until("document.getElementById('rigBitHead').textContent === 'Bit depth, on bottom, same for 6 min'")
        scene.update_state(bit_depth=1033.4)
        scene.update_state(ahead=hangs | {"moving": "up", "hangs": False})
        screen.until("document.getElementById('rigAgeMore').textContent === 'last radius 4 min old'")
        scene.update_state(hole_depth=float("nan"), ahead=None)
        screen.until("window.__wall.app.holeDepth === null")
        assert re.fullmatch(r"\d s", screen.inner_text("#rigAge"))
        scene.update_state(unused="not turning: radii not used")
        screen.until("document.getElementById('rigAgeMore').textContent === 'not turning: radii not used'")
        assert screen.evaluate(lamp) == "live", "nothing is wrong"
        scene.update_state(unused="")
        screen.until("document.getElementById('rigAgeMore').textContent === 'last radius 4 min old'")
        scene.update_state(newest=float("nan"))  # a server that was started again
        screen.until("window.__wall.app.newest === null")
        assert re.fullmatch(r"\d s", screen.inner_text("#rigAge"))
        assert screen.evaluate("Math.abs(window.__wall.app.received - Date.now() / 1000)") < 60
        scene.update_state(hole_depth=1033.4, seen_hole=1033.4, newest=time.time() - 15, received=time.time())
        screen.until(f"{lamp} === 'live'")
        scene.update_state(hole_depth=1033.9, bit_depth=1033.9, received=time.time())  # drilled on, without a radius
        screen.until(f"{lamp} === 'late'")
        drilled = r"/^no radius for \d\d s, 0\.5 m drilled$/"
        screen.until(f"{drilled}.test(document.getElementById('rigAgeMore').textContent)")
        assert re.fullmatch(r"\d\d s", screen.inner_text("#rigAge"))
        scene.update_state(received=time.time(), unused="sliding: radii not used")
        screen.until("document.getElementById('rigAgeMore').textContent === 'sliding: radii not used, 0.5 m drilled'")
        scene.update_state(newest=time.time(), received=time.time(), unused="")
        screen.until(f"{lamp} === 'live'")
        assert screen.evaluate("window.__wall.app.pace.usual") < 7
        scene.update_state(newest=time.time() - 30, received=time.time() - 30)
        screen.until("document.body.classList.contains('stale')")  # before an alarm
        assert 30 <= float(screen.inner_text("#rigAge").split()[0]) < 60
        scene.update_state(newest=time.time(), received=time.time())
        screen.until(f"{lamp} === 'live' && !document.body.classList.contains('stale')")
        screen.evaluate("window.__wall.app.received -= 9")
        screen.until(f"{lamp} === 'late'")
        assert not screen.evaluate("document.body.classList.contains('stale')")
        assert screen.evaluate("document.getElementById('rigAgeCell').className") == "zone", "it is marked first"
        scene.update_state(alarms=("no data rig: nothing for 20 s",), received=time.time() - 9)
        screen.until("document.body.classList.contains('stale')")
        assert screen.inner_text("#alarmText") == "No data from rig"
        word = "document.getElementById('rigAgeMore').textContent"
        assert screen.evaluate(word) == "no new bit depth +1 more", "what makes the page pale comes first"
        pale = "getComputedStyle(document.querySelector('#rigBit small'))"
        soft = "getComputedStyle(document.querySelector('#rigBitHead')).color"
        assert screen.evaluate(f"[{pale}.opacity, {pale}.color === {soft}]") == ["1", True], "it can be read from afar"
        inks = (
            "['rigChannels', 'stage', 'rigWorstCell'].map((id) => getComputedStyle(document.getElementById(id)).filter)"
        )
        assert screen.evaluate(inks) == ["none", "none", "grayscale(1)"], "only what counts from the bit"
        said = ("no depth rig: it sends, and none of it is a bit depth", "no samples mwd: nothing", "lost rig: stopped")
        scene.update_state(alarms=said[:2])
        screen.until("document.getElementById('alarmText').textContent.includes('mwd')")
        short = {"No bit depth from rig", "No samples from mwd"}
        assert set(screen.inner_text("#alarmText").splitlines()) == short
        scene.update_state(alarms=said[2:])
        screen.until("/^rig not connected/i.test(document.getElementById('alarmText').textContent)")
        scene.update_state(alarms=())
        screen.until("!document.body.classList.contains('stale')")
        scene.update_state(channels=0)
        screen.until("document.getElementById('rigChannels').hidden")
        screen.close()


def test_none_is_said_of_no_place_in_which_a_body_may_stick_and_each_stabiliser_has_a_word(browser: Any) -> None:
    """A string of 60 m that hangs in 30 m of wall; its bit is likely too thick for hole above it, and not surely."""
    sizes = {"reamer": (0.213, 55.0), "top": (0.2, 40.0), "stabiliser": (0.21, 10.0), "bit": (0.216, 0.0)}
    of = {"clearance": 0.002, "low": 0.001, "high": 0.003, "depth": 1010.0, "at_most": False, "short": 0.0}
    string = {"bodies": [[size, 1.0, at] for size, at in sizes.values()], "why": "", "bit": 1028.0}
    string["hanging"] = [{"name": name} if at > 28 else of | {"name": name} for name, (_, at) in sizes.items()]
    ahead = {"up": None, "down": None, "bodies": ((None, None),) * 4, "moving": "up"}
    ahead |= {"unseen": ((None, None),) * 4}
    place = (1023.0, 1024.0, 0.2145, 1025.0, "bit", 1024.8, 3, 0.62, 0.0018, False)
    tight = ahead | {"up": {"places": (place,)}, "bodies": (*((None, None),) * 3, (1025.0, None))}
    state = {"bit_depth": 1028.0, "hole_depth": 1040.0, "newest": time.time(), "string": string}
    with hb.view(MadeWall(20_000)) as viewer:
        viewer.scene.update_state(**state, ahead=tight)
        screen = Screen(browser, viewer.url, "#rig=1", (1366, 768), drawn=False)
        screen.until("window.__wall.app.zones.length")
        viewer.scene.update_state(zones=(), zones_to=1031.2)
        worst = ["Worst going up: tight, 62 % sure", "−2 mm ±2", "1023.0–1024.0 m"]
        assert screen.evaluate(f"({CELL})('rigWorst')") == worst
        where = ["Next going up: may stick in", "3.0 m", "bit, the worst place"]
        assert screen.evaluate(f"({CELL})('rigWhere')") == where
        cards = "['rigWorstCell', 'rigWhereCell'].map((id) => document.getElementById(id).className)"
        assert screen.evaluate(cards) == ["unknown", "unknown"], "hatched, and orange only where it is likely to stick"
        assert not screen.is_visible("#alarm")
        rows = screen.evaluate(ROWS)
        assert [row[0] for row in rows] == ["stabiliser", "bit"]
        assert [row[3] for row in rows] == ["none", "3.0 m may stick"]
        assert screen.inner_text("#rigBodies .lacks") == "Hole not measured at 973 m (reamer), 988 m (top)"
        assert screen.evaluate(OVER) == []
        viewer.scene.update_state(ahead=ahead)
        screen.until("document.getElementById('rigWorst').textContent.startsWith('none')")
        screen.close()


def test_nothing_counts_from_a_depth_that_was_refused_or_corrected(browser: Any) -> None:
    string = {"bodies": [[0.216, 0.3, 0.0]], "why": "", "bit": 1020.0}
    string["hanging"] = [{"name": "bit", "clearance": 0.004, "low": 0.003, "high": 0.005, "depth": 1019.9, "short": 0}]
    ahead = {"up": None, "down": None, "bodies": ((None, None),), "moving": ""}
    refused = "depth jump: bit depth refused, 3346 m: the last depth used was 1020 m, since 12:00:01 UTC"
    stepped = "depth step: bit depth jumped by -9.5 m: it came to 1010.50 m in 0.5 s, since 12:00:01 UTC"
    lamp = "document.getElementById('rigLamp').className"
    said = """['rigAgeMore', 'rigWhereMore', 'rigBodies', 'rigBitHead', 'alarmText'].map(
      (id) => document.getElementById(id).textContent)"""
    with hb.view(MadeWall(20_000)) as viewer:
        scene = viewer.scene
        state = {"bit_depth": 1020.0, "hole_depth": 1026.0, "string": string, "ahead": ahead}
        scene.update_state(**state, newest=time.time() - 30, received=time.time(), alarms=(refused,))
        screen = Screen(browser, viewer.url, "#rig=1", (1366, 768), drawn=False)
        screen.until("document.querySelector('#rigBodies .name')")
        assert screen.evaluate(f"[document.body.classList.contains('stale'), {lamp}]") == [False, "late"], "one is used"
        scene.update_state(received=time.time() - 4)
        screen.until("document.body.classList.contains('stale')")
        short = "bit depth refused, 3346 m"
        unknown = f"Clearances not known: {short}"
        assert screen.evaluate(said) == [short, short, unknown, "Bit depth", short]
        scene.update_state(received=time.time(), alarms=(stepped,))
        screen.until("document.getElementById('rigWhereMore').textContent.includes('jumped')")
        short = "bit depth jumped by -9.5 m"
        assert screen.evaluate(said) == [short, short, f"Clearances not known: {short}", "Bit depth", short]
        scene.update_state(hole_depth=1020.0, received=time.time(), alarms=())
        screen.until(f"{lamp} === 'live' && !document.body.classList.contains('stale')")
        scene.update_state(hole_depth=1029.5, bit_depth=1029.5, seen_hole=1029.5, received=time.time())
        screen.until("window.__wall.app.holeDepth === 1029.5")
        screen.settle()
        assert "drilled" not in screen.inner_text("#rigAgeMore")
        scene.update_state(hole_depth=1029.7, bit_depth=1029.7, received=time.time())
        screen.until("/s, 0.2 m drilled$/.test(document.getElementById('rigAgeMore').textContent)")
        constant = "stays: caliper constant since 1008 m: 107.95 mm, 50 times in a row, since 12:00:01 UTC"
        scene.update_state(newest=time.time(), received=time.time(), alarms=(constant,))
        screen.until("document.getElementById('rigAgeMore').textContent === 'caliper constant since 1008 m'")
        assert screen.evaluate(lamp) == "late"
        assert screen.inner_text("#alarmText") == "Caliper constant since 1008 m"
        screen.close()


def test_rig_mode_says_what_is_worst_and_where_if_nothing_is_tight_ahead(browser: Any) -> None:
    depth = np.arange(2000.0, 2024.0, 0.002)
    washed, tight = abs(depth - 2012) < 1, abs(depth - 2018) < 0.5
    radius = np.where(washed, 0.128, np.where(tight, 0.104, 0.1085))
    wall = hb.reconstruct(hb.Caliper(depth, depth * 9000 % 360, radius), bit_diameter=0.216)
    string = [hb.RigidBody(0.216, 0.3, 0, "bit"), hb.RigidBody(0.2, 1.0, 3.0, "stabiliser")]
    end = wall.depth[-1]
    with hb.view(wall, string=string) as viewer:
        viewer.scene.update_state(bit_depth=end + 2.5, hole_depth=end + 2.5, newest=time.time())
        screen = Screen(browser, viewer.url, "#rig=1", (1366, 768), drawn=False)
        screen.until("document.getElementById('rigWorstHead').textContent.includes('sure')")
        worst = next(zone for zone in wall.zones().zones if zone.kind == "undergauge")
        head, digits, more = screen.evaluate(f"({CELL})('rigWorst')")
        undergauge = f"Worst going up: undergauge, {worst.confidence_text} sure"
        assert head == undergauge, "before the washout, which is larger"
        assert re.fullmatch(rf"−{-1000 * worst.measure:.0f} mm ±\d", digits)
        assert more == f"{worst.start:.1f}–{worst.stop:.1f} m, under bit size"
        far = f"{end + 2.5 - 0.3 - worst.stop:.1f} m"  # from the upper end of the first body that is too thick for it
        where = ["Next going up: undergauge in", far, "bit, the worst place"]
        assert screen.evaluate(f"({CELL})('rigWhere')") == where
        screen.until(f"({ROWS})[0][2] === '+17 mm'")
        assert [row[3:] for row in screen.evaluate(ROWS)] == [["–", "–"]], "nobody looks ahead"
        viewer.scene.update_state(zones=(), zones_to=end - 6)
        screen.until("document.getElementById('rigWorst').textContent.startsWith('looking')")
        assert screen.evaluate(f"({CELL})('rigWorst')")[2] == f"none to {end - 6:.1f} m"
        assert screen.evaluate(f"({CELL})('rigWhere')")[0] == "Hole size"
        assert re.fullmatch(rf"data to {end:.1f} m, 2.\d m behind bit", screen.inner_text("#rigAgeMore"))
        assert not re.search(r"\bC[12]\b", screen.inner_text("#rig"))
        assert screen.evaluate(CLIPPED) == []
        screen.close()


def test_no_worst_place_is_said_only_of_hole_that_was_seen(browser: Any) -> None:
    depth = np.arange(2000.0, 2024.0, 0.002)
    depth = depth[abs(depth - 2010.0) > 2.5]
    wall = hb.reconstruct(hb.Caliper(depth, depth * 9000 % 360, np.full(depth.size, 0.1085)), bit_diameter=0.216)
    with hb.view(wall) as viewer:
        viewer.scene.update_state(bit_depth=2024.0, hole_depth=2024.0, newest=time.time(), zones=(), zones_to=2024.0)
        screen = Screen(browser, viewer.url, "#rig=1", (1366, 768), drawn=False)
        screen.until("window.__wall.app.zonesTo === 2024")
        screen.settle()
        assert screen.inner_text("#rigWorst").strip() == "not known"
        top, bottom = map(float, re.findall(r"[\d.]+", screen.inner_text("#rigWorstMore").removesuffix(" m")))
        assert (top, bottom) == pytest.approx((2008.5, 2011.5), abs=0.4), "a radius has samples within a metre"
        where = screen.evaluate(f"({CELL})('rigWhere')")
        assert where == ["Next going up: unseen hole in", f"{2024.0 - bottom:.1f} m", "bit"]
        viewer.scene.update_state(bit_depth=2090.0, hole_depth=2090.0)
        screen.until("window.__wall.app.bit === 2090")
        screen.settle()
        assert screen.inner_text("#rigWorstMore") == "too little seen", "no hole near the bit"
        screen.close()


def test_no_place_and_no_clearance_is_known_of_a_string_whose_bit_has_no_depth(browser: Any) -> None:
    """Hole that is tight for a stabiliser alone is no zone: without a bit depth, nobody looks for it."""
    depth = np.arange(2000.0, 2024.0, 0.002)
    wall = hb.reconstruct(hb.Caliper(depth, depth * 9000 % 360, np.full(depth.size, 0.1085)), bit_diameter=0.216)
    with hb.view(wall) as viewer:
        viewer.scene.update_state(newest=time.time(), received=time.time(), zones=(), zones_to=2024.0)
        screen = Screen(browser, viewer.url, "#rig=1", (1366, 768), drawn=False)
        screen.until("document.getElementById('rigWorst').textContent.startsWith('none')")
        viewer.scene.update_state(string={"bodies": [[0.216, 0.3, 0.0], [0.213, 1.0, 9.0]], "why": ""})
        screen.until("document.getElementById('rigWorst').textContent.startsWith('not known')")
        lacks = screen.inner_text("#rigBodies"), screen.inner_text("#rigWorstMore"), screen.inner_text("#rigBitMore")
        assert lacks == ("Clearances not known: no bit depth received", *["no bit depth received"] * 2)
        viewer.scene.update_state(bit_depth=2024.0, hole_depth=2024.0, received=time.time())
        screen.until("document.getElementById('rigWorst').textContent.startsWith('none')")
        screen.close()


def test_the_picture_of_the_channels_has_their_values_and_names_as_text() -> None:
    picture = channel_strip(
        [ShownChannel("<b>", "bar", -3.5, 700.0, "low", [0.0, 10.0, 90.0], [1.0, 2.0, 1.0])], "dark"
    )
    root = ElementTree.fromstring(picture)
    texts = ["".join(at.itertext()) for at in root.iter("{http://www.w3.org/2000/svg}text")]
    assert texts == ["<b>, low, 12 min old", "−3.5 bar", "last 13 min"]
    line, gaps = root.iter("{http://www.w3.org/2000/svg}path")
    assert [part[0] for part in re.findall(r"[ML][^ML]+", line.attrib["d"])] == ["M", "L", "M"]  # a gap of 80 s
    assert gaps.attrib["d"].count("M") == 2, "it and the time since then"


@pytest.mark.parametrize(("every", "age", "old"), [(10.0, 14.0, ""), (10.0, 16.0, "16 s old"), (60.0, 80.0, "")])
def test_a_value_of_a_channel_is_pale_if_another_was_to_come_since(every: float, age: float, old: str) -> None:
    picture = channel_strip([ShownChannel("WOB", "kN", 90.0, age, "", [0.0, every, 2 * every], [1.0] * 3)], "dark")
    head, number, _ = ElementTree.fromstring(picture).iter("{http://www.w3.org/2000/svg}text")
    assert head.text == (f"WOB, {old}" if old else "WOB")
    assert (number.attrib["fill"] == head.attrib["fill"]) == bool(old)


def test_rig_mode_follows_and_survives_a_reload(browser: Any) -> None:
    with hb.view(MadeWall(30_000)) as viewer:
        screen = Screen(browser, viewer.url, "#md=1010&sec=10", drawn=False)
        section = "(({ top, length, follow }) => [top, length, follow])(window.__wall.app.view)"
        before = screen.evaluate(section)
        screen.keyboard.press("k")
        screen.keyboard.press("k")
        assert screen.evaluate(section) == before
        screen.keyboard.press("k")
        screen.settle()
        top = screen.evaluate("window.__wall.app.view.top")
        for key in ("ArrowUp", "PageUp", " "):
            screen.keyboard.press(key)
        assert screen.evaluate("[window.__wall.app.view.top, window.__wall.app.view.follow]") == [top, True]
        assert "rig=1" in screen.address()
        screen.reload()
        assert screen.is_visible("#rig")
        assert screen.evaluate("window.__wall.app.view.top") == pytest.approx(top, abs=0.01)
        screen.keyboard.press("k")
        assert not screen.is_visible("#rig")
        screen.close()


def test_the_bit_ahead_of_a_short_wall_is_in_the_picture(browser: Any) -> None:
    wall = MadeWall(9_000)  # 14 m
    with hb.view(wall) as viewer:
        bit = wall.depth[-1] + 3
        viewer.scene.update_state(bit_depth=bit, newest=time.time())
        screen = Screen(browser, viewer.url, "#rig=1", drawn=False)
        screen.until(f"window.__wall.app.bit === {bit} && window.__wall.app.view.bottom > {bit}")
        assert screen.evaluate("window.__wall.app.view.top") < wall.depth[0] + 1
        screen.close()


def test_a_new_zone_announces_itself_until_it_is_silenced(browser: Any) -> None:
    wall = MadeWall(25_000)
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=1020&sec=20", drawn=False)
        screen.until("window.__wall.app.zones.length")
        before = screen.evaluate("window.__wall.app.zones.length")
        assert not screen.is_visible("#alarm"), "zones of the wall as it was are not new"
        viewer.scene.update_state(newest=time.time())
        screen.until("window.__wall.app.newest")
        viewer.update(wall.grow(20_000))
        screen.until(f"window.__wall.app.zones.length > {before}")
        screen.until("!document.getElementById('alarm').hidden")
        text = screen.inner_text("#alarmText")
        assert text.startswith("New washout")
        places = [screen.locator(name).bounding_box() for name in ("#bar", "#alarm", "main")]
        assert [place["y"] + place["height"] for place in places[:2]] == [place["y"] for place in places[1:]], "rows"
        assert screen.evaluate("document.querySelectorAll('#zones .new').length") >= 1
        screen.reload()
        screen.until("window.__wall.app.zones.length")
        screen.settle()
        assert screen.inner_text("#alarmText") == text
        screen.keyboard.press("q")
        screen.settle()
        assert not screen.is_visible("#alarm")
        viewer.scene.update_state(alarms=("WITS: no record for 60 s",))
        screen.until("!document.getElementById('alarm').hidden")
        assert screen.inner_text("#alarmText") == "WITS: no record for 60 s"
        screen.close()


def test_alarms_take_two_lines_and_turn_the_lamp_at_once(browser: Any) -> None:
    alarms = (
        "depth jump mwd: the bit went from 1031.4 to 1036.4 m and stays there, since 12:00:01 UTC, 14:00:01 here",
        "refused mwd: no sample was usable for 120 s: 1,240 no value, 12 sent twice, since 12:00:09 UTC, 14:00:09 here",
        "no data rig: nothing has come for 120 s, since 12:02:09 UTC, 14:02:09 here",
    )
    with hb.view(MadeWall(20_000)) as viewer:
        viewer.scene.update_state(bit_depth=1041.4, newest=time.time())
        screen = Screen(browser, viewer.url, "#md=1010&sec=10", (1366, 768), drawn=False)
        screen.keyboard.press("k")
        screen.until("window.__wall.app.figures.summary?.mean_diameter && window.__wall.app.zones.length")
        ids = "['rigLamp', 'rigAgeMore', 'lamp', 'lampSign']"
        lamp = f"{ids}.map((id) => document.getElementById(id)).map((at, i) => i % 2 ? at.textContent : at.className)"
        screen.until("document.getElementById('rigLamp').className === 'live'")
        assert screen.evaluate(lamp)[0::2] == ["live", "lamp live"]
        viewer.scene.update_state(alarms=alarms)
        screen.until("!document.getElementById('alarm').hidden")
        screen.settle()
        assert screen.inner_text("#alarmText").splitlines() == [
            "No data from rig",
            "No sample was usable for 120 s, +1 more",
        ]
        assert screen.evaluate(lamp) == ["late", "no data from rig +1 more", "lamp late", "!"]
        height = "document.getElementById('alarm').getBoundingClientRect().height"
        banner = screen.evaluate(height)
        assert banner < 110
        assert screen.evaluate(CLIPPED) == []
        assert min(cell["height"] for cell in screen.evaluate(DIGITS)) >= 77
        assert all(cell["fits"] for cell in screen.evaluate(DIGITS))
        screen.keyboard.press("a")
        screen.settle()
        assert screen.inner_text("#alarmWhole").lower().splitlines() == [one.lower() for one in alarms[::-1]]
        assert screen.evaluate(height) == banner, "the whole text lies over the display"
        screen.keyboard.press("a")
        screen.settle()
        assert not screen.is_visible("#alarmWhole"), "A closes what it opened"
        assert screen.is_visible("#alarm")
        screen.keyboard.press("q")
        screen.settle()
        assert screen.is_visible("#alarmWhole"), "first to be read"
        screen.keyboard.press("q")
        screen.settle()
        assert not screen.is_visible("#alarm")
        assert screen.evaluate(lamp)[0] == "late", "silenced, and it lasts"
        viewer.scene.update_state(alarms=alarms[:1])
        screen.until("document.getElementById('rigLamp').className === 'live'")  # data come, at a new depth
        viewer.scene.update_state(alarms=(), lost=("rig",))
        screen.until("document.getElementById('rigLamp').className === 'lost'")
        assert screen.evaluate(lamp) == ["lost", "rig not connected", "lamp lost", "✕"]
        screen.close()


def test_section_and_images_beside_survive_a_restart_in_rig_mode(browser: Any) -> None:
    wall = MadeWall(20_000)
    with hb.view(wall, attributes=gamma_and_resistivity(wall)) as viewer:
        screen = Screen(browser, viewer.url, "#md=1010&sec=10", (1366, 768), drawn=False)
        assert screen.evaluate("window.__wall.app.view.beside") == ["GR"]
        section = screen.evaluate("[window.__wall.app.view.top, window.__wall.app.view.bottom]")
        screen.keyboard.press("k")
        session = screen.evaluate("window.__wall.app.store.session")
        viewer.scene.begin(viewer.scene.shape)  # as a new server does
        viewer.update()
        screen.until(f"window.__wall.app.store.session !== '{session}' && window.__wall.app.store.levels[0].size")
        screen.keyboard.press("k")
        screen.settle()
        assert screen.evaluate("window.__wall.app.view.beside") == ["GR"]
        assert screen.evaluate("'beside0' in window.__wall.app.renderer.rects")
        assert screen.evaluate("[window.__wall.app.view.top, window.__wall.app.view.bottom]") == pytest.approx(section)
        screen.close()


def test_rig_mode_for_less_than_a_frame_leaves_the_section_its_figures(browser: Any) -> None:
    with hb.view(MadeWall(20_000)) as viewer:
        screen = Screen(browser, viewer.url, "#md=1010&sec=10", (1366, 768), drawn=False)
        screen.settle()
        screen.evaluate(  # a request of the section waits; rig mode comes and goes before the next picture
            """() => {
              const { app } = window.__wall;
              app.renderer.draw = () => {};
              app.figures.asked = '';
              app.figures.ask();
              app.view.rig = true;
              setTimeout(() => { app.view.rig = false; delete app.renderer.draw; app.redraw(); }, 1500);
            }"""
        )
        screen.until("!window.__wall.app.view.rig && !window.__wall.app.figures.pending")
        screen.close()


def test_a_bit_ahead_of_the_wall_has_its_true_depth_where_the_path_reaches(browser: Any) -> None:
    wall, path = MadeWall(30_000), hb.Survey([0, 950, 1090], [0, 30, 30], [0, 40, 40]).path()
    with hb.view(wall, path=path) as viewer:
        screen = Screen(browser, viewer.url, "#rig=1", drawn=False)
        for bit, below in ((1075.0, f"TVD {path.position([1075.0])[0, 2]:.1f} m"), (1095.0, "TVD: beyond the survey")):
            viewer.scene.update_state(bit_depth=bit, newest=time.time())
            screen.until(f"window.__wall.app.bit === {bit}")
            screen.settle()
            assert screen.inner_text("#rigBitMore") == below
        screen.close()


def test_the_figures_reach_the_end_of_a_wall_that_stops_growing(browser: Any) -> None:
    wall = MadeWall(30_000)
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=1055&sec=40", drawn=False)
        screen.until("window.__wall.app.figures.summary")
        viewer.update(wall.grow(12_800))
        end = wall.depth[-1]
        screen.until(f"Math.abs(window.__wall.app.figures.summary.stop - {end}) < 0.3")
        screen.close()
