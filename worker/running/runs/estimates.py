"""The search of an estimate repeated over its stored evaluations: its requests follow from seed, starts and results.

Nothing is evaluated. Each request must be the next stored points; then density, origins of modes and the alarms of the
search follow, too, which `worker.evidence.audit.estimate` compares.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from campaigns.results.base import EXCLUDED, OK
from campaigns.results.estimate import ImportanceDensity
from worker.engine.problem.distributions import Distributions
from worker.engine.rare import earlier, starts
from worker.engine.rare.estimate import Estimate, Refused, estimated, without_far
from worker.engine.search.base import Batch
from worker.engine.stages.estimate import STREAM, density
from worker.evidence.audit import draw, limits
from worker.evidence.audit.estimate import Drawn, Searched
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
    known = _starts(run, k, own)
    made, requests = _answered(run, k, own, known) if len(known.first) else (Refused("no_violation"), [])
    if made is None or (not len(known.first) and (run.stage == k).any()):
        return None
    if isinstance(made, Refused):
        why = "too_far" if without_far(made, known.moved) != made else made.why
        nothing = ImportanceDensity(designs=[], centres=[], covariances=[], shares=[])
        return Searched(nothing, [], {}, refused=(why, made.limit))
    of_modes = [[known.origins[one] for one in mode.origins or ()] for mode in made.modes]
    found: dict[str, float] = {alarm.why: alarm.value for alarm in made.alarms if alarm.why in OF_SEARCH}
    drawn = Drawn(*made.sampled, made.drawn, np.concatenate(requests)[-made.drawn :])
    return Searched(density(made.mixture), of_modes, found, drawn)


def _answered(run: Run, k: int, own: Distributions, known: _Starts) -> tuple[Estimate | Refused | None, list[Any]]:
    """The result of the search that receives the stored evaluations, and its requests in standard normal space."""
    here = run.stage == k
    points, costs, status = run.points[here], run.every[here], run.status[here]

    def cube(normal: Any) -> Any:
        from scipy import special

        return own.quantile(special.ndtr(normal), redrawn=False)

    seed = np.random.SeedSequence(int(run.claims["results"][k]["seed"]), spawn_key=(STREAM,))
    searching = estimated(
        known.first,
        run.threshold,
        run.plan[k].planned,
        np.random.default_rng(seed),
        run.campaign.confidence,
        lambda normal: ~own.beyond(cube(normal)),
        known.stored,
    )
    done, batch, requests = 0, None, list[Any]()
    try:
        while True:
            request = next(searching) if batch is None else searching.send(batch)
            requests.append(request)
            rows = slice(done, done + len(request))
            done += len(request)
            if done > len(points) or np.abs(points[rows] - cube(request)).max() > NEAR:
                return None, requests
            batch = Batch(costs[rows], status[rows])
    except StopIteration as end:
        return end.value if done == len(points) else None, requests


class _Starts(NamedTuple):
    """What the search begins with: starts (k, n) and all stored violations in standard normal space, which starts are
    farther in a tail than these, and where the starts and after them all others are stored."""

    first: Any
    stored: Any
    moved: Any
    origins: Origins


def _starts(run: Run, k: int, own: Distributions) -> _Starts:
    """The violations of the stages before, as the stage chooses among them by the rules of its version."""
    ok = run.status == OK
    low = np.where(ok, run.raw, np.inf)
    rows = np.flatnonzero((run.stage < k) & ((low <= run.threshold) | (~ok & (run.status != EXCLUDED))))
    rows = rows[np.argsort(run.stage[rows], kind="stable")]
    uniform, budget = own.uniform(run.points[rows]), run.plan[k].planned
    begins = {at: int(np.argmax(run.stage == at)) for at in set(run.stage[rows].tolist())}
    of = [{"position": int(run.stage[row]), "index": row - begins[int(run.stage[row])]} for row in rows.tolist()]
    if run.wording < limits.WIDER:
        first = earlier.chosen(run.points[rows], low[rows], budget)
        normal, stored = earlier.normal(uniform), None
    else:
        sampled = np.isin(run.stage[rows], run.certifying)
        stored = normal = starts.normal(uniform)
        first = starts.chosen(starts.Stored(run.points[rows], low[rows], normal, sampled), budget)
    moved = starts.moved(uniform[first]) & (run.wording >= limits.WIDER)
    return _Starts(normal[first], stored, moved, [of[row] for row in (*first, *range(len(of)))])
