"""Capsules of a violated run, and their files as they are or changed."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import pytest

from clearance.cli._capsule import write_capsules
from tests.given.corrupted_records import ran
from worker.engine.stages.parts import offered


def few_checks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few checks, as in the tests of replay, so that they share their runs."""
    monkeypatch.setattr(offered, "SPOT_CHECKS", 2)
    monkeypatch.setattr(offered, "AT_MOST", 3)


def written(folder: Path) -> Path:
    """The capsule of the worst finding of the run."""
    write_capsules(folder, *ran("violated"), None)
    return folder / "capsule-F1.zip"


def files_of(path: Path) -> dict[str, bytes]:
    """The files in a capsule by name."""
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def zipped(files: dict[str, bytes], *more: tuple[str, bytes]) -> bytes:
    """Files as a capsule; more: further ones, also of the same name."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in [*files.items(), *more]:
            archive.writestr(name, data)
    return buffer.getvalue()
