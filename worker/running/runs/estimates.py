"""The search of an estimate repeated over its stored evaluations: its requests follow from seed, starts and results.

Nothing is evaluated. Each request must be the next stored points; then density, origins of modes and the alarms of the
search follow, too, which `worker.evidence.audit.estimate` compares.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from campaigns.results.base import EXCLUDED, OK
from campaigns.results.estimate import ImportanceDensity
from worker.engine.problem.distributions import Distributions
from worker.engine.rare import starts
from worker.engine.rare.estimate import Estimate, Refused, estimated
from worker.engine.search.base import Batch
from worker.engine.stages.estimate import STREAM, density
from worker.evidence.audit import draw
from worker.evidence.audit.estimate import Searched
from worker.evidence.audit.recompute import Run
from worker.evidence.audit.record import Record

NEAR = 1e-6
"""Fraction of a range by which a stored point may differ: bits of another machine, over all steps of the search."""
OF_SEARCH = ("unexplained", "unsaturated")
Origins = list[dict[str, int]]


def repeated(record: Record) -> dict[int, Searched | None]:
    """The repeated search of every estimate, by its stage; None if its stored points are not those requested."""
    if record.campaign.stages.estimate is None:
        return {}
    try:
        run = Run(record)
        run.describe()
        return {k: _repeated(run, k) for k, result in enumerate(run.claims["results"]) if "alarms" in (result or {})}
    except (TypeError, ValueError, KeyError, IndexError, AttributeError):
        return {}  # the record is not that of a run, which the audit states


def _repeated(run: Run, k: int) -> Searched | None:
    own = draw.distributed(run.campaign, run.bounds)
    first, origins = _starts(run, k)
    made = _answered(run, k, own, first) if len(first) else Refused("no_violation")
    if made is None or (not len(first) and (run.stage == k).any()):
        return None
    if isinstance(made, Refused):
        nothing = ImportanceDensity(designs=[], centres=[], covariances=[], shares=[])
        return Searched((made.why, made.limit), nothing, [], {})
    of_modes = [[origins[one] for one in mode.origins or ()] for mode in made.modes]
    found: dict[str, float] = {alarm.why: alarm.value for alarm in made.alarms if alarm.why in OF_SEARCH}
    return Searched(None, density(made.mixture), of_modes, found)


def _answered(run: Run, k: int, own: Distributions, first: Any) -> Estimate | Refused | None:
    """The result of the search that receives the stored evaluations."""
    here = run.stage == k
    points, costs, status = run.points[here], run.every[here], run.status[here]

    def cube(normal: Any) -> Any:
        from scipy import special

        return own.quantile(special.ndtr(normal), redrawn=False)

    seed = np.random.SeedSequence(int(run.claims["results"][k]["seed"]), spawn_key=(STREAM,))
    searching = estimated(
        starts.normal(own.uniform(first)),
        run.threshold,
        run.plan[k].planned,
        np.random.default_rng(seed),
        run.campaign.confidence,
        lambda normal: ~own.beyond(cube(normal)),
    )
    done, batch = 0, None
    try:
        while True:
            request = next(searching) if batch is None else searching.send(batch)
            rows = slice(done, done + len(request))
            done += len(request)
            if done > len(points) or np.abs(points[rows] - cube(request)).max() > NEAR:
                return None
            batch = Batch(costs[rows], status[rows])
    except StopIteration as end:
        return end.value if done == len(points) else None


def _starts(run: Run, k: int) -> tuple[Any, Origins]:
    """The violations of the stages before, as the stage chooses among them; where each is stored."""
    ok = run.status == OK
    low = np.where(ok, run.raw, np.inf)
    rows = np.flatnonzero((run.stage < k) & ((low <= run.threshold) | (~ok & (run.status != EXCLUDED))))
    rows = rows[np.argsort(run.stage[rows], kind="stable")]
    rows = rows[starts.chosen(run.points[rows], low[rows], run.plan[k].planned)]
    begins = [int(np.argmax(run.stage == run.stage[row])) for row in rows]
    origins = [{"position": int(run.stage[row]), "index": int(row) - at} for row, at in zip(rows, begins, strict=True)]
    return run.points[rows], origins
