"""SQP multistart: descends, ends at corners, handles failed regions, keeps its limit of threads."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import numpy as np
import pytest
from scipy.stats import qmc

from campaigns.codes import StopCode
from clearance.testing.searching import run, space
from tests.given.ended_searches import ending
from tests.given.functions_with_minima import on_unit_cube
from worker.engine.search.base import Ended, Floats
from worker.engine.search.methods import sqp
from worker.engine.search.parts.descent import FAILED


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
    assert found.text.startswith("all starts ")


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
    code, ends = ending(found.text)
    assert code == StopCode.MEMBERS
    assert StopCode.NO_VALUE in {end.code for end in ends.values() if isinstance(end, Ended)}


IMPLEMENTATIONS = pytest.mark.parametrize("implementation", ["nlopt", "scipy"])


@IMPLEMENTATIONS
@pytest.mark.parametrize("slope", [1.0, 1e5, 1e11, 1e200])
def test_sqp_descends_slopes_of_any_size(implementation: str, slope: float) -> None:
    found = run(
        sqp.method, lambda x: slope * (x - 0.5).sum(axis=1), 2, 2000, starts=np.array([[0.3, 0.2]]),
        options={"implementation": implementation},
    )  # fmt: skip
    assert found.minima[0].point.tolist() == [0.0, 0.0]
    assert found.text != FAILED


@IMPLEMENTATIONS
def test_sqp_ends_where_its_line_search_fails(implementation: str) -> None:
    # A cliff of 1e13 behind a gentle slope: the library's own quadratic programme overflows.
    def cliff(x: Floats) -> Floats:
        return np.where(x[:, 0] < 0.2, 1e13 * (x[:, 0] - 0.2) * (1 + x[:, 1]), x.sum(axis=1))

    found = run(sqp.method, cliff, 2, 2000, starts=np.array([[0.3, 0.2]]), options={"implementation": implementation})
    assert found.text == found.minima[0].text == FAILED
    assert found.minima[0].cost == found.lowest


@pytest.mark.parametrize("name", ["Branin", "Hartman 3", "Hartman 6", "Shekel 10", "Levy 8"])
def test_both_implementations_end_at_the_same_minimum(name: str) -> None:
    f = on_unit_cube(name, 1)
    start = np.clip(f.minimisers[:1] + 0.01, 0.0, 1.0)
    ends = []
    for implementation in ("nlopt", "scipy"):
        found = run(sqp.method, f, f.dimension, 5000, starts=start, options={"implementation": implementation})
        ends.append(found.minima[0])
        assert found.points.min() >= 0.0
        assert found.points.max() <= 1.0
        assert f.gap(ends[-1].cost) < 1e-6
    assert ends[0].point == pytest.approx(ends[1].point, abs=1e-4)


def test_sqp_counts_its_iterations() -> None:
    found = run(sqp.method, waves, 2, 5000, starts=np.array([[0.1, 0.1]]), options={"iterations": 2})
    assert ending(found.text)[0] == StopCode.ITERATIONS
    assert len(found.batches) == 2


def test_sqp_takes_thousands_of_starts_some_at_a_time() -> None:
    search = sqp.method.search(space(2, 10**6, starts=np.random.default_rng(1).random((3000, 2))), sqp.Options())
    before = threading.active_count()
    assert len(next(search)) == 256 * 5
    assert threading.active_count() - before <= 256
    search.close()
    assert threading.active_count() == before
