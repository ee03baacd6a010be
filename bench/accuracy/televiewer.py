"""Compare a geologist's picks on a televiewer's amplitude image with what helibore finds in image and caliper.

    python -m bench.accuracy.televiewer ../shared/data/calipers

The command prints a line for each pick: the dark lobe found there, its azimuth less that of the pick, its opening, and
how much the hole is over gauge. Then it prints how many breakouts were found that nobody picked, and how little the
counts depend on the criteria. `docs/televiewer.md` explains the table.
"""

from __future__ import annotations

import csv
import itertools
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import helibore as hb
from helibore.images.image_breakouts import DarkLobe, ImageBreakout, ImageBreakouts
from helibore.logs.zone_criteria import Criteria
from helibore.settings.zone_settings import ImageCriteria

BREAKOUT = "1"
"""The type of the picks in opposite pairs. Four of fourteen picks are of types 0 and 2; no file explains the types."""
NEAR = 20.0
"""A pick and a lobe count as the same if they lie at most this many degrees apart."""
GAUGE = 0.104
"""Diameter of the hole without breakouts, metres; at the top the mean caliper reads 104.04 mm."""


@dataclass(frozen=True)
class Pick:
    """One side of a feature, as the geologist picked it.

    ``depth`` is the depth of its middle and ``length`` its length along the hole, metres; ``azimuth`` is its direction
    and ``opening`` its width around the hole, degrees; ``kind`` is the type in the file.
    """

    depth: float
    azimuth: float
    opening: float
    length: float
    kind: str

    @property
    def ends(self) -> tuple[float, float]:
        """Return top and bottom of the feature, metres."""
        return self.depth - self.length / 2, self.depth + self.length / 2


@dataclass(frozen=True)
class Match:
    """A pick, and the breakout (``zone``) and its lobe that were found at the pick, or None and None."""

    pick: Pick
    zone: ImageBreakout | None
    lobe: DarkLobe | None

    @property
    def off(self) -> float:
        """Return the azimuth of the lobe less that of the pick, degrees."""
        return float("nan") if self.lobe is None else (self.lobe.toolface - self.pick.azimuth + 180) % 360 - 180


def read_picks(folder: Path) -> list[Pick]:
    """Read the geologist's picks from ``folder``."""
    with (folder / "breakout_picks.csv").open() as file:
        return [
            Pick(*(float(row[of]) for of in ("depth_m", "azimuth_deg", "opening_deg", "length_m")), row["type"])
            for row in csv.DictReader(file)
        ]


def read_wall(folder: Path) -> hb.Wall:
    """Return a round wall, as large as the mean caliper, with the image; without travel time its shape is not known."""
    size = np.genfromtxt(folder / "caliper_max_ave.csv", delimiter=",", names=True)
    round_hole = hb.Caliper.from_average(size["depth_m"], size["cal_ave_diameter_mm"] / 1000)
    wall = hb.reconstruct(round_hole, bit_diameter=GAUGE, sectors=144, pitch=0.02, estimator="inverse-distance")
    with hb.open(folder / "atv_amplitude.npz") as file:
        image = file.image("amplitude").sector_image(origin="centre", reference="north", name="Amplitude")
    wall.images[image.name] = image
    return wall


def match(picks: list[Pick], found: ImageBreakouts) -> list[Match]:
    """Return for each pick the nearest lobe of the breakouts at its depths, if that is within `NEAR` degrees."""
    matches = []
    for pick in picks:
        near = [Match(pick, zone, lobe) for zone in found.zones if _meet(zone, pick) for lobe in zone.lobes]
        best = min(near, key=lambda one: abs(one.off), default=None)
        matches.append(best if best is not None and abs(best.off) <= NEAR else Match(pick, None, None))
    return matches


def false_ones(found: ImageBreakouts, picks: list[Pick]) -> list[ImageBreakout]:
    """Return the found breakouts without a lobe within `NEAR` degrees of a picked breakout at the same depths."""
    broken = [pick for pick in picks if pick.kind == BREAKOUT]
    return [
        zone
        for zone in found.zones
        if not any(
            abs(Match(pick, zone, lobe).off) <= NEAR for pick in broken if _meet(zone, pick) for lobe in zone.lobes
        )
    ]


def _meet(zone: ImageBreakout, pick: Pick) -> bool:
    top, bottom = pick.ends
    return zone.start < bottom and zone.stop > top


