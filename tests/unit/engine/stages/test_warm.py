"""Nothing compiles while a search runs: its kernels are compiled before, on a function of few parameters.

Each case has a process of its own, in which nothing has compiled yet.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from tests.given.at_night import rows_nightly_but
from worker.engine.kernels.numba_internals import is_compiled
from worker.engine.search.base import Batch, Floats, Method, Parallel, Space
from worker.engine.stages import search as stage
from worker.running.catalogue.installed import methods

COMPILING = [name for name, method in methods().items() if method.compiles]
WITH_MEMBERS = ["auto", "portfolio"]
SIZES = ((2, 400), (4, 300), (8, 300))
"""Parameters, and evaluations for each of them: on both sides of where `auto` begins in another way."""
BY_DAY = ((2, 400), (8, 100))


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("name", "sizes"),
    rows_nightly_but([("auto", BY_DAY)], [("auto", BY_DAY), *((n, SIZES) for n in ["each by itself", *WITH_MEMBERS])]),
)
def test_nothing_compiles_after_the_warm_up(name: str, sizes: tuple[tuple[int, int], ...]) -> None:
    names = [name] if name in WITH_MEMBERS else [m for m in COMPILING if m not in WITH_MEMBERS]
    command = [sys.executable, "-c", f"from {__name__} import searched; searched({names}, {sizes})"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout.split()) == (0, names), ended.stderr


@pytest.mark.parametrize("name", COMPILING)
def test_a_warm_up_is_short(name: str) -> None:
    evaluated: list[Floats] = []
    method = methods()[name]
    stage._with_members.cache_clear()
    stage._with_members(_counting(method, evaluated))
    assert 0 < sum(map(len, evaluated)) < 1000
    assert {points.shape[1] for points in evaluated} == {stage.WARM}


def _counting(method: Method, evaluated: list[Floats]) -> Method:
    """The method, which notes the points that it requests."""

    def search(space: Space, options: object) -> Parallel:
        inside = method.search(space, options)
        points = next(inside)
        while True:
            evaluated.append(np.asarray(points))
            points = inside.send((yield points))

    return replace(method, search=search)


def searched(names: list[str], sizes: tuple[tuple[int, int], ...]) -> None:
    """Warm and run each method; prints its name if nothing was compiled after it was warmed."""
    for name in names:
        method = methods()[name]
        stage._warm(method, methods())
        before = signatures()
        for size in sizes:
            for fails in (True, False):
                _run(method, *size, fails)
        assert before, "no function of a search is compiled"
        assert signatures() == before, {k: v for k, v in signatures().items() if before.get(k) != v}
        print(name)


def signatures() -> dict[str, int]:
    """How many signatures of each function of a search are compiled or loaded, of those that have any."""
    found = {}
    for module in [m for name, m in sys.modules.items() if name.startswith("worker.engine.search")]:
        for name, value in vars(module).items():
            if is_compiled(value) and value.signatures:
                found[f"{module.__name__}.{name}"] = len(value.signatures)
    return found


def _run(method: Method, n: int, each: int, fails: bool) -> None:
    """On many valleys; where it fails, in a fifth of the cube."""
    left = n * each
    space = Space(n, left, np.random.default_rng(1), np.empty((0, n)), lambda u: u, lambda m: None)
    search = method.search(space, method.options())
    try:
        points = next(search)
        while left > 0:
            assert isinstance(points, np.ndarray)
            left -= len(points)
            status = ((points[:, 0] < 0.2) & fails).astype(np.uint8)
            costs = (np.cos(8 * points) + (points - 0.3) ** 2).sum(axis=1)
            points = search.send(Batch(np.where(status, np.nan, costs)[:, None], status))
    except StopIteration:
        pass
    search.close()
