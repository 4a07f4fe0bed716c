"""Compiled loops on disk: reused by the next process, recompiled after any edit of a dependency."""

from __future__ import annotations

import errno
import fcntl
import json
import math
import os
import shutil
import subprocess
import sys
import types
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from numba import config
from numba.core.caching import FunctionCache

from tests.given.at_night import rows_nightly_but
from tests.given.loaded_functions import loaded
from worker.engine.kernels.bind import filled, plain
from worker.engine.kernels.cached import cached
from worker.engine.kernels.folder import cache_folder
from worker.engine.kernels.maths import kernel

FILES = {
    "far.py": """
        from worker.engine.kernels.maths import kernel

        OFFSET = 0.0

        @kernel
        def bent(x, by=2.0):
            return by * x + OFFSET
    """,
    "near.py": """
        import component_far.far as far
        from worker.engine.kernels.maths import kernel

        @kernel
        def helped(x):
            return far.bent(x) + 1.0
    """,
    "main.py": """
        import json
        import numpy as np
        from component_far.near import helped
        from worker.engine.kernels.bind import compile_loop, filled

        slot = None

        def template(x, y):
            for i in range(len(x)):
                y[i] = slot(x[i])

        loop = compile_loop(filled(template, {"slot": helped}), "test")
        print(f"{loop.py_func.__module__}.{loop.py_func.__qualname__}", flush=True)
        y = np.empty(3)
        loop(np.array([1.0, 2.0, np.nan]), y)
        stats = loop.stats
        print(json.dumps({
            "name": loop.py_func.__qualname__,
            "answer": [repr(v) for v in y.tolist()],
            "hits": sum(stats.cache_hits.values()),
            "misses": sum(stats.cache_misses.values()),
        }))
    """,
}


class Package:
    """A package whose kernel reaches a helper through another module, and its own cache."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        (folder / "component_far").mkdir()
        (folder / "component_far" / "__init__.py").touch()
        for name, text in FILES.items():
            self.write(name, text)

    def write(self, name: str, text: str) -> None:
        lines = text.split("\n")
        (self.folder / "component_far" / name).write_text("\n".join(line[8:] for line in lines), encoding="utf-8")

    def edit(self, name: str, old: str, new: str) -> None:
        assert FILES[name].count(old) == 1
        self.write(name, FILES[name].replace(old, new))

    def run(self) -> Any:
        """What a new process answers: the kernel's values, and whether it found the compiled code on disk."""
        loop, answer = self.start().communicate(timeout=120)[0].split("\n", 1)
        return json.loads(answer) | {"loop": loop}

    def start(self) -> subprocess.Popen[str]:
        """A new process; its first line is the name of the loop, which it compiles next."""
        place = {
            "CLEARANCE_KERNEL_CACHE": str(self.folder / "cache"),
            "PYTHONPATH": os.pathsep.join([str(self.folder), os.getcwd()]),
            "PYTHONDONTWRITEBYTECODE": "1",  # edits come faster than the clock of a file system
        }
        environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"} | place
        command = [sys.executable, "-m", "component_far.main"]
        return subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)


@pytest.mark.nightly  # four processes; by day the digests and the files of the cache, each by itself
def test_of_processes_that_need_the_same_code_one_compiles_it(tmp_path: Path) -> None:
    """And an edit of a dependency is compiled anew."""
    package = Package(tmp_path)
    first = package.run()
    assert (first["answer"], first["hits"], first["misses"]) == (["3.0", "5.0", "nan"], 0, 1)
    assert list((tmp_path / "cache").rglob("*.nbc"))

    shutil.rmtree(tmp_path / "cache")
    (tmp_path / "cache" / "locks").mkdir(parents=True)
    with (tmp_path / "cache" / "locks" / first["loop"]).open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        one, other = package.start(), package.start()
        assert one.stdout is not None
        assert other.stdout is not None
        assert one.stdout.readline().strip() == other.stdout.readline().strip() == first["loop"]
    answers = [json.loads(process.communicate(timeout=120)[0]) for process in (one, other)]
    # The second process finds what the first has stored.
    assert sorted((answer["misses"], answer["hits"]) for answer in answers) == [(0, 1), (1, 0)]
    assert [answer["name"] for answer in answers] == [first["name"]] * 2
    assert [answer["answer"] for answer in answers] == [["3.0", "5.0", "nan"]] * 2

    package.edit("far.py", "by * x", "x / by")
    edited = package.run()
    assert (edited["answer"], edited["misses"]) == (["1.5", "2.0", "nan"], 1)
    assert edited["name"] != first["name"]


