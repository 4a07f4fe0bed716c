"""A threshold is drawn with all its digits: beside a rounded one, a value that violates would read as equal to it."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from backend.reports import figures
from backend.scenes.base.setting import Setting
from campaigns.claims.numbers import exact, limit
from tests.conftest import __file__ as conftest

ROOT = Path(conftest).parents[1]
PLACES = ("backend", "clearance", "tools")
ROUND = {"fixed", "number", "plain", "printed", "written"}
"""The functions that write a number with six digits, unless more are asked for."""
LIMIT = 0.50000004


def is_threshold(node: ast.expr) -> bool:
    return (getattr(node, "attr", None) or getattr(node, "id", "")).endswith("threshold")


def rounded(tree: ast.AST) -> Iterator[int]:
    """The lines where a threshold is formatted, or written with a number of digits that does not follow from it."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FormattedValue) and is_threshold(node.value):
            if node.format_spec is not None and node.conversion != ord("r"):
                yield node.lineno
        elif isinstance(node, ast.Call) and node.args and is_threshold(node.args[0]):
            name = getattr(node.func, "attr", None) or getattr(node.func, "id", "")
            if name in ROUND and "digits" not in {keyword.arg for keyword in node.keywords}:
                yield node.lineno


def test_no_threshold_is_rounded_where_it_is_shown() -> None:
    texts = {file: file.read_text("utf-8") for place in PLACES for file in (ROOT / place).rglob("*.py")}
    named = {file: text for file, text in texts.items() if "threshold" in text}
    found = [f"{file.relative_to(ROOT)}:{k}" for file, text in named.items() for k in rounded(ast.parse(text))]
    assert found == []


def test_charts_and_3d_views_show_all_digits_of_a_threshold() -> None:
    of = figures.Quantity("d_min", "m", LIMIT)
    assert f"Criterion, {exact(LIMIT)} m" in figures.convergence([("#000", "A", [(1.0, 0.6), (9.0, 0.5)])], of)
    assert f"Criterion, {exact(LIMIT)} m" in figures.separation([], of)
    plain: Any = dict.fromkeys(Setting.__dataclass_fields__)
    assert (
        Setting(**plain | {"quantity": "d_min", "unit": "m", "threshold": LIMIT}).criterion
        == f"d_min > {limit(LIMIT)} m"
    )
    assert (exact(LIMIT), limit(LIMIT)) == ("0.50000004", "0.50000004")
