"""Search: one method looks for the lowest cost within its budget.

For a random method the result holds the statement its sample allows: Clopper and Pearson, The use of confidence or
fiducial limits (Biometrika 26, 1934), one-sided. Start reading at `run`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import TypeAdapter
from scipy import stats

from campaigns.stages import Search as Asked
from worker.catalog import methods
from worker.search.base import EXCLUDED, OK, Floats, Method, Minimum, Space
from worker.stages.base import Context, Driven, drive
from worker.store import Columns
from worker.wording import count


def run(context: Context, position: int, index: int) -> dict[str, Any]:
    """Run search stage number `index` of the campaign, stored at `position`."""
    asked = context.campaign.stages.search[index]
    method = methods()[asked.method]
    minima: list[Minimum] = []
    space = Space(
        dimension=context.problem.dimension,
        budget=asked.evaluations,
        random=stream(context.campaign.seed, index),
        starts=_starts(context, asked),
        quantile=context.problem.quantile,
        report=minima.append,
    )
    options: Any = TypeAdapter(method.options).validate_python(asked.options)
    driven = drive(context, position, method.search(space, options), asked.evaluations, method.repeats)
    minima.sort(key=lambda m: _place(m, space.starts))
    return _result(context, method, driven, minima)


def stream(seed: int, index: int) -> np.random.Generator:
    """The random numbers of search stage `index`: independent of every other stage and of who flies it."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(index,)))


def bound(violations: int, samples: int, confidence: float) -> float:
    """Upper Clopper-Pearson bound on a probability of which `violations` of `samples` were seen."""
    if samples == 0 or violations >= samples:
        return 1.0
    return float(stats.beta.ppf(confidence, violations + 1, samples - violations))


def _starts(context: Context, asked: Asked) -> Floats:
    points = [context.problem.point(start) for start in asked.starts]
    return np.clip(np.array(points), 0.0, 1.0) if points else np.empty((0, context.problem.dimension))


def _place(minimum: Minimum, starts: Floats) -> int:
    """Minima are told in the order of the campaign's starts, not in the order in which the descents happened to end."""
    same = [i for i, start in enumerate(starts) if minimum.start is not None and np.array_equal(start, minimum.start)]
    return same[0] if same else len(starts)


def _result(context: Context, method: Method, driven: Driven, minima: list[Minimum]) -> dict[str, Any]:
    problem, tally = context.problem, driven.tally
    best = None
    if tally.best is not None and tally.best_point is not None:
        best = {
            "cost": tally.best,
            "margin": tally.best - problem.threshold,
            "parameters": problem.named(tally.best_point),
            "index": tally.best_index,
        }
    return {
        "method": method.name,
        "title": method.title,
        "kind": method.kind,
        "best": best,
        "evaluations": tally.evaluations,
        "failed": tally.failed,
        "excluded": tally.excluded,
        "seconds": tally.seconds,
        "stop": {"kind": driven.stop, "text": driven.text},
        "minima": [
            {
                "start": None if m.start is None else problem.named(m.start),
                "parameters": problem.named(m.point),
                "point": m.point.tolist(),
                "cost": m.cost,
                "evaluations": m.evaluations,
                "text": m.text,
            }
            for m in minima
        ],
        "sample": _sample(context, driven.columns) if method.kind == "random" and driven.columns else None,
    }


def _sample(context: Context, columns: Columns) -> dict[str, Any]:
    """What the sample says. A failed flight counts as a violation: nobody knows how it would have ended."""
    drawn = columns.status != EXCLUDED
    costs = columns.costs[columns.status == OK, 0]
    samples = int(np.count_nonzero(drawn))
    failed = samples - len(costs)
    violations = int(np.count_nonzero(costs <= context.problem.threshold)) + failed
    confidence = context.campaign.confidence
    upper = bound(violations, samples, confidence)
    counts, edges = np.histogram(costs, bins=min(40, max(5, int(np.sqrt(len(costs))))))
    return {
        "samples": samples,
        "violations": violations,
        "failed": failed,
        "confidence": confidence,
        "upper_bound": upper,
        "lowest": float(costs.min()) if len(costs) else None,
        "mean": float(costs.mean()) if len(costs) else None,
        "deviation": float(costs.std(ddof=1)) if len(costs) > 1 else None,
        "histogram": {"edges": edges.tolist(), "counts": counts.tolist()},
        "text": f"{count(violations)} of {count(samples)} flights drawn from the stated distributions violate "
        f"the criterion: P(violation) is at most {100 * upper:.3g} % with {100 * confidence:g} % confidence",
    }
