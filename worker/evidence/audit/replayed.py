"""The search of an estimate repeated over its stored evaluations: its requests follow from seed, starts and results.

Nothing is evaluated. Each request must be the next stored points; then density, origins of modes and the alarms of the
search follow, too.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from campaigns.results.base import EXCLUDED, OK
from worker.engine.rare import starts
from worker.engine.rare.estimate import Estimate, Refused, estimated
from worker.engine.search.base import Batch
from worker.evidence.audit import draw
from worker.evidence.audit.recompute import Run

STREAM = 2**25
"""The random stream of the stage."""
NEAR = 1e-6
"""Fraction of a range by which a stored point may differ: bits of another machine, over all steps of the search."""


Replayed = tuple[Estimate | Refused | None, list[tuple[int, int]]]


def replayed(run: Run, k: int) -> Replayed:
    """The estimate, None if the stored points are not those requested; and where its starts are stored, in their order.

    The result is that of the engine of this installation: of a run of another one it may differ.
    """
    if k not in run.replayed:
        run.replayed[k] = _replayed(run, k)
    found: Replayed = run.replayed[k]
    return found


def _replayed(run: Run, k: int) -> Replayed:
    points, own = run.rows(k)[0], draw.distributed(run.campaign, run.bounds)
    costs, status = (of[run.stage == k] for of in (run.every, run.status))
    first, origins = _starts(run, k)
    if not len(first):
        return (None if len(points) else Refused("no_violation")), origins
    seed = np.random.SeedSequence(int(run.claims["results"][k]["seed"]), spawn_key=(STREAM,))

    def cube(normal: Any) -> Any:
        from scipy import special

        return own.quantile(special.ndtr(normal), redrawn=False)

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
                return None, origins
            batch = Batch(costs[rows], status[rows])
    except StopIteration as end:
        return (end.value if done == len(points) else None), origins


def _starts(run: Run, k: int) -> tuple[Any, list[tuple[int, int]]]:
    """The violations of the stages before, as the stage chooses among them."""
    ok = run.status == OK
    low = np.where(ok, run.raw, np.inf)
    rows = np.flatnonzero((run.stage < k) & ((low <= run.threshold) | (~ok & (run.status != EXCLUDED))))
    rows = rows[np.argsort(run.stage[rows], kind="stable")]
    rows = rows[starts.chosen(run.points[rows], low[rows], run.plan[k].planned)]
    begins = [int(np.argmax(run.stage == run.stage[row])) for row in rows]
    return run.points[rows], [(int(run.stage[row]), int(row) - at) for row, at in zip(rows, begins, strict=True)]
