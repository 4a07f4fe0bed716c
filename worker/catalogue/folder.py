"""The digest of a folder: what identifies the files of a simulator, here and on every node that evaluates it."""

from __future__ import annotations

import hashlib
from pathlib import Path


def digest_of(folder: Path) -> str:
    """SHA-256 over all files of a folder, by relative path and content."""
    sink = hashlib.sha256()
    for path in sorted(p for p in folder.rglob("*") if p.is_file() and "__pycache__" not in p.parts):
        content = path.read_bytes()
        sink.update(f"{path.relative_to(folder)}\0{len(content)}\0".encode())
        sink.update(content)
    return sink.hexdigest()
