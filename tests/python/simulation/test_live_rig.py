"""The played rig, the command line, the metrics and the snapshots, end to end."""

from __future__ import annotations

import re
import socket
import subprocess
import sys
import threading
import urllib.error
import urllib.request
from contextlib import suppress

import numpy as np
import pytest
from click.testing import CliRunner
from live_servers import free_port
from patience import PATIENCE, wait

import helibore as hb
from helibore import Live
from helibore.cli import cli
from helibore.cli.live_status_page import Page
from helibore.cli.prometheus_metrics import metrics
from helibore.live.rules.configuration import parse
from helibore.live.server import Server
from helibore.live.snapshot_files import snapshot
from helibore.live.wire import wits
from helibore.simulation.rig import Faults, Rig, configuration, connect, play
from helibore.simulation.tool import Lift

EM = ("--telemetry", "em")


def listened(rig, folder):
    """A live wall that last_received a whole rig over loopback."""
    port = free_port()
    live = Live(parse(rig.configuration(f"listen://127.0.0.1:{port}")), folder)
    server = Server(live)
    server.start()
    with socket.create_connection(("127.0.0.1", port)) as link:
        sent = play(rig, link, speed=0)
    while live.model.readers[1].total("bytes") + server.queued < sent and server.failure is None:
        server.wait(0.05)
    server.stop()
    live.close()
    assert server.failure is None
    return live, server


def rows(columns):
    table = np.column_stack(columns)
    return table[np.lexsort(table.T)]


@pytest.mark.parametrize("faults", [Faults(), Faults(0.1, 0.1, 0.1)])
def test_a_played_rig_with_a_lift_ends_with_the_bits_of_the_batch(tmp_path, faults):
    rig = Rig("memory", 2000.0, 2004.0, lift=1.0, faults=faults, rate=20.0, seed=3)
    live, _ = listened(rig, tmp_path)
    kept = live.wall.samples
    sent = np.unique(rig.triples, axis=0)
    np.testing.assert_array_equal(rows([kept.toolface, kept.depth, kept.radius]), rows(sent.T))
    batch = hb.reconstruct(kept, bit_diameter=0.216, start_depth=2000.0)
    assert np.array_equal(live.wall.radius, batch.radius, equal_nan=True)
    assert live.model.counts["flag OFF_BOTTOM"] > 0
    assert (live.model.counts["flag DUPLICATE"] > 0) == (faults.doubled > 0)
    gaps = live.model.events.counts["rig", "gap"]
    assert (gaps > 0) == (faults.dropped > 0)
    assert len(live.survey) >= 2
    assert len(live.images["GR"].arrays()[0]) == len(rig.run.gamma_depth)
    again = Live.replay(tmp_path)
    assert np.array_equal(live.wall.radius, again.wall.radius, equal_nan=True)
    assert np.array_equal(live.path.position([2001.0]), again.path.position([2001.0]))


def test_the_telemetry_sets_rate_and_delay(golden):
    slow, fast = (Rig(name, 2000.0, 2001.0, lift=0.0) for name in ("mud-pulse", "wired-pipe"))
    assert len(fast.triples) > 1000 * len(slow.triples)
    assert max(at for at, _ in slow.frames()) > slow.run.time[-1] + 19
    with golden.raises():
        Rig("smoke")
    with golden.raises():
        Faults(late=1.0)


def test_metrics_page_and_snapshot_tell_the_same(tmp_path):
    live, server = listened(Rig("memory", 2000.0, 2002.0, lift=0.5, rate=20.0), tmp_path / "j")
    live.report("test", 'quote " and \\ and\nline')
    text = metrics(server)
    for line in text.splitlines():
        assert re.fullmatch(r'# (HELP|TYPE) \w+ .+|\w+(\{(\w+="([^"\\\n]|\\.)*",?)+\})? [-+0-9.e]+(inf)?', line), line
    values = dict(line.rsplit(" ", 1) for line in text.splitlines() if not line.startswith("#"))
    assert float(values["helibore_samples_drawn_total"]) == live.model.counts["drawn"] > 0
    assert float(values['helibore_wits_frames_total{source="rig"}']) == live.model.readers[1].total("frames")
    assert float(values['helibore_latency_seconds_bucket{le="+Inf"}']) == float(
        values["helibore_latency_seconds_count"]
    )
    from rich.console import Console

    console = Console(width=100, record=True, file=open("/dev/null", "w"))  # noqa: SIM115, PTH123
    console.print(Page(server).draw())
    page = console.export_text()
    assert f"{live.wall.sample_count:,}" in page
    console.file.close()
    names = {path.name for path in snapshot(live, tmp_path / "now")}
    tables = {"image-GR.csv", "survey.csv", "passes.csv", "events.csv"}
    assert names == {"main.wall", "main.las", "main.glb", "snapshot.json", *tables}
    assert names == {path.name for path in (tmp_path / "now").iterdir()}, "nothing half-written lies about"
    saved = hb.load(tmp_path / "now" / "main.wall")
    assert np.array_equal(saved.radius, live.wall.radius, equal_nan=True)
    assert np.array_equal(saved.path.position([2000.5]), live.path.position([2000.5]))
    depth, values = live.images["GR"].arrays()
    truth = hb.SectorImage(depth, values, "GR", "gAPI", origin="edge", reference="high-side")
    assert saved.images["GR"].on(saved).tobytes() == truth.on(live.wall).tobytes()
    las = hb.open(tmp_path / "now" / "main.las").sets[0]
    assert len(las.channels[0].values) == len(live.wall.logs().depth)
    table = np.genfromtxt(tmp_path / "now" / "image-GR.csv", delimiter=",", skip_header=1)
    assert np.array_equal(table[:, 0], live.images["GR"].arrays()[0])
    assert np.array_equal(table[:, 1:], live.images["GR"].arrays()[1], equal_nan=True)


