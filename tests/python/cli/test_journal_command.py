"""``helibore journal``: what it prints, what it writes, and how it ends."""

from __future__ import annotations

import csv
import gzip
import shutil

import numpy as np
import pytest
from click.testing import CliRunner
from live_wires import CHANGED, FRAMES, SENT, Clock, same_bits, sent_rows, write_two_sessions

import helibore as hb
from helibore import Live
from helibore.cli import cli
from helibore.live.journal import checkpoint, journal
from helibore.live.journal.session_header import recorded_configuration
from helibore.live.rules.configuration import parse


def run(*arguments, code=0):
    result = CliRunner().invoke(cli, ["journal", *map(str, arguments)])
    assert result.exit_code == code, result.output
    return result.output


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """Two sessions of four segments and two checkpoints; one record in the last segment cannot be read."""
    path, clock = tmp_path_factory.mktemp("written") / "well.journal", Clock()
    for part in range(2):
        with Live(parse(SENT), path, clock=clock) as live:
            assert live.journal is not None
            live.journal._segment_bytes = 12_000
            for frame in FRAMES[part * 100 : part * 100 + 100]:
                clock.step(1)
                live.receive("mwd", frame)
            live.checkpoint()
            live.append_stations([float(part)], [1.0], [2.0])
            live.journal.append(0, 0, b"\0" * 23, journal.STATIONS)
        clock.step(60)
    return path


@pytest.fixture
def folder(written, tmp_path):
    """A copy of the journal."""
    return shutil.copytree(written, tmp_path / "well.journal")


def test_list_and_verify(folder):
    lines = run("list", folder).splitlines()
    segments, checkpoints = journal.paths(folder), checkpoint.paths(folder)
    assert [line.partition(":")[0] for line in lines] == [
        *(path.name for path in segments), "session 1", "session 2", *(path.name for path in checkpoints)
    ]  # fmt: skip
    assert lines[-3] == "session 2: 2023-11-14T22:16:00.000Z"
    assert lines[0].startswith(f"000001.hbj: {segments[0].stat().st_size:,} bytes, ")
    records = sum(len(segment.records) for segment in journal.segments(folder))
    assert run("verify", folder) == f"{folder}: {records} records are intact\n"


def test_verify_names_each_damage_and_ends_with_2(folder):
    found = list(journal.segments(folder))
    text = bytearray(found[1].text)
    text[int(found[1].records["offset"][3])] ^= 1
    found[1].path.write_bytes(text)
    newest = checkpoint.paths(folder)[-1]
    newest.write_bytes(newest.read_bytes()[:-30])
    start = int(found[1].records["offset"][3]) - 48
    stop = int(found[1].records["offset"][4]) - 48
    records = sum(len(segment.records) for segment in found)
    assert run("verify", folder, code=2).splitlines() == [
        f"000002.hbj: bytes {start} to {stop} hold no intact record ({stop - start} bytes lost)",
        f"{newest}: damaged: BadZipFile: File is not a zip file",
        f"helibore: {folder}: 2 places are damaged, {records - 1} records are intact",
    ]
    journal.paths(folder)[2].unlink()
    assert "are missing before this file" in run("verify", folder, code=2)


def test_replay_with_a_corrected_configuration(folder, tmp_path):
    corrected = tmp_path / "corrected.toml"
    corrected.write_text(
        SENT.replace('order = ["toolface", "depth"', 'toolface_offset = 90.0, order = ["toolface", "depth"')
    )
    before = run("replay", folder)
    vertices = len(Live.replay(folder).wall)
    assert before.splitlines()[-1] == f"600 samples drawn, 0 refused, 0 in no layer; {vertices:,} vertices"
    assert "aside: set aside what the host pushed of record" in before
    run("replay", folder, "-c", corrected, "-o", tmp_path / "out")
    toolface = hb.load(tmp_path / "out" / "main.wall").samples.toolface
    expected = (sent_rows()[:, 0] + 90.0) % 360
    assert np.allclose(np.sort(toolface), np.sort(expected))


def test_the_counts_of_samples_add_up(folder, tmp_path):
    """Samples before the start of the wall by more than their reach, 1 m, are in no layer."""
    ranged = SENT.replace('order = ["toolface"', 'radius_range = [0.05, 0.12], order = ["toolface"')
    (tmp_path / "c.toml").write_text(ranged.replace("start_depth = 100.0", "start_depth = 102.0"))
    _, depth, radius = sent_rows().T
    refused = radius > 0.12
    drawn = ~refused & (depth >= 101.0)
    counts = f"{drawn.sum()} samples drawn, {refused.sum()} refused, {(~refused & ~drawn).sum()} in no layer; "
    assert run("replay", folder, "-c", tmp_path / "c.toml").splitlines()[-1].startswith(counts)
    assert min(drawn.sum(), refused.sum(), (~refused & ~drawn).sum()) > 20


def test_an_export_may_have_an_ending_in_capitals(folder, tmp_path):
    run("export", folder, "-o", tmp_path / "small.csv")
    run("export", folder, "-o", tmp_path / "LARGE.CSV")
    assert (tmp_path / "LARGE.CSV").read_bytes() == (tmp_path / "small.csv").read_bytes()


def test_a_recorded_configuration_that_cannot_be_read_stops_no_replay_with_another(folder, tmp_path, monkeypatch):
    corrected = tmp_path / "corrected.toml"
    corrected.write_text(SENT)
    expected = run("replay", folder, "-c", corrected)

    def refuse(_):
        raise AssertionError("a recorded configuration was read")

    monkeypatch.setattr("helibore.live.journal.session_header.parse", refuse)
    assert run("replay", folder, "-c", corrected) == expected
    assert run("export", folder, "-c", corrected, "-o", tmp_path / "x.wits").endswith(" bytes\n")


