"""Measure toolfaces from files with four angles: ``python -m bench.accuracy.angles [SEED]``.

Each LAS file has a relative bearing, an azimuth of pad 1 in the horizontal plane, the inclination and the azimuth of
the hole, under one of eight namings, with and without descriptions; the hole bends, and its angles have three decimals.
The angles are made from directions in space. Thirty inclinations from 1 to 80 degrees.

    both       toolface of the samples by the file as it is read without any option, largest error, degrees
    azimuth    the same if the relative bearing is left out
    by path    the same as "azimuth", if the file has no azimuth of the hole and the survey has it
    agree      files whose angles are reported to agree, %
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np

import helibore as hb
from helibore.base.arrays import Floats

ROWS = 240
DEPTH = 100.0 + 0.1 * np.arange(ROWS)
BEND = np.linspace(-0.5, 0.5, ROWS)
INCLINATIONS = np.linspace(1.0, 80.0, 30)
NAMINGS = (
    ("RB", "P1AZ", "DEVI", "HAZI"),
    ("RB_OBMT", "P1AZ_OBMT", "DEVIM", "HAZIM"),
    ("HSRB", "AZI1", "SDEV", "IAZI"),
    ("IRBR", "IAP1", "ITLT", "IAZI"),
    ("RBR", "IAAZ", "DEV", "DAZ"),
    ("RBEI", "UAZI", "INC", "AZM"),
    ("RBGX", "AZI1", "DEVGX", "DAZGX"),
    ("IRHS", "P1AZ:1", "DHAV", "SAZIMC"),
)
DESCRIPTIONS = ("Relative bearing", "Pad 1 azimuth", "Hole deviation", "Hole azimuth")


def directions(bearing: Floats, inclination: Floats, azimuth: Floats) -> Floats:
    """Return the azimuth of a pad in the horizontal plane, from its direction in space."""
    rb, steep, away = np.radians(bearing), np.radians(inclination), np.radians(azimuth)
    tangent = np.stack([np.sin(steep) * np.cos(away), np.sin(steep) * np.sin(away), np.cos(steep)], axis=-1)
    high = np.stack([np.cos(steep) * np.cos(away), np.cos(steep) * np.sin(away), -np.sin(steep)], axis=-1)
    pad = np.cos(rb)[:, None] * high + np.sin(rb)[:, None] * np.cross(tangent, high)
    found: Floats = np.degrees(np.arctan2(pad[:, 1], pad[:, 0])) % 360
    return found


def written(path: Path, columns: dict[str, Floats], texts: dict[str, str]) -> Path:
    """Write a LAS file of angles and of two diameters."""
    angles = [f"{name}.DEG : {texts.get(name, '')}" for name in columns]
    lines = [
        "~V",
        "VERS. 2.0:",
        "WRAP. NO:",
        "~W",
        "NULL. -999.25:",
        "~C",
        "DEPT.M :",
        *angles,
        "C1.IN :",
        "C2.IN :",
        "~A",
    ]
    rows = np.stack([DEPTH, *columns.values(), *np.full((2, ROWS), 8.5)], axis=1)
    path.write_text("\n".join([*lines, *(" ".join(f"{value:.3f}" for value in row) for row in rows)]) + "\n")
    return path


def error(file: Path, path: hb.Path, bearing: Floats) -> tuple[float, bool]:
    """Return the largest error of the toolface of the first arm, degrees, and whether angles are said to agree."""
    readings = hb.open(file).readings()
    made = hb.prepare(readings, path=path).caliper
    toolface = made.toolface.reshape(ROWS, 4)[:, 0]
    away = float(np.abs((toolface - bearing + 180) % 360 - 180).max())
    return away, any(" agree" in note for note in readings.notes)


def main(seed: int) -> None:
    """Print a row for each naming."""
    rng = np.random.default_rng(seed)
    print(f"{'names':34}{'described':>10}{'both':>9}{'azimuth':>9}{'by path':>9}{'agree':>7}")
    with tempfile.TemporaryDirectory() as folder:
        for names in NAMINGS:
            for described in (False, True):
                texts = dict(zip(names, DESCRIPTIONS, strict=True)) if described else {}
                rows = []
                for number, inclination in enumerate(INCLINATIONS):
                    bearing = rng.uniform(0, 360, ROWS)
                    steep, away = inclination + BEND, (rng.uniform(0, 360) + 4 * BEND) % 360
                    columns = dict(zip(names, (bearing, directions(bearing, steep, away), steep, away), strict=True))
                    path = hb.Survey(DEPTH, steep, away).path(reference="high-side", extend=True)
                    found = []
                    for out in ((), names[:1], (names[0], names[3])):
                        kept = {name: of for name, of in columns.items() if name not in out}
                        file = written(Path(folder) / f"{number}-{len(out)}.las", kept, texts)
                        try:
                            found.append(error(file, path, bearing))
                        except hb.InputError as refused:
                            print(f"{' '.join(kept)}: {refused}")
                            found.append((np.nan, False))
                    rows.append([each for each, _ in found] + [found[0][1]])
                worst = np.max(rows, axis=0)
                shown = "".join(f"{each:9.4f}" for each in worst[:3])
                agree = 100 * np.mean([row[3] for row in rows])
                print(f"{' '.join(names):34}{'yes' if described else 'no':>10}{shown}{agree:7.0f}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("seed", type=int, nargs="?", default=1)
    main(parser.parse_args().seed)
