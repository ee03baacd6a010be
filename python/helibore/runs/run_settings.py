"""What a run was made of and with, as a TOML file beside its mesh; and back.

    helibore = "0.1.0"
    [output]         file = "wall.glb"      blake2b = "..."
    [[caliper]]      file = "caliper.csv"   blake2b = "..."    [[caliper.channel]]  name = "md_m"  role = "depth" ...
    [survey]         the same
    [preparation]    [path]    [wall]       settings by the names they have in Python

Files are named relative to the settings file. Every setting is written, defaults too: a later version with other
defaults repeats the run. Not here: running (``run``).
"""

from __future__ import annotations

import hashlib
import math
import os
import types
import typing
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, get_type_hints

from helibore import __version__
from helibore.base.atomic_file import write_whole
from helibore.base.settings import Settings
from helibore.channels.role_map import quoted
from helibore.channels.roles import Role, RoleMap
from helibore.preparation.conditioning import Echo
from helibore.preparation.prepare import Preparation

__all__ = ["Input", "PathSettings", "RunSettings", "checksum", "read_settings", "settings_file", "write_settings"]

NULLS = (-999.25, -9999.0, -9999.25)
"""Numbers that mean no value, unless a run says otherwise: ``helibore.base.nulls.NULLS``."""

KEYS = ("helibore", "nulls", "color_by", "output", "caliper", "survey", "track", "echo", "preparation", "path", "wall")


@dataclass(frozen=True)
class Input:
    """A file that was read, one set of it, and what its channels were taken for.

    Attributes
    ----------
    file
        The file.
    blake2b
        Of its bytes, in hexadecimal; "" while not known.
    roles
        The set's name and the role of every channel used.
    """

    file: Path
    blake2b: str
    roles: RoleMap


@dataclass(frozen=True, kw_only=True)
class PathSettings:
    """How a survey becomes a path; see `helibore.Survey.path`."""

    method: str = "minimum-curvature"
    reference: str = "high-side"
    head: tuple[float, ...] = (0.0, 0.0, 0.0)
    extend: float = 0.0


@dataclass(frozen=True, kw_only=True)
class RunSettings:
    """Everything that decides the bytes of a mesh.

    Attributes
    ----------
    caliper
        One or more files of one hole, earliest first.
    wall
        What the wall is built with.
    survey, track
        The survey; and depth and toolface by time. None without.
    echo
        How travel times become radii; None without.
    preparation, path
        What was done to the readings, and how the survey became a path.
    nulls
        Numbers that mean no value.
    color_by
        Attribute that colours the mesh; None: the radius.
    output, output_blake2b
        The mesh and the checksum of its bytes; None and "" before it is written.
    version
        Of helibore.
    """

    caliper: tuple[Input, ...]
    wall: Settings
    survey: Input | None = None
    track: Input | None = None
    echo: Echo | None = None
    preparation: Preparation = field(default_factory=Preparation)
    path: PathSettings = field(default_factory=PathSettings)
    nulls: tuple[float, ...] = NULLS
    color_by: str | None = None
    output: Path | None = None
    output_blake2b: str = ""
    version: str = __version__

    @property
    def inputs(self) -> tuple[Input, ...]:
        """Every file the run reads."""
        return (*self.caliper, *(one for one in (self.survey, self.track) if one is not None))


def settings_file(output: str | os.PathLike[str]) -> Path:
    """Where the settings of a mesh stand: ``wall.glb.toml`` beside ``wall.glb``."""
    output = Path(output)
    return output.with_name(f"{output.name}.toml")


def checksum(path: str | os.PathLike[str]) -> str:
    """BLAKE2b of a file's bytes, 256 bits, as ``b2sum -l 256`` prints it: half the time of SHA-256."""
    with Path(path).open("rb") as file:
        return hashlib.file_digest(file, lambda: hashlib.blake2b(digest_size=32)).hexdigest()


