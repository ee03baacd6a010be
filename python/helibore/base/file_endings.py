"""Endings of the files of a wall. The command line names them in its help, without the modules that write the files."""

from __future__ import annotations

ARCHIVE_ENDING = ".wall"
"""Ending of the file that `Wall.save` writes."""
SURFACE_ENDINGS = (".glb", ".ply", ".obj", ".stl", ".vtu", ".vtp", ".vtkhdf")
"""Endings of the files that `Surface.save` writes."""
VOLUME_ENDINGS = (".vtu", ".vtkhdf")
"""Endings of the files that `Volume.save` writes."""
