"""The folder of what is computed once: compiled loops, generated code, examinations. It needs no compiler."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path


def cache_folder() -> Path:
    """The folder of compiled loops: CLEARANCE_KERNEL_CACHE, else the user's cache folder."""
    setting = os.environ.get("CLEARANCE_KERNEL_CACHE")
    base = os.environ.get("XDG_CACHE_HOME")
    return Path(setting) if setting else (Path(base) if base else Path.home() / ".cache") / "clearance" / "kernels"


def store(file: Path, text: str) -> None:
    """Write a file of the cache as a whole, if that is possible: other processes may read or write it at that time."""
    draft = file.with_suffix(f".{os.getpid()}")
    with suppress(OSError):
        draft.parent.mkdir(parents=True, exist_ok=True)
        try:
            draft.write_text(text, encoding="utf-8")
            draft.replace(file)
        finally:
            draft.unlink(missing_ok=True)
