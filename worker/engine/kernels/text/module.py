"""Loads generated code as a module with a real file, so that tracebacks and debuggers show its lines."""

from __future__ import annotations

import hashlib
import linecache
from contextlib import suppress
from types import ModuleType

from worker.engine.kernels.folder import cache_folder, store


def loaded(text: str, name: str) -> ModuleType:
    """The text as a module with a file in the cache folder; tracebacks show its lines even if that is not writable."""
    name = f"{name}_{hashlib.sha256(text.encode()).hexdigest()[:16]}"
    file = cache_folder() / "scenarios" / f"{name}.py"
    with suppress(OSError):
        if not file.exists() or file.read_text(encoding="utf-8") != text:
            store(file, text)
    linecache.cache[str(file)] = len(text), None, text.splitlines(keepends=True), str(file)
    # Cached compiled code stores the module name of its functions, which every later process must be able to import.
    module = ModuleType(__name__)
    module.__file__ = str(file)
    exec(compile(text, str(file), "exec", dont_inherit=True), vars(module))
    return module
