"""A third-party package with components and methods, in a folder."""

from __future__ import annotations

from pathlib import Path


def package(folder: Path, group: str, name: str, text: str) -> None:
    """An installed package with one entry point."""
    (folder / f"{name}.py").write_text(text, encoding="utf-8")
    info = folder / f"{name}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n", encoding="utf-8")
    (info / "entry_points.txt").write_text(f"[{group}]\n{name} = {name}\n", encoding="utf-8")