def test_a_run_that_says_where_it_listens_can_be_ended(tmp_path):
    configuration = tmp_path / "rig.toml"
    configuration.write_text(Rig("memory", 2000.0, 2002.0, lift=0.0).configuration(f"listen://127.0.0.1:{free_port()}"))
    with subprocess.Popen(
        [sys.executable, "-u", "-c", "from helibore.cli import main; main()", "live", configuration, "--journal",
         tmp_path / "j", "--metrics-port", str(free_port()), "--token", "s3"],
        stdout=subprocess.PIPE,
    ) as running:  # fmt: skip
        assert running.stdout is not None
        assert b" listens at " in running.stdout.readline()
        running.terminate()
        assert b"samples drawn" in running.communicate(timeout=PATIENCE)[0]
    assert running.returncode == 0


def test_the_command_line_reads_a_played_rig(tmp_path):
    port, metrics_port = free_port(), free_port()
    rig = Rig("memory", 2000.0, 2002.0, lift=0.0, rate=20.0)
    configuration = tmp_path / "rig.toml"
    configuration.write_text(rig.configuration(f"listen://127.0.0.1:{port}"))
    with subprocess.Popen(
        [sys.executable, "-c", "from helibore.cli import main; main()", "live", configuration, "--journal",
         tmp_path / "j", "--snapshot", tmp_path / "now", "--metrics-port", str(metrics_port), "--token", "s3"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    ) as running:  # fmt: skip
        try:
            played = CliRunner().invoke(cli, ["simulate", "--wits", f"tcp://127.0.0.1:{port}", "--to", "2002m",
                                              "--speed", "0", *EM])  # fmt: skip
            assert played.exit_code == 0, played.output
            assert f"listen://127.0.0.1:{port}" in played.output

            def drawn() -> float:
                with (
                    suppress(urllib.error.URLError),  # the metrics are served only after the sources
                    urllib.request.urlopen(f"http://127.0.0.1:{metrics_port}/metrics?token=s3") as page,
                ):
                    text = page.read().decode()
                    return float(re.search(r"^helibore_samples_drawn_total (\S+)", text, re.MULTILINE)[1])
                return 0.0

            wait(lambda: drawn() > 100, lambda: "no samples are drawn", pause=0.05)
        finally:
            running.terminate()
        out, err = running.communicate(timeout=PATIENCE)
    assert running.returncode == 0, err
    assert b"samples drawn" in out
    assert (tmp_path / "now" / "main.wall").exists()
    assert Live.replay(tmp_path / "j").wall.sample_count > 100


def test_the_configuration_is_there_before_the_rig_is_simulated(monkeypatch):
    """Whoever pipes it to a file and starts the listening side at once must not find the file empty."""

    def refuse(*_, **__):
        raise ValueError("simulated")

    monkeypatch.setattr("helibore.simulation.rig.simulate", refuse)
    result = CliRunner().invoke(cli, ["simulate", "--wits", "tcp://127.0.0.1:1", "--from", "1800m", *EM])
    assert result.stdout == configuration("listen://127.0.0.1:1", "em", 1800.0) + "\n"
    assert parse(result.stdout).wall["bit_diameter"] == 0.216
    assert result.stderr.splitlines()[0] == "# simulating 250 m of drilling"
    assert "simulated" in result.stderr


def test_the_tool_is_lifted_where_it_is_told_to_be():
    rig = Rig("em", 2000.0, 2004.0, (Lift(2001.0, 0.5), Lift(2003.0, 1.0)))
    back = np.flatnonzero(np.diff(rig.run.depth) < -0.1)
    np.testing.assert_allclose(rig.run.depth[back], [2001.0, 2003.0], atol=0.01)
    np.testing.assert_allclose(rig.run.depth[back + 1], [2000.5, 2002.0], atol=0.01)


@pytest.mark.parametrize(
    "arguments",
    [
        ["hole"],
        ["--noise", "1mm"],
        ["--format", "npz", "-q"],
        ["--speed", "-1"],
        ["--wits", "127.0.0.1:9872"],
    ],
)
def test_what_a_played_rig_does_not_heed_is_refused_at_once(tmp_path, monkeypatch, arguments, golden):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(cli, ["simulate", "--wits", "tcp://127.0.0.1:1", *arguments])
    assert result.exit_code == 2
    assert result.stdout == ""
    golden(result.stderr)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("text", "arguments", "reported"),
    [
        ("", ["--journal", "j"], "rig.toml: wall.bit_diameter: is missing"),
        (None, ["--journal", "j"], "rig.toml: No such file or directory"),
        (Rig("em", 2000.0, 2000.5, 0.0).configuration("host"), [], "no journal: give --journal FOLDER"),
        (Rig("em", 2000.0, 2000.5, 0.0).configuration("host"), ["--check"], ""),
    ],
)
def test_a_wrong_start_is_one_line_and_exit_code_2(tmp_path, monkeypatch, text, arguments, reported):
    monkeypatch.chdir(tmp_path)
    if text is not None:
        (tmp_path / "rig.toml").write_text(text)
    result = CliRunner().invoke(cli, ["live", "rig.toml", *arguments])
    assert result.exit_code == (2 if reported else 0), result.output
    assert reported in result.output
    assert not (tmp_path / "j").exists()


