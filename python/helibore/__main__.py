"""``python -m helibore``: the command line."""

from helibore.cli import main

main()
