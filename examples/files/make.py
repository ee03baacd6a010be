"""Makes the files of this folder from a simulated hole: python examples/files/make.py

helibore simulate writes caliper.csv, survey.csv and gamma.csv. A wireline caliper of two pairs of arms, pulled through
a longer part of the hole, gives xy_caliper.csv. Each file in flaws is caliper.csv with one flaw of a real log; the role
map beside it states what the file does not.
"""

import subprocess
import sys
from pathlib import Path

import numpy as np

from helibore.simulation import Hole

HERE = Path(__file__).parent
FOOT, INCH = 0.3048, 0.0254


def write(name: str, header: str, formats: str, *columns: np.ndarray) -> None:
    """Write columns as CSV."""
    np.savetxt(HERE / name, np.column_stack(columns), formats.split(), ",", header=header, comments="")


def xy_caliper() -> None:
    """Two pairs of arms, quantized as real ones, every half foot upwards; the tool turns once in 30 m."""
    hole = Hole.example(2000.0, 2050.0)
    depth = np.arange(2050.0, 2000.0, -0.1524)
    bearing = (40 + 12 * (2050 - depth)) % 360
    x, y = (hole.radius(depth, bearing + arm) + hole.radius(depth, bearing + arm + 180) for arm in (0, 90))
    inclination = np.interp(depth, [2000, 2050], [25, 27])
    quantized = (np.round(size / INCH / 0.02) * 0.02 for size in (x, y))
    write("xy_caliper.csv", "MD_ft,RB_deg,CALX_in,CALY_in,DEVI_deg", "%.2f %.1f %.2f %.2f %.2f",
          depth / FOOT, bearing, *quantized, inclination)  # fmt: skip


def las() -> None:
    """One arm that turns with the string, every 2.5 cm downwards, as LAS 2."""
    hole = Hole.example(2000.0, 2050.0)
    depth = np.arange(2000.0, 2050.0, 0.025)
    toolface = (np.arange(depth.size) * 47.3) % 360
    radius = 1000 * hole.radius(depth, toolface)
    curves = (("DEPT", "M", "Measured depth"), ("TF", "DEG", "Tool face"), ("RAD", "MM", "Radius"))
    lines = ["~Version", "VERS. 2.0 : CWLS LAS 2.0", "WRAP. NO : one line a row", "~Well", "STRT.M 2000.000 :"]
    lines += ["STOP.M 2049.975 :", "STEP.M 0.025 :", "NULL. -999.25 :", "WELL. Example : name", "~Curve"]
    lines += [f"{name}.{unit} : {text}" for name, unit, text in curves]
    rows = zip(depth, toolface, radius, strict=True)
    lines += ["~ASCII", *(f"{at:9.3f} {angle:6.1f} {reading:7.2f}" for at, angle, reading in rows)]
    (HERE / "turning_arm.las").write_text("\n".join(lines) + "\n")


def flaws() -> None:
    """One flaw a file."""
    _, depth, toolface, radius = np.loadtxt(HERE / "caliper.csv", delimiter=",", skiprows=1, max_rows=400).T
    write("flaws/no_units.csv", "MD,TF,RAD", "%.4f %.6f %.5f", depth / FOOT, np.radians(toolface), radius / INCH)
    write("flaws/own_names.csv", "Q1,Q2,Q3", "%.5f %.4f %.6f", depth, toolface, radius)
    write(
        "flaws/arm_angle.csv", "depth_m,toolface_deg,radius_m", "%.5f %.4f %.6f", depth, (toolface - 135) % 360, radius
    )
    write("flaws/sensor_offset.csv", "depth_m,toolface_deg,radius_m", "%.5f %.4f %.6f", depth + 14.2, toolface, radius)
    slack = depth + 3 * np.sin(depth)
    write("flaws/two_depths.csv", "MD_m,DBOT_m,toolface_deg,radius_m", "%.5f %.5f %.4f %.6f",
          slack, depth, toolface, radius)  # fmt: skip
    write("flaws/wrong_unit.csv", "depth_m,toolface_deg,radius_in", "%.5f %.4f %.3f", depth, toolface, radius * 1000)


if __name__ == "__main__":
    hole = ("simulate", str(HERE), "--to", "2010m", "--sample-rate", "1", "-q")
    subprocess.run([sys.executable, "-m", "helibore", *hole], check=True)
    for unneeded in ("truth.csv", "hole.json"):
        (HERE / unneeded).unlink()
    xy_caliper()
    las()
    flaws()
