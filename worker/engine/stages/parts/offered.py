"""Simulates stored violations and a random choice of the evaluations of all stages again.

Violations that are not findings are examined as well: up to `AT_MOST` of the violating evaluations are simulated at
half the step and with the reference integrator, and the counts are reported. `SPOT_CHECKS` random evaluations are
compared with the reference integrator, so that the difference is known for more than the findings.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from campaigns import limits, thin
from campaigns.asked.allowance import CASE
from campaigns.results.base import OK
from campaigns.results.finding import Validation
from campaigns.results.validate import Furthest, SpotChecks, StageCount, Violations
from worker.engine.stages.parts import noise, seeds
from worker.engine.stages.parts.base import all_columns, stream
from worker.engine.stages.parts.confirm import cases, reference
from worker.engine.stages.parts.context import Context
from worker.engine.stages.parts.left import Left
from worker.engine.stages.parts.repeated import Case
from worker.engine.systems.base import Floats

AT_MOST, SPOT_CHECKS = limits.VIOLATIONS, limits.SPOT_CHECKS
STREAM = 2**22
"""Spawn key of the choice of spot checks."""


@dataclass(frozen=True)
class Stored:
    """One stored evaluation that succeeded."""

    position: int
    index: int
    point: Floats
    cost: float
    seed: int | None

    @property
    def case(self) -> Case:
        return Case(f"stage {self.position}, evaluation {self.index}", self.point, self.cost, self.seed)


class _Stored:
    """All evaluations of some stages that have a cost (at or below a limit, if given), in columns."""

    def __init__(self, context: Context, positions: range, limit: float = np.inf) -> None:
        self.columns = dict(all_columns(context, [*positions]))
        self.seeds = {at: own for at, _, own in seeds.drawn(context, positions)}
        rows = {at: np.flatnonzero((c.status == OK) & (c.costs[:, 0] <= limit)) for at, c in self.columns.items()}
        self.position = np.concatenate([np.full(len(r), at) for at, r in rows.items()] or [np.empty(0, dtype=int)])
        self.index = np.concatenate([*rows.values()] or [np.empty(0, dtype=int)])
        self.cost = np.concatenate([self.columns[at].costs[r, 0] for at, r in rows.items()] or [np.empty(0)])

    def __len__(self) -> int:
        return len(self.index)

    def pick(self, rows: NDArray[np.int64]) -> list[Stored]:
        """The evaluations in these rows."""
        found = []
        for at, i in zip(self.position[rows].tolist(), self.index[rows].tolist(), strict=True):
            own, columns = self.seeds.get(at), self.columns[at]
            seed = int(own[i]) if own is not None and i < len(own) else None
            found.append(Stored(at, i, columns.points[i], float(columns.costs[i, 0]), seed))
        return found


def violations(context: Context, positions: range, left: Left) -> tuple[Violations, list[tuple[Stored, Validation]]]:
    """Simulate every stored violation, or an even choice by cost, again; the counts, and the confirmed ones.

    The lowest confirmed one comes first.
    """
    found = _Stored(context, positions, context.problem.threshold)
    lowest_first = np.argsort(found.cost, kind="stable")
    each = 1 if noise.noisy(context) else CASE
    most = left.violations(min(len(found), AT_MOST), each)
    chosen = found.pick(lowest_first[thin.even(len(found), most)])
    again = cases(context, [s.case for s in chosen], calls=1)
    confirmed = [(s, case) for s, case in zip(chosen, again, strict=True) if case.violates]
    stages, counts = np.unique(found.position, return_counts=True)
    described = Violations(
        stored=len(found),
        by_stage=[StageCount(position=int(at), count=int(n)) for at, n in zip(stages, counts, strict=True)],
        checked=len(chosen),
        confirmed=len(confirmed),
        statement=(),  # by worker.evidence.verdicts.validation
    )
    return described, confirmed


def spot_checks(context: Context, positions: range, left: Left) -> SpotChecks:
    """Random evaluations of all stages with the reference integrator: its differences from the stored values."""
    known = _Stored(context, positions)
    random = stream(context.campaign.seed, STREAM)
    most = left.spot_checks(min(len(known), SPOT_CHECKS))
    chosen = known.pick(np.sort(random.permutation(len(known))[:most]))
    flights = reference(context, [s.case for s in chosen])
    pairs = [(s, f.cost) for s, f in zip(chosen, flights, strict=True) if f.cost is not None]
    apart = np.array([abs(cost - s.cost) for s, cost in pairs])
    threshold = context.problem.threshold
    sides = [s for s, cost in pairs if cost <= threshold < s.cost]
    reasons = sorted({f.reason for f in flights if f.cost is None})
    largest = float(apart.max()) if len(apart) else None
    median = float(np.median(apart)) if len(apart) else None
    return SpotChecks(
        checked=len(chosen),
        compared=len(pairs),
        largest=largest,
        median=median,
        violating=len(sides),
        lowest_reference=min((cost for _, cost in pairs), default=None),
        at=_furthest(context, *pairs[int(apart.argmax())]) if len(apart) else None,
        reasons=reasons[:5],
        statement=(),  # by worker.evidence.verdicts.validation
    )


def _furthest(context: Context, stored: Stored, other: float) -> Furthest:
    return Furthest(
        position=stored.position,
        index=stored.index,
        cost=stored.cost,
        reference=other,
        parameters=context.problem.named(stored.point),
        realisation=stored.seed,
    )
