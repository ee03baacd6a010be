"""The protocol of a kind of source, and the registry that finds the kinds.

    [source.NAME]  -> kind by the scheme of its address -> table (settings), checked -> source (what they mean)
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

from helibore.base.errors import InputError
from helibore.live.rules.source_tables import SourceTable
from helibore.live.rules.sources import OtherTables, Source
from helibore.live.wire.transport import Opener
from helibore.settings.toml_reading import TomlSource, read_table

Read = TypeVar("Read", bound=Source)
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


class SourceKind(Generic[Read, Reader]):
    """What helibore asks of a kind of source; the defaults are those of a plain stream of bytes.

    Attributes
    ----------
    schemes
        The words before the colon in the addresses of this kind.
    table
        The settings of ``[source.NAME]``, declared.
    source
        What these settings mean: ``source.read(name, table, others)`` makes it.
    reader
        What reads the bytes of a source, made with the source, the book of events and the limits of depths.
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
    table: type[SourceTable]
    source: type[Read]
    reader: type[Reader]
    of_start: tuple[str, ...] = ()
    longest_wait: float = 5.0
    answers: bool = False
    resumes: bool = False

    def open(self, source: Read, position: Position, report: Report) -> Opener:
        """Return what opens links to ``source``; a link goes on from ``position()``."""
        raise NotImplementedError

    def items(self, source: Read) -> Items | None:  # noqa: ARG002
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
    return next(kind for kind in kinds() if kind.table is type(source.table))


def read_source(name: str, tree: Any, others: OtherTables, file: TomlSource) -> Source:
    """Read the table of a source; its kind follows from the scheme of its address. Errors name the line in ``file``."""
    keys = "source", name
    if not isinstance(tree, dict):
        raise file.error(keys, "must be a table", tree)
    if "address" not in tree:
        raise file.error((*keys, "address"), "is missing")
    scheme = str(tree["address"]).partition(":")[0].lower()
    kind = next((kind for kind in kinds() if scheme in kind.schemes), None)
    kind = kind or next(kind for kind in kinds() if "host" in kind.schemes)  # its table states the rule of addresses
    try:
        if isinstance(tree["address"], str):  # before keys that are not known, because it decides which keys are
            kind.table.check_address(tree["address"])
    except InputError as error:
        raise file.located(error, keys) from error
    table = read_table(kind.table, tree, file, keys)
    try:
        found: Source = kind.source.read(name, table, others)
    except InputError as error:
        raise file.located(error, keys) from error
    return found
