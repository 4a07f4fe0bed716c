"""Facts hang on types, not on names: methods outside their files, and JSON without a type of its own."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
PRODUCT = ("backend", "campaigns", "clearance", "worker")
METHODS = {file.stem for file in (ROOT / "worker/engine/search/methods").glob("*.py")} - {"__init__"}


def sources(*folders: str) -> list[tuple[str, str]]:
    """Path and text of every module."""
    files = [file for folder in folders for file in sorted((ROOT / folder).rglob("*.py"))]
    return [(str(file.relative_to(ROOT)), file.read_text(encoding="utf-8")) for file in files]


@pytest.mark.parametrize("folder", ["worker/engine/stages", "worker/evidence", "backend/scenes"])
def test_a_stage_a_claim_and_a_view_know_no_method_by_its_name(folder: str) -> None:
    """What they need to know of it is a property of `worker.engine.search.base.Method` or of its entry."""
    named = re.compile(rf"search\.methods import|[\"'](?:{'|'.join(sorted(METHODS))})[\"']")
    assert [path for path, text in sources(folder) if named.search(text)] == []


@pytest.mark.parametrize(
    ("named", "most"), [(r"\bJsonObject\b", 56), (r"\bdict\[str, Any\]", 50), (r"\bdict\[str, object\]", 140)]
)
def test_json_without_a_type_of_its_own_stays_at_the_edges(named: str, most: int) -> None:
    """Lines of product code: columns, documents of other programs, parts of OpenAPI descriptions. Only ever fewer."""
    lines = [line for _, text in sources(*PRODUCT) for line in text.splitlines() if re.search(named, line)]
    assert len(lines) <= most


PARTICIPLES = {"asked", "given", "held", "said", "told"}
WIRE = {
    *("backend/http/errors.py", "campaigns/asked/problem.py", "clearance/client/answers.py"),
    "worker/evidence/audit/judge.py",
    *("backend/db/tables_launched.py", "backend/runs/schemas.py", "campaigns/results/attraction.py"),
}
"""Fields of stored documents and of the API: `given` of a problem, `asked` of a baseline, `held` of an equilibrium."""
OPERATORS = {"worker/engine/kernels/about_trim.py"}
"""What controllers of operators construct."""


def bound(tree: ast.AST) -> Iterator[str]:
    """The names of variables, parameters, attributes, functions and classes."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Name | ast.Attribute) and isinstance(node.ctx, ast.Store):
            yield node.id if isinstance(node, ast.Name) else node.attr
        elif isinstance(node, ast.arg):
            yield node.arg
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield node.name


def test_a_participle_is_no_name() -> None:
    found = {
        path
        for path, text in sources(*PRODUCT)
        if "migrations" not in path and PARTICIPLES & {name.strip("_") for name in bound(ast.parse(text))}
    }
    assert found == WIRE | OPERATORS
