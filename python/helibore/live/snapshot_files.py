"""Export a live wall as files of one moment: walls, mesh, logs, images, survey, passes, events.

    main.wall       settings, samples, vertices, survey, images: hb.load opens it     for each layer with vertices
    main.las        (or main.csv) measurements of every turn, means of images         for each layer longer than a turn
    main.glb        the wall along the path; without a path, straight and vertical    unless the path is too short
    image-GR.csv    depth_m, GR[1], GR[2] ...                                         for each image
    survey.csv      depth_m, inclination_deg, azimuth_deg
    passes.csv      source, pass, number, start_utc, stop_utc, top_m, bottom_m, samples: a row for each pass
    events.csv      source, rule, count; of the first and the last event: utc, connection, line, text
    snapshot.json   number, utc, records, complete, files

Everything is copied at one moment (``frozen_copy.py``), written to the folder ``.new``, and then moved file by file.
While files are moved, ``snapshot.json`` says ``"complete": false``. A program that reads ``snapshot.json`` before and
after the other files has files of one moment if it finds ``true`` and the same number both times. If a file cannot be
written, all previous files stay.
"""

from __future__ import annotations

import csv
import io
import json
import shutil
from collections.abc import Iterable, Sequence
from pathlib import Path

from helibore.base.atomic_file import write_whole
from helibore.base.utc_time import utc
from helibore.live.frozen_copy import FrozenCopy, frozen_copy
from helibore.live.live import Live
from helibore.live.model.events import Event
from helibore.live.rules.file_names import escaped
from helibore.logs.image_means import image_means
from helibore.wall.state import WallState

MANIFEST = "snapshot.json"
Cells = Sequence[float | str | None]


def snapshot(live: Live, folder: str | Path) -> list[Path]:
    """Write the files into ``folder`` and return their paths, ``snapshot.json`` last.

    There is no mesh of a wall that the path does not cover.

    An image whose name is not allowed in a file name is left out, and an image that `SectorImage` refuses is written
    only as a table; an event reports each such image. An image with an unknown layout, with fewer than two rows or
    without values is written only as a table, too.

    Raises
    ------
    OSError
        If a file cannot be written; the files of the previous export are then unchanged. If a file cannot be moved,
        ``snapshot.json`` says ``"complete": false``.
    """
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    beside = target / ".new"
    shutil.rmtree(beside, ignore_errors=True)  # a process that was killed may have left it
    beside.mkdir()
    try:
        of = frozen_copy(live)
        for text in of.left_out:
            live.report("snapshot", text)
        _write(of, beside, live.configuration.snapshot.logs)
        return _put_in_place(beside, target, of)
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def _put_in_place(beside: Path, target: Path, of: FrozenCopy) -> list[Path]:
    """Move the files of ``beside`` to ``target``; delete the files that only the previous export used."""
    number, there = _manifest(target)
    sizes = {path.name: path.stat().st_size for path in sorted(beside.iterdir())}
    facts = {"number": number + 1, "utc": utc(of.wall_time), "records": of.records}
    _write_manifest(target, {**facts, "complete": False, "files": {**there, **sizes}})
    for name in {**there, **sizes}:
        if name in sizes:
            (beside / name).replace(target / name)
        else:
            (target / name).unlink(missing_ok=True)
    _write_manifest(target, {**facts, "complete": True, "files": sizes})
    return [*(target / name for name in sizes), target / MANIFEST]


def _manifest(target: Path) -> tuple[int, dict[str, int]]:
    """Return number and files (name: size) of the previous export, without names that are not files of this folder."""
    try:
        found = json.loads((target / MANIFEST).read_text(encoding="utf-8"))
        files = {name: int(size) for name, size in found["files"].items() if _is_own(target, name)}
        return int(found["number"]), files
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return 0, {}


def _is_own(target: Path, name: str) -> bool:
    return name == Path(name).name and name.isprintable() and not (target / name).is_dir()  # "..", "" are folders


def _write_manifest(target: Path, manifest: dict[str, object]) -> None:
    text = json.dumps(manifest, indent=1) + "\n"
    write_whole(target / MANIFEST, lambda whole: whole.write(text.encode()))


def _write(of: FrozenCopy, target: Path, logs: str) -> None:
    for name, wall in of.walls.items():
        wall.save(target / f"{escaped(name)}.wall")
        if logs != "none" and len(wall) > wall.settings.sectors:
            measured = wall.logs()
            measured.save(target / f"{escaped(name)}.{logs}", image_means(measured, wall.images))
    for name, (depth, values) in of.images.items():
        heads = ["depth_m", *(f"{name}[{number}]" for number in range(1, values.shape[1] + 1))]
        rows = ([d, *row] for d, row in zip(depth.tolist(), values.tolist(), strict=True))
        _table(target / f"image-{escaped(name)}.csv", heads, rows)
    if len(of.stations):
        _table(target / "survey.csv", ["depth_m", "inclination_deg", "azimuth_deg"], of.stations.tolist())
    if of.passes:
        heads = ["source", "pass", "number", "start_utc", "stop_utc", "top_m", "bottom_m", "samples"]
        runs = ([run.source, run.name, run.number, utc(run.start), utc(run.stop), run.top, run.bottom, run.samples]
                for run in of.passes)  # fmt: skip
        _table(target / "passes.csv", heads, runs)
    if of.events:
        place = ("utc", "connection", "line", "text")
        heads = ["source", "rule", "count", *(f"{when}_{name}" for when in ("first", "last") for name in place)]
        _table(target / "events.csv", heads, (
            [event.source, event.rule, event.count, *_place(event), *_place(event.newest)] for event in of.events
        ))  # fmt: skip
    if of.main in of.walls:
        _mesh(of.walls[of.main], of, target)


def _mesh(wall: WallState, of: FrozenCopy, target: Path) -> None:
    if len(wall) <= wall.settings.sectors + 1:
        return
    top, bottom = sorted((wall.start_depth, stop := float(wall.depth[-1])))
    if of.path is None or (of.path.start_depth <= top and of.path.stop_depth >= bottom):
        wall.surface(of.path, stop=stop).save(target / "main.glb")


def _place(event: Event) -> Cells:
    return [utc(event.wall), event.connection, event.line or None, event.text]


def _table(file: Path, heads: list[str], rows: Iterable[Cells]) -> None:
    """Write a table with all digits of its numbers; a missing number is an empty cell."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(heads)
    table.writerows([None if value != value else value for value in row] for row in rows)
    write_whole(file, lambda whole: whole.write(text.getvalue().encode()))
