"""The files below a folder, also those of folders that are linked into it, under the names by which it shows them."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path


def files_below(folder: Path) -> list[Path]:
    """All files below a folder in order, without bytecode."""
    return sorted(Path(inner, name) for inner, names in walked(str(folder)) for name in names)


def walked(folder: str, around: tuple[str, ...] = ()) -> Iterator[tuple[str, list[str]]]:
    """Each folder with the names of its files.

    A link back to a folder that it is in (`around`) shows nothing else and is left out, and so is what cannot be read:
    nothing that runs as this user reads it.
    """
    place, names = os.path.realpath(folder), list[str]()
    if place in around:
        return
    with contextlib.suppress(FileNotFoundError, NotADirectoryError, PermissionError):
        names = sorted(os.listdir(folder))
    yield folder, [name for name in names if os.path.isfile(os.path.join(folder, name))]
    for name in names:
        inner = os.path.join(folder, name)
        if name != "__pycache__" and os.path.isdir(inner):
            yield from walked(inner, (*around, place))
