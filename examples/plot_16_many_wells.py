"""
Many wells
==========

``hb.reprocess`` makes the wells of a manifest on Dask: here in threads of this process, elsewhere on your cluster. A
second run makes only what has changed.
"""

import tempfile
from pathlib import Path

import pyarrow
from distributed import Client
from pyarrow import parquet

import helibore as hb
from helibore.simulation import Hole, Tool, simulate

field = Path(tempfile.mkdtemp())
manifest = 'output = "walls"\noutputs = ["archive", "logs"]\n[defaults.wall]\nbit_diameter = 0.216\n'
for number in range(3):
    measured = simulate(Hole.example(stop=2004.0, seed=number), Tool(), samples=6000, seed=number)
    columns = {"depth_m": measured.depth, "toolface_deg": measured.toolface, "radius_m": measured.radius}
    parquet.write_table(pyarrow.table(columns), field / f"{number}.parquet")
    manifest += f'[[well]]\nname = "W{number}"\ncaliper = "{number}.parquet"\n'
(field / "manifest.toml").write_text(manifest)

with Client(processes=False, dashboard_address=None) as client:  # or Client("tls://scheduler:8786")
    for _ in range(2):
        report = hb.reprocess(field / "manifest.toml", client)
        print(report.sentence(), report.failed)

for row in parquet.read_table(field / "walls/catalogue.parquet").to_pylist():
    print(row["well"], row["TOP"], row["BOTTOM"], row["DEQ"])
figure = hb.plot.overview(hb.load(field / "walls/wells/W2/W2.wall"), title="W2 of three wells")
