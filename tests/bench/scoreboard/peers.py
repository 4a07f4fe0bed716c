"""Optimisation libraries that take part in the score board, as their documentation calls them, over the unit cube.

Those that the product does not install come from `build/peers`; see peers.txt. One that is missing is reported.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import cma
import nlopt
import numpy as np
from scipy import optimize

from tests.bench.scoreboard.searches import Evaluations, Peer, Spent

FOLDER = Path(__file__).parents[3] / "build" / "peers"
INSTALL = "python -m pip install --no-deps --target build/peers -r tests/bench/scoreboard/peers.txt"


def allow() -> None:
    """Let the packages of the peers' folder be imported, after those that are installed."""
    if str(FOLDER) not in sys.path:
        sys.path.append(str(FOLDER))


def module(name: str) -> Any:
    """A module of the peers' folder."""
    allow()
    try:
        return import_module(name)
    except ModuleNotFoundError as missing:
        raise ModuleNotFoundError(f"{missing.name} is not installed: {INSTALL}", name=missing.name) from None


@dataclass(frozen=True)
class Library:
    """A peer: its title, package, modules that must be there, and whether its points depend on the budget.

    slow: it spends tens of milliseconds of its own per evaluation, so that it takes part in BBOB only.
    """

    title: str
    package: str
    modules: tuple[str, ...]
    search: Peer
    plans: bool = False
    slow: bool = False

    def version(self) -> str:
        """The installed version; empty if it cannot run."""
        allow()
        try:
            return version(self.package) if all(find_spec(m) for m in self.modules) else ""
        except PackageNotFoundError:
            return ""


def pycma_bipop(evaluations: Evaluations, dimension: int, budget: int, seed: int) -> None:
    """BIPOP-CMA-ES, every start over the whole box, deviation 0.2 of it as in BBOB's published runs."""
    random = np.random.default_rng(seed)
    options = {"bounds": [0, 1], "seed": seed + 1, "verbose": -9, "verb_log": 0, "maxfevals": budget}
    cma.fmin2(evaluations, lambda: random.random(dimension), 0.2, options, restarts=1000, bipop=True)


def scipy_annealing(evaluations: Evaluations, dimension: int, budget: int, seed: int) -> None:
    """Dual annealing, restarted when its 1,000 iterations are over."""
    random = np.random.default_rng(seed)
    while True:
        optimize.dual_annealing(evaluations, _box(dimension), rng=random, maxfun=10 * budget)


def scipy_evolution(evaluations: Evaluations, dimension: int, budget: int, seed: int) -> None:
    """Differential evolution, restarted when it has converged."""
    random = np.random.default_rng(seed)
    while True:
        optimize.differential_evolution(evaluations, _box(dimension), rng=random)


def scipy_direct(evaluations: Evaluations, dimension: int, budget: int, seed: int) -> None:
    """DIRECT, locally biased, until the budget ends."""
    optimize.direct(evaluations, _box(dimension), maxfun=10 * budget, maxiter=10 * budget, vol_tol=0.0, len_tol=0.0)


def _box(dimension: int) -> Any:
    return optimize.Bounds(np.zeros(dimension), np.ones(dimension))


def nlopt_crs(evaluations: Evaluations, dimension: int, budget: int, seed: int) -> None:
    """Controlled random search with local mutation."""
    _nlopt(nlopt.opt(nlopt.GN_CRS2_LM, dimension), evaluations, budget, seed)


def nlopt_mlsl(evaluations: Evaluations, dimension: int, budget: int, seed: int) -> None:
    """MLSL with a low-discrepancy sample and BOBYQA."""
    optimiser, local = nlopt.opt(nlopt.G_MLSL_LDS, dimension), nlopt.opt(nlopt.LN_BOBYQA, dimension)
    local.set_xtol_rel(1e-8)
    optimiser.set_local_optimizer(local)
    _nlopt(optimiser, evaluations, budget, seed)


def _nlopt(optimiser: Any, evaluations: Evaluations, budget: int, seed: int) -> None:
    nlopt.srand(seed + 1)
    optimiser.set_min_objective(lambda point, _: evaluations(point))
    optimiser.set_lower_bounds(np.zeros(dimension := optimiser.get_dimension()))
    optimiser.set_upper_bounds(np.ones(dimension))
    optimiser.set_maxeval(budget)
    random = np.random.default_rng(seed)
    try:
        while len(evaluations.values) < budget:
            optimiser.optimize(random.random(dimension))
    except (nlopt.RoundoffLimited, nlopt.ForcedStop):
        raise Spent from None


def nevergrad(evaluations: Evaluations, dimension: int, budget: int, seed: int) -> None:
    """NgIohTuned, which chooses by dimension and budget and starts at the middle of the box."""
    ng, metamodel = module("nevergrad"), module("nevergrad.optimization.metamodel")
    # It converts arrays of one element, which numpy 2.4 refuses.
    metamodel.float = lambda value: np.asarray(value).item()
    np.random.seed(seed)  # some of its members draw from the global generator
    box = ng.p.Array(shape=(dimension,), lower=0.0, upper=1.0)
    box.random_state.seed(seed)
    optimiser = ng.optimizers.registry["NgIohTuned"](parametrization=box, budget=budget)
    for _ in range(budget):
        candidate = optimiser.ask()
        optimiser.tell(candidate, evaluations(candidate.value))


def _optuna(sampler: str) -> Peer:
    def search(evaluations: Evaluations, dimension: int, budget: int, seed: int) -> None:
        optuna = module("optuna")
        optuna.logging.set_verbosity(optuna.logging.ERROR)
        study = optuna.create_study(sampler=getattr(optuna.samplers, sampler)(seed=seed))
        box = {f"x{i}": optuna.distributions.FloatDistribution(0.0, 1.0) for i in range(dimension)}
        for _ in range(budget):
            trial = study.ask(box)
            study.tell(trial, evaluations(np.array([trial.params[name] for name in box])))

    return search


PEERS: dict[str, Library] = {
    "pycma_bipop": Library("pycma BIPOP", "cma", ("cma",), pycma_bipop),
    "scipy_annealing": Library("SciPy dual annealing", "scipy", ("scipy",), scipy_annealing),
    "scipy_evolution": Library("SciPy differential evolution", "scipy", ("scipy",), scipy_evolution),
    "scipy_direct": Library("SciPy DIRECT", "scipy", ("scipy",), scipy_direct),
    "nlopt_crs": Library("NLopt CRS2", "nlopt", ("nlopt",), nlopt_crs),
    "nlopt_mlsl": Library("NLopt MLSL with BOBYQA", "nlopt", ("nlopt",), nlopt_mlsl),
    "nevergrad": Library("nevergrad NgIohTuned", "nevergrad", ("nevergrad",), nevergrad, plans=True, slow=True),
    "optuna_tpe": Library("Optuna TPE", "optuna", ("optuna",), _optuna("TPESampler"), slow=True),
    "optuna_gp": Library("Optuna GP", "optuna", ("optuna", "torch"), _optuna("GPSampler"), slow=True),
}