def require_unchanged(file: Path, blake2b: str) -> None:
    """Raise a ValueError with both checksums if a file is not as it was."""
    found = checksum(file)
    if found != blake2b:
        raise ValueError(
            f"{file}: has changed since the run: its BLAKE2b is {found}, the settings have {blake2b}; "
            "only the same file repeats it"
        )


def write_settings(path: str | os.PathLike[str], settings: RunSettings) -> None:
    """Write settings as TOML, whole or not at all."""
    folder = Path(path).resolve().parent
    lines = [f"# Repeat this run: helibore reconstruct --from-settings {Path(path).name} -o OUTPUT",
             f"helibore = {quoted(settings.version)}", f"nulls = {written(settings.nulls)}"]  # fmt: skip
    if settings.color_by is not None:
        lines.append(f"color_by = {quoted(settings.color_by)}")
    if settings.output is not None:
        lines += ["", "[output]", f"file = {quoted(relative(settings.output, folder))}"]
        lines.append(f"blake2b = {quoted(settings.output_blake2b)}")
    for one in settings.caliper:
        lines += ["", "[[caliper]]", *_input_lines(one, folder, "caliper")]
    for name, found in (("survey", settings.survey), ("track", settings.track)):
        if found is not None:
            lines += ["", f"[{name}]", *_input_lines(found, folder, name)]
    for name in ("echo", "preparation", "path", "wall"):
        group = getattr(settings, name)
        if group is not None:
            lines += ["", f"[{name}]", *_group_lines(group)]
    content = "\n".join([*lines, ""]).encode()
    write_whole(path, lambda file: file.write(content))


def relative(path: Path, folder: Path) -> str:
    """Return the name of a file as seen from a folder, with slashes."""
    try:
        return Path(os.path.relpath(path.resolve(), folder)).as_posix()
    except ValueError:  # another drive
        return path.resolve().as_posix()


def _input_lines(one: Input, folder: Path, table: str) -> list[str]:
    lines = [f"file = {quoted(relative(one.file, folder))}", f"blake2b = {quoted(one.blake2b)}"]
    if one.roles.set_name is not None:
        lines.append(f"set = {quoted(one.roles.set_name)}")
    for role in one.roles:
        if role.role != "none":
            lines += ["", f"[[{table}.channel]]", *_group_lines(role, sparse=True)]
    return lines


def _group_lines(group: Any, sparse: bool = False) -> list[str]:
    """A line a field; None is left out where it is the default, else written as "none". ``sparse``: no defaults."""
    lines = []
    for each in fields(group):
        value = getattr(group, each.name)
        if value != each.default if sparse else value is not None or each.default is not None:
            lines.append(f"{each.name} = {written(value)}")
    return lines


def written(value: Any) -> str:
    """Return a value as TOML; None as "none"."""
    if value is None:
        return '"none"'
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return quoted(value)
    if isinstance(value, tuple):
        return f"[{', '.join(written(one) for one in value)}]"
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else str(value)
    return str(int(value))


def read_settings(path: str | os.PathLike[str]) -> RunSettings:
    """Read the settings of a run; nothing it names is opened.

    Returns
    -------
    RunSettings
        With files as paths that can be opened from here.

    Raises
    ------
    ValueError
        Naming the file, the table, the key and the rule.
    OSError
        If it cannot be read.
    """
    import tomllib

    path = Path(path)
    try:
        tree = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path.name}: not TOML: {error}") from error
    if "mesh" in tree:
        raise ValueError(f"{path.name}: settings of helibore mesh, which repeats them by --from-settings {path.name}")
    for key in tree:
        if key not in KEYS:
            raise ValueError(f"{path.name}: {key}: must be one of {', '.join(KEYS)}")
    for key in ("helibore", "caliper", "wall"):
        if key not in tree:
            raise ValueError(f"{path.name}: {key}: is missing: no settings of a run")
    reader = _Reader(path)
    calipers = tree["caliper"]
    if not isinstance(calipers, list) or not calipers:
        raise ValueError(f"{path.name}: caliper: must be one table or more, [[caliper]]")
    output = reader.table(tree, "output", {"file", "blake2b"})
    return RunSettings(
        caliper=tuple(reader.input(f"caliper {number}", one) for number, one in enumerate(calipers, 1)),
        wall=reader.group("wall", Settings, tree["wall"]),
        survey=reader.input("survey", tree["survey"]) if "survey" in tree else None,
        track=reader.input("track", tree["track"]) if "track" in tree else None,
        echo=reader.group("echo", Echo, tree["echo"]) if "echo" in tree else None,
        preparation=reader.group("preparation", Preparation, tree.get("preparation", {})),
        path=reader.group("path", PathSettings, tree.get("path", {})),
        nulls=reader.value("nulls", tuple[float, ...], tree.get("nulls", list(NULLS))),
        color_by=reader.value("color_by", str, tree["color_by"]) if "color_by" in tree else None,
        output=reader.folder / reader.value("output.file", str, output["file"]) if "file" in output else None,
        output_blake2b=reader.value("output.blake2b", str, output.get("blake2b", "")),
        version=reader.value("helibore", str, tree["helibore"]),
    )


