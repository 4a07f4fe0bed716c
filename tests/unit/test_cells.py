"""No text of a user is a formula in a spreadsheet; numbers stay numbers."""

from __future__ import annotations

import csv
import io
import re
from pathlib import Path

import pytest

from campaigns.cells import FORMULA, plain, safe

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("first", FORMULA)
def test_text_that_a_spreadsheet_would_calculate_is_marked(first: str) -> None:
    text = f"{first}cmd|' /C calc'!A0"
    assert safe(text) == f"'{text}"
    assert plain(str(safe(text))) == text


@pytest.mark.parametrize("cell", ["-0.8", "+1e-3", "-inf", "nan", -0.8, None, True, "R-0001", "", "a=b", "'quoted'"])
def test_numbers_and_other_text_are_unchanged(cell: object) -> None:
    assert safe(cell) == cell
    assert not isinstance(cell, str) or plain(cell) == cell


def test_every_writer_of_csv_marks_its_cells() -> None:
    """A line that gives rows to a writer gives them through `safe`."""
    for folder in ("backend", "worker"):
        for file in (ROOT / folder).rglob("*.py"):
            text = file.read_text(encoding="utf-8")
            if "csv.writer(" in text:
                written = re.findall(r"\.writerows?\(", text)
                assert len(re.findall(r"\bsafe\b", text)) > 1, f"{file}: {len(written)} writes of unmarked cells"


def test_a_marked_cell_survives_the_reader() -> None:
    out = io.StringIO()
    csv.writer(out).writerow([safe('=1+"x",\n2')])
    ((cell,),) = csv.reader(io.StringIO(out.getvalue(), newline=""))
    assert plain(cell) == '=1+"x",\n2'
