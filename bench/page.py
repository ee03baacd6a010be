"""The page of all results, ``bench-results.html``: figures in tables, and a picture of the cost against the size."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

STYLE = """body{font:15px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:60rem;padding:0 1rem}
:root{color-scheme:light dark}
table{border-collapse:collapse;margin:.5rem 0 1.5rem}td,th{padding:.15rem .8rem .15rem 0;text-align:left}
td+td{text-align:right;font-variant-numeric:tabular-nums}h2{margin-top:2rem}svg{max-width:100%}"""
COLORS = ("#1f5fa8", "#b3541e", "#2e7d4f", "#7a5aa6")
WIDTH, HEIGHT, LEFT, BOTTOM = 640, 360, 60, 40


def page(results: dict[str, Any], text: Any) -> str:
    """Return all results as HTML; ``text`` is a function that yields name and text of each figure in a value."""
    parts = [f"<h1>Benchmarks of helibore</h1>{_table(text('', results['machine']))}"]
    for name, cases in results.items():
        if name == "machine":
            continue
        parts.append(f"<h2>{escape(name.replace('_', ' '))}</h2>")
        if name == "sizes":
            parts.append(cost_by_size(cases))
        for case in cases:
            figures = text("", {key: value for key, value in case.items() if key != "case"})
            parts.append(f"<h3>{escape(case['case'])}</h3>{_table(figures)}")
    return f"<!doctype html><meta charset=utf-8><title>Benchmarks</title><style>{STYLE}</style>{''.join(parts)}\n"


def _table(rows: Any) -> str:
    return f"<table>{''.join(f'<tr><td>{escape(name)}<td>{escape(value)}' for name, value in rows)}</table>"


def cost_by_size(cases: Sequence[dict[str, Any]]) -> str:
    """Return an SVG picture of the nanoseconds for each sample against the number of samples, both logarithmic.

    A level line means that the cost grows in proportion to the number of samples.
    """
    from math import floor, log10

    lines: dict[str, list[tuple[float, float]]] = {}
    for case in cases:
        for work, milliseconds in case["milliseconds"].items():
            lines.setdefault(work, []).append((log10(case["samples"]), log10(1e6 * milliseconds / case["samples"])))
    points = [point for line in lines.values() for point in line]
    (left, right), (low, high) = ((min(of), max(of)) for of in zip(*points, strict=True))
    low, high = floor(low), floor(high) + 1

    def at(x: float, y: float) -> str:
        across = LEFT + (WIDTH - LEFT - 130) * (x - left) / ((right - left) or 1)
        return f"{across:.1f},{10 + (HEIGHT - BOTTOM - 10) * (high - y) / (high - low):.1f}"

    marks = []
    for power in range(low, high + 1):
        x, y = at(left, power).split(",")
        marks.append(f'<text x="{LEFT - 8}" y="{float(y) + 4}" text-anchor="end">{10.0**power:g}</text>')
        marks.append(f'<path d="M{x},{y}H{WIDTH - 130}" stroke="currentColor" opacity=".15"/>')
    for case in cases:
        x = at(log10(case["samples"]), low).split(",")[0]
        marks.append(f'<text x="{x}" y="{HEIGHT - 14}" text-anchor="middle">{case["samples"]:,}</text>')
    for color, (work, line) in zip(COLORS, lines.items(), strict=False):
        path = " ".join(at(*point) for point in line)
        x, y = at(*line[-1]).split(",")
        marks.append(f'<polyline points="{path}" fill="none" stroke="{color}" stroke-width="2"/>')
        marks.append(f'<text x="{float(x) + 8}" y="{float(y) + 4}" fill="{color}">{escape(work)}</text>')
    return (
        f'<p>Nanoseconds for each sample, by number of samples.</p><svg viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" '
        f'font-family="system-ui,sans-serif" font-size="12" fill="currentColor">{"".join(marks)}</svg>'
    )
