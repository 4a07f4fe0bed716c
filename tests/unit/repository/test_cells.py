"""No text of a user is a formula in a spreadsheet; numbers stay numbers."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import pytest

from campaigns.cells import FORMULA, Writer, kept, plain, safe

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize("first", FORMULA)
def test_text_that_a_spreadsheet_would_calculate_is_marked(first: str) -> None:
    text = f"{first}cmd|' /C calc'!A0"
    assert safe(text) == f"'{text}"
    assert plain(str(safe(text))) == text


@pytest.mark.parametrize("cell", ["-0.8", "+1e-3", "-inf", "nan", -0.8, None, True, "R-0001", "", "a=b", "'quoted'"])
def test_numbers_and_other_text_are_unchanged(cell: object) -> None:
    assert safe(cell) == cell
    assert not isinstance(cell, str) or plain(cell) == cell


@pytest.mark.parametrize("text", ["-mode", "'-mode", "''=x", "'-0.8", "-0.8", "'quoted'", "'", ""])
def test_text_that_looks_marked_is_kept(text: str) -> None:
    cell = safe(kept(text))
    assert isinstance(cell, str)
    assert plain(cell) == text


def test_all_files_are_written_with_marked_cells() -> None:
    for folder in ("backend", "worker", "campaigns"):
        for file in (ROOT / folder).rglob("*.py"):
            if file != ROOT / "campaigns" / "cells.py":
                assert "csv.writer(" not in file.read_text(encoding="utf-8"), f"{file}: use campaigns.cells.Writer"


def test_a_marked_cell_survives_the_reader() -> None:
    out = io.StringIO()
    Writer(out).writerows([['=1+"x",\n2', -1.5], ["-", "+1"]])
    assert list(csv.reader(io.StringIO(out.getvalue(), newline=""))) == [['\'=1+"x",\n2', "-1.5"], ["'-", "+1"]]
