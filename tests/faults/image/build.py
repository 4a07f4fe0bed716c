"""The image of this clone: its Dockerfile, on Debian's packages in place of the images that it begins with."""

from __future__ import annotations

from pathlib import Path

from tests.faults.image import base, context
from tests.faults.image.dockerfile import Build, Stage
from tests.faults.processes import REPOSITORY


def built(folder: Path) -> Stage:
    """Build it there; the test is skipped where that is impossible."""
    python = base.debian(folder / "python")
    bases = {"python": python, "node": base.with_node(python, folder / "node")}
    context.copied(REPOSITORY, folder / "context")
    (folder / "stages").mkdir()
    text = (REPOSITORY / "Dockerfile").read_text(encoding="utf-8")
    return Build(folder / "context", bases, folder / "stages").run(text)
