"""Finds what makes a component random or keeps state, by name: every flight of a case must have the same bits.

The names are looked up in the imported module, so that `from random import random as noise` is found too.
"""

from __future__ import annotations

import ast
import builtins
import importlib.util
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import BuiltinFunctionType, ModuleType
from typing import Any

import numpy as np

from worker.engine.components.own import folders
from worker.engine.systems.simulators.declared.external import Reader, is_main
from worker.engine.systems.simulators.declared.outside import BUILTINS, NAMES, Outside
from worker.running.examination import reading
from worker.running.examination.mistake import Mistake
from worker.running.examination.reading import Source

NOISE = "declare it as noise, in `draw` of an environment or by a fault"
RANDOM, CLOCK, OUTSIDE, ADDRESS, TABLE = (
    f"is random, and the same case must give the same result: {NOISE}",
    "reads the clock, and the same case must give the same result: use t, the time of the simulation",
    "reaches outside of the simulation, and a component computes from its arguments only: remove it",
    "differs between processes, and the same case must give the same result: remove it",
    "reads what the digest of the component does not cover: write the numbers into its file",
)
TEXTS = {Outside.RANDOM: RANDOM, Outside.CLOCK: CLOCK, Outside.ADDRESS: ADDRESS}
"""Of what reads the state outside; of all else `OUTSIDE`."""
MODULES = {
    **{name: TEXTS.get(kind, OUTSIDE) for name, kind in NAMES.items() if kind is not None},
    **dict.fromkeys(("datetime",), CLOCK),
    **dict.fromkeys(("posix", "sys", "io", "pathlib", "logging", "threading", "ctypes", "itertools", "gc"), OUTSIDE),
    **dict.fromkeys(("warnings",), OUTSIDE),
}
FUNCTIONS = {
    **{name: TEXTS.get(kind, OUTSIDE) for name, kind in BUILTINS.items()},
    **dict.fromkeys(("print", "exec", "eval", "compile", "__import__", "breakpoint"), OUTSIDE),
    **dict.fromkeys(("globals", "locals", "vars", "setattr", "delattr", "next"), OUTSIDE),
    **dict.fromkeys(("repr", "object"), ADDRESS),
}
HIDDEN = frozenset({"__hash__", "__repr__", "__str__", "__reduce__"})
"""Attributes that may have the address of an object or the seed of its process."""
CONSTANTS = (bool, int, float, complex, str, bytes, range, np.generic, np.ndarray, ModuleType)


def check(source: Source, module: str) -> None:
    """Raises `Mistake` for the first name in the file of an imported module that makes it random or keeps state."""
    _check(source, vars(sys.modules[module]), {source.file})
    _check_imports(source, sys.modules[module].__package__ or "", {source.file})


def _check_imports(source: Source, package: str, seen: set[Path]) -> None:
    """What is executed in own files that it imports, also where no kernel uses their functions."""
    for node in ast.walk(source.tree):
        if not isinstance(node, ast.Import | ast.ImportFrom):
            continue
        base = "" if isinstance(node, ast.Import) else "." * node.level + (node.module or "")
        between = "." if base.strip(".") else ""
        for name in {base, *(f"{base}{between}{alias.name}" for alias in node.names)} - {""}:
            module = sys.modules.get(importlib.util.resolve_name(name, package))
            file = Path(getattr(module, "__file__", None) or ".")
            if module is not None and file not in seen and file.parent in folders():
                seen.add(file)
                inner = reading.read(file)
                try:
                    _check_outside(inner, vars(module))
                    _check_imports(inner, module.__package__ or "", seen)
                except Mistake as mistake:
                    raise Mistake(f"{file.name}, line {mistake.line}: {mistake.text}", node.lineno) from None


def _check(source: Source, known: Mapping[str, Any], seen: set[Path]) -> None:
    for function in source.functions.values():
        of_scope = reading.globals_of(source.scope(function))
        for node, name, chain in _loaded(function):
            if name in of_scope:
                _check_name(source, known, seen, (function, node, name, chain))
        if function in source.kernels:
            _check_stores(function, of_scope)
    _check_outside(source, known)


def _check_outside(source: Source, known: Mapping[str, Any]) -> None:
    """What the file reads of the state outside, in functions and when it is imported."""
    tops = [*_at_import(source.tree)]
    for node, name, chain in (found for top in tops for found in _loaded(top)):
        text = next(_impure(known, name, chain), "")
        if text in (RANDOM, CLOCK, ADDRESS):
            raise Mistake(f"{'.'.join((name, *chain))} {text}", node.lineno)
    reader = Reader(source.tree)
    for use in (use for top in [*tops, *source.functions.values()] for use in reader.of(top)):
        raise Mistake(f"{use.name} {TEXTS.get(use.kind, TABLE)}", use.line)
    _check_order(source.tree)


