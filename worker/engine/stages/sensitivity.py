"""Sensitivity: each parameter over its bounds, the others nominal; Morris and Sobol indices if requested.

Srikanthakumar, chapter 3: d_min against each parameter. One at a time shows main effects near the nominal point and
no interactions; the indices cover the whole box: Morris' elementary effects and Sobol's variance fractions, by SALib.

Morris, Factorial sampling plans for preliminary computational experiments (Technometrics 33, 1991), with mu* of
Campolongo et al. (2007); Saltelli et al., Variance based sensitivity analysis of model output (Computer Physics
Communications 181, 2010).
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any, TypedDict

import numpy as np

from campaigns.asked.stages import Morris, Sensitivity, SobolIndices
from campaigns.claims.say import Part
from campaigns.claims.spans import Spans
from campaigns.claims.stages import ends
from campaigns.claims.stages import surroundings as sentences
from campaigns.results.base import EXCLUDED, OK
from campaigns.results.indices import MorrisRow, MorrisStudy, SobolRow, SobolStudy
from campaigns.stages.sensitivity import SensitivityResult
from worker.engine.problem.problem import Problem
from worker.engine.search.base import Batch, Floats
from worker.engine.stages.parts.base import drive, stream
from worker.engine.stages.parts.context import Context
from worker.engine.stages.parts.outcome import Outcome, Stage
from worker.engine.stages.parts.slices import curves

MORRIS_STREAM, SOBOL_STREAM = 2**22, 2**22 + 1
"""Index of the random stream; searches use those from 0 on."""
FEW = 10
"""Evaluations that decide the variance, or an index: the bootstrap of fewer gives too narrow an interval."""


def run(context: Context, position: int) -> Outcome[SensitivityResult]:
    """The curves in one batch, each kind of index in another."""
    request = context.campaign.stages.sensitivity
    assert request is not None
    found: list[SensitivityResult] = []
    drive(context, position, _search(context, request, found), 2**62)
    return Outcome(found[0])


def _search(context: Context, request: Sensitivity, found: list[SensitivityResult]) -> Generator[Floats, Batch, str]:
    problem, seed, confidence = context.problem, context.campaign.seed, context.campaign.confidence
    through = yield from curves(problem, problem.nominal_point, request.points)
    effects = fractions = None
    if request.morris is not None:
        random = stream(seed, MORRIS_STREAM)
        effects = yield from morris(problem, request.morris, random, confidence)
    if request.sobol is not None:
        random = stream(seed, SOBOL_STREAM)
        fractions = yield from sobol(problem, request.sobol, random, confidence)
    found.append(SensitivityResult(points=request.points, curves=through, morris=effects, sobol=fractions))
    return ends.CURVES


def morris(
    problem: Problem, request: Morris, random: np.random.Generator, confidence: float
) -> Generator[Floats, Batch, MorrisStudy]:
    """mu, mu* and sigma of each parameter's effect, per whole range, in the criterion's unit."""
    from SALib.analyze import morris as analysis
    from SALib.sample import morris as sampling

    box = _box(problem)
    points = np.asarray(sampling.sample(box, request.trajectories, num_levels=request.levels, seed=random))
    batch = yield points
    empty = MorrisStudy(
        **_counts(batch, confidence), trajectories=request.trajectories, levels=request.levels, indices=None
    )
    if reason := _unusable(batch):
        return empty.model_copy(update={"statement": reason})
    values = batch.costs[:, 0]
    found = analysis.analyze(
        box, points, values, conf_level=confidence, num_levels=request.levels, seed=int(random.integers(2**31))
    )
    columns = {"mu": "mu", "mu_star": "mu_star", "mu_star_confidence": "mu_star_conf", "sigma": "sigma"}
    rows = [MorrisRow(path=path, **values) for path, values in _rows(problem, found, columns)]
    statement = sentences.effects(_leading(problem, {row.path: row.mu_star for row in rows}))
    return empty.model_copy(update={"indices": rows, "statement": statement})


def sobol(
    problem: Problem, request: SobolIndices, random: np.random.Generator, confidence: float
) -> Generator[Floats, Batch, SobolStudy]:
    """First-order and total fractions of the variance, under the distributions, with the half width of their interval.

    The indices split a variance among independent parameters: correlations are ignored.
    """
    from SALib.analyze import sobol as analysis
    from SALib.sample import sobol as sampling

    box = _box(problem)
    uniform = np.asarray(sampling.sample(box, request.samples, calc_second_order=False, seed=random))
    batch = yield problem.distributions.marginals(uniform)
    empty = SobolStudy(**_counts(batch, confidence), samples=request.samples, indices=None)
    if reason := _unusable(batch):
        return empty.model_copy(update={"statement": reason})
    _, exponent = np.frexp(np.abs(batch.costs[:, 0]).max())
    values = np.ldexp(batch.costs[:, 0], -exponent)  # the indices are of no unit, and squares must be finite
    if reason := _no_variance(values, box["num_vars"]):
        return empty.model_copy(update={"statement": reason})
    found = analysis.analyze(
        box, values, calc_second_order=False, conf_level=confidence, seed=int(random.integers(2**31))
    )
    _without_few(found, values)
    columns = {"first": "S1", "first_confidence": "S1_conf", "total": "ST", "total_confidence": "ST_conf"}
    rows = [SobolRow(path=path, **values) for path, values in _rows(problem, found, columns)]
    leading = _leading(problem, {row.path: row.total for row in rows})
    statement = sentences.totals(leading, bool(problem.distributions.mixed))
    return empty.model_copy(update={"indices": rows, "statement": statement})


class _Box(TypedDict):
    num_vars: int
    names: list[str]
    bounds: list[list[float]]


def _box(problem: Problem) -> _Box:
    """The unit cube as SALib's problem definition."""
    names = [r.path for r in problem.ranges]
    return {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}


