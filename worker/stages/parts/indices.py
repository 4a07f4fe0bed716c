"""Sensitivity indices over the whole box: Morris' elementary effects and Sobol's shares of the variance, by SALib.

Morris, Factorial sampling plans for preliminary computational experiments (Technometrics 33, 1991), with mu* of
Campolongo et al. (2007); Saltelli et al., Variance based sensitivity analysis of model output (Computer Physics
Communications 181, 2010). Start reading at `morris` and `sobol`; each asks for one batch and returns what it says.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from campaigns.asked.stages import Morris, SobolIndices
from campaigns.wording import count, listed
from worker.search.base import EXCLUDED, OK, Batch
from worker.stages.parts.slices import Asking
from worker.systems.problem import Problem

MORRIS_STREAM, SOBOL_STREAM = 2**22, 2**22 + 1
"""Of random numbers; searches have those from 0 on."""


def morris(problem: Problem, asked: Morris, random: np.random.Generator, confidence: float) -> Asking:
    """mu, mu* and sigma of each parameter's effect, per whole range, in the criterion's unit."""
    from SALib.analyze import morris as analysis
    from SALib.sample import morris as sampling

    box = _box(problem)
    points = np.asarray(sampling.sample(box, asked.trajectories, num_levels=asked.levels, seed=random))
    batch = yield points
    told = {"trajectories": asked.trajectories, "levels": asked.levels} | _flown(batch, confidence)
    reason = _unusable(batch)
    if reason is not None:
        return told | {"indices": None, "text": reason}
    values = batch.costs[:, 0]
    found = analysis.analyze(
        box, points, values, conf_level=confidence, num_levels=asked.levels, seed=int(random.integers(2**31))
    )
    columns = {"mu": "mu", "mu_star": "mu_star", "mu_star_confidence": "mu_star_conf", "sigma": "sigma"}
    rows = _rows(problem, found, columns)
    return told | {"indices": rows, "text": f"largest effects: {_leading(rows, 'mu_star')}"}


def sobol(problem: Problem, asked: SobolIndices, random: np.random.Generator, confidence: float) -> Asking:
    """First-order and total shares of the variance, under the distributions, with the half width of their interval.

    The indices split a variance among independent parameters: correlations are left out.
    """
    from SALib.analyze import sobol as analysis
    from SALib.sample import sobol as sampling

    box = _box(problem)
    uniform = np.asarray(sampling.sample(box, asked.samples, calc_second_order=False, seed=random))
    batch = yield problem.distributions.marginals(uniform)
    told = {"samples": asked.samples} | _flown(batch, confidence)
    values = batch.costs[:, 0]
    reason = _unusable(batch)
    if reason is None and np.ptp(values) <= 1e-12 * max(1.0, float(np.abs(values).max())):
        reason = "not computed: the value is the same for all flights, there is no variance to share"
    if reason is not None:
        return told | {"indices": None, "text": reason}
    found = analysis.analyze(
        box, values, calc_second_order=False, conf_level=confidence, seed=int(random.integers(2**31))
    )
    columns = {"first": "S1", "first_confidence": "S1_conf", "total": "ST", "total_confidence": "ST_conf"}
    rows = _rows(problem, found, columns)
    apart = "; correlations are left out" if problem.distributions.mixed else ""
    return told | {"indices": rows, "text": f"largest total shares: {_leading(rows, 'total')}{apart}"}


def _box(problem: Problem) -> dict[str, Any]:
    """The unit cube, as SALib wants it."""
    names = [r.path for r in problem.ranges]
    return {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}


def _flown(batch: Batch, confidence: float) -> dict[str, Any]:
    excluded = int(np.count_nonzero(batch.status == EXCLUDED))
    failed = int(np.count_nonzero(batch.status != OK)) - excluded
    return {"evaluations": len(batch.status), "failed": failed, "excluded": excluded, "confidence": confidence}


def _unusable(batch: Batch) -> str | None:
    """Why no index is computed: the designs need the value of every flight, and none is made up."""
    missing = int(np.count_nonzero(batch.status != OK))
    if not missing:
        return None
    return (
        f"not computed: {count(missing)} of {count(len(batch.status))} flights failed or were excluded, and the design "
        "needs the value of every one; narrow the bounds to where all can be flown"
    )


def _rows(problem: Problem, found: Any, columns: dict[str, str]) -> list[dict[str, Any]]:
    """One row per parameter; what is no number is None."""
    rows = []
    for k, r in enumerate(problem.ranges):
        values = {name: float(found[key][k]) for name, key in columns.items()}
        rows.append({"path": r.path} | {name: v if np.isfinite(v) else None for name, v in values.items()})
    return rows


def _leading(rows: list[dict[str, Any]], column: str) -> str:
    ordered = sorted(rows, key=lambda row: -(row[column] or 0.0))
    return listed([f"{row['path']} {row[column] or 0.0:.3g}" for row in ordered[:3]])
