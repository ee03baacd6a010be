"""Play streams that are well formed and wrong, and time their alarms: ``python -m bench.live.wrong``.

The streams are those of tests/python/live/wrong_streams.py: by WITS, MQTT, ETP and from a store. Each line has the
alarm, the seconds until it began, the most that are allowed, and its text. The exit code is 1 if an alarm is late, is
absent, lacks the setting that it must name, or came before anything was wrong.
"""

from __future__ import annotations

import logging
import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2] / "tests" / "python" / part) for part in ("", "live")]
from wrong_streams import STREAMS, played  # noqa: E402


def main() -> int:
    """Play all streams, or those whose names contain an argument."""
    logging.getLogger("helibore.live").setLevel(logging.CRITICAL)
    wrong = 0
    names = [name for name in STREAMS if not sys.argv[1:] or any(one in name for one in sys.argv[1:])]
    for name in names:
        stream = STREAMS[name]
        delay, text, false = played(name)
        right = delay <= stream.within and not false and all(word in text for word in stream.words)
        wrong += not right
        print(f"{'' if right else 'WRONG: '}{name}: {stream.rule} after {delay:g} of {stream.within:g} s: {text}")
        for one in false:
            print(f"    false: {one}")
    print(f"{len(names) - wrong} of {len(names)} streams alarmed as they should")
    return int(wrong > 0)


if __name__ == "__main__":
    raise SystemExit(main())
