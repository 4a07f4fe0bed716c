"""A generated text as a module of a real file, so that tracebacks and debuggers show its lines.

Start reading at `loaded`.
"""

from __future__ import annotations

import hashlib
import linecache
import os
from contextlib import suppress
from pathlib import Path
from types import ModuleType

from worker.kernels.cache import cache_folder


def loaded(text: str, name: str) -> ModuleType:
    """The text as a module; its file is in the cache folder, its lines are known where that cannot be written."""
    name = f"{name}_{hashlib.sha256(text.encode()).hexdigest()[:16]}"
    file = cache_folder() / "scenarios" / f"{name}.py"
    with suppress(OSError):
        _write(file, text)
    linecache.cache[str(file)] = len(text), None, text.splitlines(keepends=True), str(file)
    # Compiled code on disk holds the name of its functions' module, which every later process must be able to import.
    module = ModuleType(__name__)
    module.__file__ = str(file)
    exec(compile(text, str(file), "exec", dont_inherit=True), vars(module))
    return module


def _write(file: Path, text: str) -> None:
    """Write the file in one step, unless it is there: other processes may read it, or write it at the same time."""
    if file.exists() and file.read_text(encoding="utf-8") == text:
        return
    file.parent.mkdir(parents=True, exist_ok=True)
    draft = file.with_suffix(f".{os.getpid()}")
    draft.write_text(text, encoding="utf-8")
    draft.replace(file)
