"""Checks the tables of a configuration with pydantic; every error names place, value and rule.

source.rig.units = 'SI': must be "metric" or "fps"
source.rig.itmes: is not a setting; did you mean items?
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from typing import Annotated, Any, TypeVar, get_args, get_origin

from helibore.base.errors import InputError, needs

with needs("pydantic", "live"):
    from pydantic import AfterValidator, BaseModel, ConfigDict, PlainValidator, ValidationError


class Table(BaseModel):
    """One table of a configuration; a key that is not a field is an error."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)

    def _derive(self, **values: Any) -> None:
        """Set derived fields, or convert fields to core units; only `model_post_init` may call this."""
        self.__dict__.update(values)


def _not_a_setting(_: object) -> None:
    raise InputError("", "is not a setting")


Checked = TypeVar("Checked", bound=Table)
Value = TypeVar("Value")
Derived = Annotated[Value, PlainValidator(_not_a_setting)]
"""A field that the file must not set: `Table._derive` sets it."""


def with_values(value: Any, recorded: Any) -> Any:
    """Return a copy of ``value`` that holds the values of ``recorded``, which was read from JSON.

    A field of a table or dataclass that ``recorded`` lacks keeps its value. A dict has the keys of ``recorded``: first
    those that ``value`` also has, in the order of ``value``. If two lists differ in length, the recorded list is used.
    """
    if isinstance(value, Table):
        names = type(value).model_fields.keys() & recorded.keys()
        return value.model_copy(update={name: with_values(getattr(value, name), recorded[name]) for name in names})
    if is_dataclass(value) and not isinstance(value, type):
        names = {one.name for one in fields(value)} & recorded.keys()
        return replace(value, **{name: with_values(getattr(value, name), recorded[name]) for name in names})
    if isinstance(value, dict):  # in the order of value: JSON has sorted keys
        order = [*(key for key in value if key in recorded), *(key for key in recorded if key not in value)]
        return {key: with_values(value.get(key), recorded[key]) for key in order}
    if isinstance(value, (list, tuple)) and len(value) == len(recorded):
        return type(value)(with_values(of, one) for of, one in zip(value, recorded, strict=True))
    return recorded


def within(least: float, most: float = math.inf) -> AfterValidator:
    """Return a validator that refuses numbers outside [least, most]."""

    def check(value: float) -> float:
        if not least <= value <= most:
            kind = "a whole number " if isinstance(value, int) else ""
            raise ValueError(
                f"must be {kind}" + (f"from {least:.8g} to {most:.8g}" if most < math.inf else f"at least {least:g}")
            )
        return value

    return AfterValidator(check)


def check(model: type[Checked], entries: Any, place: str = "", context: Any = None) -> Checked:
    """Return ``entries`` as a table of ``model``; the validators of ``model`` get ``context``.

    Raises
    ------
    InputError
        For the first entry that breaks a rule; ``place`` is the name of the table, such as ``source.rig``.
    """
    try:
        return model.model_validate(entries, context=context)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
    where = joined_place(place, *first["loc"])
    kind, context = first["type"], first.get("ctx", {})
    if kind == "missing":
        raise InputError(where, f"must be set: {_description(model, first['loc'])}")
    if kind == "extra_forbidden":
        key = str(first["loc"][-1])
        near = difflib.get_close_matches(key, _table_at(model, first["loc"][:-1]).model_fields, 1)
        raise InputError(where, "is not a setting" + (f"; did you mean {near[0]}?" if near else ""))
    cause = context.get("error")
    if isinstance(cause, InputError):
        raise InputError(joined_place(where, cause.place), cause.rule, cause.value)
    rules = {
        "float_type": "must be a finite number", "finite_number": "must be a finite number",
        "int_type": "must be a whole number", "string_type": "must be a text that is not empty",
        "string_too_short": "must be a text that is not empty", "list_type": "must be a list",
        "dict_type": "must be a table", "model_type": "must be a table",
        "datetime_type": "must be a date and time without quotes, such as 2026-05-01T10:00:00Z",
        "literal_error": f"must be {context.get('expected', '')}".replace("'", '"'),
    }  # fmt: skip
    raise InputError(where, str(cause) if cause else rules.get(kind, first["msg"]), repr(first["input"]))


def joined_place(*parts: str | int) -> str:
    """Return the place that the parts name, such as ``source.rig.nulls[0]``."""
    place = ""
    for part in parts:
        place += f"[{part}]" if isinstance(part, int) else f".{part}" if place and part else str(part)
    return place


def _table_at(model: type[Table], location: Sequence[str | int]) -> type[Table]:
    """Return the class of the table at ``location`` within ``model``; without a location, ``model`` itself."""
    parts = list(location)
    while parts:
        annotation = model.model_fields[str(parts.pop(0))].annotation
        if get_origin(annotation) is dict:
            parts.pop(0)  # the key
        model = next(
            kind for kind in (annotation, *get_args(annotation)) if isinstance(kind, type) and issubclass(kind, Table)
        )
    return model


def _description(model: type[Table], location: Sequence[str | int]) -> str:
    return _table_at(model, location[:-1]).model_fields[str(location[-1])].description or "a value"


def without_none(**entries: Any) -> Mapping[str, Any]:
    """Return the entries that are not None."""
    return {name: value for name, value in entries.items() if value is not None}
