"""The page for everyone: axe-core finds no serious or critical violation in its main views, light and dark."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
from locations import ROOT, WEB
from made_wall import MadeWall, curved_path, gamma_and_resistivity
from patience import PATIENCE
from screen import NEEDS_BROWSER, Screen

import helibore as hb
from helibore.logs.picks import Pick

pytestmark = NEEDS_BROWSER

# By size of the window: what the view is made to show, and a key pressed in it, which Escape undoes.
VIEWS: dict[tuple[int, int], list[tuple[dict[str, str | bool], str]]] = {
    (1366, 768): [
        ({}, ""),
        ({"theme": "dark"}, "d"),  # picking
        ({"theme": "dark"}, "?"),  # the help
        ({"theme": "light", "rig": True}, ""),
        ({"theme": "dark", "rig": True}, ""),
    ],
    (820, 1180): [({}, "")],
    (390, 844): [
        ({}, "d"),
        ({"theme": "dark"}, ""),
        ({"theme": "light", "tab": "section"}, ""),
        ({"tab": "zones"}, ""),
    ],
}
RUN = """() => axe.run(document, { resultTypes: ['violations'] }).then(({ violations }) =>
  violations.filter(({ impact }) => impact === 'serious' || impact === 'critical')
    .map(({ id, nodes }) => [id, nodes.map(({ target, failureSummary }) => `${target}: ${failureSummary}`)]))"""


@pytest.fixture(scope="module")
def axe(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The text of axe-core: as `./develop lint` installed it, or installed now."""
    for folder in (ROOT / "build" / "page-check", tmp_path_factory.mktemp("axe")):
        file = folder / "node_modules" / "axe-core" / "axe.min.js"
        if not file.is_file() and folder.parent != ROOT / "build":
            install(folder)
        if file.is_file():
            return file.read_text("utf-8")
    pytest.skip("npm could not install axe-core")


def install(folder: Path) -> None:
    npm = shutil.which("npm")
    if npm is None:
        pytest.skip("npm, which installs axe-core, is not here")
    for name in ("package.json", "package-lock.json", ".npmrc"):
        shutil.copy(WEB / "check" / name, folder)
    command = [npm, "ci", "--ignore-scripts", "--no-audit", "--no-fund"]
    subprocess.run(command, cwd=folder, capture_output=True, timeout=PATIENCE, check=False)


def test_no_view_has_a_serious_violation(browser: Any, axe: str) -> None:
    wall = MadeWall(30_000)
    with hb.view(wall, path=curved_path(), attributes=gamma_and_resistivity(wall), well="Made-1 T2") as viewer:
        viewer.scene.picks.append(Pick(kind="bed", depth=1020.0, toolface=40.0, apparent_dip=60.0))
        viewer.scene.update_state(alarms=("WITS: no record for 60 s",))
        found = {}
        for size, views in VIEWS.items():
            screen = Screen(browser, viewer.url, "#md=1020&sec=30&theme=light", size, drawn=False)
            screen.until("window.__wall.app.zones.length && window.__wall.app.picking.kept.length")
            screen.evaluate(axe)
            for shown, key in views:
                screen.evaluate(f"window.__wall.app.view.choose({json.dumps(shown)})")
                if key:
                    screen.keyboard.press(key)
                screen.settle()
                assert screen.is_visible("#rig") == shown.get("rig", False)
                assert screen.is_visible("#dips") == (key == "d")
                screen.until(f"document.getElementById('help').open === {json.dumps(key == '?')}")
                found[size, str(shown), key] = screen.evaluate(RUN)
                if key:
                    screen.keyboard.press("Escape")
            screen.close()
        assert {view: violations for view, violations in found.items() if violations} == {}
