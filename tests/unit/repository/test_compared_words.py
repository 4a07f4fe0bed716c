"""How many assertions compare English: codes, numbers and ids say the same and survive another wording."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from tests.conftest import __file__ as conftest

TESTS = Path(conftest).parent
AT_MOST = 578
"""Lower it with every assertion that compares codes instead. A sentence is compared once, where it is made."""

IN_A_ROW = 4
WORD = re.compile(r"[^\w<>=/{}]*[A-Za-z]+(?:[-'’][a-z]+)*[^\w<>=/{}]*")
"""A word with its punctuation; a number, a path, markup or a name with an underscore is none."""


def words(text: str) -> int:
    """The longest row of words in it."""
    longest = row = 0
    for part in text.split():
        row = row + 1 if WORD.fullmatch(part) else 0
        longest = max(longest, row)
    return longest


def compared(tree: ast.AST) -> Iterator[ast.expr]:
    """What is asserted, the patterns of expected errors, and the texts expected in the browser."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Assert):
            yield node.test
        elif isinstance(node, ast.Call):
            name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            if name in ("raises", "warns"):
                yield from (keyword.value for keyword in node.keywords if keyword.arg == "match")
            elif re.fullmatch(r"(not_)?to_(contain|have)_text", name):
                yield from node.args


def english(tree: ast.AST) -> int:
    """How many of them contain a string with several words in a row."""
    strings = (
        [node.value for node in ast.walk(expression) if isinstance(node, ast.Constant) and isinstance(node.value, str)]
        for expression in compared(tree)
    )
    return sum(any(words(string) >= IN_A_ROW for string in found) for found in strings)


def test_what_counts() -> None:
    source = """
assert text == "it is 0.84 m and 3 s late"
assert text == "the worst case found"
assert code == "not a word of_it", "the message of an assertion counts not"
with pytest.raises(ValueError, match=r"there is no file \\S+"): pass
expect(page).to_contain_text(f"{n} runs wait for a worker")
"""
    assert [english(ast.Module([line], [])) for line in ast.parse(source).body] == [0, 1, 0, 1, 1]


def test_no_more_assertions_compare_english_than_before() -> None:
    found = {path: english(ast.parse(path.read_text(encoding="utf-8"))) for path in TESTS.rglob("*.py")}
    most = sorted(((n, path.relative_to(TESTS).as_posix()) for path, n in found.items()), reverse=True)[:10]
    assert sum(found.values()) <= AT_MOST, most
