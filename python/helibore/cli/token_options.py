"""The options that say where the token of a page or of metrics comes from."""

from __future__ import annotations

from helibore.cli.quantities import FILE
from helibore.cli.sections import opt

TOKEN = (
    opt("--token", "Secret of the addresses; others can see it in the list of processes.  [HELIBORE_TOKEN, or random]"),
    opt("--token-file", "File of the secret; it is made, for you only, if it does not exist.", type=FILE),
)
