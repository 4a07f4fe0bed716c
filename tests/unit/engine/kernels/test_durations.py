"""Compilations are reported while they run, with what earlier ones took on this machine, and only if there is one."""

from __future__ import annotations

import fcntl
import importlib
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from numba import config

from worker.engine.kernels import cache
from worker.engine.kernels.cached import cached
from worker.engine.kernels.durations import Watched, reported

TEMPLATE = """
def rover_fly_8_0123456789abcdef(x):
    return x + 1.0
"""


class Heard:
    """What is reported within a block."""

    def __init__(self) -> None:
        self.begun: list[float | None] = []
        self.ended = 0

    def end(self) -> None:
        self.ended += 1


def function() -> Callable[[float], float]:
    """A function of a module, as numba's cache needs it; another object at every call."""
    made: Callable[[float], float] = importlib.reload(importlib.import_module("rover")).rover_fly_8_0123456789abcdef
    return made


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(cache, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path))
    (tmp_path / "rover.py").write_text(TEMPLATE)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "rover", raising=False)
    return tmp_path


def test_a_compilation_is_reported_and_a_hit_is_not(folder: Path) -> None:
    heard = Heard()
    with reported(heard.begun.append, heard.end):
        assert cached(function())(1.0) == 2.0
        assert (heard.begun, heard.ended) == ([None], 1), "without earlier ones no number is invented"
        assert cached(function())(1.0) == 2.0, "loaded from the disk cache"
    assert (heard.begun, heard.ended) == ([None], 1)
    cached(function())(1)  # another signature; nothing listens
    assert heard.ended == 1


def watched(folder: Path, name: str) -> Watched:
    def made() -> None: ...

    made.__qualname__, made.__module__ = f"{name}_fly_8_0123456789abcdef", "worker.generated"
    return Watched(made, folder)


def took(folder: Path, name: str, seconds: float) -> None:
    found = watched(folder, name)
    found._store(seconds)


def test_what_earlier_compilations_took(folder: Path) -> None:
    assert watched(folder, "rover").expected() is None
    took(folder, "unicycle", 4.0)
    took(folder, "fixed_wing", 20.0)
    took(folder, "pioneer", 6.0)
    assert watched(folder, "rover").expected() == 6.0
    took(folder, "rover", 9.0)
    assert watched(folder, "rover").expected() == 9.0
    for file in (folder / "seconds").rglob("*fly_8"):
        file.write_text("nan")
    assert watched(folder, "rover").expected() is None


def test_waiting_for_another_process_is_reported_and_not_measured(folder: Path) -> None:
    heard = Heard()
    with reported(heard.begun.append, heard.end), watched(folder, "rover") as found:
        found.wait()
    assert (heard.begun, heard.ended) == ([None], 1)
    assert watched(folder, "rover").expected() is None


def test_a_compilation_that_fails_ends_too(folder: Path) -> None:
    heard = Heard()

    def wrong(x: float) -> object:
        return {x, "a"}

    wrong.__qualname__ = "wrong_fly_8_0123456789abcdef"
    with reported(heard.begun.append, heard.end), pytest.raises(Exception, match="nopython"):
        cached(wrong)(1.0)
    assert (heard.begun, heard.ended) == ([None], 1)
    assert not list(folder.rglob("*wrong_fly_8"))


def test_what_is_compiled_for_another_function_belongs_to_that(folder: Path) -> None:
    """It is reported once, and waits for nobody that compiles it alone and needs the compiler, too."""
    inner = cached(function())
    heard = Heard()
    (folder / "locks").mkdir()
    with (folder / "locks" / "rover.rover_fly_8_0123456789abcdef").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        with reported(heard.begun.append, heard.end):
            assert cached(lambda x: 2.0 * inner(x))(1.0) == 4.0
    assert (heard.begun, heard.ended) == ([None], 1)
    with reported(heard.begun.append, heard.end):
        assert cached(function())(1.0) == 2.0, "stored as well"
    assert heard.ended == 1
