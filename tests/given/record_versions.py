"""Records that state each version of the rules, and whether their verdict follows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from tests.given.corrupted_records import Folder, copied
from worker.evidence.audit.judge import closing


def follows(folder: Folder, version: int | None) -> bool:
    """Whether the verdict follows from the record that states this version."""
    if version is None:
        folder.forget_seal()
    else:
        folder.result["versions"] |= {"wording": version}
        folder.reseal()
    return closing(folder.items())[0]


def copies(folder: Path, versions: Sequence[int | None]) -> Iterator[tuple[int | None, Folder]]:
    """The record for each of these versions."""
    original = {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*") if file.is_file()}
    for version in versions:
        yield version, Folder(copied(original, folder))
