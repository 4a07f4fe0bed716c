"""CEC 2013 niching: how many of the global optima are among the findings of a whole run.

A run is that of `clearance.search` with one method: half of the evaluations that the competition permits go to the
search and at most the other half to distinguishing its findings. The nominal case is the median of a few random points:
the middle of the box, which is usual, is an optimum of some functions. Two minima count as one within the radius that
the competition states, if that is less than usual. The reported points are the findings as low as the worst case within
1 % of nominal less worst, and within the loosest accuracy of the competition, which its entrants know.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from annotated_types import Le

from campaigns.asked.stages import Findings
from campaigns.limits import DISTANCE, SAME_COST
from clearance.function.request import document_of, request_of
from clearance.function.running import run
from clearance.function.searches import searches, stages
from tests.bench.scoreboard.cells import Cell, Row
from tests.bench.scoreboard.parts import Part, Request, Table, averaged
from tests.bench.scoreboard.reaching import seeds
from tests.given.niching import ACCURACIES, PROBLEMS
from worker.engine.search.base import Floats

BELOW = -1.0
"""The threshold: below every cost, so that nothing is spent on the boundary of a violation."""
MEDIAN_OF = 65
SEEDS = 3
"""Of each problem at most: a run takes up to 400,000 evaluations."""
METHODS = ("auto", "portfolio", "contrast_racing")
"""Those that search several valleys at once; a run of one takes up to minutes."""


def _cells(request: Request) -> list[Cell]:
    ours = [method for method in request.methods if method in METHODS]
    return [
        Cell("niching", request.half, method, name, problem.dimension, seed)
        for name, problem in PROBLEMS.items()
        for method in ours
        for seed in seeds(request)[:SEEDS]
    ]


def measure(cell: Cell, evaluations: int | None = None) -> dict[str, Any]:
    """Peak ratio and F1 at every accuracy of the competition."""
    problem = PROBLEMS[cell.problem]
    permitted = problem.evaluations if evaluations is None else evaluations
    points, costs, used = reported(cell, permitted)
    rows = []
    for accuracy in ACCURACIES:
        found = problem.found(points, accuracy)
        recall, precision = found / problem.optima, found / max(len(points), 1)
        rows.append((float(recall), float(2 * recall * precision / (recall + precision)) if found else 0.0))
    return {
        "peak ratio": [recall for recall, _ in rows],
        "F1": [f1 for _, f1 in rows],
        "reported": len(points),
        "lowest": float(costs.min()) if len(costs) else None,
        "evaluations": used,
    }


def reported(cell: Cell, permitted: int) -> tuple[Floats, Floats, int]:
    """The findings as low as the worst, as points (k, n), their costs, and the evaluations that were stored."""
    problem = PROBLEMS[cell.problem]
    names = [f"x{i}" for i in range(problem.dimension)]

    def cost(**values: Floats) -> Floats:
        return problem(np.stack([np.asarray(values[name]) for name in names], axis=1))

    drawn = np.random.default_rng(cell.number).random((MEDIAN_OF, problem.dimension))
    nominal = drawn[np.argsort(problem(drawn))[MEDIAN_OF // 2]]
    request = request_of(
        cost, dict.fromkeys(names, (0.0, 1.0)), dict(zip(names, map(float, nominal), strict=True)), True, "", "", "", ()
    )
    half = permitted // 2
    asked = dict(stages(searches([cell.method], half, None, None, request.ranges), 0, half))
    most = next(limit.le for limit in Findings.model_fields["at_most"].metadata if isinstance(limit, Le))
    radius = problem.radius / float((problem.high - problem.low).max())
    asked["findings"] = {"at_most": most, "distance": min(DISTANCE, radius)}
    result = run(request, document_of(request, BELOW, cell.problem, asked, cell.number), False, None, None)
    found = [f for f in result.findings if np.isfinite(f.cost)]
    points = np.array([[f.parameters[name] for name in names] for f in found]).reshape(-1, len(names))
    costs = np.array([f.cost for f in found])
    fall = float(problem(nominal[None, :])[0]) - costs.min(initial=np.inf)
    same = costs <= costs.min(initial=np.inf) + min(SAME_COST * max(fall, 0.0), max(ACCURACIES))
    return points[same], costs[same], len(result.costs)


def _table(rows: Sequence[Row]) -> Table:
    def figures(row: Row) -> dict[str, float]:
        ratio, f1 = (float(np.mean(row.figures[name])) for name in ("peak ratio", "F1"))
        own = {f"{row.cell.problem}, peak ratio": ratio, f"{row.cell.problem}, F1": f1}
        return {"all, peak ratio": ratio, "all, F1": f1} | own

    return averaged(rows, figures)


PART = Part(
    "niching",
    "CEC 2013 niching",
    "Peak ratio and F1 of the findings of a whole run, averaged over five accuracies from 0.1 to 1e-5, 20 problems and "
    "the seeds (Li, Engelbrecht, Epitropakis 2013). Evaluations as the competition permits; the limit of findings is "
    "the largest that a campaign may have. Peers return one point, so none takes part.",
    _cells,
    measure,
    _table,
    shown="all",
    reach="runs",
)
