"""NLopt's global methods by name: each searches, and is reproducible from its seed."""

from __future__ import annotations

import subprocess
import sys
from typing import get_args, get_type_hints

import numpy as np
import pytest

from campaigns.codes import StopCode
from clearance.testing.searching import batch, run, space
from tests.given.ended_searches import ending
from tests.given.functions_with_minima import on_unit_cube
from worker.engine.search.base import Floats, side_by_side
from worker.engine.search.methods import nlopt_global
from worker.engine.search.methods.nlopt_global import Options, method

ALGORITHMS = get_args(get_type_hints(Options)["algorithm"])
RANDOM = ["crs2_lm", "isres", "esch"]


def bowl(x: Floats) -> Floats:
    return np.asarray(((x - 0.37) ** 2).sum(axis=1))


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_each_finds_a_bowls_bottom(algorithm: str) -> None:
    found = run(method, bowl, 2, 1500, options={"algorithm": algorithm})
    assert found.lowest < 1e-2
    (minimum,) = found.minima
    assert minimum.cost <= found.lowest + 1e-3
    assert {len(b) for b in found.batches} == {1}


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_each_continues_past_points_without_a_value(algorithm: str) -> None:
    half = run(method, lambda x: np.where(x[:, 0] > 0.5, np.nan, bowl(x)), 2, 800, options={"algorithm": algorithm})
    assert half.lowest < 0.05
    assert all(np.isfinite(m.cost) for m in half.minima)
    nothing = run(method, lambda x: np.full(len(x), np.nan), 2, 100, options={"algorithm": algorithm})
    assert nothing.minima == []


def interleaved(algorithm: str, seeds: list[int]) -> list[Floats]:
    """The points of several searches that take turns."""
    searches = [method.search(space(2, 300, seed=s), Options(algorithm=algorithm)) for s in seeds]  # type: ignore[arg-type]
    together = side_by_side(searches)
    points, asked = next(together), []
    for _ in range(300):
        asked.append(points.copy())
        points = together.send(batch(bowl(points)))
    together.close()
    return [np.concatenate([a[i : i + 1] for a in asked]) for i in range(len(seeds))]


@pytest.mark.parametrize("algorithm", RANDOM)
def test_a_seed_gives_its_points_whoever_else_searches(algorithm: str) -> None:
    alone = [run(method, bowl, 2, 300, seed=s, options={"algorithm": algorithm}).points for s in (1, 2)]
    assert not np.array_equal(*alone)
    for one, other in zip(alone, interleaved(algorithm, [1, 2]), strict=True):
        assert np.array_equal(one, other)


ABANDONED = """
from clearance.testing.searching import batch, plain, space
from worker.engine.search.methods.nlopt_global import Options, method
for algorithm in {algorithms}:
    for points in (1, 2) * 3:
        search = plain(method.search(space(64, 1000), Options(algorithm=algorithm)))
        point = next(search)
        for _ in range(points - 1):
            point = search.send(batch(point[:, 0]))
        search.close()
"""


@pytest.mark.nightly
def test_none_crashes_the_process_when_it_is_abandoned_at_its_first_points() -> None:
    """As at the end of a budget, or when a run is cancelled."""
    script = ABANDONED.format(algorithms=[a for a in ALGORITHMS if a not in method.most_parameters["algorithm"]])
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=100)
    assert done.returncode == 0, done.stderr


def test_too_many_parameters_for_ags_is_a_sentence() -> None:
    search = method.search(space(11, 100), Options(algorithm="ags"))
    with pytest.raises(StopIteration) as ended:
        next(search)
    assert ending(ended.value.value) == (StopCode.UNSUITED, {"most": 10, "parameters": 11})


def test_the_known_minimum_is_found() -> None:
    function = on_unit_cube("six-hump camel", 1)
    assert function.gap(run(method, function, 2, 3000).lowest) < 0.01
    assert nlopt_global.method.extend is None