def test_frames_of_the_rig_are_read_without_an_event():
    rig = Rig("wired-pipe", 2000.0, 2000.3, lift=0.1)
    parser = wits.Parser()
    frames = [frame for _, frame in rig.frames()]
    batch = parser.feed(b"".join(frames))
    assert len(batch.events) == 0
    assert len(batch.frames) == len(frames) > 0


def test_a_snapshot_of_little_has_what_there_is(tmp_path):
    text = '[wall]\nbit_diameter = 0.216\nstart_depth = 100.0\n[snapshot]\nlogs = "csv"\n[source.a]\naddress = "host"\n'
    live = Live(parse(text + 'units = "metric"\n'))
    assert [path.name for path in snapshot(live, tmp_path)] == ["snapshot.json"]
    live.append_samples([100.0, 100.02], [0.0, 90.0], [0.11, 0.112])
    names = {path.name for path in snapshot(live, tmp_path)}
    assert names == {"main.wall", "passes.csv", "snapshot.json"}, "not one turn yet: no logs, no mesh"
    live.append_stations([0.0, 10.0], [0.0, 0.0], [0.0, 0.0])
    live.append_samples(np.linspace(100.05, 112.0, 2000), np.arange(2000) * 37.0 % 360, np.full(2000, 0.11))
    names = {path.name for path in snapshot(live, tmp_path)}
    logs = {"main.csv", "main.csv.facts.json"}
    assert names == {"main.wall", "survey.csv", "passes.csv", "snapshot.json"} | logs, "the path ends at 110 m"
    assert len(hb.load(tmp_path / "main.wall")) == len(live.wall)


def test_an_address_that_is_taken_is_named():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        result = CliRunner().invoke(cli, ["simulate", "--wits", f"listen://127.0.0.1:{port}", "-q", *EM])
    rule = "Address already in use; give another address"
    assert (result.exit_code, result.stderr) == (2, f"helibore: 127.0.0.1 port {port}: {rule}\n")


def test_a_rig_waits_for_a_receiver_that_does_not_read():
    with socket.create_server(("127.0.0.1", 0)) as listening:
        link = connect(f"tcp://127.0.0.1:{listening.getsockname()[1]}", 0.1)
        receiver = listening.accept()[0]
    with link, receiver:
        left = 30_000_000
        sending = threading.Thread(target=link.sendall, args=(bytes(left),))
        sending.start()
        sending.join(0.5)
        assert sending.is_alive(), "the buffers are full"
        while left:
            left -= len(receiver.recv(1 << 20))
        sending.join()


@pytest.mark.skipif(not socket.has_ipv6, reason="needs IPv6")
def test_a_rig_listens_on_an_ipv6_address():
    with socket.create_server(("::1", 0), family=socket.AF_INET6) as free:
        port = free.getsockname()[1]
    with pytest.raises(TimeoutError, match="nobody connected"):
        connect(f"listen://[::1]:{port}", 0.01)


def test_an_address_without_a_connection_is_named():
    port = free_port()
    with pytest.raises(ConnectionRefusedError) as refused:
        connect(f"tcp://127.0.0.1:{port}", 0.01)
    rule = "Connection refused; give another address"
    assert refused.value.strerror == f"127.0.0.1 port {port}: {rule}"
    with pytest.raises(TimeoutError) as late:
        connect(f"listen://127.0.0.1:{port}", 0.01)
    assert late.value.strerror == f"listen://127.0.0.1:{port}: nobody connected within 0.01 s"