@pytest.mark.nightly  # four processes; by day the digests alone, in test_digest.py: `test_what_the_digest_covers`
@pytest.mark.parametrize(("old", "new"), [("OFFSET = 0.0", "OFFSET = 10.0"), ("by=2.0", "by=12.0")])
def test_constants_and_defaults_of_a_helper_are_seen_too(tmp_path: Path, old: str, new: str) -> None:
    package = Package(tmp_path)
    before = package.run()
    package.edit("far.py", old, new)
    after = package.run()
    assert after["name"] != before["name"]
    assert after["answer"][:2] == ["13.0", "15.0" if old.startswith("OFFSET") else "25.0"]
    assert after["hits"] == 0


# Filling slots


def template(x: float) -> Any:
    return slot(x) + OFFSET


OFFSET = 0.0


def slot(x: float) -> float:
    raise NotImplementedError


def test_filling_leaves_the_template_alone() -> None:
    made = filled(template, {"slot": math.sqrt, "OFFSET": 1.0})
    assert made(4.0) == 3.0
    with pytest.raises(NotImplementedError):
        template(4.0)


def test_a_slot_that_there_is_not() -> None:
    with pytest.raises(ValueError, match="slat, slut"):
        filled(template, {"slot": math.sqrt, "slat": 1, "slut": 2})


class Pair(NamedTuple):
    a: float
    b: float


@kernel
def inner(x: float) -> float:
    return x * 2.0


@kernel
def outer(x: float) -> float:
    return inner(Pair(x, 1.0).a) + np.floor(x)  # type: ignore[no-any-return]


def test_plain_functions_reach_plain_functions() -> None:
    made = plain(outer)
    assert isinstance(made, types.FunctionType)
    assert isinstance(made.__globals__["inner"], types.FunctionType)
    assert made(1.5) == outer(1.5) == 4.0


def test_what_is_called_instead_is_called_through_modules_and_closures_too() -> None:
    """Else the reference would check the polynomials against themselves, without a word."""

    def made(inside: Any) -> Any:
        @kernel
        def calls(x: float) -> float:
            return inside(x)  # type: ignore[no-any-return]

        return calls

    module = types.ModuleType("m")
    vars(module)["far"], vars(module)["calls"] = types.ModuleType("m.far"), made(inner)
    vars(vars(module)["far"])["inner"] = inner
    function = loaded("def f(x): return m.calls(x) + m.far.inner(x)", m=module)
    assert plain(function)(1.5) == 6.0
    assert plain(function, {inner: lambda x: 100.0 * x})(1.5) == 300.0


def test_where_the_cache_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CLEARANCE_KERNEL_CACHE", "/given")
    assert cache_folder() == Path("/given")
    monkeypatch.delenv("CLEARANCE_KERNEL_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", "/base")
    assert cache_folder() == Path("/base/clearance/kernels")
    monkeypatch.delenv("XDG_CACHE_HOME")
    assert cache_folder() == Path.home() / ".cache" / "clearance" / "kernels"


def doubled(x: float) -> float:
    return 2.0 * x


@pytest.mark.parametrize("error", [ModuleNotFoundError("moved"), KeyError("renamed"), EOFError("cut off")])
def test_a_cached_kernel_that_cannot_be_loaded_is_compiled_again(
    error: Exception, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    asked = []

    def refuse(*_: object) -> None:
        asked.append(1)
        raise error

    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(FunctionCache, "_load_overload", refuse)
    assert cached(doubled)(1.5) == 3.0
    assert asked


DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda content: b"",
    "cut off": lambda content: content[: len(content) // 2],
    "without its end": lambda content: content[:-1],
    "zeros": lambda content: bytes(len(content)),
    "one bit": lambda content: content[:99] + bytes([content[99] ^ 1]) + content[100:],
    "longer": lambda content: content + b"x",
    "of an earlier version": lambda content: content[:-32],
}


@pytest.mark.by_day(3)
@pytest.mark.parametrize(
    ("kind", "damage"),
    rows_nightly_but(
        [*product(["nbc"], DAMAGES), ("nbi", "one bit"), ("nbi", "empty")], product(["nbi", "nbc"], DAMAGES)
    ),
)
def test_a_damaged_file_of_the_cache_is_made_again(
    damage: str, kind: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path))

    def hits() -> int:
        made = cached(doubled)
        assert made(1.5) == 3.0
        return sum(made.stats.cache_hits.values())

    assert (hits(), hits()) == (0, 1)
    (file,) = tmp_path.rglob(f"*.{kind}")
    file.write_bytes(DAMAGES[damage](file.read_bytes()))
    assert (hits(), hits()) == (0, 1)
    assert not list(tmp_path.rglob("*.tmp.*"))


def test_a_cache_that_cannot_be_written_prevents_nothing(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(os, "fsync", full)
    assert cached(doubled)(1.5) == 3.0
    assert [record.levelname for record in caplog.records] == ["WARNING"]
    assert [path for path in tmp_path.rglob("*") if path.is_file() and "locks" not in path.parts] == []
