"""SQP and Monte Carlo, the adapter for libraries that call back, and several searches side by side."""

from __future__ import annotations

import dataclasses
import gc
import threading
from collections.abc import Iterator

import numpy as np
import pytest
from scipy.stats import qmc

from tests.unit.searching import batch, run, space
from worker.search import monte_carlo, sqp
from worker.search.base import Batch, Floats, Search, side_by_side
from worker.search.callback import Ask, called_back


def bowl(x: Floats) -> Floats:
    return np.asarray((x - [0.3, 0.7]) ** 2 @ [1.0, 20.0])


def waves(x: Floats) -> Floats:
    """Four valleys of different depth."""
    return np.asarray(np.cos(4 * np.pi * x[:, 0]) + np.cos(4 * np.pi * x[:, 1]) + x @ [0.2, 0.1])


@pytest.fixture(autouse=True)
def no_thread_stays() -> Iterator[None]:
    before = set(threading.enumerate())
    yield
    assert set(threading.enumerate()) <= before


# SQP


@pytest.mark.parametrize("differences", ["central", "forward"])
def test_sqp_descends_to_the_minimum(differences: str) -> None:
    found = run(sqp.method, bowl, 2, 2000, starts=np.array([[0.9, 0.1]]), options={"differences": differences})
    (minimum,) = found.minima
    assert minimum.point == pytest.approx([0.3, 0.7], abs=1e-4)
    assert minimum.start is not None
    assert minimum.start.tolist() == [0.9, 0.1]
    assert minimum.cost == min(np.concatenate(found.values)) == found.lowest
    assert minimum.evaluations == len(np.unique(found.points, axis=0)) < 200
    assert found.text == minimum.text


def test_sqp_ends_on_a_corner_exactly() -> None:
    found = run(sqp.method, lambda x: -x.sum(axis=1), 2, 2000, starts=np.array([[0.4, 0.6]]))
    assert found.minima[0].point.tolist() == [1.0, 1.0]
    assert found.points.max() == 1.0


def test_sqp_finds_the_valley_of_every_start() -> None:
    starts = np.array([[0.2, 0.2], [0.8, 0.2], [0.2, 0.8], [0.8, 0.8]])
    found = run(sqp.method, waves, 2, 5000, starts=starts)
    assert len(found.minima) == 4
    for minimum in found.minima:
        assert minimum.start is not None
        assert np.abs(minimum.point - minimum.start).max() < 0.1
    assert len({round(m.cost, 6) for m in found.minima}) == 4
    assert found.text is not None
    assert found.text.startswith("every start ended: ")


def test_sqp_asks_for_a_point_and_its_differences_of_all_starts_as_one_batch() -> None:
    starts = np.array([[0.2, 0.2], [0.8, 0.2], [0.0, 1.0]])
    found = run(sqp.method, waves, 2, 5000, starts=starts)
    assert len(found.batches[0]) == 3 * 5
    assert found.batches[0][::5].tolist() == starts.tolist()
    assert found.points.min() >= 0.0
    assert found.points.max() <= 1.0


def test_sqp_without_starts_takes_sobol_points_of_its_seed() -> None:
    one, again, other = (run(sqp.method, waves, 2, 5000, seed=seed) for seed in (1, 1, 2))
    assert np.array_equal(one.points, again.points)
    assert not np.array_equal(one.batches[0], other.batches[0])
    first = one.batches[0][::5]
    assert len(first) == 8
    assert qmc.discrepancy(first) < 0.05
    assert one.lowest == pytest.approx(-2 + 0.075, abs=0.01)


def test_sqp_survives_a_region_without_values() -> None:
    def walled(x: Floats) -> Floats:
        return np.where(x[:, 0] < 0.45, np.nan, bowl(x))

    found = run(sqp.method, walled, 2, 2000, starts=np.array([[0.9, 0.1], [0.2, 0.5]]))
    (minimum,) = found.minima
    assert minimum.start is not None
    assert minimum.start.tolist() == [0.9, 0.1]
    assert minimum.point[0] >= 0.45
    assert minimum.cost < bowl(np.array([[0.9, 0.1]]))[0]
    assert found.text is not None
    assert "a start could not be evaluated" in found.text


def test_sqp_ends_where_its_line_search_fails() -> None:
    # Gradients of 1e11 overflow the library's own quadratic programme.
    found = run(sqp.method, lambda x: 1e11 * (x - 0.5).sum(axis=1), 2, 2000, starts=np.array([[0.3, 0.2]]))
    assert found.text == found.minima[0].text == "the line search failed"
    assert found.minima[0].cost == found.lowest


def test_sqp_counts_its_iterations() -> None:
    found = run(sqp.method, waves, 2, 5000, starts=np.array([[0.1, 0.1]]), options={"iterations": 2})
    assert found.text == "the iterations are used up"
    assert len(found.batches) == 2


def test_sqp_takes_thousands_of_starts_some_at_a_time() -> None:
    search = sqp.method.search(space(2, 10**6, starts=np.random.default_rng(1).random((3000, 2))), sqp.Options())
    before = threading.active_count()
    assert len(next(search)) == 256 * 5
    assert threading.active_count() - before <= 256
    search.close()
    assert threading.active_count() == before


# Monte Carlo


def test_monte_carlo_draws_from_the_distributions_of_the_campaign() -> None:
    drawn = run(monte_carlo.method, lambda x: x[:, 0], 3, 9000).points
    assert drawn.shape == (9000, 3)
    assert np.array_equal(drawn, np.random.default_rng(1).random((9000, 3)))
    shaped = dataclasses.replace(space(3, 100), quantile=np.square)
    assert np.array_equal(next(monte_carlo.method.search(shaped, monte_carlo.Options())), drawn[:100] ** 2)


def test_a_longer_sample_begins_as_the_shorter_one() -> None:
    short, long = (run(monte_carlo.method, waves, 2, budget).points for budget in (700, 9000))
    assert np.array_equal(short, long[:700])


# Libraries that call back


def doubling(ask: Ask) -> float:
    """A library that asks for ever larger points, and returns the last answer."""
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
    assert caught.traceback  # it holds the frames, and so every generator that was not closed
    assert threading.active_count() == before
