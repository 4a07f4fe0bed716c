"""The functions on which methods for small budgets are tuned, checked and judged: their minima, and that no set has a
function of another."""

from __future__ import annotations

import json
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from tests.bench import figures, small_budgets
from tests.given.small_budget_functions import JUDGED
from tests.given.small_budget_tuning import TUNING
from tests.given.small_budget_valleys import VALLEYS, Landscape
from worker.running.catalogue.installed import methods

SETS = (JUDGED, TUNING, *VALLEYS)
LANDSCAPES = [f for half in VALLEYS for f in half.values()]


def test_no_function_is_in_two_sets() -> None:
    for one, other in combinations(SETS, 2):
        assert not set(one) & set(other)


@pytest.mark.parametrize("landscape", LANDSCAPES, ids=lambda f: f.name)
def test_the_minimum_is_where_it_is_stated_and_nothing_is_lower(landscape: Landscape) -> None:
    random = np.random.default_rng(5)
    for seed in (1, 2):
        f, there = landscape.at(seed), landscape.minimiser(seed)
        assert landscape.minimum <= f(there[None])[0] < landscape.minimum + 1e-6
        near = there + random.standard_normal((500, landscape.dimension)) * 10.0 ** random.uniform(-4, -1, (500, 1))
        points = np.concatenate([np.clip(near, 0, 1), random.random((500, landscape.dimension))])
        assert f(points).min() >= landscape.minimum


@pytest.mark.parametrize("landscape", LANDSCAPES, ids=lambda f: f.name)
def test_a_seed_determines_the_function_and_no_point_depends_on_its_batch(landscape: Landscape) -> None:
    points = np.random.default_rng(6).random((40, landscape.dimension))
    values = landscape.at(1)(points)
    assert np.array_equal(landscape.at(1)(points[::-1])[::-1], values)
    assert landscape.at(1)(points[7:8])[0] == values[7]
    assert not np.array_equal(landscape.at(2)(points), values)


@pytest.mark.parametrize("landscape", LANDSCAPES, ids=lambda f: f.name)
def test_it_has_more_valleys_than_that_of_the_minimum(landscape: Landscape) -> None:
    """The cost rises somewhere on the straight way from a random point to the minimum."""
    f, there = landscape.at(1), landscape.minimiser(1)
    starts = np.random.default_rng(7).random((50, 1, landscape.dimension))
    way = there + np.linspace(1, 0, 101)[None, :, None] * (starts - there)
    costs = f(way.reshape(-1, landscape.dimension)).reshape(50, 101)
    assert (np.diff(costs, axis=1) > 0).any(axis=1).mean() > 0.3


@pytest.mark.parametrize("functions", small_budgets.SETS)
def test_every_set_is_printed(functions: str) -> None:
    groups = {group: [0.1, 0.2, 0.3] for group in small_budgets.GROUPS}
    row = groups | {"own_ms": 0.5} | ({"failed of half fails": 0.25} if small_budgets.SETS[functions].failing else {})
    found = {"functions": functions, "problems": 2, "seeds": 1, "first_seed": 1, "methods": {"direct": row}}
    last = small_budgets.markdown(found)[-1]
    assert last.startswith("| DIRECT | **0.10** | ")
    assert ("25 %" in last) == bool(small_budgets.SETS[functions].failing)


def test_the_figures_of_some_methods_are_kept_next_to_those_of_the_others(tmp_path: Path) -> None:
    row = {group: [0.12345, 0.2, 0.3] for group in small_budgets.GROUPS} | {"failed of half fails": 0.25}
    found = {"functions": "judged", "problems": 10, "seeds": 15, "first_seed": 1000}
    figures.keep_small_budgets(found | {"methods": {"sqp": row, "direct": row}}, tmp_path)
    figures.keep_small_budgets(found | {"methods": {"auto": row, "sqp": row | {"failed of half fails": 0.5}}}, tmp_path)
    kept = json.loads((tmp_path / "small_budgets.json").read_text(encoding="utf-8"))["methods"]
    assert [*kept] == ["auto", "direct", "sqp"]
    assert [one["failed"] for one in kept.values()] == [0.25, 0.25, 0.5]
    assert kept["direct"]["many valleys"] == [0.1235, 0.2, 0.3]
    assert {name: one["code"] for name, one in kept.items()} == figures.small_budgets_code(kept)
    with pytest.raises(ValueError, match="15 seeds"):
        figures.keep_small_budgets(found | {"seeds": 3, "methods": {"auto": row}}, tmp_path)


def test_the_guide_has_every_method() -> None:
    kept = figures.read("small_budgets")
    assert {*kept["methods"]} == {m.name for m in methods().values() if m.kind != "multi"}
    assert (kept["problems"], kept["seeds"]) == (len(JUDGED), small_budgets.SEEDS)


@pytest.mark.nightly  # by day an edit of a method need not wait for its figures
def test_the_code_is_that_which_the_figures_of_the_guide_are_of() -> None:
    kept = figures.read("small_budgets")["methods"]
    now = figures.small_budgets_code(kept)
    changed = [name for name, one in kept.items() if one["code"] != now[name]]
    assert not changed, f"run `python -m tests.bench.small_budgets --keep {' '.join(changed)}`"