class _Reader:
    """Values of a TOML tree as the types the dataclasses state, each error with its place."""

    def __init__(self, path: Path) -> None:
        self.name, self.folder = path.name, path.parent

    def table(self, tree: dict[str, Any], name: str, keys: set[str]) -> dict[str, Any]:
        found = tree.get(name, {})
        if not isinstance(found, dict):
            raise ValueError(f"{self.name}: {name}: must be a table")
        for key in found:
            if key not in keys:
                raise ValueError(f"{self.name}: {name}.{key}: must be one of {', '.join(sorted(keys))}")
        return found

    def input(self, name: str, tree: Any) -> Input:
        found = self.table({name: tree}, name, {"file", "blake2b", "set", "channel"})
        for key in ("file", "blake2b"):
            if key not in found:
                raise ValueError(f"{self.name}: {name}.{key}: is missing")
        channels = found.get("channel", [])
        if not isinstance(channels, list):
            raise ValueError(f"{self.name}: {name}.channel: must be tables")
        roles = [self.group(f"{name}.channel {at}", Role, one) for at, one in enumerate(channels, 1)]
        set_name = self.value(f"{name}.set", str, found["set"]) if "set" in found else None
        file = self.folder / self.value(f"{name}.file", str, found["file"])
        blake2b = self.value(f"{name}.blake2b", str, found["blake2b"])
        return Input(file, blake2b, RoleMap(set_name, {role.channel: role for role in roles}))

    def group(self, name: str, kind: type[Any], tree: Any) -> Any:
        hints = get_type_hints(kind)
        found = self.table({name: tree}, name, set(hints))
        values = {key: self.value(f"{name}.{key}", hints[key], value) for key, value in found.items()}
        try:
            return kind(**values)
        except (TypeError, ValueError) as error:
            raise ValueError(f"{self.name}: {name}: {error}") from error

    def value(self, place: str, hint: Any, value: Any) -> Any:
        """One value as its type: "none" stands for None where that is allowed."""
        options = typing.get_args(hint) if isinstance(hint, types.UnionType) else (hint,)
        if type(None) in options and value == "none":
            return None
        (wanted,) = (one for one in options if one is not type(None))
        if typing.get_origin(wanted) is tuple:
            parts = typing.get_args(wanted)
            if isinstance(value, list) and (parts[-1] is Ellipsis or len(parts) == len(value)):
                kinds = [parts[0]] * len(value) if parts[-1] is Ellipsis else parts
                return tuple(self.value(place, kind, one) for kind, one in zip(kinds, value, strict=True))
            raise ValueError(f"{self.name}: {place} = {value!r}: must be a list")
        number = isinstance(value, int | float) and not isinstance(value, bool)
        if wanted is float and number:
            return float(value)
        if isinstance(value, wanted) and (wanted is bool or not isinstance(value, bool)):
            return value
        words = {float: "a number", int: "a whole number", str: "text", bool: "true or false"}
        raise ValueError(f"{self.name}: {place} = {value!r}: must be {words[wanted]}")
