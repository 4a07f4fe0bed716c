"""Linear algebra on one thread: the same bits whatever the machine has, and its threads back afterwards."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import numpy as np
import pytest

from worker.engine.search.parts import one_thread as module
from worker.engine.search.parts.one_thread import one_thread


@pytest.fixture(autouse=True)
def several() -> Iterator[None]:
    """More than one thread, which the processes of the tests have."""
    for library in module._libraries():
        library.set(2)
    yield
    for library in module._libraries():
        library.set(1)


def threads() -> list[int]:
    return [library.get() for library in module._libraries()]


def test_it_has_one_thread_inside_and_the_earlier_number_outside() -> None:
    before = threads()
    with one_thread():
        assert set(threads()) == {1}
        with one_thread():
            pass
        assert set(threads()) == {1}, "the outer block is not over"
    assert threads() == before


def test_an_error_inside_restores_it() -> None:
    before = threads()
    with pytest.raises(ZeroDivisionError), one_thread():
        raise ZeroDivisionError
    assert threads() == before


def test_blocks_of_two_threads_overlap() -> None:
    before, entered, leave = threads(), threading.Event(), threading.Event()

    def other() -> None:
        with one_thread():
            entered.set()
            leave.wait(10)

    thread = threading.Thread(target=other, daemon=True)
    with one_thread():
        thread.start()
        entered.wait(10)
    assert set(threads()) == {1}
    leave.set()
    thread.join()
    assert threads() == before


def test_the_packages_that_are_installed_here_are_covered() -> None:
    """Both wheels contain an OpenBLAS; without it, results could depend on the number of cores."""
    built = [p.__config__.CONFIG["Build Dependencies"]["blas"]["name"] for p in (np, __import__("scipy"))]
    assert len(module._libraries()) == sum("openblas" in name for name in built)
