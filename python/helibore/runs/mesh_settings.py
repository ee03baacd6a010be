"""The settings beside what ``helibore mesh`` wrote: its options, and the checksums of the files they name; and back.

    helibore = "0.1.0"
    [output]    file = "well.vtu"    blake2b = "..."
    [mesh]      average = "log.json:CALCM"    sectors = 64    pitch = 0.1 ...
    [[file]]    name = "log.json"    blake2b = "..."

Options have the names they have in Python, lengths are metres, files are named relative to the settings. Defaults are
written, too, where they have a say: a later version with other defaults repeats the mesh. What columns mean is guessed
anew where no option says it; the checksum of the output tells whether it is the same.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from helibore import __version__
from helibore.cli.reading import nulls
from helibore.cli.wall_source import idle

FILES = ("source", "maps", "survey", "survey_map")  # options that are files, or begin with one
SPELLED = ("average", "images")
ELSEWHERE = ("output", "from_settings", "quiet", "help")


@dataclass(frozen=True)
class MeshSettings:
    """What repeats a mesh: the words of its command line, and the checksum of what they made."""

    words: list[str]
    blake2b: str


def inputs(options: dict[str, Any]) -> list[Path]:
    """Return every file that the options name, once."""
    named = [(name, str(value)) for name in (*FILES, *SPELLED) for value in _every(options[name])]
    return list(dict.fromkeys(_divided(name, text)[0] for name, text in named))


def write_mesh_settings(command: click.Command, options: dict[str, Any], files: dict[Path, str], blake2b: str) -> None:
    """Write the settings of ``options["output"]`` beside it, whole or not at all, with the checksums of all files."""
    from helibore.base.atomic_file import write_whole
    from helibore.channels.role_map import quoted
    from helibore.runs.run_settings import relative, settings_file, written

    output = options["output"]
    path = settings_file(output)
    folder = path.resolve().parent
    lines = [f"# Repeat this mesh: helibore mesh --from-settings {path.name} -o OUTPUT",
             f"helibore = {quoted(__version__)}", "", "[output]", f"file = {quoted(relative(output, folder))}",
             f"blake2b = {quoted(blake2b)}", "", "[mesh]"]  # fmt: skip
    unheeded = (*idle(options)[0], *ELSEWHERE)
    for name in (option.name or "" for option in command.params):
        value = nulls(options) if name == "absent" else options.get(name)
        if name in unheeded or (value is None and name != "max_distance") or value is False or value == ():
            continue
        if name in (*FILES, *SPELLED):
            parts = [_divided(name, str(each)) for each in _every(value)]
            moved = tuple(relative(file, folder) + rest for file, rest in parts)
            value = moved if isinstance(value, tuple) else moved[0]
        lines.append(f"{name} = {written(value)}")
    for file, known in files.items():
        lines += ["", "[[file]]", f"name = {quoted(relative(file, folder))}", f"blake2b = {quoted(known)}"]
    content = "\n".join([*lines, ""]).encode()
    write_whole(path, lambda target: target.write(content))


def read_mesh_settings(path: Path, command: click.Command) -> MeshSettings:
    """Read the settings of a mesh and check that the files they name are as they were.

    Raises
    ------
    ValueError
        Naming the file, the key and the rule, or the file that has changed and both checksums.
    OSError
        If a file cannot be read.
    """
    import tomllib

    from helibore.runs.run_settings import require_unchanged

    try:
        tree = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path.name}: not TOML: {error}") from error
    if not isinstance(tree.get("mesh"), dict):
        raise ValueError(f"{path.name}: mesh: is missing: no settings of helibore mesh")
    known = {}
    for at, each in enumerate(tree.get("file", []), 1):
        if not (isinstance(each, dict) and isinstance(each.get("name"), str) and isinstance(each.get("blake2b"), str)):
            raise ValueError(f"{path.name}: file {at}: must have a name and its blake2b")
        known[path.parent / each["name"]] = each["blake2b"]
    options = {option.name: option for option in command.params if option.name not in ELSEWHERE}
    words, behind = [], []
    for name, value in tree["mesh"].items():
        if name not in options:
            raise ValueError(f"{path.name}: mesh.{name}: must be one of {', '.join(str(one) for one in options)}")
        if options[name].nargs > 1:
            words += [f"--{name}", *map(str, value)]
            continue
        for each in value if isinstance(value, list) else [value]:
            text = str(each)
            if name in (*FILES, *SPELLED):
                file, rest = _divided(name, text)
                file = path.parent / file
                if file not in known:
                    raise ValueError(f"{path.name}: mesh.{name} = {text!r}: no [[file]] has its blake2b")
                text = f"{file}{rest}"
            if name == "source":
                behind = ["--", text]
            else:
                option = max(options[name].opts, key=len)
                words.append(option if each is True else f"{option}={text}")
    for file, blake2b in known.items():
        require_unchanged(file, blake2b)
    output = tree.get("output")
    return MeshSettings([*words, *behind], str(output.get("blake2b", "")) if isinstance(output, dict) else "")


def _every(value: Any) -> Iterator[Any]:
    yield from value if isinstance(value, tuple) else () if value is None else (value,)


def _divided(name: str, text: str) -> tuple[Path, str]:
    """The file that an option's text begins with, and what follows it: ``:CHANNEL`` and so on."""
    behind = {"average": 1, "images": 3 if text.endswith((":north", ":high-side")) else 2}.get(name, 0)
    file = text.rsplit(":", behind)[0] if behind else text
    return Path(file), text[len(file) :]
