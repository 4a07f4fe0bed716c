"""Whether evaluations are where the campaign puts them: the nominal case, the samples, the grid, the baseline's cases,
and no point twice in a stage that never evaluates one twice."""

from __future__ import annotations

from collections import defaultdict
from typing import Any

import numpy as np

from campaigns import cube
from campaigns.claims.stages import sample as templates
from campaigns.results.base import OK
from campaigns.results.sample import GridPoint, GridResult
from worker.evidence.audit import attraction, counted, draw, estimate
from worker.evidence.audit.parts import OMIT, made
from worker.evidence.audit.recompute import Run, counts
from worker.evidence.audit.reevaluation import there


def required(run: Run) -> dict[str, tuple[object, object]]:
    """The numbers of points by what they must be, each stated as required and found: a pair."""
    pairs: dict[str, tuple[object, object] | None] = {"nominal": (1, _nominal(run))}
    for k in run.samples:
        pairs[f"stage {k}"] = _drawn(run, k)
    for k, planned in enumerate(run.plan):
        if planned.kind == "certify" and run.grid(k):
            pairs[f"grid of stage {k}"] = _grid(run, k)
        if k in run.counted:
            pairs[f"blocks of stage {k}"] = _blocks(run, k)
        if planned.kind == "baseline":
            pairs[f"stage {k}"] = _baseline(run, k)
        if planned.kind == "estimate":
            pairs |= estimate.placed(run, k)
        if planned.kind == "attraction":
            pairs |= attraction.placed(run, k)
        if planned.kind == "validate":
            points: Any = run.rows(k)[0]
            pairs[f"distinct in stage {k}"] = len(points), len({point.tobytes() for point in points})
    return {name: pair for name, pair in pairs.items() if pair is not None}


def _nominal(run: Run) -> int:
    at = cube.share(np.array([run.known[path][1] for path in run.bounds]), run.low, run.high)
    return int((run.rows(0)[0][:1] == at).all(axis=1).sum())


def _drawn(run: Run, k: int) -> tuple[int, int] | None:
    """None of a sample that gives no bound: its points are of another kind, or were extended."""
    certify = run.campaign.stages.certify if run.plan[k].kind == "certify" else None
    if k in run.counted:
        return _kept(run, k)
    draws = run.draws(k)
    points, _, status = (rows[:draws] for rows in run.rows(k))
    stated = (run.claims["results"][k] or {}).get("seed")
    seed = run.campaign.seed if stated is None else int(stated)
    if certify is not None:
        stream, blocks = draw.CERTIFY, draw.certified(certify.samples, status)
    elif run.samples[k].upper_bound is None:
        return None
    else:
        stream, early = run.searches.index(k), bool(run.options(k).get("interval"))
        blocks = draw.searched(run.plan[k].planned, draws, early)
    drawn = draw.redrawn(run.campaign, run.bounds, seed, stream, blocks)
    return draws, draw.agreeing(run.campaign, points, drawn)


def _kept(run: Run, k: int) -> tuple[int, int]:
    """The kept flights of a counted sample, each where its index puts it."""
    points, flights = run.rows(k)[0], run.claims["results"][k]["flights"]
    if len(flights) != len(points):
        return len(flights), 0
    drawn = counted.redrawn(run.campaign, run.bounds, int(run.claims["results"][k]["seed"]), flights)
    return len(points), draw.agreeing(run.campaign, points, drawn)


def _blocks(run: Run, k: int) -> tuple[int, int]:
    certify, flights = run.campaign.stages.certify, np.array(run.claims["results"][k]["flights"], dtype=np.int64)
    _, raw, status = run.rows(k)
    if certify is None or len(flights) != len(status):
        return len(run.counted[k].draws), 0
    return counted.fitting(run.counted[k], certify.samples, flights, raw, status, run.threshold)


def _grid(run: Run, k: int) -> tuple[int, int]:
    at, points = draw.gridded(run.grid(k), len(run.bounds)), run.rows(k)[0][run.draws(k) :]
    return len(at), int((points == at).all(axis=1).sum()) if len(points) == len(at) else 0


def _baseline(run: Run, k: int) -> tuple[int, int]:
    """Every evaluation of the stage at the values of all findings of the baseline that name it."""
    baseline, named = run.campaign.baseline, defaultdict(list)
    assert baseline is not None
    cases = {case.label: case for case in baseline.cases}
    for stated in run.claims["results"][k]["cases"]:
        named[stated["index"]].append(cases.get(stated["label"]))
    points = run.rows(k)[0]
    found = [
        row in named and all(case is not None and there(run, case, point) for case in named[row])
        for row, point in enumerate(points)
    ]
    return len(points), sum(found)


def grid(run: Run, k: int) -> GridResult:
    """What the grid of a certify stage shows."""
    points, raw, status = (rows[run.draws(k) :] for rows in run.rows(k))
    ok, (total, failed, excluded) = raw[status == OK], counts(status)
    each = run.grid(k)
    row = int(np.argmin(np.where(status == OK, raw, np.inf))) if len(ok) else None
    worst = None if row is None else float(raw[row])
    stated = None if worst is None else (run.quantity, worst, run.unit)
    violations = int(np.count_nonzero(ok <= run.threshold)) + failed
    lowest = None
    if worst is not None:
        lowest = made(GridPoint, cost=worst, margin=worst - run.threshold, parameters=run.values(points[row]))
    return made(
        GridResult, points=each, total=total,
        spacing={path: (high - low) / (each - 1) for path, (low, high) in run.bounds.items()}, lowest=lowest,
        violations=violations, failed=failed, excluded=excluded,
        statement=OMIT if run.reworded else templates.grid(each, total, stated, violations, failed),
    )  # fmt: skip
