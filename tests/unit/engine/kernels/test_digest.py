"""What identifies compiled code: everything that changes it, by value, and nothing else."""

from __future__ import annotations

import cmath
import enum
import json
import math
import os
import pickle
import shutil
import subprocess
import sys
import types
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import llvmlite
import numba
import numpy as np
import pytest
from numba import njit
from numba.core.registry import cpu_target
from numba.core.typing.templates import builtin_registry
from numba.extending import overload

from tests.given.loaded_functions import loaded
from worker.engine.kernels import digest as digests
from worker.engine.kernels.bind import plain
from worker.engine.kernels.cached import cached
from worker.engine.kernels.digest import digest, stamp
from worker.engine.kernels.lanes import lane_ops
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.numba_internals import FLAGS, linked
from worker.engine.kernels.text import module

REPOSITORY = Path(__file__).parents[4]

BASE = "K = 1.0\ndef g(x, a=1.0): return a * x\ndef f(x): return g(x) + K"

SAME = {
    "a comment": "K = 1.0  # the gain\ndef g(x, a=1.0): return a * x\n# below\ndef f(x): return g(x) + K",
    "other lines": "\n\nK = 1.0\n\ndef g(x, a=1.0):\n    return a * x\n\ndef f(x):\n    return g(x) + K",
    "what it does not reach": f"L = 2.0\ndef h(x): return L\n{BASE}",
}

OTHER = {
    "a constant": BASE.replace("K = 1.0", "K = 2.0"),
    "the kind of a constant": BASE.replace("K = 1.0", "K = 1"),
    "the sign of zero": BASE.replace("K = 1.0", "K = -0.0"),
    "a default": BASE.replace("a=1.0", "a=2.0"),
    "an operation": BASE.replace("a * x", "a / x"),
    "a literal": BASE.replace("+ K", "+ K + 1e-300"),
    "another function called": BASE.replace("return g(x)", "return h(x)") + "\ndef h(x, a=1.0): return a * x",
    "a tuple": BASE.replace("K = 1.0", "K = (1.0, 2.0)"),
    "another tuple": BASE.replace("K = 1.0", "K = (1.0, 3.0)"),
}


def test_what_the_digest_does_not_cover() -> None:
    for name, text in SAME.items():
        assert digest(loaded(text)) == digest(loaded(BASE)), name


def test_what_the_digest_covers() -> None:
    digests = {digest(loaded(BASE)): "the function itself"}
    for name, text in OTHER.items():
        found = digest(loaded(text))
        assert found not in digests, f"{name} has the digest of {digests.get(found)}"
        digests[found] = name


def test_the_digest_looks_into_kernels_and_modules() -> None:
    text = "def f(x): return m.g(x)"

    def module(body: str) -> types.ModuleType:
        made = types.ModuleType("helper")
        vars(made)["kernel"] = kernel
        exec(body, vars(made))
        return made

    one, other = (loaded(text, m=module(f"@kernel\ndef g(x): return x + {k}")) for k in (1.0, 2.0))
    assert digest(one) != digest(other)


def test_the_digest_looks_into_modules_of_modules() -> None:
    def package(value: float) -> types.ModuleType:
        outside, inside = types.ModuleType("helpers"), types.ModuleType("helpers.far")
        exec(f"def g(x): return x + {value}", vars(inside))
        vars(outside)["far"] = inside
        return outside

    one, other = (loaded("def f(x): return helpers.far.g(x)", helpers=package(k)) for k in (1.0, 2.0))
    assert digest(one) != digest(other)


def test_the_digest_looks_into_a_module_again_for_other_names() -> None:
    def helper(value: float) -> types.ModuleType:
        made = types.ModuleType("helper")
        exec(f"def one(x): return x\ndef two(x): return x + {value}", vars(made))
        return made

    text = "def a(x): return m.one(x)\ndef f(x): return a(x) + m.two(x)"
    one, other = (loaded(text, m=helper(k)) for k in (1.0, 2.0))
    assert digest(one) != digest(other)


def test_modules_that_name_each_other_end() -> None:
    one, other = types.ModuleType("one"), types.ModuleType("other")
    vars(one)["other"], vars(other)["one"] = other, one
    exec("def g(x): return other.h(x) if x else 0.0", vars(one))
    exec("def h(x): return one.g(x - 1.0)", vars(other))
    made = loaded("def f(x): return one.other.one.g(x)", one=one)
    assert digest(made) == digest(made)
    assert plain(made)(3.0) == 0.0


@pytest.mark.parametrize(
    ("one", "other"),
    [(np.array([1.0, 2.0]), np.array([1.0, 3.0])), (np.int64(1), np.int64(2)), (np.float32(1), np.float32(2))],
)
def test_the_digest_covers_arrays_and_numbers_of_numpy(one: Any, other: Any) -> None:
    assert digest(loaded("def f(x): return x + K", K=one)) != digest(loaded("def f(x): return x + K", K=other))


