"""Kill helibore, and then the broker, while MQTT messages come: ``python -m bench.live.mqtt --kills 20``.

The broker is mosquitto with persistence; messages have QoS 1 and a number. Helibore is killed at equal intervals
(SIGKILL) and begins again; each message must be drawn once, and a replay must have the same bits. Then messages wait at
the broker while helibore is away: the broker is stopped by SIGTERM, which must lose nothing, and killed by SIGKILL,
which may lose what it had acknowledged; then an event must name the gap.
"""

from __future__ import annotations

import argparse
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).parents[2] / "tests" / "python" / part) for part in ("", "live")]
from live_servers import Running, until  # noqa: E402
from test_live_mqtt import PROGRAM, Broker, message, numbers, publish, settings  # noqa: E402

from helibore import Live  # noqa: E402


def killed(broker: Broker, folder: Path, count: int, kills: int) -> bool:
    """Kill helibore while messages come; return whether each was drawn once, also by a replay."""
    begun = [sys.executable, "-c", PROGRAM, settings(broker), str(folder)]

    def begin() -> subprocess.Popen[bytes]:
        process = subprocess.Popen(begun, stdout=subprocess.PIPE)
        assert process.stdout
        process.stdout.readline()
        return process

    sender, program = broker.sender(), begin()
    until(lambda: any(b"127.0.0.1" in path.read_bytes() for path in folder.glob("*.hbj")))
    time.sleep(1.0)  # it has subscribed
    sending = threading.Thread(target=lambda: [publish(sender, map(message, range(at, at + 100)))
                                               for at in range(0, count, 100)])  # fmt: skip
    sending.start()
    for _ in range(kills):
        time.sleep(0.7)
        program.kill()
        program.wait()
        program = begin()
    sending.join()
    program.kill()
    program.wait()
    with Running(settings(broker), folder) as last:
        until(lambda: last.live.wall.sample_count >= count, 60)
        found = numbers(last.live)
    again = Live.replay(folder).wall
    same = np.array_equal(again.radius, last.live.wall.radius, equal_nan=True)
    lost, doubled = count - len({*found}), len(found) - len({*found})
    print(f"{count:,} messages, {kills} kills of helibore: lost {lost}, doubled {doubled}, same bits on replay: {same}")
    return not (lost or doubled) and same


def ended(broker: Broker, folder: Path, first: int, how: signal.Signals) -> bool:
    """End the broker while 1,500 messages wait; return whether nothing is lost, or the loss is named."""
    sender = broker.sender()
    publish(sender, map(message, range(first, first + 1500)))
    broker.end(how)
    broker.begin()
    again = broker.sender()
    publish(again, [message(first + 1500)])
    with Running(settings(broker), folder) as last:
        until(lambda: numbers(last.live)[-1:] == [first + 1500])
        time.sleep(1.0)
        lost = first + 1501 - len({*numbers(last.live)})
        named = [line for line in last.reported() if " gap" in line]
    print(f"{how.name} of the broker: lost {lost}; named: {named[-1] if lost and named else 'nothing'}")
    return lost == 0 or (how == signal.SIGKILL and bool(named))


def main() -> int:
    """Run, and print what came and what was lost."""
    options = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    options.add_argument("--count", type=int, default=45_000)
    options.add_argument("--kills", type=int, default=20)
    given = options.parse_args()
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "broker").mkdir()
        broker, folder = Broker(Path(name) / "broker"), Path(name) / "j"
        right = [killed(broker, folder, given.count, given.kills)]
        right.append(ended(broker, folder, given.count, signal.SIGTERM))
        right.append(ended(broker, folder, given.count + 1501, signal.SIGKILL))
        broker.end(signal.SIGKILL)
    return int(not all(right))


if __name__ == "__main__":
    raise SystemExit(main())
