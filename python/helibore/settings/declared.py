"""Declare settings: type, default, unit, rules and explanation of a setting stand at its field, and nowhere else.

    @dataclass(frozen=True, kw_only=True)
    class Criteria(Declared, group="zones"):
        join: Annotated[float, METRES, NOT_NEGATIVE, "Greatest distance of two zones that become one."] = 1.0

    Criteria(join=-1)                      InputError     join = -1: must be finite and not negative
    read_table(Criteria, tree, source)     InputError     well.toml, line 4: zones.join = -1: must be finite and not ...
    option_of(members(Criteria)["join"])   --join LENGTH  Greatest distance of two zones that become one.  [default: 1m]
    rows()                                 a row of the table of settings in the documentation

An error carries the name of its setting, ``zones.join``, so that the command line can show the option beside it.

The marks of a field are a `Unit`, any number of `Rule`, its explanation (a text), `Option` if the command line has an
option for it, and `Stated` for a table of which only what is stated counts. The first sentence of the explanation is
the help of the option. ``toml_reading`` reads TOML, ``listing`` makes tables and keyword types,
``helibore.cli.declared_options`` makes options.
"""

from __future__ import annotations

import dataclasses
import datetime
import inspect
import math
import operator
import sys
import types
import typing
from collections.abc import Callable
from dataclasses import MISSING, dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

from helibore.base import units
from helibore.base.cached import cached_property
from helibore.base.errors import InputError

LARGEST_INTEGER = 2**31
"""Absolute values of whole numbers must be below this, so that the core can hold them."""


class Unit(NamedTuple):
    """The unit in which a number is stored, and the kind of quantity for a text such as ``"8.5in"``.

    ``shown`` is the unit in which defaults are shown. If ``needed``, a text on the command line must state a unit.
    """

    word: str
    kind: str
    shown: str
    needed: bool = False

    def text(self, value: float) -> str:
        """Return a value with the unit in which it is shown."""
        return f"{value / units.factor(self.shown, self.kind):.6g}{self.shown}"


class Rule(NamedTuple):
    """What a value must be, and the test of it."""

    text: str
    test: Callable[[Any], bool]


class Option(NamedTuple):
    """The setting has an option on the command line: ``--`` and its name with hyphens; ``--no-`` for a true default.

    ``usual`` is what the help shows for a setting without a number as default; ``metavar`` names the value.
    """

    usual: str = ""
    metavar: str | None = None


class Formerly:
    """Names of the setting in the files of earlier versions, which are read for ever."""

    def __init__(self, *names: str) -> None:
        self.names = names


class Stated(NamedTuple):
    """The setting is a table of which only the stated keys are kept, by the rules of the declared class ``kind``."""

    kind: type[Any]


METRES = Unit("metres", units.LENGTH, "m")
MILLIMETRES = Unit("metres", units.LENGTH, "mm")
INCHES = Unit("metres", units.LENGTH, "in", needed=True)
DEGREES = Unit("degrees", units.ANGLE, "deg")
SECONDS = Unit("seconds", units.TIME, "s")
FINITE = Rule("must be finite", math.isfinite)
POSITIVE = Rule("must be finite and above 0", lambda value: 0 < value < math.inf)
NOT_NEGATIVE = Rule("must be finite and not negative", lambda value: 0 <= value < math.inf)
NOT_ZERO = Rule("must be finite and not 0", lambda value: math.isfinite(value) and value != 0)
DEPTH = Rule("must lie in -10000000 to 10000000 m", lambda value: abs(value) <= 1e7)


def _digits(number: float) -> str:
    return f"{number:.15g}".replace("e-0", "e-")


def at_least(least: float, unit: str = "") -> Rule:
    """Return the rule that a value is not below ``least``."""
    return Rule(f"must be at least {_digits(least)}{unit and ' ' + unit}", lambda value: value >= least)


def at_most(most: float, unit: str = "") -> Rule:
    """Return the rule that a value is not above ``most``."""
    return Rule(f"must be at most {_digits(most)}{unit and ' ' + unit}", lambda value: value <= most)


def within(least: float, most: float, unit: str = "") -> Rule:
    """Return the rule that a value lies in an interval with its ends."""
    text = f"must lie in {_digits(least)} to {_digits(most)}{unit and ' ' + unit}"
    return Rule(text, lambda value: least <= value <= most)


NOUNS: dict[Any, str] = {
    float: "a number", int: "an integer", str: "text", bool: "true or false", Path: "the name of a file",
    dict: "a table", datetime.datetime: "a date and time without quotes, such as 2026-05-01T10:00:00Z",
}  # fmt: skip
"""What a value of each type must be."""


def _plain(value: Any) -> Any:
    """Return a scalar of NumPy as one of Python. Where NumPy is not loaded, no value is NumPy's."""
    numpy = sys.modules.get("numpy")
    return value.item() if numpy is not None and isinstance(value, numpy.generic) else value


