"""What a function of this process imports is part of its identity, in whatever form it is used; else it has none."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from worker.engine.systems.simulators.identity import identified

FILES = {
    "helper_a.py": "X = 1.0\nY = 1.0\ndef f(x):\n    return X * x\n",
    "helper_b.py": "import helper_a\ndef g(x):\n    return helper_a.f(x)\n",
    "pack_a/__init__.py": "",
    "pack_a/inner.py": "X = 1.0\ndef f(x):\n    return X * x\n",
    "pack_a/relative.py": "from . import inner\ndef f(x):\n    return inner.f(x)\n",
    "pack_a/inside.py": "def f(x):\n    from .inner import f as g\n    return g(x)\n",
}
READ = {
    "import a": ("import helper_a", "helper_a.f(x)", "helper_a"),
    "import a as b": ("import helper_a as h", "h.f(x)", "helper_a"),
    "from a import b": ("from helper_a import f", "f(x)", "helper_a"),
    "a value": ("import helper_a", "helper_a.X * x", "helper_a"),
    "a module of a package": ("import pack_a.inner", "pack_a.inner.f(x)", "pack_a.inner"),
    "from a package import a module": ("from pack_a import inner", "inner.f(x)", "pack_a.inner"),
    "from . import": ("from pack_a import relative", "relative.f(x)", "pack_a.inner"),
    "of another file's import": ("import helper_b", "helper_b.g(x)", "helper_a"),
    "inside a function": ("", "imported(x)", "helper_a"),
    "inside, a as b": ("", "bound(x)", "pack_a.inner"),
    "inside, of a package": ("", "nested(x)", "pack_a.inner"),
    "inside, from a import b": ("", "taken(x)", "pack_a.inner"),
    "inside, from .a import b": ("from pack_a import inside", "inside.f(x)", "pack_a.inner"),
    "in a function in it": ("import helper_a", "(lambda: helper_a.f(x))()", "helper_a"),
    "with a version of its own": ("import helper_a; helper_a.__version__ = '1'", "helper_a.f(x)", "helper_a"),
}  # fmt: skip
INSIDE = """
def imported(x):
    import helper_a
    return helper_a.f(x)
def bound(x):
    import pack_a.inner as p
    return p.f(x)
def nested(x):
    import pack_a.inner
    return pack_a.inner.f(x)
def taken(x):
    from pack_a import inner
    return inner.f(x)
"""
UNREADABLE = {
    "importlib with a variable": ("import importlib", "importlib.import_module(str(x))"),
    "import_module with a variable": ("from importlib import import_module as im", "im(str(x))"),
    "__import__": ("", "__import__(str(x))"),
    "exec": ("", "exec(str(x))"),
    "eval": ("", "eval(str(x))"),
    "a default value": ("def call(t, how=eval):\n    return how(t)", "call('x')"),
    "a file by its path": ("import importlib.util as u", "u.spec_from_file_location('a', 'b')"),
    "runpy": ("import runpy", "runpy.run_path('a')"),
    "a library of C": ("import ctypes", "ctypes.CDLL('./a.so')"),
    "a module as a value": ("import helper_a", "getattr(helper_a, 'f')(x)"),
    "a module that is not there": (
        "def gone(x):\n    import no_such_module\n    return no_such_module.f(x)",
        "gone(x)",
    ),
}


@pytest.fixture(autouse=True)
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    yield tmp_path
    for name in [n for n in sys.modules if n.startswith(("helper_", "pack_a"))]:
        del sys.modules[name]


def made(first: str, text: str) -> Callable[..., Any]:
    """A function as a notebook defines it."""
    space: dict[str, Any] = {}
    exec(f"{first}\n{INSIDE}\ndef fly(x):\n    return {text}", space)
    function: Callable[..., Any] = space["fly"]
    return function


@pytest.mark.parametrize("form", READ)
def test_an_edit_of_what_it_imports_is_another_function(form: str, monkeypatch: pytest.MonkeyPatch) -> None:
    first, text, home = READ[form]
    function = made(first, text)
    before = identified(function)
    assert before.unknown == ""
    assert identified(made(first, text)) == before
    module = sys.modules[home]
    monkeypatch.setattr(module, "Z", 2.0, raising=False)
    assert identified(function) == before, "it does not use this"
    monkeypatch.setattr(module, "X", 2.0)
    after = identified(function)
    assert after.unknown == ""
    assert after.digest != before.digest


@pytest.mark.parametrize("form", UNREADABLE)
def test_what_cannot_be_read_is_named(form: str) -> None:
    assert identified(made(*UNREADABLE[form])).unknown
