"""Where tests find the project's own files, and the real data beside it (tests that need these skip without them)."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).parents[2]
SHARED = ROOT.parent / "shared" / "data"
WEB = ROOT / "python" / "helibore" / "viewer" / "web"
