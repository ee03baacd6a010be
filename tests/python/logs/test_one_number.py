"""One number: logs, report, viewer and `summary()` print the same digits of a wall, for twenty different walls."""

from __future__ import annotations

import html
import re
from types import SimpleNamespace

import numpy as np
import pytest

import helibore as hb
from helibore.base.units import INCH
from helibore.cli.lines import summary_lines
from helibore.logs.summary import WallSummary
from helibore.plot import html_report
from helibore.plot.content import Drawing, content_of
from helibore.viewer.feed import Feed


def wall_of(seed: int) -> hb.Wall:
    """A hole by imaging tools, four arms or an average caliper, up or down, with washouts and gaps."""
    rng = np.random.default_rng(seed)
    bit, pitch = rng.choice([0.1524, 0.2159, 0.3112]), rng.choice([0.05, 0.1, 0.2])
    depth = np.sort(rng.uniform(1500, 1512, 6000))
    toolface = rng.uniform(0, 360, depth.size)
    arm = None
    if seed % 4 == 1:
        depth = np.repeat(np.arange(1500, 1512, 0.04), 4)
        arm = np.tile([0, 1, 0, 1], depth.size // 4)
        toolface = (np.tile([0, 90, 180, 270], depth.size // 4) + rng.uniform(-20, 20) * (depth - 1500)) % 360
    radius = bit / 2 + 0.002 + 0.004 * np.cos(np.radians(2 * toolface - 60))
    radius += 0.03 * (np.abs(depth - rng.uniform(1503, 1509)) < 1.0) + rng.normal(0, 3e-4, depth.size)
    there = np.abs(depth - rng.uniform(1502, 1510)) > rng.choice([0.0, 1.5])
    if seed % 4 == 3:
        caliper = hb.Caliper.from_average(depth[there][::50], 2 * radius[there][::50])
    else:
        caliper = hb.Caliper(depth[there], toolface[there], radius[there], arm=None if arm is None else arm[there])
    ends = {"start_depth": 1511.9, "stop_depth": 1500.1} if seed % 5 == 0 else {}
    settings = {"bit_diameter": bit, "pitch": -pitch if ends else pitch, "sectors": int(rng.choice([16, 64]))}
    return hb.reconstruct(caliper, **settings, **ends, max_distance=0.3)


def numbers(text: str) -> list[str]:
    return re.findall(r"[-+]?\d[\d,]*\.?\d*", text)


def report_rows(wall: hb.Wall) -> dict[str, str]:
    content = content_of(wall, Drawing(body=(), polar=()))
    page = html_report._summary(content) + html_report._quality(content, ())
    rows = re.findall(r"<tr><th>(.*?)</th><td>(.*?)</td></tr>", page)
    return {html.unescape(label): html.unescape(text) for label, text in rows}


def viewer_numbers(wall: hb.Wall, summary: WallSummary) -> dict[str, float | None]:
    feed = Feed(wall, path=None, attributes={}, well="W")
    return feed._summarize(summary.start, summary.stop)


@pytest.mark.parametrize("seed", range(20))
def test_one_number(seed: int) -> None:
    wall = wall_of(seed)
    summary = wall.summary()
    depth = wall.samples.depth
    height = abs(summary.pitch) / summary.sectors
    inside = np.count_nonzero((depth >= summary.start - height) & (depth <= summary.stop + height))
    lines = " | ".join(f"{label} {text}" for label, text in summary_lines(summary))
    rows, viewed = report_rows(wall), SimpleNamespace(**viewer_numbers(wall, summary))
    assert rows["Samples"] == f"{inside:,}"
    assert f"vertices, from {inside:,} samples" in lines
    volume, excess = re.search(r"\| volume +(.*? m³).*? over .*?, ([^,]*) against the bit", lines).groups()
    assert rows["Hole volume"].startswith(volume)
    if summary.ranged:  # few samples a turn
        assert (volume, excess) == (viewed.volume_text, viewed.excess_text)
        ends = numbers(volume)
        decimals = len(ends[0].split(".")[1])
        assert float(ends[0]) <= round(summary.volume, decimals) <= float(ends[-1])
        assert len(ends) == 2 or summary.volume_range[0] == summary.volume_range[1]
    else:
        assert volume == f"{summary.volume:,.3f} m³" == f"{viewed.volume:,.3f} m³"
        assert excess == f"{100 * viewed.excess:+.1f} %"
    assert f"over {viewed.whole_turns:,.1f} m of whole turns" in rows["Hole volume"]
    assert f"over {summary.whole_turns:,.1f} m of whole turns" in lines
    assert f"{excess} against the bit" in rows["Hole volume"]
    sizes = numbers(rows["Diameter"])
    mean = re.search(r"mean +(.*?), by volume", lines)[1]
    (millimetres,) = re.findall(r"\(([^)]*) mm\)", mean)
    assert rows["Diameter"].startswith(f"{millimetres.strip()} mm mean")
    if not summary.ranged:
        assert f"{viewed.mean_diameter / INCH:.3f}" in mean
    for name, printed in (("least", sizes[-2]), ("greatest", sizes[-1])):
        extreme = getattr(summary, f"{name}_diameter").value
        assert getattr(viewed, f"{name}_diameter") == extreme
        assert printed == f"{1e3 * extreme:.1f}"
        assert printed in re.search(rf"{name} +([^|]*)", lines)[1]
    if summary.basis == "azimuthal":
        assert numbers(rows["Measured"])[0] == f"{100 * viewed.coverage:.2f}" == f"{100 * summary.coverage:.2f}"
    else:
        assert (rows["Measured"], viewed.coverage) == (summary.basis_text, None)
    assert numbers(rows["Without support"])[0] == f"{100 * viewed.without_radius:.2f}"
    assert f"{100 * viewed.without_radius:.2f} % of the vertices have no sample in reach" in lines
    assert (viewed.washed_out, viewed.incomplete_turns) == (summary.washed_out, summary.incomplete_turns)
    for kind, length in summary.kinds.items() if summary.basis == "azimuthal" else ():
        assert f"{kind} {length:,.1f} m" in rows["Zones"]
