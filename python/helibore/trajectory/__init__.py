"""Where the hole goes: surveys, paths, and what toolfaces are measured from."""