def _at_import(tree: ast.Module) -> Iterator[ast.AST]:
    """What is executed when the file is imported: statements, bodies of classes, defaults of functions."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield from (default for default in (*node.args.defaults, *node.args.kw_defaults) if default is not None)
        elif not isinstance(node, ast.Import | ast.ImportFrom) and not is_main(node):
            yield node


def _check_order(tree: ast.Module) -> None:
    """What may differ in every process: the order of a set of texts, and what objects tell of themselves."""
    tested = {id(side) for node in ast.walk(tree) if isinstance(node, ast.Compare) for side in node.comparators}
    for node in (node for node in ast.walk(tree) if isinstance(node, ast.expr)):
        called = node.func.id if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) else ""
        texts = isinstance(node, ast.Set) and not all(
            isinstance(e, ast.Constant) and isinstance(e.value, int) for e in node.elts
        )
        if (texts or isinstance(node, ast.SetComp) or called in ("set", "frozenset")) and id(node) not in tested:
            raise Mistake("a set has another order in every process: use a tuple", node.lineno)
        if isinstance(node, ast.Attribute) and node.attr in HIDDEN:
            raise Mistake(f"{node.attr} {ADDRESS}", node.lineno)


def _check_name(
    source: Source, known: Mapping[str, Any], seen: set[Path], use: tuple[reading.Function, ast.expr, str, list[str]]
) -> None:
    function, node, name, chain = use
    dotted = ".".join((name, *chain))
    for text in _impure(known, name, chain):
        raise Mistake(f"{function.name} uses {dotted}, which {text}", node.lineno)
    if function not in source.kernels or name not in known:
        return
    value = _values(known, name, chain)[-1]
    if not _constant(value):
        raise Mistake(
            f"{function.name} reads {dotted}, a {type(value).__name__}, and kernels read constants only: make it a "
            "tuple of numbers, a parameter or a state",
            node.lineno,
        )
    code = getattr(getattr(value, "py_func", value), "__code__", None)
    file = Path(code.co_filename) if code is not None else source.file
    if file not in seen and file.parent in folders():
        seen.add(file)
        home = sys.modules[getattr(value, "py_func", value).__module__]
        try:
            _check(reading.read(file), vars(home), seen)
        except Mistake as mistake:
            raise Mistake(f"{file.name}, line {mistake.line}: {mistake.text}", node.lineno) from None


def _check_stores(kernel: reading.Function, of_scope: set[str]) -> None:
    """A kernel that writes into something outside of it."""
    for node in ast.walk(kernel):
        inner: ast.AST = node
        while isinstance(inner, ast.Subscript | ast.Attribute) and (
            inner is not node or isinstance(inner.ctx, ast.Store)
        ):
            inner = inner.value
        if inner is not node and isinstance(inner, ast.Name) and inner.id in of_scope:
            raise Mistake(
                f"{kernel.name} changes {inner.id}, and a kernel cannot change anything outside: keep the value in a "
                "state or in the memory",
                getattr(node, "lineno", 0),
            )


def _loaded(node: ast.AST) -> Iterator[tuple[ast.expr, str, list[str]]]:
    """The names that are read, each with the attributes that follow it."""
    outer: dict[int, ast.Attribute] = {
        id(n.value): n for n in ast.walk(node) if isinstance(n, ast.Attribute) and isinstance(n.ctx, ast.Load)
    }
    for name in reading.loads(node):
        chain, at = list[str](), id(name)
        while at in outer:
            chain.append(outer[at].attr)
            at = id(outer[at])
        yield name, name.id, chain


def _values(known: Mapping[str, Any], name: str, chain: list[str]) -> list[Any]:
    """The value of a name, and of each attribute as far as they exist and belong to modules or types."""
    found = [known.get(name, getattr(builtins, name, None))]
    for attribute in chain:
        if not isinstance(found[-1], ModuleType | type):
            break
        found.append(getattr(found[-1], attribute, None))
    return found


def _impure(known: Mapping[str, Any], name: str, chain: list[str]) -> Iterator[str]:
    """Why what a name stands for cannot be used in a component; nothing if it can."""
    if name not in known and name in FUNCTIONS:
        yield FUNCTIONS[name]
    for value in _values(known, name, chain):
        homes = _homes(value)
        yield from (text for home, text in MODULES.items() if any(h == home or h.startswith(f"{home}.") for h in homes))
        plain = getattr(value, "__name__", "") if isinstance(value, BuiltinFunctionType) else ""
        if plain in FUNCTIONS and getattr(builtins, plain, None) is value:
            yield FUNCTIONS[plain]


def _homes(value: Any) -> list[str]:
    """The modules that a value belongs to: its own, those of its type, and of the object that it is a method of."""
    if isinstance(value, ModuleType):
        return [value.__name__]
    owner = getattr(value, "__self__", None)
    found = [type(value).__module__, getattr(value, "__module__", None)]
    if owner is not None:
        found += [owner.__name__] if isinstance(owner, ModuleType) else [type(owner).__module__]
        found += [owner.__module__] if isinstance(owner, type) else []
    return [home for home in found if isinstance(home, str)]


def _constant(value: Any) -> bool:
    if isinstance(value, tuple):
        return all(map(_constant, value))
    return value is None or callable(value) or isinstance(value, CONSTANTS)  # the compiler judges functions
