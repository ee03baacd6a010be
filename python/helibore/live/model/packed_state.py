"""The state of the model as a JSON value and a list of arrays, for a checkpoint.

Each class with a state lists the names of its attributes in ``STATE``; unlike with pickle, no code is stored.
"""

from __future__ import annotations

from collections import Counter, OrderedDict, deque
from dataclasses import is_dataclass
from typing import Any

import numpy as np

from helibore.live.model.events import Event
from helibore.live.model.pass_log import Pass
from helibore.live.model.watch import WatchedChannel
from helibore.live.rules.layout import Layout

RECORDS: dict[str, type] = {"Event": Event, "Pass": Pass, "Layout": Layout, "WatchedChannel": WatchedChannel}
Arrays = list[Any]


def pack(value: Any) -> tuple[Any, Arrays]:
    """Return ``value`` as a JSON value and a list of arrays; the JSON value refers to each array by its index.

    An object with a ``STATE`` becomes the attributes that its ``STATE`` names.
    """
    arrays: Arrays = []
    return _packed(value, arrays), arrays


def _packed(value: Any, arrays: Arrays) -> Any:
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, (np.ndarray, bytes, bytearray)):
        is_array = isinstance(value, np.ndarray)
        arrays.append(value if is_array else np.frombuffer(bytes(value), np.uint8))
        return {"array" if is_array else "bytes": len(arrays) - 1}
    if isinstance(value, dict):
        return {"dict": [[_packed(key, arrays), _packed(of, arrays)] for key, of in value.items()]}
    if isinstance(value, (list, tuple, set, deque)):
        kind = "tuple" if isinstance(value, tuple) else "list"
        return {kind: [_packed(one, arrays) for one in value]}
    if is_dataclass(value) and type(value).__name__ in RECORDS:
        fields = {name: _packed(getattr(value, name), arrays) for name in value.__dataclass_fields__}
        return {"record": type(value).__name__, "fields": fields}
    return {"state": {name: _packed(getattr(value, name), arrays) for name in value.STATE}}


def unpack(value: Any, packed: Any, arrays: Arrays) -> Any:
    """Return the value from which `pack` made ``packed`` and ``arrays``.

    If ``value`` is an object with a ``STATE``, or a dictionary of such objects, these objects are restored in place.
    """
    if not isinstance(packed, dict):
        return packed
    (kind, of), *more = packed.items()
    if kind == "state":
        for name, one in of.items():
            setattr(value, name, unpack(getattr(value, name), one, arrays))
        return value
    if kind == "record":
        return RECORDS[of](**{name: unpack(None, one, arrays) for name, one in more[0][1].items()})
    if kind == "array":
        return arrays[of]
    if kind == "bytes":
        return (bytearray if isinstance(value, bytearray) else bytes)(arrays[of].tobytes())
    if kind == "dict":
        known = value if isinstance(value, dict) else {}
        items = {key: unpack(known.get(key), one, arrays)
                 for key, one in ((unpack(None, key, arrays), one) for key, one in of)}  # fmt: skip
        return type(value)(items) if isinstance(value, (Counter, OrderedDict)) else items
    members = [unpack(None, one, arrays) for one in of]
    if kind == "tuple":
        return tuple(members)
    if isinstance(value, deque):
        return deque(members, maxlen=value.maxlen)
    return set(members) if isinstance(value, set) else members
