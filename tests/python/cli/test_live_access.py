"""Who may read page and metrics of ``helibore live``, HTTPS, and the log file."""

from __future__ import annotations

import socket
import ssl
import threading
import urllib.error
import urllib.request
from types import SimpleNamespace

import pytest
from click.testing import CliRunner
from live_servers import Running, configured, frames, free_port, is_closed
from patience import PATIENCE

from helibore.base.errors import InputError
from helibore.base.identity import NO_TOKEN, Access, find_token
from helibore.cli import cli
from helibore.cli.live_command import WHERE, _window
from helibore.cli.metrics_server import CONNECTIONS, MetricsServer

TOKEN = "a secret/47"


def asked(url, authorization="", context=None):
    """Status and body of a request."""
    request = urllib.request.Request(url, headers={"Authorization": authorization} if authorization else {})
    try:
        with urllib.request.urlopen(request, context=context, timeout=PATIENCE) as page:
            return page.status, page.read()
    except urllib.error.HTTPError as error:
        with error:
            return error.code, error.read()


@pytest.fixture
def certified(tmp_path):
    """Files of a certificate and its key for localhost, and a context that trusts it."""
    trustme = pytest.importorskip("trustme", reason="trustme makes the certificates")
    authority = trustme.CA()
    made = authority.issue_cert("localhost", "127.0.0.1")
    certificate, key = tmp_path / "certificate.pem", tmp_path / "key.pem"
    made.cert_chain_pems[0].write_to_path(certificate)
    made.private_key_pem.write_to_path(key)
    context = ssl.create_default_context()
    authority.configure_trust(context)
    return {"certificate": str(certificate), "key": str(key)}, context


@pytest.fixture
def running(tmp_path):
    with Running(configured(f"listen://127.0.0.1:{free_port()}"), tmp_path / "j") as found:
        yield found


def test_metrics_ask_for_the_token(running):
    port = free_port()
    pages = MetricsServer(running.server, port, Access(token=TOKEN))
    try:
        url = f"http://127.0.0.1:{port}/metrics"
        for way in ((url,), (f"{url}?token=wrong",), (url, "Bearer wrong"), (url, "Basic YTpi"), (f"{url}?token=",)):
            assert asked(*way) == (403, f"{NO_TOKEN}\n".encode())
        for way in ((f"{url}?token=a%20secret/47",), (url, f"Bearer {TOKEN}")):
            status, body = asked(*way)
            assert (status, b"helibore_queue_records" in body) == (200, True)
        assert asked(f"http://127.0.0.1:{port}/else", f"Bearer {TOKEN}") == (404, b"only /metrics is here\n")
    finally:
        pages.close()


def test_metrics_answer_no_page_of_another_server(running):
    port = free_port()
    pages = MetricsServer(running.server, port, Access(token="s3"))
    try:
        for name, value in (("Origin", "http://evil.example"), ("Sec-Fetch-Site", "cross-site")):
            request = urllib.request.Request(f"http://127.0.0.1:{port}/metrics?token=s3", headers={name: value})
            with pytest.raises(urllib.error.HTTPError) as refused:
                urllib.request.urlopen(request, timeout=PATIENCE)
            assert (refused.value.code, value in refused.value.read().decode()) == (403, True)
        text = asked(f"http://127.0.0.1:{port}/metrics?token=s3")[1].decode()
        assert 'helibore_connections_refused_total{server="metrics"} 2.0' in text
    finally:
        pages.close()


def test_the_token_is_given_in_a_file_in_the_environment_or_random(tmp_path, monkeypatch):
    monkeypatch.delenv("HELIBORE_TOKEN", raising=False)
    file = tmp_path / "token"
    made = find_token(None, file)
    assert (file.stat().st_mode & 0o777, file.read_text()) == (0o600, f"{made}\n")
    assert find_token(None, file) == made
    assert len({find_token(), find_token(), Access().token, made}) == 4
    monkeypatch.setenv("HELIBORE_TOKEN", "of the environment")
    assert [find_token(), find_token(None, file), find_token("s3", file)] == ["of the environment", made, "s3"]
    for wrong in (b"", b"\n", b"a\nb\n", b"\xff", b"x" * 5000):
        file.write_bytes(wrong)
        with pytest.raises(InputError) as refused:
            find_token(None, file)
        assert (refused.value.place, refused.value.rule) == (f"token file {file}", "must hold one line: the token")
    assert "s3" not in repr(Access(token="s3"))


def test_a_metrics_port_that_is_taken_is_named(running):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(OSError) as raised:  # noqa: PT011 (the text is compared below)
            MetricsServer(running.server, port, Access(token="s3"))
    rule = "Address already in use; give another port for metrics (--metrics-port)"
    assert str(raised.value) == f"[Errno 98] 127.0.0.1 port {port}: {rule}"


