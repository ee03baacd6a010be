"""Play streams that are well formed and wrong, and time their alarms: ``python -m bench.live.wrong``.

The streams are those of tests/python/live/wrong_streams.py: by WITS, MQTT, ETP and from a store. Each line has the
alarm, the seconds until it began, the most that are allowed, and its text. The alarm is then read from the page (in
Chromium, if it is installed), from the metrics and from stderr. The exit code is 1 if an alarm is late, is absent in
one of them, lacks the setting that it must name, or came before anything was wrong.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2] / "tests" / "python" / part) for part in ("", "live")]
from alarm_outputs import AlarmOutputs  # noqa: E402
from screen import MISSING, UNDRAWN, Chromium  # noqa: E402
from wrong_streams import STREAMS, played  # noqa: E402


def main() -> int:
    """Play all streams, or those whose names contain an argument."""
    wrong = 0
    names = [name for name in STREAMS if not sys.argv[1:] or any(one in name for one in sys.argv[1:])]
    with AlarmOutputs() as outputs:
        if MISSING:
            print(f"the page is read without a browser, as there is no {', '.join(MISSING)}")
        else:
            from playwright.sync_api import sync_playwright

            chromium = Chromium()
            outputs.callback(chromium.close)
            browser = outputs.enter_context(sync_playwright()).chromium.connect_over_cdp(chromium.address)
            outputs.page = browser.contexts[0].new_page()
            outputs.page.add_init_script(UNDRAWN)
            outputs.page.goto(outputs.window.url)
        for name in names:
            stream = STREAMS[name]
            delay, text, false, lacking = played(name, outputs.lacking)
            right = delay <= stream.within and not (false or lacking) and all(word in text for word in stream.words)
            wrong += not right
            print(f"{'' if right else 'WRONG: '}{name}: {stream.rule} after {delay:g} of {stream.within:g} s: {text}")
            for one in false:
                print(f"    false: {one}")
            if lacking:
                print(f"    not shown by {', '.join(lacking)}")
    print(f"{len(names) - wrong} of {len(names)} streams alarmed as they should")
    return int(wrong > 0)


if __name__ == "__main__":
    raise SystemExit(main())
