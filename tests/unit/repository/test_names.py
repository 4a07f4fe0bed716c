"""Facts hang on types, not on names: methods outside their files, and JSON without a type of its own."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.given.source_texts import texts

ROOT = Path(__file__).parents[3]
PRODUCT = ("backend", "campaigns", "clearance", "worker")
METHODS = {file.stem for file in (ROOT / "worker/engine/search/methods").glob("*.py")} - {"__init__"}


def sources(*folders: str) -> list[tuple[str, str]]:
    """Path and text of every module."""
    return list(texts(*(f"{folder}/**/*.py" for folder in folders)).items())


@pytest.mark.parametrize("folder", ["worker/engine/stages", "worker/evidence", "backend/scenes"])
def test_a_stage_a_claim_and_a_view_know_no_method_by_its_name(folder: str) -> None:
    """What they need to know of it is a property of `worker.engine.search.base.Method` or of its entry."""
    named = re.compile(rf"search\.methods import|[\"'](?:{'|'.join(sorted(METHODS))})[\"']")
    assert [path for path, text in sources(folder) if named.search(text)] == []


@pytest.mark.parametrize(
    ("named", "most"),
    [
        (r"\bJsonObject\b", 48),
        (r"\bdict\[str, Any\]", 48),
        (r"\bdict\[str, object\]", 136),
        (r"\bMapping\[str, object\]", 38),
        (r"\bMapping\[str, Any\]", 68),
    ],
)
def test_json_without_a_type_of_its_own_stays_at_the_edges(named: str, most: int) -> None:
    """Lines of product code: columns, documents of other programs, parts of OpenAPI descriptions. Only ever fewer."""
    lines = sum(
        len({text.rfind("\n", 0, one.start()) for one in re.finditer(named, text)}) for _, text in sources(*PRODUCT)
    )
    assert lines <= most


def aliased(value: ast.expr | None, names: set[str]) -> bool:
    """Whether an expression is `dict[str, Any]`, or one of these names of it."""
    named = ast.Name, ast.Attribute, ast.Subscript
    return isinstance(value, named) and ast.unparse(value) in {"dict[str, Any]", "Dict[str, Any]", *names}


def json_aliases(texts: dict[str, str]) -> dict[str, set[str]]:
    """By module, the names under which it has `dict[str, Any]`: those that it assigns and those that it imports."""
    names: dict[str, set[str]] = {module: set() for module in texts}
    assigning = ast.ImportFrom, ast.Assign, ast.AnnAssign, getattr(ast, "TypeAlias", ast.ImportFrom)
    statements: dict[str, list[Any]] = {}
    known = -1
    while known != (known := sum(map(len, names.values()))):
        # Only what assigns it or names a known alias can have one, as ruff formats it: to parse all takes seconds.
        named = [rf"\b{name}\b" for name in set().union(*names.values())]
        anyone = re.compile("|".join([r"= \(?(?:dict|Dict)\[str, Any\]", *named]))
        for module, text in texts.items():
            if module not in statements and anyone.search(text):
                statements[module] = [node for node in ast.walk(ast.parse(text)) if isinstance(node, assigning)]
        for module, node in ((module, node) for module, nodes in statements.items() for node in nodes):
            if isinstance(node, ast.ImportFrom):
                if node.module in names:
                    names[module] |= {n.asname or n.name for n in node.names if n.name in names[node.module]}
            elif isinstance(node, ast.Assign):
                if aliased(node.value, names[module]):
                    names[module] |= {of.id for of in node.targets if isinstance(of, ast.Name)}
            elif isinstance(node, ast.AnnAssign):
                if "TypeAlias" in ast.unparse(node.annotation) and aliased(node.value, names[module]):
                    names[module].add(ast.unparse(node.target))
            elif aliased(node.value, names[module]):  # Python 3.12
                names[module].add(ast.unparse(node.name))
    return names


def json_lines(files: list[tuple[str, str]]) -> list[str]:
    """The lines that name `dict[str, Any]` by an alias, with the path of their module."""
    texts = {path.removesuffix(".py").removesuffix("/__init__").replace("/", "."): text for path, text in files}
    found = []
    for module, names in json_aliases(texts).items():
        named = re.compile(rf"\b(?:{'|'.join(sorted(names))})\b")
        found += [f"{module}: {line}" for line in texts[module].splitlines() if names and named.search(line)]
    return found


def test_json_has_no_second_name_by_which_it_leaves_the_edges() -> None:
    """Lines of product code with any alias of `dict[str, Any]`, JsonObject included. Only ever fewer."""
    lines = json_lines(sources(*PRODUCT))
    assert len(lines) <= 55, lines


def test_every_alias_of_json_is_counted() -> None:
    defining = ("backend/first.py", "from typing import Any\n\nTree = dict[str, Any]\nOther: TypeAlias = Tree\n")
    using = ("worker/second.py", "from backend.first import Other as Row\n\n\ndef row(of: Row) -> int: ...\n")
    unlike = ("worker/third.py", "from sqlalchemy import Row\n\n\ndef row(of: Row, text: Tree) -> int: ...\n")
    assert [line.partition(":")[0] for line in json_lines([using, defining, unlike])] == [
        *["worker.second"] * 2,
        *["backend.first"] * 2,
    ]


PARTICIPLES = {"asked", "given", "held", "said", "told"}
WORDS = re.compile(rf"\b_*(?:{'|'.join(sorted(PARTICIPLES))})_*\b")
WIRE = {
    *("backend/http/errors.py", "campaigns/asked/problem.py", "clearance/client/answers.py"),
    "worker/evidence/audit/judge.py",
    *("backend/db/tables_launched.py", "backend/runs/schemas.py", "campaigns/results/attraction.py"),
}
"""Fields of stored documents and of the API: `given` of a problem, `asked` of a baseline, `held` of an equilibrium."""
OPERATORS = {"worker/engine/kernels/about_trim.py"}
"""What controllers of operators construct."""


IRREGULAR = {"begun", "drawn", "flown", "found", "given", "kept", "known", "left", "read", "shown", "taken", "written"}
MODULES_AT_MOST = 54
"""Modules of the product that a participle names. Only ever fewer: a module is named by what it contains."""


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
        if "migrations" not in path and WORDS.search(text)  # to parse all files takes seconds
        if PARTICIPLES & {name.strip("_") for name in bound(ast.parse(text))}
    }
    assert found == WIRE | OPERATORS


def test_no_more_modules_are_named_by_a_participle_than_before() -> None:
    stems = [Path(path).stem.strip("_") for path, _ in sources(*PRODUCT) if "migrations" not in path]
    named = sorted(stem for stem in stems if "_" not in stem and (stem.endswith("ed") or stem in IRREGULAR))
    assert len(named) <= MODULES_AT_MOST, named
