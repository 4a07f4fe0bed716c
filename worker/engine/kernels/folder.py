"""The folder of what is computed once: compiled loops, generated code, examinations. It needs no compiler."""

from __future__ import annotations

import os
from pathlib import Path


def cache_folder() -> Path:
    """The folder of compiled loops: CLEARANCE_KERNEL_CACHE, else the user's cache folder."""
    setting = os.environ.get("CLEARANCE_KERNEL_CACHE")
    base = os.environ.get("XDG_CACHE_HOME")
    return Path(setting) if setting else (Path(base) if base else Path.home() / ".cache") / "clearance" / "kernels"
