"""Large libraries that few tests need: imported in those tests, because every worker imports every file of tests."""

from __future__ import annotations

from typing import Any

import pytest


def pyvista() -> Any:
    """PyVista; pytest asks a module for attributes when it collects, and PyVista would load all of plotting."""
    return pytest.importorskip("pyvista", reason="PyVista reads the files: pip install pyvista", exc_type=ImportError)


def trimesh() -> Any:
    return pytest.importorskip("trimesh")
