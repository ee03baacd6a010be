"""The ways a store can send a credential back: ``python tests/slow/credentials.py``.

Each way is a place of an answer (cells, faults, reason phrases, headers, redirects, broken protocol ...), and in each
place the password, or user and password in base64, is written in each form of ``test_live_store.py``. After all of
them: no form of a credential is in any file of journal, snapshot and log, in any event, in the metrics or in what the
page shows; and the good rows that came between them are all drawn.
"""

from __future__ import annotations

import base64
import html
import logging
import os
import sys
import tempfile
import urllib.parse
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[1] / "python" / folder) for folder in ("", "live")]

import test_live_store  # noqa: E402
from live_servers import until  # noqa: E402
from small_store import LOG, Store, enveloped  # noqa: E402
from test_live_store import PASSWORD, Polled, grown, with_user  # noqa: E402

from helibore import Live  # noqa: E402
from helibore.cli.live_log import logged  # noqa: E402
from helibore.cli.prometheus_metrics import metrics  # noqa: E402
from helibore.live import server  # noqa: E402
from helibore.live.kinds.witsml_stores import WitsmlStores  # noqa: E402
from helibore.live.snapshot_files import snapshot  # noqa: E402
from helibore.live.wire import store  # noqa: E402

BASIC = base64.b64encode(f"rig7:{PASSWORD}".encode()).decode()


def answer(body: bytes, status: str = "200 OK", *headers: str, length: str | None = None) -> bytes:
    head = "\r\n".join([f"HTTP/1.1 {status}", f"Content-Length: {length or len(body)}", "Connection: close", *headers])
    return head.encode() + b"\r\n\r\n" + body


def log(cell: str = "", unit: str = "m,dega,mm", mnemonic: str = "DEPT,TF,RAD", null: str = "-999.25") -> bytes:
    rows = f"<nullValue>{null}</nullValue>"
    data = f"<mnemonicList>{mnemonic}</mnemonicList><unitList>{unit}</unitList><data>{cell}</data>"
    return enveloped(LOG.replace("HEADER", rows).replace("ROWS", data))


