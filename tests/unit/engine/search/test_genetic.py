"""The genetic algorithm: published settings, each operator, no repeated evaluations, resumption."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
import pytest

from campaigns.codes import StopCode
from campaigns.results.base import EXCLUDED, FAILED
from clearance.testing.searching import Searched
from clearance.testing.searching import run as searched
from tests.given.ended_searches import ending
from tests.given.functions_with_minima import on_unit_cube
from worker.engine.search.base import Floats
from worker.engine.search.methods import genetic
from worker.engine.search.methods.genetic import Options, method
from worker.engine.search.parts import breeding


def run(*given: Any, options: Mapping[str, object] | None = None, **more: Any) -> Searched:
    """As published, unless other options are given."""
    return searched(*given, options={"as_published": True, **(options or {})}, **more)


def bowl(x: Floats) -> Floats:
    return np.asarray(((x - 0.3) ** 2).sum(axis=1))


def flat(x: Floats) -> Floats:
    return np.ones(len(x))


def chance(seed: int = 1) -> np.random.Generator:
    return np.random.default_rng(seed)


def test_the_defaults_are_the_published_settings() -> None:
    published: dict[str, Any] = {
        "population": 20, "elite": 2, "crossover_fraction": 0.8, "crossover": "scattered", "selection": "roulette",
        "mutation": "gaussian", "scale": 1.0, "shrink": 1.0, "generations": 100, "tolerance": 1e-6,
        "stall_generations": 50,
    }  # fmt: skip
    assert published.items() <= asdict(Options()).items()


def test_fitness_falls_with_the_root_of_the_rank_and_needs_no_number() -> None:
    share = breeding.expectation(np.array([3.0, np.inf, -1e300, 7.0]))
    assert share / share.max() == pytest.approx([2**-0.5, 4**-0.5, 1.0, 3**-0.5])
    assert share.sum() == pytest.approx(1.0)
    worst = breeding.expectation(np.array([1.0, np.inf, np.inf]))
    assert worst[0] > worst[1] > worst[2] > 0.0


@pytest.mark.parametrize("name", breeding.SELECT)
def test_better_ones_become_parents_more_often(name: str) -> None:
    share = breeding.expectation(np.array([2.0, 1.0, 4.0, 3.0]))
    rows = breeding.SELECT[name](chance(), share, 40_000, 4)
    got = np.bincount(rows, minlength=4) / len(rows)
    assert got[1] > got[0] > got[3] > got[2] > 0.0
    if name != "tournament":
        assert got == pytest.approx(share, abs=0.01)
    else:  # the best of four drawn is the best of all unless it is not drawn
        assert got[1] == pytest.approx(1 - 0.75**4, abs=0.01)


def test_stochastic_uniform_selects_parents_in_proportion() -> None:
    share = np.array([0.5, 0.25, 0.15, 0.1])
    for seed in range(20):
        counts = np.bincount(breeding.stochastic_uniform(chance(seed), share, 100, 4), minlength=4)
        assert (np.abs(counts - 100 * share) < 1.0 + 1e-9).all()


@pytest.mark.parametrize("name", breeding.CROSS)
def test_children_come_from_both_parents(name: str) -> None:
    better, worse = np.full((5000, 6), 0.2), np.full((5000, 6), 0.7)
    children = breeding.CROSS[name](chance(), better, worse, 1.2 if name == "heuristic" else 1.0)
    if name in ("scattered", "two_point"):
        assert set(np.unique(children)) == {0.2, 0.7}
        assert (children == 0.2).mean() == pytest.approx(0.5 if name == "scattered" else 8 / 21, abs=0.01)
    if name == "two_point":
        changes = np.abs(np.diff(children, axis=1)).astype(bool).sum(axis=1)
        assert changes.max() == 2
    if name == "intermediate":
        assert children.min() >= 0.2
        assert children.max() <= 0.7
        assert children.mean() == pytest.approx(0.45, abs=0.01)
    if name == "heuristic":
        assert children == pytest.approx(0.1)


def test_mutations_have_the_stated_size() -> None:
    parents = np.full((20_000, 3), 0.5)
    moved = breeding.gaussian(chance(), parents, 0.25)
    assert moved.std() == pytest.approx(0.25, abs=0.01)
    assert np.array_equal(breeding.gaussian(chance(), parents, 0.0), parents)
    anew = breeding.uniform(chance(), parents, 0.1)
    assert (anew != 0.5).mean() == pytest.approx(0.1, abs=0.01)
    along = breeding.directed(chance(), parents, 0.125) - parents
    assert np.linalg.norm(along, axis=1) == pytest.approx(0.125)
    assert along.mean(axis=0) == pytest.approx(0.0, abs=0.01)


def test_gaussian_steps_shrink_to_nothing_over_the_generations(monkeypatch: pytest.MonkeyPatch) -> None:
    lengths: list[float] = []
    plain = breeding.gaussian

    def watched(random: np.random.Generator, parents: Floats, deviation: float) -> Floats:
        assert len(parents) == 18 - round(0.8 * 18)
        lengths.append(deviation)
        return plain(random, parents, deviation)

    monkeypatch.setattr(breeding, "gaussian", watched)
    run(method, bowl, 3, 100_000, options={"stall_generations": 100})
    assert lengths == pytest.approx(1.0 - np.arange(1, 101) / 100)


def test_adaptive_steps_grow_and_shrink_fourfold() -> None:
    options = Options()
    assert genetic._adapted(0.1, True, options) == pytest.approx(0.4)
    assert genetic._adapted(0.1, False, options) == pytest.approx(0.025)
    assert genetic._adapted(0.9, True, options) == 1.0
    assert genetic._adapted(1e-6, False, options) == 1e-6


def test_a_generation_is_one_batch_and_copies_of_a_parent_are_not_evaluated_again() -> None:
    found = run(method, bowl, 8, 100_000)
    assert len(found.batches[0]) == 20
    assert len(found.batches) <= 101
    later = [len(b) for b in found.batches[1:]]
    assert max(later) <= 18
    assert sum(later) < 0.9 * 18 * len(later)  # constant random bits, and parents paired with themselves
    lowest = [float(np.min(v)) for v in found.values]
    best = np.minimum.accumulate(lowest)
    assert best[-1] < 0.05 < best[0]


def test_by_default_it_begins_again_at_other_points_until_the_budget_ends() -> None:
    published, found = run(method, flat, 3, 5000), searched(method, flat, 3, 5000)
    count = len(published.points)
    assert (len(found.points) >= 5000, found.text) == (True, None)
    assert np.array_equal(found.points[:count], published.points)
    fresh = found.points[count : count + 20]
    assert fresh.std(axis=0).min() > 0.2
    assert not np.array_equal(fresh, found.points[:20])
    assert method.extend is not None
    assert method.extend(Options(), 1000) == Options()


def test_the_elite_lives_on() -> None:
    """With only elite and new mutants, the best is never lost and never evaluated again."""
    found = run(method, bowl, 2, 3000, options={"crossover_fraction": 0.0, "mutation": "uniform", "rate": 1.0})
    assert {len(b) for b in found.batches[1:]} == {18}
    assert len(np.unique(found.points, axis=0)) == len(found.points)


def test_starts_are_the_first_points() -> None:
    starts = np.array([[0.25, 0.75], [0.0, 1.0]])
    found = run(method, bowl, 2, 100, starts=starts)
    assert found.batches[0][:2].tolist() == starts.tolist()
    assert len(found.batches[0]) == 20
    assert len(run(method, bowl, 2, 100, starts=np.full((30, 2), 0.5)).batches[0]) == 20


def test_it_stops_where_the_best_cost_stalls() -> None:
    stalled = run(method, flat, 3, 100_000)
    assert ending(stalled.text) == (StopCode.CONVERGED, {"generations": 51})
    ten = run(method, bowl, 3, 100_000, options={"generations": 10})
    assert ten.text == "completed the 10 generations"


@pytest.mark.parametrize(
    ("stall", "changes", "expected"),
    [
        ("cumulative", [0.0, 0.0, 0.0, 0.0], 0.0),
        ("cumulative", [2.0, 0.0, 0.0, 0.0], 0.5),  # from 3 to 1: relative to |3| + 1
        ("weighted", [2.0, 0.0, 0.0, 0.0], 0.5 / 8 / 4),
        ("weighted", [0.0, 0.0, 0.0, 2.0], 0.5 / 4),
    ],
)
def test_the_change_over_the_last_generations(stall: Any, changes: list[float], expected: float) -> None:
    best = [99.0, *(3.0 - np.cumsum([0.0, *changes])).tolist()]
    assert genetic._change(best, Options(stall=stall, stall_generations=4)) == pytest.approx(expected)


def test_nothing_that_failed_counts_as_a_change_or_as_none() -> None:
    assert genetic._change([np.inf] * 6, Options(stall_generations=4)) == np.inf
    none = run(method, lambda x: np.full(len(x), np.nan), 2, 100_000)
    assert none.text == "completed the 100 generations"


@pytest.mark.parametrize("status", [FAILED, EXCLUDED])
def test_points_without_a_value_rank_last_and_the_search_gets_around_them(status: int) -> None:
    f = on_unit_cube("excluded region", 3)
    found = run(method, f, 3, 3000, status=status, options={"schedules": 3})
    assert f.gap(found.lowest) < 0.31  # at least the edge of the region
    late = np.concatenate([np.isnan(v) for v in found.values[-30:]])
    assert late.mean() < 0.2


@pytest.mark.by_day(3)
@pytest.mark.parametrize(
    "option",
    [
        {"mutation": "adaptive"}, {"mutation": "uniform", "rate": 0.2}, {"crossover": "intermediate"},
        {"crossover": "two_point"}, {"crossover": "heuristic"}, {"selection": "tournament"},
        {"selection": "stochastic_uniform"}, {"stall": "weighted"},
    ],
)  # fmt: skip
def test_every_operator_descends(option: dict[str, Any]) -> None:
    gains = []
    for seed in range(10):
        found = run(method, bowl, 4, 2000, options=option, seed=seed)
        gains.append(found.lowest / float(np.min(found.values[0])))
    assert np.median(gains) < 0.3


def test_it_resumes_from_where_it_ended() -> None:
    short, long = run(method, bowl, 3, 10**6), run(method, bowl, 3, 10**6, options={"schedules": 3})
    count = len(short.points)
    assert np.array_equal(long.points[:count], short.points)
    assert len(long.points) > 1.5 * count
    assert long.lowest < short.lowest
    assert long.text is not None
    assert long.text.endswith(" generations, 3 times")


@pytest.mark.parametrize("options", [{}, {"generations": 3}, {"crossover_fraction": 0.5}, {"stall_generations": 5}])
@pytest.mark.parametrize("more", [1, 500, 3000])
def test_extended_options_last_for_the_evaluations_asked_for(options: dict[str, Any], more: int) -> None:
    assert method.extend is not None
    before = run(method, bowl, 4, 10**6, options=options).points
    longer = asdict(method.extend(Options(as_published=True, **options), more))
    after = run(method, bowl, 4, len(before) + more, options=longer).points
    assert len(after) >= len(before) + more
    assert np.array_equal(after[: len(before)], before)
