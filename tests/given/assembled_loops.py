"""Loops of a few components, and invariants of the generated text."""

from __future__ import annotations

import ast
from typing import Any

import numpy as np

from worker.engine.kernels.layout import Parts
from worker.engine.kernels.text.scenario import WIDTH
from worker.engine.kernels.text.written import FUNCTIONS
from worker.engine.systems.closed_loop.assemble import Loop
from worker.running.catalogue.installed import components


def check(text: str) -> None:
    """Check that a text parses, lines fit, functions have docstrings, no variable hides a module, imports are used."""
    tree = ast.parse(text)
    assert max(map(len, text.splitlines())) <= WIDTH
    modules = {
        a.asname or a.name for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom) for a in node.names
    }
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    assert [ast.get_docstring(f) for f in functions] == [FUNCTIONS[f.name.rstrip("_0123456789")] for f in functions]
    used = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load)}
    assert modules <= used
    for function in functions:
        stored = {n.id for n in ast.walk(function) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
        assert not modules & (stored | {a.arg for a in function.args.args}), function.name


def parts(**own: Any) -> Parts:
    """The unicycle among circles, with components of one's own."""
    known: Any = components()
    given = {
        "vehicle": known["vehicle", "unicycle"],
        "controller": known["controller", "pid_speed"],
        "avoider": known["avoider", "potential_field"],
        "obstacles": (known["obstacle", "circle"],),
        "criterion": known["criterion", "separation"],
    }
    return Parts(**given | own)


def vector(loop: Loop, **own: float) -> Any:
    given = {"goal.x": 6.0, "goal.y": 7.0, "criterion.threshold": 0.5, **own}
    named = [(f"{s.prefix}.{p.name}", p.default) for s in loop.sections for p in s.parameters]
    return np.array([given.get(name, 4.0 if default is None else default) for name, default in named])
