"""The protocol of a kind of source, and the registry that finds the kinds.

    [source.NAME]  -> kind by the scheme of its address -> table (settings), checked
    bytes          kind.open(...) -> Opener -> Link -> journal -> kind.reader(...) -> Reading -> wall

A new kind is two files: a module in ``helibore.live.kinds`` with its settings, its reader and a ``KIND``, and a module
with its links. Nothing else names a kind. A program may append a folder of its own to ``helibore.live.kinds.__path__``.
The modules are found by this folder's name, so that this file depends on none of them.
"""

from __future__ import annotations

import functools
import importlib
import pkgutil
from collections.abc import Callable, Iterator
from typing import Any, Generic, Protocol, TypeVar

from helibore.live.rules.checks import check
from helibore.live.rules.sources import LENGTHS, Context, Source
from helibore.live.wire.transport import Opener

Table = TypeVar("Table", bound=Source)
Reader = TypeVar("Reader")
Report = Callable[[str, str], None]
"""Reports an event of a source's link: its rule and its text."""
Position = Callable[[], Any]
"""Returns how far the reader of a source has come."""
FOLDER = "helibore.live.kinds"
Cells = tuple[int, int, str, str]
"""A row of an export: connection, line, name and text of a value."""


class Items(Protocol):
    """Turns the records of one source, in order, into rows of an export."""

    def __call__(self, connection: int, payload: bytes, closes: bool) -> Iterator[Cells]: ...


class SourceKind(Generic[Table, Reader]):
    """What helibore asks of a kind of source; the defaults are those of a plain stream of bytes.

    Attributes
    ----------
    schemes
        The words before the colon in the addresses of this kind.
    table
        The settings of ``[source.NAME]``.
    reader
        What reads the bytes of a source, made with its settings, the book of events and the limits of depths.
    of_start
        Names of settings that a running server does not change.
    longest_wait
        The most seconds between two tries to connect.
    answers
        Whether a source is connected only once bytes have come, as a store that must be asked first.
    resumes
        Whether a new connection goes on where the last one ended. Then any changed setting connects the source again;
        otherwise only another address does, because bytes could be lost.
    """

    schemes: tuple[str, ...]
    table: type[Table]
    reader: type[Reader]
    of_start: tuple[str, ...] = ()
    longest_wait: float = 5.0
    answers: bool = False
    resumes: bool = False

    def open(self, source: Table, position: Position, report: Report) -> Opener:
        """Return what opens links to ``source``; a link goes on from ``position()``."""
        raise NotImplementedError

    def items(self, source: Table) -> Items | None:  # noqa: ARG002
        """Return what turns the records of ``source`` into rows of an export; None: they hold no items."""
        return None


AnyKind = SourceKind[Any, Any]


@functools.cache
def kinds() -> tuple[AnyKind, ...]:
    """Return the kinds of all modules in `FOLDER`, and in the folders appended to the package's path."""
    package = importlib.import_module(FOLDER)
    modules = [
        importlib.import_module(f"{package.__name__}.{one.name}") for one in pkgutil.iter_modules(package.__path__)
    ]
    return tuple(module.KIND for module in modules if hasattr(module, "KIND"))


def kind_of(source: Source) -> AnyKind:
    """Return the kind of a source."""
    return next(kind for kind in kinds() if kind.table is type(source))


def read_source(name: str, entries: dict[str, Any], bit_diameter: float, reference: str) -> Source:
    """Check the table of a source and return it; its kind follows from the scheme of its address."""
    scheme = str(entries.get("address", "")).partition(":")[0].lower()
    kind = next((kind for kind in kinds() if scheme in kind.schemes), None)
    kind = kind or next(kind for kind in kinds() if "host" in kind.schemes)  # its table states the rule of addresses
    index = kind.table.index_of(entries)
    lengths = LENGTHS.get(str(entries.get("units")), LENGTHS["metric"])
    found: Source = check(kind.table, entries, f"source.{name}", Context(name, bit_diameter, reference, lengths, index))
    return found
