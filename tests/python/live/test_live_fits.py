"""``estimator = "automatic"`` of a live wall: fits at 2, 5, 10, 20 and 40 m, each a record of the journal.

bytes, in any pieces, with kills     ->  the same fits, and the bits of one batch with the settings that they found
"""

from __future__ import annotations

import contextlib
import json
import random
import shutil
import signal
import subprocess
import sys
import threading

import numpy as np
import pytest
from live_servers import Running, configured, until
from live_wires import WALL, Clock
from patience import PATIENCE

import helibore as hb
from helibore import Live
from helibore.base.errors import InputError
from helibore.live.journal import checkpoint, journal
from helibore.live.journal.journal import Journal, JournalFullError, segments
from helibore.live.journal.session_header import headers
from helibore.live.model import fits
from helibore.live.rules.configuration import Configuration, parse
from helibore.live.wire import wits
from helibore.samples.caliper import Caliper
from helibore.settings import wall_settings

AUTOMATIC = WALL.replace("sectors = 16", 'sectors = 8\nestimator = "automatic"')
SENT = (
    AUTOMATIC + '[source.mwd]\naddress = "host"\nunits = "metric"\n'
    'caliper = { first = "5010", groups = 3, order = ["toolface", "depth", "radius"] }\n'
)
COLUMNS = ("radius", "nearest", "support", "iterations", "sigma")


def oval(stop, step=0.08, first=100.0, seed=5):
    """Rows (toolface, depth, radius in mm) of one arm that turns slowly in an oval hole."""
    depth = np.arange(first, stop, step)
    toolface = (depth - 100.0) * 117.0 % 360
    radius = 110 + 4 * np.cos(2 * np.radians(toolface - 40)) + np.random.default_rng(seed).normal(0, 0.2, depth.size)
    return np.column_stack([toolface, depth, radius]).round(4)