def test_the_digest_covers_the_defaults_of_a_named_tuple() -> None:
    text = "def f(x): return Made(x).a"
    one, other = (loaded(text, Made=type_with_default(k)) for k in (1.0, 2.0))
    assert digest(one) != digest(other)


def type_with_default(value: float) -> type:
    class Made(NamedTuple):
        x: float
        a: float = value

    return Made


def test_recursion_ends() -> None:
    assert digest(loaded("def f(x): return f(x - 1) if x else 0"))


# Places from which a change could reach machine code unseen: each row makes one function in two ways.


def added(x: float) -> float:
    return x + 1.0


def pair(fields: str) -> Any:
    """A class of tuples, of the same name and module whatever its fields."""
    return NamedTuple("pair", [(name, float) for name in fields])


def colour(red: int) -> Any:
    return enum.IntEnum("colour", {"RED": red})


def state(on: str) -> Any:
    return enum.Enum("state", {"ON": on})


def outside(k: float) -> types.ModuleType:
    made = types.ModuleType("outside")
    vars(made)["K"] = k
    return made


def generated(k: float) -> Any:
    """A function of a text that is generated for a scenario."""
    return module.loaded(f"def g(x):\n    return x + {k}\n", "generated").g


def within(k: float) -> Any:
    return lambda x: x + k


def answering(k: float) -> Any:
    """What tells the compiler how to compile a function."""
    return lambda x: within(k)


def lazily(name: str) -> float:
    """The attribute K of a module that computes its attributes."""
    if name != "K":
        raise AttributeError(name)
    return 2.0


def record(*names: str) -> Any:
    return np.zeros(1, [(name, np.float64) for name in names])


CALLS = "def f(x): return g(x)"
ADDS = "def f(x): return x + K"

PAIRS: dict[str, tuple[Callable[[], Any], Callable[[], Any]]] = {
    "flags of a kernel": (
        lambda: loaded(CALLS, g=njit(error_model="numpy")(added)),
        lambda: loaded(CALLS, g=njit(error_model="numpy", fastmath=True)(added)),
    ),
    "one flag of many": (
        lambda: loaded(CALLS, g=njit(fastmath={"nsz", "arcp"})(added)),
        lambda: loaded(CALLS, g=njit(fastmath={"nsz", "nnan"})(added)),
    ),
    "the passes of the compiler": (
        lambda: loaded(CALLS, g=njit(no_cpython_wrapper=True, no_cfunc_wrapper=True)(added)),
        lambda: loaded(CALLS, g=linked(added)),
    ),
    "compiled or not": (lambda: loaded(CALLS, g=added), lambda: loaded(CALLS, g=njit(added))),
    "a function in a tuple": (
        lambda: loaded("def f(x): return G[0](x)", G=(njit(within(1.0)),)),
        lambda: loaded("def f(x): return G[0](x)", G=(njit(within(2.0)),)),
    ),
    "a function that is a default": (
        lambda: loaded("def f(x, g=h): return g(x)", h=njit(within(1.0))),
        lambda: loaded("def f(x, g=h): return g(x)", h=njit(within(2.0))),
    ),
    "a closure": (lambda: within(1.0), lambda: within(2.0)),
    "a closure of a kernel": (lambda: loaded(CALLS, g=njit(within(1.0))), lambda: loaded(CALLS, g=njit(within(2.0)))),
    "a default by keyword": (
        lambda: loaded("def g(x, *, a=1.0): return a * x\n" + CALLS),
        lambda: loaded("def g(x, *, a=2.0): return a * x\n" + CALLS),
    ),
    "how arguments are passed": (
        lambda: loaded("def g(*a): return a\n" + CALLS),
        lambda: loaded("def g(*, a=None): return a\n" + CALLS),
    ),
    "the order of fields": (
        lambda: loaded("def f(x): return K.a", K=pair("ab")(1.0, 2.0)),
        lambda: loaded("def f(x): return K.a", K=pair("ba")(1.0, 2.0)),
    ),
    "the order of fields of a class": (
        lambda: loaded("def f(x): return P(x, 1.0).a", P=pair("ab")),
        lambda: loaded("def f(x): return P(x, 1.0).a", P=pair("ba")),
    ),
    "a named tuple or a tuple": (
        lambda: loaded("def f(x): return K[0]", K=pair("ab")(1.0, 2.0)),
        lambda: loaded("def f(x): return K[0]", K=(1.0, 2.0)),
    ),
    "a number of an enumeration": (
        lambda: loaded("def f(x): return C.RED", C=colour(1)),
        lambda: loaded("def f(x): return C.RED", C=colour(2)),
    ),
    "a member of an enumeration": (
        lambda: loaded("def f(x): return x is K", K=state("1").ON),
        lambda: loaded("def f(x): return x is K", K=state("2").ON),
    ),
    "an attribute by its name": (
        lambda: loaded("def f(x): return getattr(m, 'K')", m=outside(1.0)),
        lambda: loaded("def f(x): return getattr(m, 'K')", m=outside(2.0)),
    ),
    "the layout of an array": (
        lambda: loaded("def f(x): return K[1, 0]", K=np.ones((2, 2), order="C")),
        lambda: loaded("def f(x): return K[1, 0]", K=np.ones((2, 2), order="F")),
    ),
    "the steps of an array": (
        lambda: loaded("def f(x): return K[1]", K=np.ones(4)[:2]),
        lambda: loaded("def f(x): return K[1]", K=np.ones(4)[::2]),
    ),
    "the fields of an array": (
        lambda: loaded("def f(x): return K[0].a", K=record("a", "b")),
        lambda: loaded("def f(x): return K[0].a", K=record("b", "a")),
    ),
    "the bytes of an array": (
        lambda: loaded("def f(x): return K[0]", K=np.ones(1, ">i8")),
        lambda: loaded("def f(x): return K[0]", K=np.ones(1, "<i8")),
    ),
    "a type of the compiler": (
        lambda: loaded("def f(x): return K(x)", K=numba.types.float64),
        lambda: loaded("def f(x): return K(x)", K=numba.types.float32),
    ),
    "a type of numpy": (
        lambda: loaded("def f(x): return np.zeros(1, K)", np=np, K=np.dtype("f8")),
        lambda: loaded("def f(x): return np.zeros(1, K)", np=np, K=np.dtype("f4")),
    ),
    "a function of another module of C": (
        lambda: loaded(CALLS, g=math.sqrt),
        lambda: loaded(CALLS, g=cmath.sqrt),
    ),
    "what an intrinsic refers to": (
        lambda: loaded(CALLS, g=lane_ops(3, 8).load),
        lambda: loaded(CALLS, g=lane_ops(3, 16).load),
    ),
    "a generated text": (lambda: loaded(CALLS, g=generated(1.0)), lambda: loaded(CALLS, g=generated(2.0))),
    "a dictionary": (lambda: loaded(ADDS, K={"a": 1.0}), lambda: loaded(ADDS, K={"a": 2.0})),
}  # fmt: skip