def places(written: bytes) -> dict[str, bytes]:
    """Return the raw answer for each place; ``written`` is a form of the credential."""
    try:
        whole_text = written.decode()
    except UnicodeDecodeError:
        whole_text = written.decode("latin-1")
    text = whole_text.replace("\r", "").replace("\n", "")
    markup = html.escape(text)
    station = f'<trajectoryStation><md uom="{markup}">{markup}</md></trajectoryStation>'
    whole = enveloped(whole_text)
    return {
        "body that is no XML": answer(written),
        "document of the answer": answer(whole),
        "message of the store": answer(enveloped("", -1, markup)),
        "fault": answer(b"<s:Envelope xmlns:s='x'><faultstring>" + markup.encode() + b"</faultstring></s:Envelope>"),
        "result": answer(b"<Result>" + markup.encode() + b"</Result>"),
        "name of an element": answer(b"<e>" + b"<" + written + b"></e>"),
        "cell": answer(log(cell=f"100,{markup},110")),
        "index": answer(log(cell=f"{markup},1,110")),
        "unit": answer(log(unit=f"m,{markup},mm", cell="100,1,110")),
        "unit of the index": answer(log(unit=f"{markup},dega,mm", cell="100,1,110")),
        "mnemonic": answer(log(mnemonic=f"DEPT,{markup},RAD", cell="100,1,110")),
        "null value": answer(log(null=markup, cell="100,1,110")),
        "station": answer(enveloped(f'<trajectorys xmlns="x"><trajectory>{station}</trajectory></trajectorys>')),
        "page of 500": answer(written, "500 Internal Server Error"),
        "reason of 500": answer(b"no", f"500 {text}"),
        "address of a redirect": answer(b"", "302 Found", f"Location: https://localhost/?p={text}"),
        "header": answer(b"no", "503 Busy", f"X-Debug: {text}"),
        "cookie": answer(b"no", "503 Busy", f"Set-Cookie: s={text}"),
        "realm": answer(b"no", "503 Busy", f'WWW-Authenticate: Basic realm="{text}"'),
        "content encoding": answer(b"no", "200 OK", f"Content-Encoding: {text}"),
        "length of the body": answer(b"no", "200 OK", length=text),
        "status line": f"{text}\r\n\r\n".encode(),
        "status": f"HTTP/1.1 {text}\r\n\r\n".encode(),
        "broken header": f"HTTP/1.1 200 OK\r\n{text}\r\n\r\n".encode(),
        "chunk": f"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n{text}\r\n".encode(),
        "cut in the credential": answer(b"<" + written[: len(written) // 2], length="9999"),
        "after 1 MB": answer(b" " * ((1 << 20) - len(written) // 2) + written),
        "certificate of another protocol": written,
    }


def traces(kept: bytes) -> list[str]:
    """Return the credentials that are left in ``kept``, in whatever way they are written."""
    found = []
    plain = kept.replace(b"\0", b"")
    for _ in range(4):
        for secret in (PASSWORD, PASSWORD[4:], BASIC.rstrip("="), base64.b64encode(PASSWORD.encode()).decode()[:-2]):
            for encoding in ("utf-8", "latin-1"):
                if secret.encode(encoding) in plain:
                    found.append(secret)
        unescaped = html.unescape(urllib.parse.unquote_plus(plain.decode("latin-1"), "latin-1"))
        plain = unescaped.replace("\\u0026", "&").replace("\\x26", "&").encode("latin-1", "replace")
    return found


def main() -> None:
    os.environ["STORE_PASSWORD"] = PASSWORD
    store.SOON = server.FIRST_WAIT = WitsmlStores.longest_wait = 0.01
    forms = {name: page[2:-2] for name, page in test_live_store.written_in_twenty_ways().items()}
    answers = [raw for written in forms.values() for raw in places(written).values()]
    ways = f"{len(forms)} forms in {len(answers) // len(forms)} places"
    total = len(answers)
    with tempfile.TemporaryDirectory() as name, Store(Path(name)) as one:
        usual = one.answer

        def reply(page, asked: str) -> None:
            if not answers or "<trajectorys" in asked:
                return usual(page, asked)
            page.close_connection = True
            page.wfile.write(answers.pop(0))
            if len(answers) % 50 == 0:
                one.rows += grown(1, len(one.rows))
            return None

        one.answer, one.rows = reply, grown(5)  # type: ignore[method-assign]
        texts: list[str] = []
        with logged(f"{name}/events.log", quiet=True):
            logging.getLogger().setLevel(logging.DEBUG)
            logging.getLogger().addHandler(logging.FileHandler(f"{name}/debug.log"))
            with Polled(one, Path(name) / "j", with_user) as it:
                while answers:
                    texts += [str(event) for event in it.live.poll().events]
                    texts += [*it.server.states.values(), metrics(it.server)]
                    before = len(answers)
                    until(lambda before=before: len(answers) < before or not answers, 60)
                until(lambda: it.live.wall.sample_count >= len(one.rows), 60)
                snapshot(it.live, Path(name) / "now")
                texts += [*it.reported(), metrics(it.server), *(str(alarm) for alarm in it.server.alarms.active)]
                drawn = it.live.wall.sample_count
        again = Live.replay(Path(name) / "j")
        texts += [str(event) for event in again.model.events.latest]
        files = [path for path in Path(name).rglob("*") if path.is_file()]
        left = {str(path): found for path in files if (found := traces(path.read_bytes()))}
        size = sum(path.stat().st_size for path in files)
        assert not left, left
        shown = [text for text in set("\n".join(texts).split("\n")) if traces(text.encode())]
        assert not shown, shown[:5]
        assert again.wall.sample_count == drawn
    print(
        f"{total:,} answers, {ways}: no credential in {len(files)} files ({size / 1e6:.1f} MB), in events, log, states"
    )
    print(f"and metrics; {drawn} samples drawn between them, the same at a replay")


if __name__ == "__main__":
    main()
