"""The files that commands save from a service into a folder, and which files there they may replace.

A hidden list in the folder has the SHA-256 of every file that was saved, before it gets its name. A file that is not in
the list, or was changed since, is the user's: nothing replaces it.
"""

from __future__ import annotations

import hashlib
import os
import secrets
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

from campaigns.refusals import RefusalCode
from clearance.cli import WrongInputError, on_disk
from clearance.local import RESULT

T = TypeVar("T")
LIST = ".clearance-files"
"""The list: a line per file as `sha256sum` writes it. It only grows, so that commands at the same time lose no line."""


def others_files(folder: Path, names: Iterable[str]) -> list[str]:
    """Those of the names in the folder that are there and were not saved by a command, or were changed since."""
    with on_disk(f"{folder} cannot be read"):
        there = [name for name in names if os.path.lexists(folder / name)]
        lines = _lines(folder) if there else set()
        return [name for name in there if not _saved(folder / name, lines)]


def same_file(file: Path, source: Path | None) -> bool:
    """Whether a file is there and is the campaign file, if one was given."""
    return source is not None and file.exists() and source.exists() and file.samefile(source)


def refuse_to_replace(out: Path | None, names: Iterable[str], source: Path | None = None) -> None:
    """Raises `WrongInputError` if a file of these names in the folder is the user's, or the folder has results of
    `clearance run`. source: the campaign file."""
    if out is None:
        return
    names = tuple(names)
    if os.path.lexists(out / RESULT):
        raise WrongInputError(
            f"--out {out}: the folder has results of `clearance run` ({RESULT}), which would be mixed with the files "
            "of a service; give another folder",
            RefusalCode.EXISTS,
        )
    if any(same_file(out / name, source) for name in names):
        raise WrongInputError(
            f"--out {out}: the campaign file {source} is in it, and would be replaced; give another folder",
            RefusalCode.EXISTS,
        )
    if others := others_files(out, names):
        raise WrongInputError(
            f"--out {out}: {', '.join(others)} in it would be replaced, and was not saved there by such a command, or "
            "was changed since; give another folder, or delete what may be replaced",
            RefusalCode.EXISTS,
        )


@contextmanager
def saving(out: Path) -> Iterator[Path]:
    """A folder, not made yet, for files to be saved; at the end those in it are listed and moved to `out`."""
    part = out / f".saving-{secrets.token_hex(4)}"
    try:
        yield part
    finally:
        try:
            for file in sorted(part.iterdir()) if part.exists() else ():
                _list(out, file)
                file.replace(out / file.name)
        finally:
            shutil.rmtree(part, ignore_errors=True)


def save(out: Path, download: Callable[[Path], T]) -> T:
    """Save files with `download`, which writes them into the folder that it gets; raises `WrongInputError`."""
    with on_disk(f"the folder {out} cannot be written"), saving(out) as part:
        return download(part)


def _saved(file: Path, lines: set[str]) -> bool:
    return file.is_file() and _line(file) in lines


def _line(file: Path) -> str:
    with file.open("rb") as content:
        return f"{hashlib.file_digest(content, 'sha256').hexdigest()}  {file.name}"


def _lines(folder: Path) -> set[str]:
    try:
        return set((folder / LIST).read_text("utf-8", "replace").splitlines())
    except FileNotFoundError:
        return set()


def _list(folder: Path, file: Path) -> None:
    line = _line(file)
    if line not in _lines(folder):
        with (folder / LIST).open("a", encoding="utf-8") as out:
            out.write(f"{line}\n")
