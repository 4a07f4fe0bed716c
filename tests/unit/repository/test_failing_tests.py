"""A test that fails ends: its helpers stop what they started, and no thread of a test keeps the process alive.

A context manager without `finally` left a running service behind where the block raised, and the process waited for it
for ever.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

TESTS = Path(__file__).parents[2]
CHECKS = ("until",)
"""Functions that wait for a condition and change nothing."""


def unprotected(body: list[ast.stmt]) -> Iterator[ast.stmt]:
    """Statements after a `yield` that are left out if the block raises."""
    for at, statement in enumerate(body):
        if not any(isinstance(node, ast.Yield) for node in ast.walk(statement)):
            continue
        if isinstance(statement, ast.With | ast.If):
            yield from unprotected(statement.body)
        yield from body[at + 1 :]


def checks(statement: ast.stmt) -> bool:
    """Whether the statement only checks something."""
    called = statement.value.func if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call) else None
    return isinstance(statement, ast.Assert) or (isinstance(called, ast.Name) and called.id in CHECKS)


def neglected(source: str) -> list[int]:
    """Lines where a context manager cleans up only after a block that did not raise."""
    if "contextmanager" not in source:  # to parse all files takes seconds
        return []
    return [
        statement.lineno
        for function in ast.walk(ast.parse(source))
        if isinstance(function, ast.FunctionDef)
        if any("contextmanager" in ast.unparse(decorator) for decorator in function.decorator_list)
        for statement in unprotected(function.body)
        if not checks(statement)
    ]


def lasting(source: str) -> list[int]:
    """Lines that make a thread for which the process would wait."""
    if "threading.Thread" not in source:
        return []
    return [
        node.lineno
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "Thread"
        if ast.unparse(node.func) == "threading.Thread"
        if not any(keyword.arg == "daemon" and ast.unparse(keyword.value) == "True" for keyword in node.keywords)
    ]


def test_helpers_clean_up_after_a_failure_and_no_thread_outlives_it() -> None:
    sources = {path.relative_to(TESTS): path.read_text(encoding="utf-8") for path in TESTS.rglob("*.py")}
    assert {str(path): lines for path, source in sources.items() if (lines := neglected(source))} == {}
    assert {str(path): lines for path, source in sources.items() if (lines := lasting(source))} == {}


def test_neglected_ends_are_found() -> None:
    manager = "@contextmanager\ndef made():\n    with opened() as one:\n"
    assert neglected(manager + "        yield one\n        one.stop()\n") == [5]
    assert neglected(manager + "        yield one\n    stop()\n") == [5]
    assert neglected(manager + "        try:\n            yield one\n        finally:\n            one.stop()\n") == []
    assert neglected(manager + "        yield one\n        assert one.stopped\n        until(one.ended)\n") == []
    assert lasting("threading.Thread(target=f)\nthreading.Thread(target=f, daemon=True)\n") == [1]
