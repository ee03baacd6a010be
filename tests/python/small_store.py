"""A small WITSML 1.4.1.1 store over real HTTPS, with an authority of its own: it grows, and it fails."""

from __future__ import annotations

import datetime
import html
import http.server
import re
import ssl
import threading
import time

import pytest

trustme = pytest.importorskip("trustme", reason="a certificate authority for the test needs trustme")
SERIES = 'xmlns="http://www.witsml.org/schemas/1series" version="1.4.1.1"'
LOG = f"<logs {SERIES}><log>HEADER<logData>ROWS</logData></log></logs>"


def enveloped(document: str, result: int = 1, message: str = "") -> bytes:
    return (
        '<?xml version="1.0"?><s:Envelope xmlns:s="http://schemas.xmlsoap.org/soap/envelope/"><s:Body>'
        '<r:WMLS_GetFromStoreResponse xmlns:r="http://www.witsml.org/message/120">'
        f"<Result>{result}</Result><XMLout>{html.escape(document)}</XMLout><SuppMsgOut>{message}</SuppMsgOut>"
        "</r:WMLS_GetFromStoreResponse></s:Body></s:Envelope>"
    ).encode()


class Store:
    """Answers like a store; ``rows`` and ``stations`` grow, ``trouble`` is what goes wrong with the next answers."""

    def __init__(self, folder, not_after=None) -> None:
        self.mnemonics, self.units = "DEPT,TF,RAD,GR1,GR2,DBTM", "m,dega,mm,gAPI,gAPI,m"
        self.rows: list[str] = []
        self.stations: list[tuple[float, float, float]] = []
        self.most, self.null = 100_000, "-999.25"
        self.trouble: list[str] = []
        self.bodies: list[bytes] = []
        self.questions: list[str] = []
        self.user, self.page = None, b"broken"
        self.authority = trustme.CA()
        self.ca = folder / "ca.pem"
        self.authority.cert_pem.write_to_path(self.ca)
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        self.authority.issue_cert("localhost", not_after=not_after).configure_cert(context)
        store = self

        class Pages(http.server.BaseHTTPRequestHandler):
            def do_POST(self) -> None:
                asked = html.unescape(self.rfile.read(int(self.headers["Content-Length"])).decode())
                store.questions.append(asked)
                store.answer(self, asked)

            def log_message(self, *_: object) -> None: ...

        class Quiet(http.server.ThreadingHTTPServer):
            daemon_threads = True

            def handle_error(self, *_: object) -> None: ...

        self.server = Quiet(("127.0.0.1", 0), Pages)
        self.server.socket = context.wrap_socket(self.server.socket, server_side=True, do_handshake_on_connect=False)
        self.url = f"https://localhost:{self.server.server_address[1]}/store"
        threading.Thread(target=self.server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True).start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.server.shutdown()
        self.server.server_close()

    def answer(self, page, asked: str) -> None:
        trouble = self.trouble.pop(0) if self.trouble else ""
        if self.user is not None and page.headers.get("Authorization") != self.user:
            return self.send(page, b"who are you", 401)
        if self.bodies:
            return self.send(page, self.bodies.pop(0), 200)
        if trouble == "500":
            return self.send(page, self.page, 500)
        if trouble == "429":
            return self.send(page, b"slowly", 429, retry_after="3600")
        if trouble == "redirect":
            return self.send(page, b"", 302)
        body = enveloped(self.trajectory() if "<trajectorys" in asked else self.log(asked), self.result(asked))
        if trouble == "error":
            body = enveloped("", -433, "the object does not exist")
        elif trouble == "entity":
            body = body.replace(b"<s:Envelope", b'<!DOCTYPE a [<!ENTITY b "c">]><s:Envelope', 1)
        elif trouble == "inner entity":
            body = enveloped('<!DOCTYPE a [<!ENTITY b "c">]>' + self.log(asked))
        elif trouble == "huge":
            body = body + b" " * (2 << 20)
        elif trouble == "compressed":
            return self.send(page, body, 200, encoding="gzip")
        if trouble == "slow headers":
            page.wfile.write(b"HTTP/1.1 200 OK\r\n")
            for number in range(100):
                try:
                    page.wfile.write(b"X-%d: x\r\n" % number)
                except OSError:
                    break  # the client has left
                time.sleep(0.1)
            return None
        if trouble == "slow":
            page.send_response(200)
            page.end_headers()
            for piece in body[:40]:
                page.wfile.write(bytes([piece]))
                time.sleep(0.1)
            return None
        return self.send(page, body, 200, sent=len(body) // 2 if trouble == "cut" else None)

    def send(self, page, body, status, sent=None, encoding=None, retry_after=None) -> None:
        page.send_response(status)
        page.send_header("Content-Length", str(len(body)))
        if encoding:
            page.send_header("Content-Encoding", encoding)
        if retry_after:
            page.send_header("Retry-After", retry_after)
        if status == 302:
            page.send_header("Location", self.url + "/elsewhere")
        page.end_headers()
        page.wfile.write(body[:sent])

    def behind(self, asked: str) -> list[str]:
        start = re.search(r"<startIndex[^>]*>([^<]*)<", asked)
        return [row for row in self.rows if start is None or float(row.split(",")[0]) >= float(start[1])]

    def result(self, asked: str) -> int:
        return 2 if "<logs" in asked and len(self.behind(asked)) > self.most else 1

    def log(self, asked: str) -> str:
        rows = "".join(f"<data>{row}</data>" for row in self.behind(asked)[: self.most])
        lists = f"<mnemonicList>{self.mnemonics}</mnemonicList><unitList>{self.units}</unitList>"
        header = "" if "data-only" in asked else f"<direction>increasing</direction><nullValue>{self.null}</nullValue>"
        return LOG.replace("HEADER", header).replace("ROWS", lists + rows)

    def trajectory(self) -> str:
        stations = "".join(
            f'<trajectoryStation><md uom="ft">{d / 0.3048!r}</md><incl uom="rad">{i * 3.141592653589793 / 180!r}</incl>'
            f'<azi uom="dega">{a!r}</azi></trajectoryStation>'
            for d, i, a in self.stations
        )
        return f'<trajectorys xmlns="http://www.witsml.org/schemas/1series"><trajectory>{stations}</trajectory></trajectorys>'


LONG_AGO = datetime.datetime(2020, 1, 1, tzinfo=datetime.UTC)