def test_quarantine_writes_what_was_set_aside(folder, tmp_path):
    damaged = list(journal.segments(folder))[1]
    text = bytearray(damaged.text)
    text[int(damaged.records["offset"][3])] ^= 1
    damaged.path.write_bytes(text)
    (folder / "000001-5000.torn").write_bytes(b"torn")
    output = run("quarantine", folder, "-o", tmp_path / "out").splitlines()
    assert len(output) == 5
    assert output[0].endswith("helibore stations, 23 bytes: what the host pushed: ValueError: buffer size must be a "
                              "multiple of element size")  # fmt: skip
    assert output[-2:] == ["000001-5000.torn: 4 bytes were cut off at a restart",
                           f"{folder}: 4 items set aside; written to {tmp_path / 'out'}"]  # fmt: skip
    contents = sorted(path.read_bytes() for path in (tmp_path / "out").iterdir())
    assert contents[:2] == [b"\0" * 23] * 2
    assert contents[-1] == b"torn" or b"torn" in contents


def test_export_csv_and_wits(folder, tmp_path):
    assert run("export", folder, "-o", tmp_path / "all.csv") == f"{tmp_path / 'all.csv'}: {200 * 10 + 6:,} rows\n"
    rows = list(csv.DictReader((tmp_path / "all.csv").read_text().splitlines()))
    radii = [float(row["value"]) for row in rows if row["name"] in ("5012", "5015", "5018")]
    assert np.allclose(radii, sent_rows()[:, 2] * 1000)
    assert rows[1] == {"utc": "2023-11-14T22:13:21.000Z", "source": "mwd", "connection": "1", "line": "3",
                       "name": "5010", "value": FRAMES[0].split(b"\r\n")[2][4:].decode()}  # fmt: skip
    assert [row["value"] for row in rows if row["name"] == "inclination_deg"] == ["1", "1"]
    run("export", folder, "-o", tmp_path / "mwd.wits")
    assert (tmp_path / "mwd.wits").read_bytes() == b"".join(FRAMES)


def test_archive_moves_only_what_both_checkpoints_contain(folder):
    whole = Live.replay(folder)
    limit = min(map(checkpoint.position, checkpoint.paths(folder)))
    old = [segment.path.name for segment in journal.segments(folder) if segment.records["sequence"][-1] < limit]
    before = {path.name: path.read_bytes() for path in journal.paths(folder)}
    output = run("archive", folder)
    moved = sorted(path.name[:-3] for path in (folder / "archive").iterdir())
    assert output == f"{len(moved)} segments moved to {folder / 'archive'}\n"
    assert 0 < len(moved) < len(before)
    assert moved == old
    assert all(gzip.decompress((folder / "archive" / f"{name}.gz").read_bytes()) == before[name] for name in moved)
    assert same_bits(Live.replay(folder).wall, whole.wall)
    assert run("archive", folder) == f"{folder}: no segment is old\n"
    with Live(parse(SENT), folder) as again:
        assert same_bits(again.wall, whole.wall)
        assert again.model.next_sequence == whole.model.next_sequence + 1


def test_archive_remove_leaves_a_journal_that_goes_on_and_a_replay_reports_what_is_missing(folder):
    whole = Live.replay(folder)
    assert run("archive", folder, "--remove") == "3 segments removed\n"
    with Live(parse(SENT), folder) as again:
        assert same_bits(again.wall, whole.wall)
    assert "journal: segments 1 to 3 are missing" in run("replay", folder)


def test_a_restart_goes_on_after_the_segments_of_the_first_configuration_are_removed(tmp_path):
    path, clock = tmp_path / "well.journal", Clock()
    write_two_sessions(path, clock)
    whole = Live.replay(path)
    run("archive", path, "--remove")
    assert recorded_configuration(path).text == CHANGED
    for _ in range(2):
        with Live(parse(CHANGED), path, clock=clock) as again:
            assert same_bits(again.wall, whole.wall)
            assert again.model.numbers == {"mwd": 1, "alpha": 2}
            again.checkpoint()


@pytest.mark.parametrize(
    "arguments",
    [
        ("export", "FOLDER", "-o", "x.txt"),
        ("export", "FOLDER", "-o", "x.csv", "--source", "rig"),
        ("list", "EMPTY"),
        ("verify", "EMPTY"),
        ("replay", "EMPTY"),
        ("archive", "EMPTY"),
        ("quarantine", "EMPTY"),
    ],
)
def test_errors_are_one_line(folder, tmp_path, arguments, golden):
    names = {"FOLDER": str(folder), "EMPTY": str(tmp_path)}
    golden(run(*(names.get(one, one) for one in arguments), code=2))


def test_archiving_needs_two_good_checkpoints(folder):
    older, newest = checkpoint.paths(folder)
    newest.write_bytes(b"")
    expected = f"helibore: {newest}: damaged: BadZipFile: File is not a zip file\n"
    assert run("archive", folder, code=2) == expected
    newest.unlink()
    assert run("archive", folder, code=2) == f"helibore: {folder}: has 1 of the 2 checkpoints that archiving needs\n"
    assert journal.paths(folder)[0].name == "000001.hbj"
    assert older.exists()


@pytest.mark.parametrize("verb", ["list", "verify", "replay", "quarantine", "export", "archive"])
def test_help_has_an_example(verb):
    assert f"  helibore journal {verb} well-7.journal" in run(verb, "--help")
