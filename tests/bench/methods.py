"""Cost of the search methods: batched DIRECT against NLopt's, own time of every method, DIRECT's counts.

`measure` gives the figures for `make bench`; `python -m tests.bench.methods` prints them and the table of counts, ours
beside those of Jones et al. (1993), NLopt and SciPy. All run on one core, and its time is what counts: what others do
with the machine meanwhile matters less.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import nlopt
import numpy as np
from scipy import optimize

from campaigns import library, load_file
from clearance.testing.problems import Problem
from clearance.testing.searching import batch, run, space
from tests.given.functions_with_minima import PUBLISHED, OnUnitCube, on_unit_cube
from worker.engine.search.base import Floats, Method
from worker.engine.search.methods import direct
from worker.engine.systems.closed_loop.assemble import Loop
from worker.running.catalogue.installed import methods

EVALUATIONS = 10_000
DIMENSION = 8
REPEATS = 3
COSTLY = 800
"""Evaluations of a costly method, once: 100 per parameter."""


def measure() -> dict[str, float]:
    """Every figure by its name in `build/bench.json`."""
    return direct_vs_nlopt() | {
        f"overhead_us_{name}": overhead(method, *((COSTLY, 1) if method.costly else (EVALUATIONS, REPEATS)))
        for name, method in methods().items()
    }


def direct_vs_nlopt() -> dict[str, float]:
    """DIRECT on case 5 on one core: ours in batches on all lanes, NLopt's point by point on the one-lane build."""
    problem = Problem(load_file(library()["uav_aca"]))
    narrow = Loop(problem.system.parts, lanes=1)
    counts = problem.system.counts(problem.system.step)
    index = [r.index for r in problem.ranges]
    low = problem.vectors(np.zeros((1, problem.dimension)))[0, index]
    width = problem.vectors(np.ones((1, problem.dimension)))[0, index] - low
    vector = problem.system.nominal[None, :].copy()

    def one(x: Floats, _: Floats) -> float:
        vector[0, index] = low + x * width
        return float(narrow.simulate(vector, problem.system.step, *counts).costs[0, 0])

    def ours() -> tuple[int, float]:
        search = direct.search(space(problem.dimension, EVALUATIONS), direct.Options())
        points, asked, lowest = next(search), 0, np.inf
        while asked < EVALUATIONS:
            found, _ = problem.evaluate(points[: EVALUATIONS - asked])
            asked, lowest = asked + len(found.costs), min(lowest, float(found.costs.min()))
            if asked < EVALUATIONS:
                points = search.send(found)
        return asked, lowest

    best = {"ours": np.inf, "nlopt": np.inf}
    for _ in range(REPEATS):
        for name, work in (("ours", ours), ("nlopt", lambda: _nlopt(one, problem.dimension))):
            began = time.process_time()
            asked, lowest = work()
            best[name] = min(best[name], (time.process_time() - began) / asked)
            assert lowest < 57.25, f"{name} came to {lowest} m only"
    return {
        "direct_case5_us": 1e6 * best["ours"],
        "direct_case5_nlopt_us": 1e6 * best["nlopt"],
        "direct_vs_nlopt": best["nlopt"] / best["ours"],
    }


def _nlopt(cost: Callable[[Floats, Floats], float], dimension: int) -> tuple[int, float]:
    """GN_ORIG_DIRECT: evaluations made, the lowest value."""
    optimiser = nlopt.opt(nlopt.GN_ORIG_DIRECT, dimension)
    optimiser.set_min_objective(cost)
    optimiser.set_lower_bounds(np.zeros(dimension))
    optimiser.set_upper_bounds(np.ones(dimension))
    optimiser.set_maxeval(EVALUATIONS)
    optimiser.optimize(np.full(dimension, 0.5))
    return optimiser.get_numevals(), optimiser.last_optimum_value()


def overhead(method: Method, evaluations: int = EVALUATIONS, repeats: int = REPEATS) -> float:
    """A method's own time per evaluation [us]: the time between a result and the next request.

    On a function of `DIMENSION` parameters; a method that ends earlier restarts with another seed.
    """
    f = on_unit_cube(f"Levy {DIMENSION}", 1)
    _own(method, f, min(500, evaluations // 4))
    return 1e6 * min(_own(method, f, evaluations) / evaluations for _ in range(repeats))


def _own(method: Method, f: OnUnitCube, evaluations: int) -> float:
    own, asked, seed = 0.0, 0, 0
    while asked < evaluations:
        seed += 1
        search = method.search(space(f.dimension, evaluations, seed=seed), method.options())
        answer: Any = None
        try:
            while asked < evaluations:
                began = time.process_time()
                try:
                    points = search.send(answer)
                finally:
                    own += time.process_time() - began
                asked += len(points)
                answer = batch(f(points))
        except StopIteration:
            pass
        search.close()
    return own * evaluations / asked


def counts() -> dict[str, dict[str, tuple[int, int]]]:
    """DIRECT's evaluations to within 1 % and 0.01 % by function: published, ours, NLopt's, SciPy's."""
    found = {}
    for name, published in PUBLISHED.items():
        f = on_unit_cube(name)
        found[name] = {"published": published} | {
            program: (count(f, 1e-2), count(f, 1e-4))
            for program, count in (("ours", _ours), ("nlopt", _nlopts), ("scipy", _scipys))
        }
    return found


def _ours(f: OnUnitCube, within: float) -> int:
    found = run(direct.method, f, f.dimension, 20_000, until=lambda found: f.gap(found.lowest) < within)
    return len(found.points)


def _nlopts(f: OnUnitCube, within: float) -> int:
    """NLopt's GN_ORIG_DIRECT, Gablonsky's program."""
    optimiser = nlopt.opt(nlopt.GN_ORIG_DIRECT, f.dimension)
    optimiser.set_min_objective(lambda x, _: float(f(x[None, :])[0]))
    optimiser.set_lower_bounds(np.zeros(f.dimension))
    optimiser.set_upper_bounds(np.ones(f.dimension))
    optimiser.set_stopval(f.minimum + within * abs(f.minimum))
    optimiser.set_maxeval(20_000)
    optimiser.optimize(np.full(f.dimension, 0.5))
    return int(optimiser.get_numevals())


def _scipys(f: OnUnitCube, within: float) -> int:
    """SciPy's direct with its test of the least improvement set to Jones'."""
    found = optimize.direct(
        lambda x: float(f(np.asarray(x)[None, :])[0]), [(0.0, 1.0)] * f.dimension, eps=1e-4, maxfun=20_000,
        maxiter=100_000, locally_biased=False, f_min=f.minimum, f_min_rtol=within, vol_tol=0.0, len_tol=0.0,
    )  # fmt: skip
    return int(found.nfev)


def main() -> None:
    """Print the figures and the counts."""
    for name, value in measure().items():
        print(f"{name:<32}{value:10.2f}")
    print(f"\n{'DIRECT to 1 % / 0.01 %':<24}{'published':>14}{'ours':>14}{'NLopt':>14}{'SciPy':>14}")
    for name, row in counts().items():
        print(f"{name:<24}" + "".join(f"{f'{one}/{other}':>14}" for one, other in row.values()))


if __name__ == "__main__":
    main()