def enlargements(folder: Path, picks: list[Pick]) -> list[tuple[float, float]]:
    """Return, for each pick, by how much the maximum and the mean diameter exceed `GAUGE` at most there, metres."""
    size = np.genfromtxt(folder / "caliper_max_ave.csv", delimiter=",", names=True)
    rows = []
    for pick in picks:
        inside = (size["depth_m"] >= pick.ends[0]) & (size["depth_m"] <= pick.ends[1])
        most, mean = (size[of][inside].max() / 1000 for of in ("cal_max_diameter_mm", "cal_ave_diameter_mm"))
        rows.append((float(most - GAUGE), float(mean - GAUGE)))
    return rows


def sensitivity(image: hb.SectorImage, picks: list[Pick]) -> list[tuple[int, int, int]]:
    """Return, for each set of criteria near the defaults, how many picked breakouts and other picks are found.

    The third number is that of the false breakouts (`false_ones`).
    """
    counts = []
    for dark, opening, join in itertools.product((0.5, 0.6, 0.7), (7.5, 10.0, 12.5), (0.0, 0.02, 0.05)):
        found = image.breakouts(ImageCriteria(dark=dark, least_opening=opening, join=join))
        matches = match(picks, found)
        hits = [one.pick.kind == BREAKOUT for one in matches if one.lobe]
        counts.append((sum(hits), len(hits) - sum(hits), len(false_ones(found, picks))))
    return counts


def main(folder: Path) -> int:
    """Print the comparison of picks and breakouts; return the exit code, 0."""
    picks, wall = read_picks(folder), read_wall(folder)
    image = wall.images["Amplitude"]
    found = image.breakouts()
    matches, larger = match(picks, found), enlargements(folder, picks)
    print("pick m   type azimuth opening | found at m       azimuth   off opening darkest | max, mean - gauge mm")
    for one, (most, mean) in zip(matches, larger, strict=True):
        pick, zone, lobe = one.pick, one.zone, one.lobe
        line = f"{pick.depth:8.3f}    {pick.kind} {pick.azimuth:7.1f} {pick.opening:7.1f} | "
        if zone is not None and lobe is not None:
            line += f"{zone.start:.2f} to {zone.stop:.2f} {lobe.toolface:6.1f} {one.off:+5.1f} {lobe.opening:7.1f} "
            line += f"{lobe.relative:7.2f}"
        else:
            line += f"{'not found':<44}"
        print(f"{line} | {1000 * most:5.1f} {1000 * mean:5.1f}")
    picked = [one for one in matches if one.pick.kind == BREAKOUT]
    hits = [one for one in picked if one.lobe is not None]
    off = np.array([one.off for one in hits])
    others = sum(one.lobe is not None for one in matches if one.pick.kind != BREAKOUT)
    wrong = len(false_ones(found, picks))
    print(f"\npicked breakouts (type {BREAKOUT}): {len(hits)} of {len(picked)} found; of other types: {others}")
    print(f"azimuth off: mean {off.mean():+.1f}, most {abs(off).max():.1f} deg; false ones: {wrong}")
    print("\n".join(f"  {name}: {text}" for name, text in found.facts().items()))
    inch, scaled = Criteria().elongation, Criteria.scaled(GAUGE).elongation
    size = np.genfromtxt(folder / "caliper_max_ave.csv", delimiter=",", names=True)
    over, spacing = size["cal_max_diameter_mm"] / 1000 - GAUGE, float(np.median(np.diff(size["depth_m"])))
    for name, limit in (("1 in", inch), ("scaled to the hole", scaled)):
        reach = sum(most >= limit for one, (most, _) in zip(matches, larger, strict=True) if one.pick.kind == BREAKOUT)
        length = spacing * int((over >= limit).sum())
        print(
            f"max diameter - gauge reaches {1000 * limit:.1f} mm ({name}) over {length:.2f} m in all, "
            f"at {reach} of {len(picked)} picked breakouts"
        )
    print(f"zones of the round wall, by its mean diameter: {len(wall.zones(Criteria.scaled(GAUGE)).zones)}")
    counts = sensitivity(image, picks)
    print(
        f"{len(counts)} sets of criteria around these: "
        + "; ".join(
            f"{what} {min(of)} to {max(of)}"
            for what, of in zip(("found", "other types", "false"), zip(*counts, strict=True), strict=True)
        )
    )
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python -m bench.accuracy.televiewer FOLDER; FOLDER must hold breakout_picks.csv")
    sys.exit(main(Path(sys.argv[1])))
