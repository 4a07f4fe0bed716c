"""The names of numba's insides that one module uses are where they were; and what is linked computes plain Python."""

from __future__ import annotations

import ast
import importlib
import inspect
import math
import tomllib
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numba
import pytest

REPOSITORY = Path(__file__).parents[4]
INTERNALS = REPOSITORY / "worker" / "engine" / "kernels" / "numba_internals.py"
DOCUMENTED = ("numba", "numba.extending", "numba.core.errors", "llvmlite")

METHODS = {
    "numba.core.caching.FunctionCache.load_overload": ["self", "sig", "target_context"],
    "numba.core.ccallback.CFunc.compile": ["self"],
    "numba.core.codegen.JITCodeLibrary._optimize_final_module": ["self"],
    "numba.core.codegen.JITCodeLibrary._finalize_final_module": ["self"],
    "numba.core.codegen.JITCodeLibrary._finalize_dynamic_globals": ["self"],
    "numba.core.compiler.Compiler.define_pipelines": ["self"],
    "numba.core.dispatcher.Dispatcher.compile": ["self", "sig"],
    "numba.core.typed_passes.NativeLowering.run_pass": ["self", "state"],
}
"""What the module overrides or calls of the classes it imports, with the parameters that it expects."""


def imports(path: Path) -> Iterator[str]:
    """The names that a file imports from numba and llvmlite, each with its module."""
    text = path.read_text(encoding="utf-8")
    named = "numba" in text or "llvmlite" in text  # to parse all files takes seconds
    for node in ast.walk(ast.parse(text)) if named else ():
        if isinstance(node, ast.Import):
            yield from (f"{alias.name}." for alias in node.names if alias.name.split(".")[0] in ("numba", "llvmlite"))
        elif isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] in ("numba", "llvmlite"):
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def found(name: str) -> Any:
    """The object of a dotted name; None if a part of it is not there any more."""
    module, *rest = name.split(".")
    at: Any = importlib.import_module(module)
    for part in rest:
        module = f"{module}.{part}"
        try:
            at = getattr(at, part) if hasattr(at, part) else importlib.import_module(module)
        except ImportError:
            return None
    return at


def test_every_name_is_where_it_was() -> None:
    moved = [name for name in (*imports(INTERNALS), *METHODS) if found(name) is None]
    assert not moved, f"numba {version('numba')} has no {', '.join(moved)}"
    other = [name for name, expected in METHODS.items() if list(inspect.signature(found(name)).parameters) != expected]
    assert not other, f"numba {version('numba')} has other parameters of {', '.join(other)}"
    assert hasattr(numba.extending.intrinsic(lambda context: None), "_defn"), "an intrinsic has no _defn"


def test_a_name_that_moved_is_named() -> None:
    assert [found(name) for name in ("numba.core.moved.Compiler", "numba._dynfunc.moved")] == [None, None]
    assert found("numba.core.codegen.JITCodeLibrary") is not None


def test_no_other_module_uses_them() -> None:
    wrong = [
        f"{path.relative_to(REPOSITORY)}: {name}"
        for room in ("backend", "campaigns", "clearance", "worker")
        for path in (REPOSITORY / room).rglob("*.py")
        if path != INTERNALS
        for name in imports(path)
        if name.rpartition(".")[0] not in DOCUMENTED or name.rpartition(".")[2].startswith("_")
    ]
    assert wrong == []


@pytest.mark.parametrize("package", ["numba", "llvmlite"])
def test_the_minor_version_is_pinned_above_and_below(package: str) -> None:
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    (pinned,) = [one for one in project["dependencies"] if one.startswith(f"{package}>=")]
    major, minor = map(int, version(package).split(".")[:2])
    assert pinned == f"{package}>={major}.{minor},<{major}.{minor + 1}"
    assert f"\n{package}=={version(package)} " in (REPOSITORY / "requirements.lock").read_text(encoding="utf-8")


def root(x: float) -> float:
    return math.sqrt(x)


def norm(x: float, y: float) -> Any:
    return ROOT(x * x + y * y), -y


def longest(n: int) -> float:
    most = 0.0
    for k in range(n):
        length, _ = NORM(0.1 * k, 3.0 - k)
        most = max(most, length)
    return most


ROOT: Any = root
NORM: Any = norm


def test_levels_of_functions_give_the_bits_of_plain_python(monkeypatch: pytest.MonkeyPatch) -> None:
    from worker.engine.kernels.numba_internals import linked  # here: the tests above run where it cannot be imported

    expected = longest(9)
    monkeypatch.setitem(globals(), "ROOT", linked(root, forceinline=True))
    monkeypatch.setitem(globals(), "NORM", linked(norm))
    compiled = numba.njit(longest)
    assert compiled(9) == expected
    (code,) = compiled.inspect_asm().values()
    assert "sqrtsd" in code or "fsqrt" in code