def framed(rows):
    return [
        wits.frame([(5010 + k, f"{value:.4f}") for k, value in enumerate(three.ravel())])
        for three in np.split(rows[: len(rows) // 3 * 3], len(rows) // 3)
    ]


STREAM = b"".join(framed(oval(110.5)))
UNSTATED = SENT.replace('estimator = "automatic"\n', "")


def found(live, layer="main"):
    """Length, settings and text of each fit of a layer, as the events and the wall have them."""
    said = [event.text for event in live.model.events.latest if event.rule == "estimator"]
    return live.layers[layer].settings, said


def bits(wall):
    return {name: getattr(wall, name).tobytes() for name in COLUMNS}


def is_its_batch(wall):
    again = hb.reconstruct(wall.samples, threads=1, **vars(wall.settings))
    return bits(again) == bits(wall)


@pytest.fixture
def asked(monkeypatch):
    """The samples of which settings are chosen, in order; the same samples are fitted once in all of this file."""
    seen = []
    real = fits.choose

    def choose(caliper, settings):
        key = b"".join(column.tobytes() for column in (caliper.depth, caliper.toolface, caliper.radius)), settings
        seen.append(len(caliper.depth))
        if key not in KNOWN:
            KNOWN[key] = real(caliper, settings)
        return KNOWN[key]

    monkeypatch.setattr(fits, "choose", choose)
    return seen


KNOWN: dict = {}


@pytest.fixture
def by_default(monkeypatch):
    """The default that users have; the other tests state an estimator, or have inverse distance."""
    monkeypatch.setattr(wall_settings, "USUAL", "automatic")


def in_pieces(cuts, folder=None, text=SENT):
    """The wall of STREAM cut at these places, and what was recorded of its fits."""
    with Live(parse(text), folder, clock=Clock()) as live:
        for start, stop in zip([0, *cuts], [*cuts, len(STREAM)], strict=True):
            live.receive("mwd", STREAM[start:stop])
    return live


def test_fits_and_wall_are_the_same_however_the_bytes_are_cut(asked):
    draw = random.Random(8)
    alone = in_pieces(range(1, len(STREAM)))
    assert alone.model.events.counts["", "estimator"] == 3
    assert alone.wall.settings.estimator == "near-and-far"
    assert is_its_batch(alone.wall)
    frames = [len(part) for part in framed(oval(110.5))]
    for cuts in (
        np.cumsum(frames)[:-1].tolist(),
        *(sorted(draw.sample(range(1, len(STREAM)), n)) for n in (1, 9, 200)),
    ):
        live = in_pieces(cuts)
        assert live.wall.settings == alone.wall.settings
        assert bits(live.wall) == bits(alone.wall)
    assert set(asked) == {26, 64, 126}, "the samples up to the one with which 2, 5 and 10 m are reached"


def test_a_sensor_that_is_stuck_is_no_part_of_a_fit(monkeypatch):
    """A value that stays counted as noise of all sensors, and the wall was smooth over what the others measured."""
    fitted = []

    def choose(caliper, _):
        fitted.append(caliper.radius.tobytes())
        raise ValueError("not now")

    monkeypatch.setattr(fits, "choose", choose)
    text = AUTOMATIC + '[source.mwd]\naddress = "host"\nunits = "metric"\n[source.mwd.caliper]\n'
    text += 'depth = ["5009"]\ntoolface = ["5010"]\nradius = ["5020", "5021", "5022"]\n'
    text += "toolface_offset = [0.0, 120.0, 240.0]\n"
    rows = np.stack([oval(106.0, step=0.01, seed=seed) for seed in range(3)])
    for value in (254.0, -999.25):
        rows[2, 220:, 2] = value  # after 2.2 m
        clock = Clock()
        with Live(parse(text), clock=clock) as live:
            for of in rows.transpose(1, 0, 2):
                clock.step(1)
                radii = [(5020 + k, f"{radius:.4f}") for k, radius in enumerate(of[:, 2])]
                live.receive("mwd", wits.frame([(5009, f"{of[0, 1]:.2f}"), (5010, f"{of[0, 0]:.4f}"), *radii]))
    assert len(fitted) == 4, "at 2 and 5 m, twice"
    assert fitted[:2] == fitted[2:]


def begun_with(folder):
    """What the journal states of its walls."""
    [header, *_] = [header for segment in segments(folder) for _, header in headers(segment)]
    return json.loads(header["meaning"])["wall"]


@pytest.mark.usefixtures("asked", "by_default")
def test_a_wall_without_an_estimator_is_automatic_at_any_split_and_its_journal_says_so(tmp_path):
    stated = in_pieces(range(1, len(STREAM), 100))
    assert stated.wall.settings.estimator == "near-and-far"
    draw = random.Random(9)
    for name in ("a", "b"):
        cuts = sorted(draw.sample(range(1, len(STREAM)), 200))
        live = in_pieces(cuts, tmp_path / name, UNSTATED)
        assert begun_with(tmp_path / name)["estimator"] == "automatic"
        assert live.wall.settings == stated.wall.settings
        assert bits(live.wall) == bits(stated.wall) == bits(Live.replay(tmp_path / name).wall)
    with Live(parse(SENT), tmp_path / "a") as again:  # what was the default may be stated
        assert bits(again.wall) == bits(stated.wall)


@pytest.mark.usefixtures("by_default")
def test_a_setting_of_inverse_distance_states_it(tmp_path):
    live = in_pieces([], tmp_path / "j", UNSTATED.replace("[wall]", "[wall]\nangular_scale = 4.0"))
    assert begun_with(tmp_path / "j")["estimator"] == live.wall.settings.estimator == "inverse-distance"
    assert not live.model.fits


@pytest.fixture
def of_before(tmp_path, monkeypatch):
    """The journal, with a checkpoint, of a version with another default: half of STREAM, in segments of 2 m."""
    with monkeypatch.context() as before:
        before.setattr(Configuration, "resolved", lambda self: self)
        with Live(parse(UNSTATED), tmp_path / "old", clock=Clock()) as live:
            live.journal._segment_bytes = 2_000
            for start in range(0, len(STREAM) // 2, 50):
                live.receive("mwd", STREAM[start : start + 50])
            live.checkpoint()
    assert "estimator" not in begun_with(tmp_path / "old")
    return tmp_path / "old"


def goes_on(folder, text=UNSTATED):
    """The wall of the whole STREAM, after the journal in ``folder`` was continued to its end."""
    with Live(parse(text), folder, clock=Clock()) as live:
        live.receive("mwd", STREAM[live.model.readers[1].total("bytes") :])
    return live


@pytest.mark.usefixtures("by_default")
@pytest.mark.parametrize("lost", ["nothing", "checkpoint", "segments"])
@pytest.mark.parametrize("text", [UNSTATED, UNSTATED + "silence = 9.0\n[passes]\non_bottom = 0.7\n"])
def test_a_journal_of_before_goes_on_by_inverse_distance(of_before, lost, text):
    if lost == "checkpoint":
        checkpoint.paths(of_before)[0].unlink()
    if lost == "segments":  # as `[journal] old = "remove"` does
        assert len(journal.paths(of_before)) > 2
        for path in journal.paths(of_before)[:-1]:
            path.unlink()
    live = goes_on(of_before, text)
    plain = in_pieces([], text=UNSTATED.replace("[wall]", '[wall]\nestimator = "inverse-distance"'))
    assert live.wall.sample_count == len(oval(110.5)) // 3 * 3
    assert not live.model.fits
    assert bits(live.wall) == bits(plain.wall)
    assert "estimator" not in live.configuration.wall
    with Live(parse(text), of_before) as again:
        assert bits(again.wall) == bits(plain.wall)


@pytest.mark.usefixtures("by_default")
def test_a_journal_of_before_takes_another_estimator_by_a_replay_only(of_before):
    with pytest.raises(InputError, match=r'wall.estimator = "automatic", was not set'):
        Live(parse(SENT), of_before)
    goes_on(of_before)
    assert Live.replay(of_before).wall.settings.estimator == "inverse-distance"
    assert Live.replay(of_before, parse(UNSTATED)).wall.settings.estimator == "near-and-far"


@pytest.mark.usefixtures("asked")
def test_a_journal_that_began_with_automatic_keeps_it_where_another_default_applies(tmp_path, monkeypatch):
    with monkeypatch.context() as now:
        now.setattr(wall_settings, "USUAL", "automatic")
        in_pieces([], tmp_path / "j", UNSTATED)
    text = UNSTATED.replace("bit_diameter = 0.216", "bit_diameter = 0.2159")
    assert text != UNSTATED
    with Live(parse(text), tmp_path / "j") as live:
        assert live.configuration.wall["estimator"] == "automatic"
        assert live.wall.settings.estimator == "near-and-far"


def test_a_fit_of_samples_as_they_arrive_is_that_of_their_batch_in_any_order(monkeypatch):
    real, asked = fits.choose, []

    def choose(caliper, settings):
        asked.append((caliper, settings))
        return real(caliper, settings)

    monkeypatch.setattr(fits, "choose", choose)
    rows = oval(106.0, 0.01)
    rows[:, 1] = np.floor(rows[:, 1] / 0.12) * 0.12  # twelve at each depth
    live = Live(parse(SENT), clock=Clock())
    live.receive("mwd", b"".join(framed(rows)))
    ((arrived, settings),) = asked
    order = np.random.default_rng(1).permutation(len(arrived))
    columns = (getattr(arrived, name)[order] for name in ("depth", "toolface", "radius", "time"))
    assert real(Caliper(*columns), settings).settings == live.wall.settings


def test_a_length_that_is_passed_before_its_fit_is_made_is_fitted_no_more(asked):
    live = in_pieces([])
    assert asked == [126]
    assert [event.text[:34] for event in live.poll().events] == ["layer main: from its first 10 m: k"]


@pytest.fixture(scope="module")
def long_run(tmp_path_factory):
    """A journal in short segments of 42 m of hole, and its wall; a checkpoint after each."""
    folder = tmp_path_factory.mktemp("long") / "j"
    clock = Clock()
    with Live(parse(SENT), folder, clock=clock) as live:
        live.journal._segment_bytes = 12_000
        for part in framed(oval(142.0, 0.1)):
            clock.step(1)
            live.receive("mwd", part)
            if live.checkpoint_due:
                live.checkpoint()
    return folder, live


def recorded(folder):
    """The fits in a journal, in order."""
    return [
        json.loads(segment.payload(row))
        for segment in segments(folder)
        for row in np.flatnonzero(segment.records["kind"] == journal.FITTED)
    ]


def test_a_wall_is_fitted_at_2_5_10_20_and_40_m_and_says_what_was_found(long_run):
    folder, live = long_run
    made = recorded(folder)
    assert [(fit["layer"], fit["length"]) for fit in made] == [("main", length) for length in (2, 5, 10, 20, 40)]
    last = live.model.events.latest[-1]
    assert (last.rule, last.count, last.newest.text) == (
        "estimator", 5, f"layer main: from its first 40 m: {made[-1]['text']}"
    )  # fmt: skip
    assert "kriging with near and far neighbours: expected error" in last.newest.text
    assert live.wall.settings.covariance == tuple(made[-1]["settings"]["covariance"])
    assert is_its_batch(live.wall)


def test_after_2_m_a_narrow_slot_has_its_depth_and_spikes_are_left_out():
    """By inverse distance the slot had 12 of 20 mm up to 5 m, and with spikes up to 40."""
    draw, number = np.random.default_rng(9931), np.arange(250)
    toolface = 678.0 * number % 360
    slot = 20.0 * np.sqrt(np.clip(1 - (((toolface - 205 + 180) % 360 - 180) / 35) ** 2, 0, None))
    spikes = np.where(draw.random(250) < 0.05, draw.uniform(-30, 50, 250), 0.0)
    radius = 108.5 + np.where(number > 80, slot, 0.0) + draw.normal(0, 0.5, 250) + spikes
    live = Live(parse(SENT.replace("sectors = 8", "sectors = 64")), clock=Clock())
    live.receive("mwd", b"".join(framed(np.column_stack([toolface, 100 + 0.01 * number, radius]).round(4))))
    assert live.wall.settings.robust
    (zone,) = live.wall.zones().zones
    assert (zone.kind, zone.measure) == ("key seat", pytest.approx(0.02, abs=0.004))
    assert zone.confidence > 0.9


def test_a_replay_has_the_fits_of_the_journal_and_makes_none(long_run, asked):
    folder, live = long_run
    again = Live.replay(folder)
    assert found(again) == found(live)
    assert bits(again.wall) == bits(live.wall)
    assert asked == []


def test_a_restart_from_any_checkpoint_has_the_bits_of_the_whole_journal(long_run, asked, tmp_path):
    folder, live = long_run
    kept = checkpoint.paths(folder)
    assert len(kept) == 2
    for left_out in (0, 1):
        shutil.copytree(folder, tmp_path / str(left_out))
        for path in checkpoint.paths(tmp_path / str(left_out))[2 - left_out :]:
            path.unlink()
        with Live(parse(SENT), tmp_path / str(left_out)) as again:
            assert again.model.events.counts["", "checkpoint"] == 0, "the checkpoint was not used"
            assert again.wall.settings == live.wall.settings
            assert bits(again.wall) == bits(live.wall)
    assert asked == []


def test_a_replay_with_another_configuration_fits_what_is_due_at_its_end(long_run, asked):
    folder, live = long_run
    again = Live.replay(folder, parse(SENT))
    assert asked == [401]
    assert again.wall.settings == live.wall.settings
    assert bits(again.wall) == bits(live.wall)
    plain = Live.replay(folder, parse(SENT.replace('"automatic"', '"inverse-distance"')))
    assert plain.wall.settings.estimator == "inverse-distance"
    assert len(asked) == 1


KILLED = """
import os, signal, sys
from helibore import Live
from helibore.live.journal import journal
from helibore.live.rules.configuration import parse
append = journal.Journal.append
def dies(self, source, connection, payload, kind=journal.BYTES):
    at_five = kind == journal.FITTED and b'"length": 5' in payload
    if at_five and sys.argv[4] == "before":
        os.kill(os.getpid(), signal.SIGKILL)
    found = append(self, source, connection, payload, kind)
    if at_five and sys.argv[4] == "after":
        os.kill(os.getpid(), signal.SIGKILL)
    return found
journal.Journal.append = dies
with Live(parse(sys.argv[3]), sys.argv[1]) as live, open(sys.argv[2], "rb") as stream:
    print("open", flush=True)
    stream.seek(live.model.readers[1].total("bytes"))
    while part := stream.read(61):
        live.receive("mwd", part)
    sys.stdin.read()
"""


@pytest.mark.usefixtures("asked")
@pytest.mark.parametrize("text", [SENT, UNSTATED])
@pytest.mark.parametrize("when", ["before", "after"])
def test_a_wall_killed_beside_the_record_of_its_fit_goes_on_as_if_it_were_not(tmp_path, when, text):
    (tmp_path / "stream").write_bytes(STREAM)
    arguments = [sys.executable, "-c", KILLED, tmp_path / "j", tmp_path / "stream", text, when]
    killed = subprocess.run(arguments, check=False, stdout=subprocess.DEVNULL)
    assert killed.returncode == -signal.SIGKILL
    assert [fit["length"] for fit in recorded(tmp_path / "j")] == ([2] if when == "before" else [2, 5])
    live, whole = goes_on(tmp_path / "j", text), in_pieces([])
    assert [fit["length"] for fit in recorded(tmp_path / "j")] == [2, 5, 10]
    assert live.wall.settings == whole.wall.settings
    assert bits(live.wall) == bits(whole.wall) == bits(Live.replay(tmp_path / "j").wall)


@pytest.mark.usefixtures("asked")
def test_a_wall_killed_again_and_again_has_the_fits_and_bits_of_one_that_was_not(tmp_path):
    draw = random.Random(4)
    (tmp_path / "stream").write_bytes(STREAM)
    arguments = [sys.executable, "-c", KILLED, tmp_path / "j", tmp_path / "stream", SENT, "never"]
    for _ in range(3):
        with subprocess.Popen(arguments, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as writer:
            assert writer.stdout is not None
            writer.stdout.readline()  # a fit that was due is made
            with contextlib.suppress(subprocess.TimeoutExpired):
                writer.wait(draw.uniform(0.0, 0.4))
            writer.kill()
        assert writer.returncode == -signal.SIGKILL
    live, whole = goes_on(tmp_path / "j", SENT), in_pieces([])
    assert live.wall.settings == whole.wall.settings
    assert bits(live.wall) == bits(whole.wall) == bits(Live.replay(tmp_path / "j").wall)


def test_a_full_disk_loses_no_fit(tmp_path, asked, monkeypatch):
    real, refusals = Journal.append, []

    def full(self, source, connection, payload, kind=journal.BYTES):
        if kind == journal.FITTED and not refusals:
            refusals.append(kind)
            raise JournalFullError(28, "No space left on device")
        return real(self, source, connection, payload, kind)

    monkeypatch.setattr(Journal, "append", full)
    rows = oval(106.0)
    with Live(parse(SENT), tmp_path / "j", clock=Clock()) as live:
        for part in framed(rows):
            live.receive("mwd", part)
    assert refusals == [journal.FITTED]
    assert asked == [26, 26, 64]
    assert [fit["length"] for fit in recorded(tmp_path / "j")] == [2, 5]


@pytest.mark.parametrize(
    ("rows", "text"),
    [
        (oval(110.5, 0.4), "inverse distance, because 26 samples are too few for a fit: at least 40"),
        (oval(110.5) * [1, 1, 0] + [0, 0, 110], "inverse distance, because all radii are equal"),
    ],
)
def test_where_no_covariance_can_be_fitted_it_is_inverse_distance_and_says_so_at_each_length(rows, text):
    live = Live(parse(SENT), clock=Clock())
    for part in framed(rows):
        live.receive("mwd", part)
    assert live.model.events.counts["", "estimator"] == 3
    assert live.model.events.latest[-1].newest.text == f"layer main: from its first 10 m: {text}"
    assert live.wall.settings.estimator == "inverse-distance"
    plain = Live(parse(SENT.replace('"automatic"', '"inverse-distance"')), clock=Clock())
    plain.receive("mwd", b"".join(framed(rows)))
    assert plain.wall.radius.tobytes() == live.wall.radius.tobytes()


def test_a_fit_that_fails_leaves_the_wall_as_it_is_and_says_why(monkeypatch):
    def fails(*_):
        raise np.linalg.LinAlgError("Matrix is not positive definite")

    monkeypatch.setattr(fits, "choose", fails)
    live = in_pieces([])
    assert live.wall.settings.estimator == "inverse-distance"
    reason = "it stays with inverse distance: Matrix is not positive definite"
    assert live.model.events.latest[-1].text == f"layer main: from its first 10 m: {reason}"


def test_a_wall_that_memory_is_too_short_to_draw_again_stays_and_is_drawn_at_the_next_length(asked, monkeypatch):
    redraw, refused = hb.Wall._redraw, []

    def short(self, settings):
        refused.append(settings)
        if len(refused) == 1:
            raise MemoryError
        return redraw(self, settings)

    monkeypatch.setattr(hb.Wall, "_redraw", short)
    live = Live(parse(SENT), clock=Clock())
    parts = framed(oval(110.5))
    for part in parts[:25]:
        live.receive("mwd", part)
    assert live.wall.settings.estimator == "inverse-distance"
    assert "fit: MemoryError: " in live.model.set_aside.values()
    for part in parts[25:]:
        live.receive("mwd", part)
    assert asked == [26, 64, 126]
    assert live.wall.settings == refused[1]
    assert is_its_batch(live.wall)


def test_a_gap_and_a_jump_of_depth_do_not_count_as_hole():
    rows = oval(101.0)
    live = Live(parse(SENT), clock=Clock())
    live.receive("mwd", b"".join(framed(np.concatenate([rows, rows + np.array([0, 60, 0])]))))
    assert live.wall.samples.depth.max() > 160
    assert live.model.events.counts["", "estimator"] == 0


def test_each_layer_has_its_own_fits_and_another_hole_begins_with_what_was_found(asked, tmp_path):
    text = SENT + '[layers]\nmain = ["drill", "unknown"]\nagain = ["unknown"]\n'
    with Live(parse(text), tmp_path / "j", clock=Clock()) as live:
        live.receive("mwd", STREAM)
        assert live.layers["again"].settings == live.wall.settings
        assert {fit["layer"] for fit in recorded(tmp_path / "j")} == {"main", "again"}
        before = found(live)[0]
        live.reconfigure(parse(text + '[hole]\nname = "two"\nkickoff = 104.0\n'))
        live.receive("mwd", b"".join(framed(oval(106.0, first=104.0, seed=6))))
        assert asked == [126, 126, 65, 65], "none is due for what lies above the kickoff"
        assert live.layers["main"].settings == before
        assert [fit["layer"] for fit in recorded(tmp_path / "j")][2:] == ["two", "two-again"]
        assert live.wall is live.layers["two"]
        assert is_its_batch(live.wall)
    again = Live.replay(tmp_path / "j")
    assert {name: bits(wall) for name, wall in again.layers.items()} == {
        name: bits(wall) for name, wall in live.layers.items()
    }


@pytest.mark.usefixtures("asked")
def test_a_server_draws_on_while_a_fit_is_made(tmp_path, monkeypatch):
    real, begun, drawn = fits.choose, threading.Event(), threading.Event()

    def slow(*of):
        begun.set()
        assert drawn.wait(PATIENCE)
        return real(*of)

    monkeypatch.setattr(fits, "choose", slow)
    rows = oval(107.0)
    source = '[source.mwd]\naddress = "host"\nunits = "metric"\ncaliper = { toolface = ["5010"], depth = ["5011"], '
    text = AUTOMATIC + source + 'radius = ["5012"] }\n'
    sent = [wits.frame([(5010 + k, f"{v:.4f}") for k, v in enumerate(row)]) for row in rows]
    with Running(text, tmp_path / "j") as running:
        put = lambda part: running.server._queue.put("mwd", 1, part, journal.BYTES, threading.Event())  # noqa: E731
        for part in sent[:70]:
            put(part)
        assert begun.wait(PATIENCE)
        for part in sent[70:]:
            put(part)
        until(lambda: running.live.wall.sample_count == len(rows))
        assert running.live.wall.settings.estimator == "inverse-distance"
        drawn.set()
        until(lambda: running.count("estimator"))
        until(lambda: running.live.wall.settings.estimator == "near-and-far")
        wall = running.live.wall
    assert [fit["length"] for fit in recorded(tmp_path / "j")] == [5]
    assert is_its_batch(wall)
    assert bits(Live.replay(tmp_path / "j").wall) == bits(wall)


def test_other_walls_take_no_fit_and_a_wrong_record_is_set_aside():
    for payload, why in (
        (b"{}", "fit = {}: must have layer, length, settings and text"),
        (b"\xff", "UnicodeDecodeError"),
        (b'{"layer": "reamed", "length": 5, "settings": {}, "text": ""}', "fit.layer = 'reamed': must be a layer"),
        (b'{"layer": "main", "length": 5, "settings": {"sectors": 1}, "text": ""}', "sectors = 1: must lie in 3"),
        (b'{"layer": "main", "length": 5, "settings": {"estimator": "near-and-far"}, "text": ""}', "covariance"),
    ):
        live = Live(parse(SENT), clock=Clock())
        live._store(0, 0, payload, journal.FITTED)
        assert list(live.model.set_aside) == [1]
        assert why in live.model.set_aside[1]
        assert live.wall.settings == live.model.fits["main"].settings
        assert live.wall.settings.estimator == "inverse-distance"
    live = Live(parse(SENT.replace('"automatic"', '"inverse-distance"')), clock=Clock())
    live._store(0, 0, b'{"layer": "main", "length": 5, "settings": {}, "text": ""}', journal.FITTED)
    assert "must be a layer whose estimator is automatic" in live.model.set_aside[1]


def test_only_a_live_configuration_and_a_batch_take_automatic():
    with pytest.raises(InputError, match=r"estimator = 'automatic': must be another one where samples arrive later"):
        hb.Wall(bit_diameter=0.216, estimator="automatic")
    assert parse(configured("host").replace("sectors = 16", 'sectors = 16\nestimator = "automatic"')).wall["estimator"]
