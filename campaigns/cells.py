"""Cells of CSV files that a spreadsheet cannot take for formulas. Source: OWASP, "CSV Injection". Read `safe`."""

from __future__ import annotations

FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n", "＝", "＋", "－", "＠")  # noqa: RUF001 - full-width forms count as well
"""With these a cell begins that a spreadsheet calculates."""
MARK = "'"
"""With this a cell begins that is text to a spreadsheet."""


def safe(cell: object) -> object:
    """The cell; text that a spreadsheet would calculate is marked as text. Numbers, as such or written, are unchanged."""
    if not isinstance(cell, str) or not cell.startswith(FORMULA) or _is_number(cell):
        return cell
    return MARK + cell


def plain(cell: str) -> str:
    """The text of a cell that `safe` has written."""
    return cell[1:] if cell.startswith(MARK) and cell[1:].startswith(FORMULA) else cell


def _is_number(cell: str) -> bool:
    if not cell.isascii() or cell != cell.strip():
        return False
    try:
        float(cell)
    except ValueError:
        return False
    return True
