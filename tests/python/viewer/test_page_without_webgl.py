"""The page in a browser without WebGL 2. It starts browsers of its own, so it shares no module with the shared one."""

from __future__ import annotations

import base64

import numpy as np
from made_wall import MadeWall
from screen import CHROMIUM, FLAGS, NEEDS_BROWSER, Screen

import helibore as hb

pytestmark = NEEDS_BROWSER

# The image track as it is on the 2-D canvas, RGBA bytes as base64.
PLAIN = """(() => {
  const { left, top, width, height } = window.__wall.app.renderer.rects.image;
  const { data } = document.getElementById('ink').getContext('2d').getImageData(left, top, width, height);
  let text = '';
  for (const byte of data) text += String.fromCharCode(byte);
  return { width: Math.round(width), height: Math.round(height), text: btoa(text) };
})()"""


def test_without_webgl_the_image_is_still_there_and_the_same() -> None:
    """A browser that truly offers none, beside one that does."""
    from playwright.sync_api import sync_playwright

    wall, address = MadeWall(20_000), "#md=1006&sec=10"
    without = [flag for flag in FLAGS if "gl" not in flag and "gpu" not in flag] + ["--disable-3d-apis"]
    with hb.view(wall) as viewer, sync_playwright() as playwright:
        seen = {}
        for flags in (without, FLAGS):
            browser = playwright.chromium.launch(executable_path=CHROMIUM, args=flags)
            screen = Screen(browser, viewer.url, address)
            screen.evaluate("window.__wall.app.selection.setColours({ low: -0.002, high: 0.02 })")
            screen.settle()
            if flags is without:
                assert screen.evaluate("document.createElement('canvas').getContext('webgl2')") is None
                said = screen.inner_text("#notice")
                assert said.startswith(
                    "This browser offers no WebGL 2, so there is no 3-D view and the image is drawn without it."
                )
                got = screen.evaluate(PLAIN)
                pixels = np.frombuffer(base64.b64decode(got["text"]), np.uint8)
                seen["plain"] = pixels.reshape(got["height"], got["width"], 4)[..., :3].astype(int)
                hovered = screen.evaluate(
                    "(({ image }) => [image.left + 99, image.top + 200])(window.__wall.app.renderer.rects)"
                )
                top = screen.evaluate("document.getElementById('stage').getBoundingClientRect().top")
                screen.mouse.move(hovered[0], hovered[1] + top)
                screen.until("document.getElementById('readout').textContent.includes('mm')")
                for key in "hi[]":
                    screen.keyboard.press(key)
                screen.settle()
            else:
                seen["drawn"] = screen.pixels("image")[..., :3].astype(int)
            screen.close()
            browser.close()
    inner = (slice(3, -3), slice(3, -3))
    same = (abs(seen["plain"][inner] - seen["drawn"][inner]).max(axis=-1) <= 6).mean()
    assert same > 0.97, "but for the edges of quads, which may fall on the next pixel"
    assert len(np.unique(seen["plain"].reshape(-1, 3), axis=0)) > 50, "a picture, not a blank"
