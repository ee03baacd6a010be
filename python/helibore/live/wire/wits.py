"""Read and write WITS level 0.

A frame begins with the line ``&&``, has a line ``RRIIvalue`` for each item II of a record RR, and ends with ``!!``. The
C++ core reads frames; this file names the arrays of the core. The configuration of a source defines the units and the
meaning of its items (see ``sources.py``).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from helibore import _core
from helibore.base import nulls
from helibore.base.arrays import Rows

LINE_LIMIT, FRAME_LIMIT, ITEM_LIMIT = _core.WITS_LIMITS
"""The default limits: bytes of a line, bytes and lines of a frame (`Limits` in cpp/include/helibore/wits.hpp)."""
NULLS = (*nulls.NULLS, -8888.0, -999.0, -99999.0)
"""Numbers that mean "no value" unless a source states other numbers. The text ``-9999.00`` means the same."""

NULL = 1
"""Item flag: the value is empty or one of the source's null numbers."""
INVALID = 2
"""Item flag: the value is not a number in plain or exponent notation; an item with a text always has this flag."""

RULES = {
    "stray_text": "text between frames is not read",
    "stray_end": "'!!' must follow '&&'",
    "unclosed": "a frame must end with '!!' before the next '&&'; it was not read",
    "not_an_item": "a line in a frame must begin with RRII, 01 to 99 each; the line was not read",
    "long_line": "a line must not be longer than the line limit; the line was not read",
    "long_frame": "a frame must not be longer than the frame limit; it was not read",
    "many_items": "a frame must not have more lines than the item limit; it was not read",
    "cut_off": "the connection ended within a frame; it was not read",
}
"""The rule that each kind of bad text breaks, in the order of the numbers in ``Batch.events['rule']``."""
RULE_NAMES = tuple(RULES)


@dataclass(frozen=True, slots=True)
class Batch:
    """The frames that one call of :meth:`Parser.feed` or :meth:`Parser.finish` completed.

    Attributes
    ----------
    base
        Offset in the stream of ``text[0]``.
    text
        The stream from the end of the previous batch up to the end of the last complete frame or line.
    items
        Structured (n,): ``frame`` (number since the parser began), ``code`` (RRII as an integer, 108 for record 01
        item 08), ``value`` (float64, NaN if flagged), ``flags`` (0, NULL or INVALID), ``offset`` and ``length`` of the
        value's text in the stream.
    frames
        Structured (m,): ``start`` and ``stop`` (offsets in the stream), ``first`` (row in ``items`` of its first item),
        ``items`` (number of its items), ``line`` (number of the line with its ``&&``, from 1).
    events
        Structured (e,), one for each bad text: ``offset``, ``line`` (from 1), ``length``, ``rule`` (index into RULES).
    """

    base: int
    text: bytes
    items: Rows
    frames: Rows
    events: Rows

    def line_of(self, item: int, frame: int) -> int:
        """Return the line, from 1, of row ``item`` of ``items``; its frame is row ``frame`` of ``frames``."""
        start, stop = int(self.frames["start"][frame]) - self.base, int(self.items["offset"][item]) - self.base
        return int(self.frames["line"][frame]) + self.text.count(b"\n", start, stop)

    def text_of(self, item: int) -> bytes:
        """Return the text of the value of row ``item`` of ``items``, as it was received."""
        start = int(self.items["offset"][item]) - self.base
        return self.text[start : start + int(self.items["length"][item])]


class Parser:
    """Reads the stream of one connection. The frames do not depend on how the stream is cut into chunks.

    Parameters
    ----------
    nulls
        Numbers that mean "no value" in this source.
    line_limit, frame_limit, item_limit
        Bytes of a line, bytes of a frame, lines of a frame. A longer line or frame is counted and dropped, and reading
        continues at the next line or the next ``&&``. So the memory that the parser holds between calls is bounded.

    Raises
    ------
    ValueError
        If a null is not finite, or a limit is too small.
    """

    STATE = ("state",)

    def __init__(
        self,
        nulls: Sequence[float] = NULLS,
        line_limit: int = LINE_LIMIT,
        frame_limit: int = FRAME_LIMIT,
        item_limit: int = ITEM_LIMIT,
    ) -> None:
        self._core = _core.WitsParser(list(nulls), line_limit, frame_limit, item_limit)

    def feed(self, chunk: bytes | bytearray | memoryview) -> Batch:
        """Return the frames that ``chunk`` completes."""
        return Batch(*self._core.feed(chunk))

    def finish(self) -> Batch:
        """Return the frames that the end of the stream completes, and begin a new stream.

        The last line of the stream needs no line end.
        """
        return Batch(*self._core.finish())

    @property
    def state(self) -> bytes:
        """The state of the parser; a parser with the same settings continues from a state that is assigned to it."""
        return self._core.state()

    @state.setter
    def state(self, state: bytes) -> None:
        self._core.restore(state)

    @property
    def counts(self) -> dict[str, int]:
        """Counts by name: bytes, lines, frames, items, nulls, not_numbers, stray_lines, and each name in RULES."""
        return self._core.counts()


def code(text: str) -> int:
    """Return the item code of ``text``, four digits RRII.

    Raises
    ------
    ValueError
        If the text is not four digits, 01 to 99 twice.
    """
    if len(text) != 4 or not (text.isascii() and text.isdigit()) or text[:2] == "00" or text[2:] == "00":
        raise ValueError(f"item {text!r}: must be four digits RRII, 01 to 99 each")
    return int(text)


def frame(items: Iterable[tuple[int, str]]) -> bytes:
    """Return one frame as ASCII bytes, with CRLF after each line; ``items`` are (code, text of the value) pairs."""
    lines = ["&&", *(f"{number:04d}{value}" for number, value in items), "!!", ""]
    return "\r\n".join(lines).encode("ascii")


HEARTBEAT = frame([(111, "-9999")])
"""The keep-alive that a Pason EDR expects: item 0111 with the null -9999."""
POLL = frame([])
"""An empty frame, which requests one packet from a sender."""
