"""Refuse to start processes from a script if each new process would start processes again.

A new process runs the user's script from its top, except the part below ``if __name__ == "__main__":``. Without that
line, each new process makes the same call again, and ends with a traceback.
"""

from __future__ import annotations

import ast
import sys
from pathlib import Path

from helibore.base.errors import InputError


def check_main_guard(caller: str) -> None:
    """Refuse a call of ``caller`` at the top level of the running script, unless the call stands below an ``if``."""
    main = vars(sys.modules["__main__"])
    file, spec = main.get("__file__"), main.get("__spec__")
    if file is None or (spec is not None and spec.name.endswith("__main__")):  # a prompt or __main__.py: not run again
        return
    frame = sys._getframe()
    while frame.f_back is not None and not (frame.f_code.co_name == "<module>" and frame.f_globals is main):
        frame = frame.f_back
    if frame.f_globals is not main or frame.f_code.co_name != "<module>":  # called in another thread
        return
    try:
        tree = ast.parse(Path(file).read_bytes())
    except (OSError, SyntaxError):
        return
    line = frame.f_lineno
    if not any(isinstance(node, ast.If) and node.lineno <= line <= (node.end_lineno or line) for node in tree.body):
        rule = (
            f'must stand, indented, below the line if __name__ == "__main__": because {caller} starts processes, and '
            "each process runs this file again from its top"
        )
        raise InputError(f"{Path(file).name}, line {line}", rule)
