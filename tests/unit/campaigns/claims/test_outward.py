"""Every bound and every end of an interval is rounded outward, wherever a sentence, a line or a report states one."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from campaigns.claims import reweighted
from campaigns.claims.numbers import Format
from campaigns.claims.spans import Quantity, Spans, words
from campaigns.claims.stages import attraction, calls, estimate, sample

ROOT = Path(__file__).parents[4]
SOURCES = [
    file
    for folder in ("campaigns", "backend", "clearance", "worker/evidence/verdicts")
    for file in sorted((ROOT / folder).rglob("*.py"))
    if "migrations" not in file.parts
]
UPWARD = {"upper_bound", "at_end", "high", "redrawn", "missed"}
DOWNWARD = {"low", "bound", "effective", "confidence", "level"}
"""The names of the numbers that are upper bounds, and of those that are lower ones or must not reach what they miss."""
NEAREST = {"number", "probability", "share", "probable", "percent", "signed"}
"""What writes a span to the nearest digit."""
COUNTED = {"effective"}
"""Named so, and also whole numbers."""


WRITING = re.compile(rf"\b(?:{'|'.join(sorted({*NEAREST, 'at_most', 'at_least', 'say'}))})\(|upper_bound|confidence")
"""What a file must contain to break a rule below: to parse all files takes seconds."""


def _nodes(file: Path) -> list[ast.AST]:
    text = file.read_text(encoding="utf-8")
    return list(ast.walk(ast.parse(text))) if WRITING.search(text) else []


def _function(call: ast.expr) -> str:
    return call.func.id if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) else ""


def _named(call: ast.Call) -> set[object]:
    given = [*call.args, *(keyword.value for keyword in call.keywords)]
    return {one.value for one in given if isinstance(one, ast.Constant)}


@pytest.mark.by_day(150)
@pytest.mark.parametrize("file", SOURCES, ids=lambda file: str(file.relative_to(ROOT)))
def test_no_bound_is_rounded_to_the_nearest(file: Path) -> None:
    nodes = _nodes(file)
    for call in (node for node in nodes if isinstance(node, ast.Call)):
        if _function(call) in NEAREST:
            assert not _named(call) & (UPWARD | DOWNWARD), ast.unparse(call)
            assert "confidence" not in ast.unparse(call.args[0]), ast.unparse(call)
        if _function(call) == "at_most":
            assert not _named(call) & DOWNWARD, ast.unparse(call)
        if _function(call) == "at_least":
            assert not _named(call) & UPWARD, ast.unparse(call)
        if _function(call) == "say":
            for before, after in zip(call.args, call.args[1:], strict=False):
                text = before.value if isinstance(before, ast.Constant) else ""
                bounded = str(text).endswith(("at most ", "up to "))
                assert not (bounded and _function(after) in {"probability", "share", "probable"}), ast.unparse(call)
    for node in nodes:
        if isinstance(node, ast.FormattedValue) and node.format_spec is not None:
            assert not any(word in ast.unparse(node.value) for word in ("upper_bound", "confidence")), ast.unparse(node)


def _sentences(value: float) -> Iterator[Spans]:
    """Every sentence that states a bound or an interval, of this awkward number."""
    counts = sample.Counts(1, 300, 0, 7, value, value, sample.WITHOUT)
    yield counts.bound(value)
    yield sample.interim((), 3, value)
    yield counts.quantile(0.05, "d_min", "m", 3, 59, value)
    yield counts.quantile(0.05, "d_min", "m", 0, None, None)
    yield sample.so_far(sample.Drawn(1, 300, value, value), value, 10, value)
    yield calls.independent(1, 0, 10, value, value)
    yield estimate.estimated(value, (value, value), value, estimate.Draws(100, 50.0, outside=value))
    yield reweighted.estimate(value, (value, value), value, reweighted.Draws(300, 0, 7, 200.0, value, value))
    yield reweighted.outside(value, 0.05)
    yield reweighted.redrawn(value)


@pytest.mark.parametrize("value", [0.0051234567, 0.0049876543, 0.99949999, 3.14159e-7, 0.0049, 0.21234999])
def test_every_bound_of_a_sentence_holds_as_it_is_read(value: float) -> None:
    named = set()
    for statement in _sentences(value):
        for span in statement:
            if isinstance(span, Quantity) and span.name in UPWARD | DOWNWARD and span.format is not Format.COUNT:
                number, *percents = words((span,)).split()
                read = float(number) / (100 if percents == ["%"] else 1)
                assert read >= value * (1 - 1e-15) if span.name in UPWARD else read <= value * (1 + 1e-15), span
                named.add(span.name)
    assert named == (UPWARD | DOWNWARD) - COUNTED


MISSED: dict[str, tuple[Spans, str]] = {
    "effective": (estimate.few(29.96, 30.0), "29.9"),
    "effective of draws": (reweighted.too_few(99.97, 300, 100), "99.9"),
    "outside": (reweighted.outside(0.0500001, 0.05), "5.01 %"),
    "target": (sample.curtailed((), 3, 0.01239999, 300, 200), "1.239999 %"),
}
"""A sentence that compares a number with a limit, and how its number is read."""


@pytest.mark.parametrize("name", MISSED)
def test_what_misses_a_limit_never_reads_as_the_limit(name: str) -> None:
    statement, read = MISSED[name]
    assert [words((s,)) for s in statement if isinstance(s, Quantity) and s.name == name.split()[0]] == [read]


@pytest.mark.parametrize("simulator", [False, True])
@pytest.mark.parametrize("outside", [0.0, 0.01])
@pytest.mark.parametrize("excluded", [0, 7])
def test_tails_are_added_only_to_what_is_counted_over_all_draws(excluded: int, outside: float, simulator: bool) -> None:
    counts = sample.Counts(1, 300, 0, excluded, outside, 0.95, sample.WITHOUT, simulator)
    drawing = sample.Drawn(1, 300, 0.95, outside, excluded)
    over = sample._over(1, 0.1)
    for statement in (
        counts.bound(0.02),
        counts.quantile(0.05, "d_min", "m", 3, 59, 0.5),
        sample.so_far(drawing, 0.02, 10, 0.01),
    ):
        assert (over in words(statement)) == (excluded > 0 and outside > 0.0)
    alone = sample.Counts(1, 300, 0, excluded, 0.0, 0.95, sample.WITHOUT, simulator)
    conditions = [words(one._conditions(over_all=one.outside > 0.0)) for one in (counts, alone)]
    assert (conditions[0] == conditions[1]) == (not excluded or not outside)


@pytest.mark.parametrize("difference", [0.01234, 0.0996, 2.5])
def test_the_rates_of_a_model_differ_by_no_more_than_is_read(difference: float) -> None:
    assert float(words((attraction._upward(difference, "", 2),))) >= difference