@pytest.mark.parametrize("name", PAIRS)
def test_what_is_easily_missed_is_covered(name: str) -> None:
    one, other = PAIRS[name]
    assert digest(one()) == digest(one())
    assert digest(one()) != digest(other())
    assert stamp(one(), "function", FLAGS).digest != stamp(other(), "function", FLAGS).digest
    assert not stamp(one(), "function", FLAGS).unknown


def test_what_is_registered_for_the_compiler_is_covered(monkeypatch: pytest.MonkeyPatch) -> None:
    """An `overload` is found by the function that it is for, which does not refer to it."""
    found = {stamp(loaded(CALLS, g=added), "function", {})}
    for k in (1.0, 1.0, 2.0):
        with monkeypatch.context() as patch:
            for registry in ("functions", "globals"):
                patch.setattr(builtin_registry, registry, [*getattr(builtin_registry, registry)])
            overload(added)(answering(k))
            found.add(stamp(loaded(CALLS, g=added), "function", {}))
    assert len(found) == 3
    assert not any(each.unknown for each in found)


MACHINE: dict[str, tuple[Any, str, Any]] = {
    "Python": (sys, "version", "3.99"),
    "numba": (numba, "__version__", "99"),
    "llvmlite": (llvmlite, "__version__", "99"),
    "numpy": (np, "__version__", "99"),
    "how functions are compiled here": (digests, "SOURCE", "0"),
    **{f"numba's {name}": (numba.config, name, 99) for name in digests.SETTINGS},
}


