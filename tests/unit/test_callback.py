"""Callback libraries as generators, and concurrent searches; no thread outlives its search."""

from __future__ import annotations

import gc
import threading
from collections.abc import Iterator

import numpy as np
import pytest

from tests.unit.searching import batch
from worker.search.base import Batch, Floats, Search, side_by_side
from worker.search.parts.callback import Ask, called_back


@pytest.fixture(autouse=True)
def no_thread_stays() -> Iterator[None]:
    before = set(threading.enumerate())
    yield
    assert set(threading.enumerate()) <= before


# Libraries that call back


def doubling(ask: Ask) -> float:
    """A library that requests ever larger points, and returns the last result."""
    x, answer = 0.01, 0.0
    while x < 1:
        answer = float(ask(np.array([[x]])).costs[0, 0])
        x *= 2
    return answer


def cost(points: Floats) -> Batch:
    return batch(points.sum(axis=1))


def test_a_library_that_calls_back_becomes_a_generator() -> None:
    search = called_back(doubling)
    asked = []
    points = next(search)
    for _ in range(6):
        asked.append(float(points[0, 0]))
        points = search.send(cost(points))
    assert asked == [0.01 * 2**k for k in range(6)]
    with pytest.raises(StopIteration) as ended:
        search.send(cost(points))
    assert ended.value.value == 0.64


@pytest.mark.parametrize("after", range(4))
def test_abandoning_it_ends_its_thread(after: int) -> None:
    search = called_back(doubling)
    before = threading.active_count()
    points = next(search) if after else None
    for _ in range(after - 1):
        assert points is not None
        points = search.send(cost(points))
    assert threading.active_count() == before + (after > 0)
    search.close()
    assert threading.active_count() == before


def test_forgetting_it_ends_its_thread_too() -> None:
    search = called_back(doubling)
    next(search)
    before = threading.active_count()
    del search
    gc.collect()
    assert threading.active_count() == before - 1


def test_a_library_that_keeps_every_exception_ends_nevertheless() -> None:
    asked = []

    def stubborn(ask: Ask) -> None:
        for k in range(100):
            asked.append(k)
            try:
                ask(np.array([[0.5]]))
            except Exception:
                continue

    search = called_back(stubborn)
    next(search)
    search.close()
    assert asked == [0]


def test_a_library_that_asks_again_after_it_was_abandoned_is_refused_again() -> None:
    def deaf(ask: Ask) -> int:
        refused = 0
        for _ in range(5):
            try:
                ask(np.array([[0.5]]))
            except BaseException:
                refused += 1
        seen.append(refused)
        return refused

    seen: list[int] = []
    search = called_back(deaf)
    next(search)
    search.close()
    assert seen == [5]


def test_an_error_in_the_library_surfaces() -> None:
    def broken(ask: Ask) -> None:
        ask(np.array([[0.5]]))
        raise ZeroDivisionError("in the library")

    search = called_back(broken)
    points = next(search)
    with pytest.raises(ZeroDivisionError, match="in the library"):
        search.send(cost(points))


def test_an_error_thrown_into_the_generator_ends_the_thread() -> None:
    search = called_back(doubling)
    next(search)
    with pytest.raises(KeyboardInterrupt):
        search.throw(KeyboardInterrupt())


# Side by side


def asking(name: str, count: int, closed: list[str], size: int = 2) -> Search:
    """Asks `count` times for `size` points whose value is that of its name, and checks the answers."""
    try:
        for k in range(count):
            answer = yield np.full((size, 1), ord(name) + k / 100)
            assert answer.costs[:, 0].tolist() == [ord(name) + k / 100] * size
        return f"{name} ended"
    finally:
        closed.append(name)


def together(*searches: Search, at_once: int = 256) -> tuple[list[Floats], list[str]]:
    asked, both = [], side_by_side(list(searches), at_once)
    try:
        points = next(both)
        while True:
            asked.append(points[:, 0].tolist())
            points = both.send(cost(points))
    except StopIteration as ended:
        return asked, ended.value


def test_searches_side_by_side_get_their_own_answers() -> None:
    closed: list[str] = []
    asked, said = together(asking("a", 1, closed, 3), asking("b", 3, closed, 1), asking("c", 2, closed))
    assert asked == [[97.0] * 3 + [98.0] + [99.0] * 2, [98.01, 99.01, 99.01], [98.02]]
    assert said == ["a ended", "b ended", "c ended"]
    assert sorted(closed) == ["a", "b", "c"]


def test_of_many_searches_the_next_begins_when_one_has_ended() -> None:
    closed: list[str] = []
    asked, said = together(*(asking(n, k, closed, 1) for n, k in zip("abcd", (1, 3, 0, 1), strict=True)), at_once=2)
    assert asked == [[97.0, 98.0], [98.01, 100.0], [98.02]]
    assert said == ["a ended", "b ended", "c ended", "d ended"]
    assert together() == ([], [])


def test_closing_them_closes_each() -> None:
    closed: list[str] = []
    both = side_by_side([asking(name, 5, closed) for name in "abc"])
    next(both)
    both.close()
    assert closed == ["a", "b", "c"]


def test_when_one_cannot_begin_the_others_are_closed() -> None:
    def broken(ask: Ask) -> str:
        raise MemoryError

    before = threading.active_count()
    both = side_by_side([called_back(lambda ask: str(doubling(ask))), called_back(broken)])
    with pytest.raises(MemoryError) as caught:
        next(both)
    assert caught.traceback  # the traceback references the frames, and thus every open generator
    assert threading.active_count() == before