def shown(value: Any) -> str:
    """Return a value as an error shows it: numbers as they were given, texts in quotes, lists in brackets."""
    value = list(value) if isinstance(value, tuple) else _plain(value)
    return repr(value).removesuffix(".0") if isinstance(value, float) else repr(value)


@dataclass(frozen=True, eq=False, repr=False)
class Member:
    """One setting of a declared class, as its annotation states it."""

    name: str
    hint: Any  # the type without marks and without None
    optional: bool  # None is allowed
    default: Any  # MISSING: must be given
    marks: tuple[Any, ...]
    setting: str = ""  # with its group, as in wall.power; "": it is in no group

    @cached_property
    def kind(self) -> Any:
        """The type without its arguments: float, int, bool, str, Path, Literal, tuple, dict or a declared class."""
        hint, _ = words_of(self.hint)
        return typing.get_origin(hint) or hint

    @cached_property
    def parts(self) -> tuple[Any, ...]:
        """The arguments of the type: the choices of a Literal, the types in a tuple."""
        return typing.get_args(self.hint)

    @property
    def choices(self) -> tuple[Any, ...]:
        """The values that are allowed if there are only a few; else ()."""
        return self.parts if self.kind is Literal else ()

    @cached_property
    def unit(self) -> Unit | None:
        """The unit of a number."""
        return next((mark for mark in self.marks if isinstance(mark, Unit)), None)

    @cached_property
    def option(self) -> Option | None:
        """How the command line has the setting; None: only by ``--setting``."""
        return next((mark for mark in self.marks if isinstance(mark, Option)), None)

    @cached_property
    def rules(self) -> tuple[Rule, ...]:
        """The rules of the value, in the order in which they are checked."""
        return tuple(mark for mark in self.marks if isinstance(mark, Rule))

    @cached_property
    def text(self) -> str:
        """The explanation."""
        return " ".join(next((mark for mark in self.marks if isinstance(mark, str)), "").split())

    @cached_property
    def formerly(self) -> tuple[str, ...]:
        """The names of the setting in the files of earlier versions."""
        return next((mark.names for mark in self.marks if isinstance(mark, Formerly)), ())

    @cached_property
    def stated(self) -> type[Any] | None:
        """The declared class of a table of which only the stated keys are kept; None: the setting is no such table."""
        return next((mark.kind for mark in self.marks if isinstance(mark, Stated)), None)

    @property
    def rule_text(self) -> str:
        """All rules of the value in one text, without "must be"."""
        rules = [rule.text for rule in self.rules] or ([f"must be one of {self.choice_text}"] if self.choices else [])
        return "; ".join(text.removeprefix("must be ").removeprefix("must lie in ") for text in rules)

    @property
    def default_text(self) -> str:
        """The default as help and documentation show it; "" if there is none to show."""
        if self.option is not None and self.option.usual:
            return self.option.usual
        if self.default is MISSING or self.default is None or self.default in ((), {}, ""):
            return ""
        if dataclasses.is_dataclass(self.default):
            return ""  # a group of its own shows its defaults
        if self.kind is bool:
            return "true" if self.default else "false"
        if self.unit is not None and isinstance(self.default, float):
            return self.unit.text(self.default)
        return f"{self.default:g}" if isinstance(self.default, float) else str(self.default)

    @property
    def summary(self) -> str:
        """The first sentence of the explanation."""
        first, stop, _ = self.text.partition(". ")
        return first + stop.rstrip() if stop else first

    @property
    def choice_text(self) -> str:
        """The choices, with commas."""
        return ", ".join(map(str, self.choices))

    def checked(self, value: Any) -> Any:
        """Return a value in the type of the setting; raise InputError, with its name, if it breaks a rule."""
        if value is None and self.optional:
            return None
        try:
            made = _converted(self.hint, value)
        except OverflowError:
            raise self._error("absolute value must be below 2147483648", shown(value)) from None
        except TypeError as error:
            raise self._error(f"must be {error}", repr(_plain(value))) from None
        for rule in self.rules:
            if not rule.test(made):
                raise self._error(rule.text, shown(value))
        return made

    def _error(self, rule: str, value: str) -> InputError:
        return InputError(self.name, rule, value, self.setting)


def words_of(hint: Any) -> tuple[Any, tuple[Any, ...]]:
    """Return a type, and the words that stand for a value of it: float and its words for ``float | Literal[...]``."""
    if typing.get_origin(hint) not in (types.UnionType, typing.Union):
        return hint, ()
    kind, words = typing.get_args(hint)
    return kind, typing.get_args(words)


