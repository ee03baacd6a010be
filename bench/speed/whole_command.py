"""Compare the whole command, from process start to GLB on disk, with the shortest NumPy and trimesh program for it.

    python -m bench.speed.whole_command [--samples 2400000] [--rounds 5]

Ours    `helibore reconstruct samples.npz --survey survey.csv -o ours.glb`: load, rebuild, place, save, summary
Peer    one Python process that imports NumPy and trimesh, loads the same arrays and the finished mesh, exports the mesh

The files are checked before anything is timed. The two commands run in turn, each in a fresh process with its output in
a pipe. The bar is 2 x the peer's time, with 2.4 M samples and 256 k quads.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import trimesh

import helibore as hb
from helibore.simulation.tool import Hole, simulate

SECTORS, PITCH = 64, 0.1
PEER = """
import sys
import numpy as np
import trimesh
samples = np.load(sys.argv[1])
columns = [samples[name] for name in ("time", "depth", "toolface", "radius")]
mesh = np.load(sys.argv[2])
wall = trimesh.Trimesh(mesh["vertices"], mesh["faces"], vertex_colors=mesh["colors"], process=False)
with open(sys.argv[3], "wb") as file:
    file.write(trimesh.Scene(wall).export(file_type="glb"))
"""


def prepare(folder: Path, samples: int, length: float) -> list[list[str]]:
    """Write samples, survey and finished mesh to ``folder``; return our command and the peer's."""
    hole = Hole.example(2000.0, 2000.0 + length)
    run = simulate(hole, samples=samples)
    np.savez(folder / "samples.npz", time=run.time, depth=run.depth, toolface=run.toolface, radius=run.radius)
    stations = np.column_stack([run.station_depth, run.inclination, run.azimuth])
    np.savetxt(folder / "survey.csv", stations, delimiter=",", header="md_m,incl_deg,azim_deg", comments="")
    ours = [
        sys.executable, "-m", "helibore", "reconstruct", str(folder / "samples.npz"),
        "--survey", str(folder / "survey.csv"), "-o", str(folder / "ours.glb"),
        "--bit-diameter", f"{hole.bit_diameter}m", "--sectors", str(SECTORS), "--pitch", f"{PITCH}m",
    ]  # fmt: skip
    subprocess.run(ours, check=True, capture_output=True)
    finished = trimesh.load_scene(folder / "ours.glb").to_geometry()
    colors = finished.visual.vertex_colors
    np.savez(folder / "mesh.npz", vertices=finished.vertices, faces=finished.faces, colors=colors)
    peer = [sys.executable, "-c", PEER, *(str(folder / name) for name in ("samples.npz", "mesh.npz", "peer.glb"))]
    subprocess.run(peer, check=True, capture_output=True)
    check(folder, run.depth.size)
    return [ours, peer]


def check(folder: Path, samples: int) -> None:
    """Check that both GLB files hold the wall that the library rebuilds from these samples."""
    loaded = np.load(folder / "samples.npz")
    caliper = hb.Caliper(loaded["depth"], loaded["toolface"], loaded["radius"], loaded["time"])
    assert len(caliper) == samples
    wall = hb.reconstruct(caliper, bit_diameter=0.216, sectors=SECTORS, pitch=PITCH, estimator="inverse-distance")
    stations = np.loadtxt(folder / "survey.csv", delimiter=",", skiprows=1).T
    surface = wall.surface(hb.Survey(*stations).path())
    triangles = surface.vertices[surface.triangles()]
    area = 0.5 * np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1)
    for name in ("ours.glb", "peer.glb"):
        mesh = trimesh.load_scene(folder / name).to_geometry()
        assert len(mesh.faces) == 2 * len(surface.quads), name
        assert abs(mesh.area / area.sum() - 1) < 1e-4, name  # float32 in the file


def measure(commands: list[list[str]], rounds: int) -> list[float]:
    """Return the median seconds of each command, run in turn."""
    seconds: list[list[float]] = [[] for _ in commands]
    for _ in range(rounds):
        for command, times in zip(commands, seconds, strict=True):
            start = time.perf_counter()
            subprocess.run(command, check=True, capture_output=True)
            times.append(time.perf_counter() - start)
    return [statistics.median(times) for times in seconds]


def main() -> None:
    """Run the comparison; print its result as a line and as JSON."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--samples", type=int, default=2_400_000)
    parser.add_argument("--length", type=float, default=400.0, help="metres of hole; each has 640 quads")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        ours, peer = measure(prepare(Path(folder), options.samples, options.length), options.rounds)
    quads = int(options.length / PITCH * SECTORS)
    print(f"{options.samples:,} samples, about {quads:,} quads: ours {ours:.2f} s, NumPy and trimesh {peer:.2f} s, "
          f"{ours / peer:.2f} x (bar 2 x)")  # fmt: skip
    print(
        json.dumps({"samples": options.samples, "quads": quads, "ours_s": ours, "peer_s": peer, "ratio": ours / peer})
    )


if __name__ == "__main__":
    main()
