"""What a host pushes while a hole is drilled, as text for ``tests/consumer/live.cpp``, and hb.Live's reports."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

import helibore as hb
from helibore.live.rules.configuration import parse
from helibore.simulation.tool import Hole, Lift, Tool, simulate

CONFIGURATION = """
[wall]
bit_diameter = 0.216
start_depth = 100.0
sectors = 16
direct = true
threads = 1
[source.host]
address = "host"
units = "metric"
survey = {}
"""


class Push(NamedTuple):
    """One call: its text, and the same call on a Live."""

    text: str
    call: Callable[[hb.Live], object]


def numbers(values: np.ndarray) -> str:
    """Every digit, as C++ prints them."""
    return "".join(f" {value:.17g}" for value in np.ravel(values).tolist())


def rows(head: str, table: np.ndarray) -> str:
    return f"{head} {len(table)}\n" + "".join(numbers(row)[1:] + "\n" for row in table)


def pushes() -> list[Push]:
    """A tool lifted once, its samples in parts of all sizes out of order; a late, a repeated and a bad station."""
    draw = np.random.default_rng(9)
    run = simulate(Hole.example(start=100.0, stop=105.0, seed=4), Tool(lifts=(Lift(103.0, 2.0),), noise=0.001),
                   samples=900, seed=4)  # fmt: skip
    samples = np.column_stack([run.depth, run.toolface - 180.0, run.radius, run.time])
    cuts = np.sort(draw.choice(np.arange(1, 900), 40, replace=False))
    parts = np.split(samples, cuts)
    parts[3], parts[30] = parts[30], parts[3]
    stations = np.array([[0, 0, 0], [130, 9, 20], [50, 5, 10], [50, 5, 10], [60, 190, 0], [120, 7, 15.0]])
    images = np.column_stack([draw.permutation(np.arange(100, 106, 0.25)), draw.normal(60, 5, (24, 8))])
    images[5, 0] = images[17, 0]
    found = []
    for i, part in enumerate(parts):
        found.append(Push(rows("samples", part), lambda live, p=part: live.append_samples(*p.T)))
        if i % 7 == 0:
            station = stations[i // 7 : i // 7 + 1]
            found.append(Push(rows("stations", station), lambda live, s=station: live.append_stations(*s.T)))
        if i % 4 == 0:
            some = images[i // 2 : i // 2 + 2]
            if len(some):
                found.append(Push(rows("image GR gAPI 8", some),
                                  lambda live, t=some: live.append_image("GR", t[:, 0], t[:, 1:], "gAPI")))  # fmt: skip
    return found


def reported_by_python(found: list[Push]) -> list[str]:
    """What the program prints, from hb.Live."""
    live = hb.Live(parse(CONFIGURATION))
    lines = []
    for push in found:
        push.call(live)
        update = live.poll()
        ranges = update.changes["main"].ranges if update.changes else np.empty((0, 2))
        lines += ["changed" + numbers(ranges), "quads" + numbers(update.quads("main", 16))]
        lines.append("images" + "".join(f" {name} {start} {stop}" for name, (start, stop) in update.images.items()))
        lines.append("path" + (numbers(np.array(update.path_from)) if update.path_from is not None else ""))
        lines += [f"event {event.text}" for event in update.events if event.rule == "station"]
    depth, values = live.images["GR"].arrays()
    wall, path = live.wall, live.path
    assert path is not None
    columns = {"depth": wall.depth, "radius": wall.radius, "nearest": wall.nearest, "image_depth": depth,
               "image_values": values}  # fmt: skip
    lines += [name + numbers(column) for name, column in columns.items()]
    return lines + ["position" + numbers(row) for row in path.position(wall.depth)]