@pytest.mark.parametrize("name", MACHINE)
def test_versions_and_settings_of_the_compiler_are_covered(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    before = stamp(added, "function", FLAGS)
    monkeypatch.setattr(*MACHINE[name], raising=name in ("Python", "numba", "llvmlite", "numpy"))
    assert stamp(added, "function", FLAGS) != before


def test_what_is_made_of_a_function_is_covered() -> None:
    kinds = [("function", FLAGS), ("callback", FLAGS), ("function", {}), ("function", FLAGS | {"nogil": True})]
    assert len({stamp(added, kind, flags) for kind, flags in kinds}) == len(kinds)


def test_the_processor_is_covered(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """By the key within a file: the same folder serves several machines."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    made = cached(added)
    made(1.0)
    codegen = cpu_target.target_context.codegen()
    key = made._cache._index_key((numba.types.float64,), codegen)
    assert key[-1] == (codegen._llvm_module.triple, codegen._get_host_cpu_name(), codegen._tm_features)


def test_an_argument_with_its_fields_in_another_order_is_another_signature(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Numba's own key has only the class and the types of the fields, and its code would answer with the other one."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    home = types.ModuleType("home_of_pairs")
    monkeypatch.setitem(sys.modules, home.__name__, home)
    answers = []
    for fields in ("ab", "ba", "ba"):
        vars(home)["pair"] = pair(fields)
        vars(home)["pair"].__module__ = home.__name__
        made = cached(loaded("def f(p): return p.a"))
        answers.append((made(vars(home)["pair"](1.0, 2.0)), sum(made.stats.cache_hits.values())))
    assert answers == [(1.0, 0), (2.0, 0), (2.0, 1)]


def test_a_function_that_uses_what_cannot_be_told_is_not_stored(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    lazy = types.ModuleType("lazy")
    vars(lazy)["__getattr__"] = lazily
    assert cached(loaded("def f(x): return x + lazy.K", lazy=lazy))(1.0) == 3.0
    assert "attributes of lazy" in caplog.text
    assert not list(tmp_path.rglob("*.nb?"))
    assert stamp(loaded(ADDS, K=object()), "function", {}).unknown == "(object)"


# Copies of the package

COPIED = """
import json
from numba import types
from worker.engine.kernels import maths
from worker.engine.kernels.bind import compile_loop, filled
from worker.engine.kernels.durations import reported
from worker.engine.kernels.cached import cached_callback
from worker.engine.search.parts import levels
import numpy as np

slot = None

def turned(x, y):
    for i in range(len(x)):
        y[i] = slot(x[i])

def called(x):
    return maths.wrap(x)

begun = []
with reported(begun.append, lambda: None):
    loop = compile_loop(filled(turned, {"slot": maths.wrap}), "copied")
    y = np.empty(1)
    loop(np.array([4.0]), y)
    after_loop = len(begun)
    callback = cached_callback(called, types.float64(types.float64))
    after_callback = len(begun)
    levels._approach(np.zeros((2, 1)), np.full(2, np.inf), np.array([0]))
print(json.dumps({
    "from": maths.__file__, "loop": y[0], "callback": callback.ctypes(4.0),
    "compiled": [after_loop, after_callback - after_loop, len(begun) - after_callback],
}))
"""


def copied(folder: Path) -> Path:
    """The package in another folder, written now."""
    for name in ("worker", "campaigns"):
        shutil.copytree(
            REPOSITORY / name,
            folder / name,
            ignore=shutil.ignore_patterns("__pycache__"),
            copy_function=shutil.copyfile,
        )
    (folder / "copied.py").write_text(COPIED, encoding="utf-8")
    return folder


def ran(folder: Path, cache: Path) -> Any:
    """What a process of its own computes with the package in a folder, and what it compiles for that."""
    place = {"CLEARANCE_KERNEL_CACHE": str(cache), "PYTHONPATH": str(folder)}
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"} | place
    command = [sys.executable, "-m", "copied"]
    done = subprocess.run(command, env=environment, cwd=folder, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert Path(found["from"]).is_relative_to(folder)
    return found


@pytest.mark.nightly  # four processes; by day `test_what_the_digest_covers`
def test_copies_of_the_package_in_other_folders_share_what_is_compiled(tmp_path: Path) -> None:
    """And where a constant differs, what reaches it is compiled anew; nothing else is."""
    cache = tmp_path / "cache"
    first, second, other = (copied(tmp_path / name) for name in ("first", "second", "other"))
    assert ran(first, cache)["compiled"] == [1, 1, 1]
    shutil.rmtree(first)
    again = ran(second, cache)
    assert again["compiled"] == [0, 0, 0]
    assert again["loop"] == again["callback"] == 4.0 - 2.0 * math.pi
    text = (other / "worker/engine/kernels/maths.py").read_text(encoding="utf-8")
    assert text.count("TWO_PI = 6.283185307179586\n") == 1
    edited = text.replace("TWO_PI = 6.283185307179586\n", "TWO_PI = 6.25\n")
    (other / "worker/engine/kernels/maths.py").write_text(edited, encoding="utf-8")
    changed = ran(other, cache)
    assert changed["compiled"] == [1, 1, 0]
    assert changed["loop"] == changed["callback"] == 4.0 - 6.25


@pytest.mark.nightly
def test_a_function_that_is_sent_to_another_process_is_compiled_there() -> None:
    sent = pickle.dumps(cached(loaded("def f(x): return x + 1.0")))
    receive = [sys.executable, "-c", "import pickle, sys; print(pickle.load(sys.stdin.buffer)(1.0))"]
    received = subprocess.run(receive, cwd=REPOSITORY, input=sent, capture_output=True, check=False)
    assert received.stdout == b"2.0\n", received.stderr.decode()
