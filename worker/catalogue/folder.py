"""The digests of folders: what identifies the files of a simulator, here and on every node that evaluates it."""

from __future__ import annotations

import hashlib
import importlib.util
from collections.abc import Mapping
from pathlib import Path


def digest_of(folder: Path) -> str:
    """SHA-256 over all files of a folder, by relative path and content."""
    sink = hashlib.sha256()
    for path in sorted(p for p in folder.rglob("*") if p.is_file() and "__pycache__" not in p.parts):
        content = path.read_bytes()
        sink.update(f"{path.relative_to(folder)}\0{len(content)}\0".encode())
        sink.update(content)
    return sink.hexdigest()


def digest_of_place(place: Mapping[str, str]) -> str:
    """SHA-256 over the file of a function and the other Python files of its folder, or over its package."""
    if "file" in place:
        return _over(Path(place["file"]).parent, packages=True)
    spec = importlib.util.find_spec(place["module"].partition(".")[0])
    if spec is not None and spec.submodule_search_locations:
        return _over(Path(next(iter(spec.submodule_search_locations))), packages=True)
    return hashlib.sha256(Path(spec.origin).read_bytes() if spec and spec.origin else b"").hexdigest()


def _over(folder: Path, packages: bool) -> str:
    """The Python files of a folder, and of the packages in it."""
    sink = hashlib.sha256()

    def add(folder: Path, prefix: str) -> None:
        for path in sorted(folder.iterdir()):
            if path.suffix == ".py" and path.is_file():
                content = path.read_bytes()
                sink.update(f"{prefix}{path.name}\0{len(content)}\0".encode())
                sink.update(content)
            elif packages and (path / "__init__.py").is_file():
                add(path, f"{prefix}{path.name}/")

    add(folder, "")
    return sink.hexdigest()