def _converted(hint: Any, value: Any) -> Any:
    """Return a value in a type; raise TypeError, whose text says what it must be, or OverflowError."""
    hint, words = words_of(hint)
    if words:
        return value if value in words else _number(value, f"{NOUNS[float]}, or one of {', '.join(words)}")
    kind = typing.get_origin(hint) or hint
    if kind is float:
        return _number(value, NOUNS[float])
    if kind is int:
        return _integer(value)
    if kind is bool:
        if not isinstance(_plain(value), bool):
            raise TypeError(NOUNS[bool])
        return bool(value)
    if kind is Literal:
        if value not in typing.get_args(hint):
            raise TypeError(f"one of {', '.join(map(str, typing.get_args(hint)))}")
        return value
    if kind is tuple:
        return _tuple(typing.get_args(hint), value)
    if kind is Path and isinstance(value, str):
        return Path(value)
    if kind is str and not isinstance(value, str):
        raise TypeError(NOUNS[str])
    return value


def _number(value: Any, noun: str) -> float:
    try:
        if not isinstance(value, str | bytes):
            return float(value)
    except (OverflowError, TypeError, ValueError):
        pass
    raise TypeError(noun)


def _integer(value: Any) -> int:
    try:
        made = operator.index(value)
    except TypeError:
        raise TypeError(NOUNS[int]) from None
    if abs(made) >= LARGEST_INTEGER:
        raise OverflowError
    return made


def _tuple(parts: tuple[Any, ...], value: Any) -> tuple[Any, ...]:
    endless = parts[-1] is Ellipsis
    try:
        values = None if isinstance(value, str | bytes) else tuple(value)
    except TypeError:
        values = None
    if values is None or not (endless or len(parts) == len(values)):
        raise TypeError("a list" if endless else f"a list of {len(parts)}")
    return tuple(map(_converted, [parts[0]] * len(values) if endless else parts, values))


def members(kind: type[Any]) -> dict[str, Member]:
    """Return the settings of a declared class by name, in the order of its fields."""
    found: dict[str, Member] | None = kind.__dict__.get("_members")
    if found is None:
        found = _members(kind)
        kind._members = found
    return found


def _members(kind: type[Any]) -> dict[str, Member]:
    hints = typing.get_type_hints(kind, include_extras=True)
    found: dict[str, Member] = {}
    group = getattr(kind, "group", "")
    for each in dataclasses.fields(kind):
        hint, *marks = typing.get_args(given) if typing.get_origin(given := hints[each.name]) is Annotated else [given]
        kinds = typing.get_args(hint) if typing.get_origin(hint) in (types.UnionType, typing.Union) else (hint,)
        plain: Any = typing.Union[tuple(one for one in kinds if one is not type(None))]  # noqa: UP007
        default = each.default if each.default_factory is MISSING else each.default_factory()
        setting = f"{group}.{each.name}" if group else ""
        found[each.name] = Member(each.name, plain, type(None) in kinds, default, tuple(marks), setting)
    return found


class _Documented(type):
    """The class of declared classes. Their docstring lists the settings; the list is made when somebody asks for it."""

    @property
    def __doc__(cls) -> str:  # type: ignore[override]
        own = inspect.cleandoc(cls.__dict__.get("__doc__") or "")
        if "__match_args__" not in cls.__dict__:  # dataclass() itself asks before it has the fields
            return own
        return "\n".join([own, "", "Attributes", "----------", *map(_attribute, members(cls).values())])


def _attribute(member: Member) -> str:
    facts = [member.unit.word if member.unit else "", member.rule_text]
    about = "; ".join(fact for fact in facts if fact)
    return f"{member.name}\n    {member.text}{f' ({about})' if about else ''}"


class Declared(metaclass=_Documented):
    """Base of the declared classes: each setting is checked, and converted to its type, when an object is made.

    ``group`` is what stands before the dot in the names of the settings; "": they have no names outside their file.
    """

    group: ClassVar[str] = ""

    def __init_subclass__(cls, group: str = "") -> None:
        cls.group = group or cls.group

    def __post_init__(self) -> None:
        values = self.__dict__
        for name, member in members(type(self)).items():
            if (value := values[name]) is not member.default:  # a default keeps its rules
                values[name] = member.checked(value)
        try:
            self._check()
        except InputError as error:
            if (at_fault := members(type(self)).get(error.place.partition(".")[0])) is not None:
                error.about(at_fault.setting)
            raise

    def _check(self) -> None:
        """Check the rules that concern several settings."""

    def _ordered(self, *pairs: tuple[str, str]) -> None:
        """Raise InputError unless the first setting of each pair is at most the second."""
        for least, most in pairs:
            low, high = getattr(self, least), getattr(self, most)
            if low is not None and high is not None and not low <= high:
                raise InputError(least, f"must not be larger than {most} = {high:g}", f"{low:g}")

    def changed(self) -> dict[str, object]:
        """Return the settings that are not their defaults, by name."""
        return {
            name: getattr(self, name) for name, of in members(type(self)).items() if getattr(self, name) != of.default
        }
