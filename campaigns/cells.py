"""CSV files (RFC 4180) whose cells a spreadsheet cannot take for formulas. Source: OWASP, "CSV Injection"."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from _typeshed import SupportsWrite


class Writer:
    """Writes rows; text that a spreadsheet would calculate is marked as text."""

    def __init__(self, out: SupportsWrite[str]) -> None:
        self._writer = csv.writer(out)

    def writerow(self, cells: Iterable[object]) -> None:
        self._writer.writerow([safe(cell) for cell in cells])

    def writerows(self, rows: Iterable[Iterable[object]]) -> None:
        self._writer.writerows([safe(cell) for cell in row] for row in rows)


FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n", "＝", "＋", "－", "＠")
"""With these a cell begins that a spreadsheet calculates."""
MARK = "'"
"""With this a cell begins that is text to a spreadsheet."""


def safe(cell: object) -> object:
    """The cell; text that a spreadsheet would calculate is marked as text; numbers are unchanged."""
    if not isinstance(cell, str) or not cell.startswith(FORMULA) or _is_number(cell):
        return cell
    return MARK + cell


def kept(text: str) -> str:
    """The text for a file that is read again: one that looks as if `safe` had marked it has one mark more."""
    return MARK + text if _marked(text) else text


def plain(cell: str) -> str:
    """The text of a cell that `kept` and `safe` have written."""
    return cell[1:] if _marked(cell) else cell


def _marked(cell: str) -> bool:
    return cell.startswith(MARK) and cell.lstrip(MARK).startswith(FORMULA)


def _is_number(cell: str) -> bool:
    if not cell.isascii() or cell != cell.strip():
        return False
    try:
        float(cell)
    except ValueError:
        return False
    return True
