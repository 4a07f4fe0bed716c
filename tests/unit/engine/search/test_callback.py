"""Callback libraries as generators, and concurrent searches; no library goes on when its search is closed."""

from __future__ import annotations

import gc
import threading
from collections.abc import Callable, Generator, Iterator
from typing import Any, TypeVar

import numpy as np
import pytest

from clearance.testing.searching import batch
from worker.engine.search.base import Batch, Floats, Search, side_by_side
from worker.engine.search.parts.callback import Ask, called_back, called_back_in_thread

T = TypeVar("T")
Made = Callable[[Callable[[Ask], Any]], Generator[Floats, Batch, Any]]


@pytest.fixture(autouse=True)
def no_thread_stays() -> Iterator[None]:
    before = set(threading.enumerate())
    yield
    assert set(threading.enumerate()) <= before


def driven(search: Generator[Floats, Batch, T], factor: float = 1.0) -> T:
    """What it returns, answered to its end."""
    points = next(search)
    try:
        while True:
            points = search.send(cost(points * factor))
    except StopIteration as ended:
        result: T = ended.value
        return result


# Libraries that call back


@pytest.fixture(params=[called_back, called_back_in_thread], ids=["greenlet", "thread"])
def made(request: pytest.FixtureRequest) -> Made:
    """The function that makes a generator of a library."""
    function: Made = request.param
    return function


def doubling(ask: Ask, running: list[str] | None = None) -> float:
    """A library that requests ever larger points, and returns the last result; `running` names it while it runs."""
    names = [] if running is None else running
    x, answer = 0.01, 0.0
    names.append("doubling")
    try:
        while x < 1:
            answer = float(ask(np.array([[x]])).costs[0, 0])
            x *= 2
        return answer
    finally:
        names.remove("doubling")


def cost(points: Floats) -> Batch:
    return batch(points.sum(axis=1))


def test_a_library_that_calls_back_becomes_a_generator(made: Made) -> None:
    search = made(doubling)
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
def test_closing_it_ends_the_library(made: Made, after: int) -> None:
    running: list[str] = []
    search = made(lambda ask: doubling(ask, running))
    points = next(search) if after else None
    for _ in range(after - 1):
        assert points is not None
        points = search.send(cost(points))
    assert len(running) == (after > 0)
    search.close()
    assert running == []


def test_forgetting_it_ends_the_library_too(made: Made) -> None:
    running: list[str] = []
    search = made(lambda ask: doubling(ask, running))
    next(search)
    assert running
    del search
    gc.collect()
    assert running == []


def test_an_interrupt_while_it_is_answered_ends_the_library(made: Made) -> None:
    running: list[str] = []

    def answering() -> None:
        search = made(lambda ask: doubling(ask, running))
        next(search)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        answering()
    gc.collect()
    assert running == []


def test_an_interrupt_while_the_library_computes_is_raised(made: Made) -> None:
    def computing(ask: Ask) -> None:
        ask(np.array([[0.5]]))
        raise KeyboardInterrupt  # as from its signal, which may come at any time

    search = made(computing)
    points = next(search)
    with pytest.raises(KeyboardInterrupt):
        search.send(cost(points))


def test_no_thread_is_started_and_several_threads_have_their_own() -> None:
    before, found = threading.active_count(), dict[int, float]()

    def drive(k: int) -> None:
        found[k] = driven(called_back(doubling), k)

    drive(1)
    assert threading.active_count() == before
    threads = [threading.Thread(target=drive, args=[k], daemon=True) for k in range(2, 6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == {k: 0.64 * k for k in range(1, 6)}


def test_a_library_may_be_driven_from_within_another(made: Made) -> None:
    def outer(ask: Ask) -> float:
        inner, total = made(doubling), 0.0
        points = next(inner)
        while True:
            answer = ask(points)
            total += float(answer.costs[0, 0])
            try:
                points = inner.send(answer)
            except StopIteration as ended:
                return total + float(ended.value)

    assert driven(made(outer)) == pytest.approx(1.27 + 0.64)


def test_a_library_that_keeps_every_exception_ends_nevertheless(made: Made) -> None:
    asked = []

    def stubborn(ask: Ask) -> None:
        for k in range(100):
            asked.append(k)
            try:
                ask(np.array([[0.5]]))
            except Exception:
                continue

    search = made(stubborn)
    next(search)
    search.close()
    assert asked == [0]


def test_a_library_that_asks_again_after_it_was_abandoned_is_refused_again(made: Made) -> None:
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
    search = made(deaf)
    next(search)
    search.close()
    assert seen == [5]


def test_an_error_in_the_library_surfaces(made: Made) -> None:
    def broken(ask: Ask) -> None:
        ask(np.array([[0.5]]))
        raise ZeroDivisionError("in the library")

    search = made(broken)
    points = next(search)
    with pytest.raises(ZeroDivisionError, match="in the library"):
        search.send(cost(points))


def test_an_error_thrown_into_the_generator_ends_the_library(made: Made) -> None:
    running: list[str] = []
    search = made(lambda ask: doubling(ask, running))
    next(search)
    with pytest.raises(KeyboardInterrupt):
        search.throw(KeyboardInterrupt())
    assert running == []


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
    asked, statement = together(asking("a", 1, closed, 3), asking("b", 3, closed, 1), asking("c", 2, closed))
    assert asked == [[97.0] * 3 + [98.0] + [99.0] * 2, [98.01, 99.01, 99.01], [98.02]]
    assert statement == ["a ended", "b ended", "c ended"]
    assert sorted(closed) == ["a", "b", "c"]


def test_of_many_searches_the_next_begins_when_one_has_ended() -> None:
    closed: list[str] = []
    asked, statement = together(
        *(asking(n, k, closed, 1) for n, k in zip("abcd", (1, 3, 0, 1), strict=True)), at_once=2
    )
    assert asked == [[97.0, 98.0], [98.01, 100.0], [98.02]]
    assert statement == ["a ended", "b ended", "c ended", "d ended"]
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

    running: list[str] = []
    both = side_by_side([called_back(lambda ask: str(doubling(ask, running))), called_back(broken)])
    with pytest.raises(MemoryError) as caught:
        next(both)
    assert caught.traceback  # the traceback references the frames, and thus every open generator
    assert running == []