def test_metrics_need_no_new_thread_and_lose_no_slot(running, monkeypatch):
    """Where memory lacks, ``Thread.start`` raises, or never returns."""
    port = free_port()
    pages = MetricsServer(running.server, port, Access(token="s3"))
    try:
        with monkeypatch.context() as patch:
            patch.setattr(threading.Thread, "start", lambda _: 1 / 0)
            for _ in range(2 * CONNECTIONS):
                assert asked(f"http://127.0.0.1:{port}/metrics?token=s3")[0] == 200
            patch.setattr("helibore.cli.metrics_server.metrics", lambda _: 1 / 0)
            for _ in range(2 * CONNECTIONS):
                with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE) as link:
                    link.sendall(b"GET /metrics?token=s3 HTTP/1.0\r\n\r\n")
                    assert is_closed(link)
        assert asked(f"http://127.0.0.1:{port}/metrics?token=s3")[0] == 200
    finally:
        pages.close()


def test_metrics_over_https(running, certified):
    files, context = certified
    port = free_port()
    pages = MetricsServer(running.server, port, Access(token=TOKEN, **files))
    try:
        url = f"https://localhost:{port}/metrics"
        assert asked(url, f"Bearer {TOKEN}", context)[0] == 200
        assert asked(url, "", context)[0] == 403
        with pytest.raises(OSError, match="CERTIFICATE_VERIFY_FAILED"):
            asked(url, f"Bearer {TOKEN}", ssl.create_default_context())
        with pytest.raises(OSError):  # noqa: PT011 (how a server that speaks TLS ends a request in the clear differs)
            asked(f"http://localhost:{port}/metrics", f"Bearer {TOKEN}")
    finally:
        pages.close()


def test_the_page_over_https_asks_for_the_token(certified):
    pytest.importorskip("uvicorn", reason="the page is served by the extra 'view'")
    from helibore.cli.live_view import Window
    from helibore.viewer.page_files import page

    if page("app.js") is None:
        pytest.skip("the page was not built: Node.js 18 is missing")
    files, context = certified
    with Window("well-7", Access(token=TOKEN, **files)) as window:
        assert window.url.startswith("https://127.0.0.1:")
        assert window.url.endswith("/?token=a%20secret%2F47")
        assert asked(window.url, context=context)[0] == 200
        status, body = asked(window.url.partition("?")[0], context=context)
        assert (status, body[:24]) == (403, b"token: missing or wrong.")


def test_the_token_is_printed_on_a_terminal_only(monkeypatch, capsys):
    monkeypatch.setattr("helibore.cli.live_view.Window", lambda *_, **__: SimpleNamespace(url="https://x:1/?token=s3"))
    _window("well", 0, Access(token="s3"))
    assert capsys.readouterr().out == f"the wall is shown at https://x:1/?token=... ({WHERE})\n"


@pytest.mark.parametrize(
    "options",
    [
        ["--key", "x.pem"],
        ["--token", ""],
        ["--metrics-port", "65536"],
        ["--every", "0"],
        ["--certificate", "no-such.pem"],
    ],
)
def test_wrong_access_never_starts(tmp_path, options, golden):
    (tmp_path / "rig.toml").write_text(configured("host"))
    arguments = ["live", str(tmp_path / "rig.toml"), "--journal", str(tmp_path / "j"), "-q", "--seconds", "0", *options]
    result = CliRunner().invoke(cli, arguments)
    assert result.exit_code == 2
    golden(result.output)
    assert not (tmp_path / "j").exists()


def test_the_log_file_has_every_kind_of_event_with_local_time_and_utc_and_is_rotated(tmp_path):
    (tmp_path / "rig.wits").write_bytes(b"".join(frames(3)) + b"noise\r\n")
    (tmp_path / "rig.toml").write_text(configured(f"file://{tmp_path}/rig.wits"))
    log = tmp_path / "events.log"
    log.write_bytes(b"x" * ((10 << 20) - 10))
    arguments = ["live", str(tmp_path / "rig.toml"), "--journal", str(tmp_path / "j"), "-q", "--log", str(log)]
    result = CliRunner().invoke(cli, arguments)
    assert result.exit_code == 0, result.output
    assert (tmp_path / "events.log.1").read_bytes() == b"x" * ((10 << 20) - 10)
    text = log.read_text()
    assert " INFO " in text
    assert "mwd connection 1: connected: " in text
    assert "mwd connection 1 line " in text
    assert ": stray_text: " in text
    for line in text.splitlines():
        when, kind, utc = line.split(" ")[1:4]
        assert len(when) == len("12:00:00+0000")
        assert kind in ("INFO", "WARNING")
        assert utc.endswith("Z")
    assert "connected" not in result.output  # stderr has warnings only
    assert "stray_text" in result.output


def test_without_a_terminal_the_command_says_where_its_sources_are(tmp_path):
    (tmp_path / "rig.wits").write_bytes(b"".join(frames(3)))
    (tmp_path / "rig.toml").write_text(configured(f"file://{tmp_path}/rig.wits"))
    arguments = ["live", str(tmp_path / "rig.toml"), "--journal", str(tmp_path / "j")]
    first, second, *_ = CliRunner().invoke(cli, arguments).stdout.splitlines()
    assert first == f"mwd is read from file://{tmp_path}/rig.wits"
    assert second == f"the journal is {tmp_path / 'j'}"
    assert "is read from" not in CliRunner().invoke(cli, [*arguments, "-q"]).stdout
