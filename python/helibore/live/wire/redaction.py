"""Remove the credentials of a store from all that the store sends, in all forms in which stores write a text.

    s&cret  s&amp;cret  s&amp;amp;cret  s%26cret  s\\u0026cret  s&#38;cret  UTF-16  Basic dTpzJmNyZXQ=

Each character becomes a regular expression for all ways to write it. Bytes that do not change the text (zero bytes,
line ends, bounds of CDATA, backslashes of JSON) may stand between characters. Each byte of a credential becomes a star.
"""

from __future__ import annotations

import base64
import re
import string

from helibore.base.errors import InputError

SHORTEST = 6
"""Least number of characters of a password."""
AMPERSAND = rb"(?:&|%(?:25)*26|\\{1,8}u0026)(?:(?:amp|#0*38|#[xX]0*26);)*"
BETWEEN = rb"(?:[\0\r\n]|<!\[CDATA\[|\]\]>)*\\{0,8}"
NAMED = {"&": "amp", "<": "lt", ">": "gt", '"': "quot", "'": "apos"}
Units = list[bytes]
"""Regular expressions, one for each of several consecutive bytes or groups of bytes."""


def check_password(place: str, password: str) -> None:
    """Refuse a password so short that it may also occur in the data, because redaction would then change the data.

    Raises
    ------
    InputError
        If the password is shorter than 6 characters, has no ASCII letter, or is not UTF-8 text.
    """
    try:
        password.encode()
    except UnicodeEncodeError:  # os.environ holds a wrong byte as half of a surrogate pair
        raise InputError(place, "the password must be UTF-8 text") from None
    if len(password) < SHORTEST or not set(password) & set(string.ascii_letters):
        rule = f"the password must have {SHORTEST} characters or more and a letter: helibore removes it from answers"
        raise InputError(place, rule)


def _hexadecimal(number: int, digits: int) -> Units:
    return [f"[{digit}{digit.upper()}]".encode() for digit in f"{number:0{digits}x}"]


def _letters(text: str) -> Units:
    return [re.escape(letter.encode()) for letter in text]


def _written(character: str) -> list[Units]:
    """Return all ways to write a character, each as `Units`."""
    code, raw = ord(character), character.encode()
    ways = [[AMPERSAND]] if character == "&" else [[re.escape(bytes([byte])) for byte in raw]]
    if code > 127:
        misread = [raw.decode("latin-1").encode(), raw.decode("cp1252", "ignore").encode()]  # UTF-8 read as Latin-1
        for encoded in (
            *misread,
            *(character.encode(name, "ignore") for name in ("latin-1", "utf-16-le", "utf-16-be")),
        ):
            ways += [[re.escape(bytes([byte])) for byte in encoded if byte]] if encoded else []  # zeros: see BETWEEN
    if character == " ":
        ways.append([rb"\+"])
    if character in NAMED:
        ways.append([AMPERSAND, *_letters(NAMED[character]), b";"])
    ways.append([AMPERSAND, b"#", b"0*", *_letters(str(code)), b";"])
    ways.append([AMPERSAND, b"#", b"[xX]", b"0*", *_hexadecimal(code, 1), b";"])
    ways.append([unit for byte in raw for unit in (b"%", b"(?:25)*", *_hexadecimal(byte, 2))])
    ways.append([rb"\\{1,8}", b"u", *_hexadecimal(code & 0xFFFF, 4)])
    ways.append([rb"\\{1,8}", b"x", *_hexadecimal(code & 0xFF, 2)])
    if code > 127:
        ways.append([unit for byte in raw for unit in (rb"\\{1,8}", b"x", *_hexadecimal(byte, 2))])
    if not character.isalnum():
        ways.append([rb"\\{1,8}", re.escape(raw)])
    return ways


def _whole(ways: list[Units]) -> bytes:
    return b"(?:" + b"|".join(BETWEEN.join(units) for units in ways) + b")"


def _begun(ways: list[Units]) -> bytes:
    """Return an expression for the first unit or more of a character, written in any of the ``ways``."""
    found = []
    for units in ways:
        nested = b""
        for unit in reversed(units):
            nested = unit + BETWEEN + (b"(?:" + nested + b")?" if nested else b"")
        found.append(nested)
    return b"(?:" + b"|".join(found) + b")"


class Redactor:
    """Removes from texts the password of ``auth`` (user, password), also in Base64, and the token of ``user:password``.

    If ``auth`` is None, nothing is removed.
    """

    def __init__(self, auth: tuple[str, str] | None) -> None:
        self._secrets: list[tuple[re.Pattern[bytes], re.Pattern[bytes]]] = []
        if auth is None:
            return
        tokens = {base64.b64encode(text.encode()).decode() for text in (":".join(auth), auth[1])}
        tokens |= {token.replace("+", "-").replace("/", "_") for token in tokens}
        for secret in [*sorted((token.rstrip("=") for token in tokens), key=len, reverse=True), auth[1]]:
            characters = [_written(character) for character in secret]
            padding = rb"(?:=|%3[dD])*" if secret != auth[1] else b""
            begun = b""
            for ways in reversed(characters):
                begun = b"(?:" + (_whole(ways) + BETWEEN + begun + b"|" if begun else b"") + _begun(ways) + b")"
            whole = BETWEEN.join(_whole(ways) for ways in characters) + padding
            self._secrets.append((re.compile(whole), re.compile(begun + rb"\Z")))

    def clean(self, body: bytes, *, cut: bool = False) -> bytes:
        """Return ``body`` with every credential replaced by asterisks.

        With ``cut``, the body may end in the middle of a credential; the part of the credential is then replaced, too.
        """
        for whole, _ in self._secrets:
            body = whole.sub(lambda match: b"*" * len(match[0]), body)
        if cut:
            starts = [match.start() for _, begun in self._secrets if (match := begun.search(body))]
            start = min(starts, default=len(body))
            body = body[:start] + b"*" * (len(body) - start)
        return body

    def clean_text(self, text: str) -> str:
        """Return a text without credentials."""
        return self.clean(text.encode("utf-8", "replace")).decode("utf-8", "replace")
