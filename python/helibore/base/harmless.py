r"""Make texts of files and wires harmless where they are shown or written.

printable(name)         ESC [31mGR    ->  \x1b[31mGR            a terminal or a log obeys no text of a file
cell(note)              =1+1          ->  '=1+1                  a spreadsheet computes no text of a table
in_html(title)          <b>           ->  &lt;b&gt;              a page of HTML or XML obeys no text of a file
"""

from __future__ import annotations

import re
from typing import Any

HIDDEN = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff\ud800-\udfff]")
"""Characters that no terminal shows as such: controls but newline and tab, marks that turn text around, and halves of
surrogate pairs, which stand for bytes of a file's name that are not UTF-8."""

FORMULA = re.compile(r"'*(?![+-]?\d+(?:\.\d*)?(?:[eE][+-]?\d+)?$)[=+\-@\t\r＝＋－＠]")
"""The start of a cell that a spreadsheet computes, and of one that `cell` has marked."""


def printable(text: str) -> str:
    r"""Return a text with the characters of `HIDDEN` as escapes: ``\x1b``; all others, also of any script, stay."""
    if text.isascii() and text.isprintable():
        return text
    return HIDDEN.sub(lambda found: found[0].encode("unicode_escape").decode("ascii"), text)


def printable_texts(value: Any) -> Any:
    """Return a value of JSON whose texts are `printable`; the keys of an object, which are names of code, stay."""
    if isinstance(value, str):
        return printable(value)
    if isinstance(value, dict):
        return {key: printable_texts(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [printable_texts(one) for one in value]
    return value


def in_html(text: str) -> str:
    """Return a text for a page of HTML or XML, also between quotes: `printable`, with no tag and no reference."""
    from html import escape

    return escape(printable(text))


def cell(text: str) -> str:
    """Return a text for a cell of a table: one more apostrophe stands before what a spreadsheet would compute."""
    return f"'{text}" if FORMULA.match(text) else text


def text_of(found: str) -> str:
    """Return the text that `cell` made a cell of."""
    return found[1:] if found.startswith("'") and FORMULA.match(found) else found