class _Counts(TypedDict):
    evaluations: int
    failed: int
    excluded: int
    confidence: float


def _counts(batch: Batch, confidence: float) -> _Counts:
    excluded = int(np.count_nonzero(batch.status == EXCLUDED))
    failed = int(np.count_nonzero(batch.status != OK)) - excluded
    return {"evaluations": len(batch.status), "failed": failed, "excluded": excluded, "confidence": confidence}


def _unusable(batch: Batch) -> Spans | None:
    """Why no index is computed; None if the design has every value."""
    missing = int(np.count_nonzero(batch.status != OK))
    return sentences.no_index(missing, len(batch.status)) if missing else None


def _no_variance(values: Floats, parameters: int) -> Spans | None:
    """Why there is no variance to split; None if there is. Its estimate has the values of the base sample alone."""
    if _constant(values):
        return sentences.NO_VARIANCE
    first, *_, second = _designs(values, parameters)
    base = np.concatenate([first, second])
    lost = _constant(base) or base.var() <= np.finfo(float).eps * values.var()
    few = lost or _alike(np.square(base - base.mean())) < FEW
    return sentences.few_decide(FEW, len(base)) if few else None


def _designs(values: Floats, parameters: int) -> Floats:
    """The values of Saltelli's designs: the first sample, those with one parameter of the second, and the second."""
    return values.reshape(-1, parameters + 2).T


def _alike(parts: Floats) -> float:
    """Of so many equal parts the sum of the squares would be the same."""
    total = np.abs(parts).sum()
    return float(1 / np.square(parts / total).sum()) if total else 0.0


def _without_few(found: Any, values: Floats) -> None:
    """Remove the intervals of indices that few evaluations decide: Saltelli et al. (2010), equations (b) and (f)."""
    first, *mixed, base = _designs(values, len(found["ST"]))
    for k, one in enumerate(mixed):
        for name, parts in ("S1_conf", (base - values.mean()) * (one - first)), ("ST_conf", np.square(first - one)):
            if _alike(parts) < FEW:
                found[name][k] = np.nan


def _constant(values: Floats) -> bool:
    return bool(np.ptp(values) <= 1e-12 * np.abs(values).max())


def _rows(problem: Problem, found: Any, columns: dict[str, str]) -> list[tuple[str, dict[str, float | None]]]:
    """The rows of a study, one per parameter; a non-finite value is None."""
    rows = []
    for k, r in enumerate(problem.ranges):
        values = {name: float(found[key][k]) for name, key in columns.items()}
        rows.append((r.path, {name: v if np.isfinite(v) else None for name, v in values.items()}))
    return rows


def _leading(problem: Problem, values: dict[str, float | None]) -> list[tuple[Part, float]]:
    ordered = sorted(values.items(), key=lambda item: -(item[1] or 0.0))
    return [(problem.symbols[path], value or 0.0) for path, value in ordered[:3]]


stage = Stage("sensitivity", run)
