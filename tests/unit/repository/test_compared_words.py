"""How many assertions compare English: codes, numbers and ids say the same and survive another wording."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

import pytest

from tests.conftest import __file__ as conftest

TESTS = Path(conftest).parent
AT_MOST = 154
"""Lower it with every assertion that compares codes instead. A sentence is compared once, where it is made."""
TABLES_AT_MOST = 92
"""Tables of sentences: what parametrises a test, or what a loop in one goes through. Each counts once, whatever its
length: one table is the place where the sentences of one maker are compared."""

IN_A_ROW = 4
WORD = re.compile(r"[^\w<>=/{}]*[A-Za-z]+(?:[-'’][a-z]+)*[^\w<>=/{}]*")
"""A word with its punctuation; a number, a path, markup or a name with an underscore is none."""


PLAIN = (ast.Name, ast.Constant, ast.arg, ast.alias, ast.expr_context, ast.operator, ast.cmpop, ast.boolop, ast.unaryop)
"""What contains nothing that is looked for: most nodes."""


def walk(tree: ast.AST) -> Iterator[ast.AST]:
    """All nodes but plain ones, in half of the time that `ast.walk` takes."""
    waiting = [tree]
    while waiting:
        node = waiting.pop()
        yield node
        for name in node._fields:
            field = getattr(node, name, None)
            if isinstance(field, list):
                waiting += [value for value in field if isinstance(value, ast.AST) and not isinstance(value, PLAIN)]
            elif isinstance(field, ast.AST) and not isinstance(field, PLAIN):
                waiting.append(field)


def words(text: str) -> int:
    """The longest row of words in it."""
    longest = row = 0
    for part in text.split():
        row = row + 1 if WORD.fullmatch(part) else 0
        longest = max(longest, row)
    return longest


def compared(nodes: Iterable[ast.AST]) -> Iterator[ast.expr]:
    """What is asserted, the patterns of expected errors, and the texts expected in the browser."""
    for node in nodes:
        if isinstance(node, ast.Assert):
            yield node.test
        elif isinstance(node, ast.Call):
            name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            if name in ("raises", "warns"):
                yield from (keyword.value for keyword in node.keywords if keyword.arg == "match")
            elif re.fullmatch(r"(not_)?to_(contain|have)_text", name):
                yield from node.args


def tables(nodes: Iterable[ast.AST]) -> Iterator[ast.expr]:
    """The values that parametrise tests, and what the loops around assertions go through."""
    for node in nodes:
        if isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "parametrize":
            yield from node.args[1:2]
        elif isinstance(node, ast.For) and any(isinstance(inner, ast.Assert) for inner in walk(node)):
            yield node.iter


def english(expressions: Iterable[ast.expr]) -> int:
    """How many of them contain a string with several words in a row."""
    strings = (
        [node.value for node in ast.walk(expression) if isinstance(node, ast.Constant) and isinstance(node.value, str)]
        for expression in expressions
    )
    return sum(any(words(string) >= IN_A_ROW for string in found) for found in strings)


def test_english_that_is_compared_is_counted() -> None:
    source = """
assert text == "it is 0.84 m and 3 s late"
assert text == "the worst case found"
assert code == "not a word of_it", "the message of an assertion counts not"
with pytest.raises(ValueError, match=r"there is no file \\S+"): pass
expect(page).to_contain_text(f"{n} runs wait for a worker")
"""
    assert [english(compared(ast.walk(line))) for line in ast.parse(source).body] == [0, 1, 0, 1, 1]


def test_a_table_counts_once() -> None:
    source = """
@pytest.mark.parametrize(("x", "why"), [(1, "it is far too small"), (2, "it is far too large")])
def test(x, why):
    for y, statement in ((1, "neither is there any more"), (2, "no")):
        assert statement in told(x, y)
    for z in ("what nobody compares here", "x"):
        made(z)
"""
    assert english(tables(ast.walk(ast.parse(source)))) == 2


@cache
def numbers() -> dict[str, tuple[int, int]]:
    """By file of the tests: how many comparisons have English, and how many tables."""
    texts = ((path.relative_to(TESTS).as_posix(), path.read_text("utf-8")) for path in TESTS.rglob("*.py"))
    walked = ((path, list(walk(ast.parse(text)))) for path, text in texts)
    return {path: (english(compared(nodes)), english(tables(nodes))) for path, nodes in walked}


@pytest.mark.parametrize(("place", "at_most"), [(0, AT_MOST), (1, TABLES_AT_MOST)], ids=["compared", "tables"])
def test_no_more_english_is_compared_than_before(place: int, at_most: int) -> None:
    most = sorted(((found[place], path) for path, found in numbers().items()), reverse=True)
    assert sum(number for number, _ in most) <= at_most, most[:10]
