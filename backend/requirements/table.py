"""Reads requirements from CSV files (RFC 4180)."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator

from backend.requirements.reqif import CannotRead, Read, numbered
from campaigns.cells import plain

IDS = ("id", "requirement", "requirement id", "uid", "reqif.foreignid")
TEXTS = ("text", "description", "statement", "object text", "reqif.text")
"""Headers of the columns, in any case."""
EXPORTED = ("id", "text", "status", "why", "file")
"""The first columns of our own export, which marks cells; in any other file an apostrophe is part of the text."""


def read(content: bytes, id_name: str = "", text_name: str = "") -> tuple[list[Read], int]:
    """The requirements of a file, in its order, and how many lines without a text were skipped; raises `CannotRead`.

    Separated by commas or semicolons, with a header.
    """
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise CannotRead(f"the file is not UTF-8 text (byte {error.start}): save it as CSV UTF-8") from None
    if "\0" in text:
        raise CannotRead("the file contains null characters: save it as CSV UTF-8")
    header = text.split("\n", 1)[0]
    lines = csv.reader(
        io.StringIO(text, newline=""), delimiter=";" if header.count(";") > header.count(",") else ",", strict=True
    )
    try:
        return _requirements(lines, id_name, text_name)
    except csv.Error as error:
        raise CannotRead(f"line {lines.line_num} is not readable as CSV: {error}") from None


def _requirements(lines: Iterator[list[str]], id_name: str, text_name: str) -> tuple[list[Read], int]:
    header = [name.strip() for name in next(lines, [])]
    ours = tuple(header[: len(EXPORTED)]) == EXPORTED
    header = numbered(plain(name) if ours else name for name in header)
    key = _column(header, (id_name,) if id_name else IDS, "id")
    text = _column(header, (text_name,) if text_name else TEXTS, "text")
    found, skipped = [], 0
    for number, cells in enumerate(lines, 2):
        line = [plain(cell) for cell in cells] if ours else cells
        if not any(cell.strip() for cell in line):
            continue
        if len(line) != len(header):
            raise CannotRead(f"row {number} has {len(line)} columns, the header has {len(header)}")
        if not line[text].strip():
            skipped += 1
            continue
        rest = {header[i]: cell for i, cell in enumerate(line) if i not in (key, text) and header[i] and cell.strip()}
        found.append(Read(line[key].strip(), line[text].strip(), rest))
    if not found:
        raise CannotRead("the file has no row with a text")
    return found, skipped


def _column(header: list[str], names: Iterable[str], what: str) -> int:
    wanted = [name.lower() for name in names]
    for name in wanted:
        for i, heading in enumerate(header):
            if heading.lower() == name:
                return i
    raise CannotRead(
        f"no column for the {what}: the header has {', '.join(header)[:200] or 'nothing'}; it needs {wanted[0]!r}, or "
        "name the column"
    )
