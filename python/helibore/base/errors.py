"""The two errors that a user can correct: an input breaks a rule, or an extra of helibore is not installed.

    InputError("toolface[17]", "must be finite", "nan")     ->  toolface[17] = nan: must be finite
    InputError("well.las, line 12", "truncated")            ->  well.las, line 12: truncated
    MissingExtraError("h5py", "vtkhdf")                     ->  needs h5py: pip install "helibore[vtkhdf]"; in a ...

A caller recognises these errors by their class and their attributes, never by their text.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from os import PathLike

from helibore.base.addresses import without_secrets
from helibore.base.harmless import printable

MOST = 4_000
"""Characters of an error's text; a file may hold 20,000 names."""


def shown(text: str) -> str:
    """Return the text of an error as it may be shown: without what a terminal obeys and keys, at most `MOST` long."""
    text = printable(without_secrets(text))
    return text if len(text) <= MOST else f"{text[: MOST - 200]} ... {text[-150:]}"


class InputError(ValueError):
    """An input breaks a rule.

    Attributes
    ----------
    place : str
        Where the input is: an argument, a setting, a file with its line, an option.
    rule : str
        What the input must be, or what is wrong with it.
    value : str or None
        The value as the error shows it; None if no single value is wrong.
    setting : str
        The setting that it is about, such as ``wall.sectors``, so that a command can name its option; "": none.

    Notes
    -----
    The text of the error shows no escape sequence and no key of an address, and not more than `MOST` characters; the
    attributes hold the texts as they are.
    """

    def __init__(self, place: str, rule: str, value: str | None = None, setting: str = "") -> None:
        self.place, self.rule, self.value, self.setting = place, rule, value, setting
        super().__init__(shown(f"{place}: {rule}" if value is None else f"{place} = {value}: {rule}"))

    def __reduce__(self) -> tuple[type[InputError], tuple[str, str, str | None, str]]:
        return type(self), (self.place, self.rule, self.value, self.setting)

    def about(self, setting: str) -> InputError:
        """Return this error, which now states its setting; a setting that it states already stays."""
        self.setting = self.setting or setting
        return self

    def within(self, outer: str) -> InputError:
        """Return the same error with its place inside an outer one: ``well.las: pitch = 0: must not be 0``."""
        return InputError(f"{outer}: {self.place}", self.rule, self.value, self.setting)


def check_not_negative(settings: Mapping[str, float]) -> None:
    """Raise InputError if a number is negative or not finite; the error names the first such number."""
    for name, value in settings.items():
        if not (math.isfinite(value) and value >= 0):
            raise InputError(name, "must be finite and not negative", str(value))


def check_choice(place: str, value: object, choices: Collection[object]) -> None:
    """Raise InputError unless the value is one of the choices; the error lists the choices."""
    if value not in choices:
        raise InputError(place, f"must be one of {', '.join(map(str, choices))}", repr(value))


def check_names(prefix: str, names: Iterable[str], known: Collection[str]) -> None:
    """Raise InputError if a name is not known; see `unknown_name`. Its place is ``prefix`` + this name."""
    for name in names:
        if name not in known:
            raise unknown_name(f"{prefix}{name}", name, known)


def unknown_name(place: str, name: str, known: Iterable[str]) -> InputError:
    """Return the error for a name that is not known: it states the nearest known name, or else all known names."""
    from difflib import get_close_matches

    known = list(known)
    near = get_close_matches(name, known, 1)
    return InputError(place, f"not known; did you mean {near[0]}?" if near else f"must be one of {', '.join(known)}")


def check_ending(path: str | PathLike[str], endings: Collection[str], why: str = "") -> str:
    """Return which of ``endings`` a file's name has, in upper or lower case; raise InputError if it has none of them.

    The error lists the endings; ``why`` follows this list.
    """
    for ending in endings:
        if str(path).lower().endswith(ending):
            return ending
    raise InputError(str(path), f"the ending must be one of {', '.join(endings)}{why}")


def port_error(error: OSError, host: str, port: int, option: str) -> OSError:
    """Return the error for an address on which no server can start; it names the address and ``option`` to change."""
    reason = (error.strerror or str(error)).partition(" (while")[0]  # as socket.create_server repeats the address
    return OSError(error.errno, f"{host} port {port}: {reason}; give another {option}")


class MissingExtraError(ImportError):
    """Error for a missing library that belongs to an extra.

    Attributes
    ----------
    library, extra : str
        The library that is missing, and the extra of helibore that installs it.
    """

    def __init__(self, library: str, extra: str) -> None:
        self.library, self.extra = library, extra
        # No index has helibore yet: the second command works today.
        command = f'pip install "helibore[{extra}]"; in a clone of helibore: pip install ".[{extra}]"'
        super().__init__(f"needs {library}: {command}")

    def __reduce__(self) -> tuple[type[MissingExtraError], tuple[str, str]]:
        return type(self), (self.library, self.extra)


@contextmanager
def needs(library: str, extra: str) -> Iterator[None]:
    """Turn an ImportError for a library of an extra into a `MissingExtraError`.

    If ``library`` is empty, the error names the module that is missing.
    """
    try:
        yield
    except ImportError as error:
        raise MissingExtraError(library or error.name or extra, extra) from error


def require_library(library: str, extra: str) -> None:
    """Import a library; raise a `MissingExtraError` if that fails."""
    with needs(library.replace("_", "-"), extra):
        __import__(library)
