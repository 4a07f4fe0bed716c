"""Evaluates stored evaluations of a run again, from its record alone, and compares the costs.

An evaluation depends only on its point and its noise seed, so on a machine of the same kind the costs have the same
bits; on another kind, where the compiler uses other instructions, they agree within `ELSEWHERE`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from campaigns import Campaign
from campaigns.claims.numbers import count
from campaigns.results import Finding
from campaigns.results.base import OK
from campaigns.results.draws import of_draws
from campaigns.results.measured import Measured
from campaigns.results.stage import StageResult
from campaigns.stages.found import declared
from campaigns.stored.records import Columns, StagePlan
from campaigns.versions import Versions
from worker.engine.problem.problem import Problem
from worker.engine.systems.base import Floats, in_own_sign, slotted

ELSEWHERE = 1e-9
"""The largest difference on a machine of another kind, relative to the cost and at least to 1."""

Agreement = Literal["same bits", "within 1e-9", "differs"]


class UnknownCase(LookupError):
    """The run has no such finding or evaluation; the message lists what it has."""


@dataclass(frozen=True)
class Recorded:
    """What a replay needs of a stored run; drawn: the number of the first evaluations of each stage, by position, that
    drew their own noise seed; measured: whether its simulator repeated."""

    campaign: Campaign
    sample_seed: int
    plans: Sequence[StagePlan]
    evaluations: Mapping[int, Columns]
    findings: Sequence[Finding]
    versions: Versions
    modules: Mapping[str, str] = field(default_factory=dict)
    drawn: Mapping[int, int] = field(default_factory=dict)
    measured: Measured | None = None
    seeds: Mapping[int, Sequence[int]] = field(default_factory=dict)
    """Of the first evaluations of a stage, by position, that have their own."""
    results: Mapping[int, StageResult | None] = field(default_factory=dict)
    """Of the stages, by position."""


@dataclass(frozen=True)
class Case:
    """One stored evaluation. vector (size,): all parameters; costs (k,): as stored, NaN unless the status is ok; of a
    finding only the deciding one, (1,). single: one call of a simulator, however many an evaluation usually has."""

    name: str
    vector: Floats
    costs: Floats
    status: int
    seed: int | None = None
    single: bool = False


@dataclass(frozen=True)
class Replayed:
    """A case and its evaluation now; reason: why it has no cost now."""

    case: Case
    costs: Floats
    status: int
    reason: str

    @property
    def agreement(self) -> Agreement:
        """How well stored and new cost agree; two evaluations without a cost agree if they have the same status."""
        if self.status != self.case.status:
            return "differs"
        if self.status != OK or self.costs.tobytes() == self.case.costs.tobytes():
            return "same bits"
        scale = np.maximum(np.abs(self.case.costs), 1.0)
        return "within 1e-9" if bool((np.abs(self.costs - self.case.costs) <= ELSEWHERE * scale).all()) else "differs"


def agrees(agreement: Agreement, alike: bool) -> bool:
    """Whether something agrees as it must on a machine of the same kind (alike), or of another."""
    return agreement == "same bits" or (agreement == "within 1e-9" and not alike)


def other_machine(then: Versions, now: Versions) -> list[str]:
    """The differences for which other bits are expected although the code is the same, as clauses."""
    pairs = [("the system", then.system, now.system), ("the step [s]", then.step, now.step)]
    pairs += [("the number of simulations in lockstep", then.lanes, now.lanes)]
    if then.cpu and now.cpu:
        pairs += [("the processor", then.cpu.target, now.cpu.target)]
        if then.cpu.target == now.cpu.target and then.cpu.features != now.cpu.features:
            return [*_different(pairs), "the processor has other features"]
    return [*_different(pairs), *([] if then.cpu else ["the processor of the run is not known"])]


def _different(pairs: Sequence[tuple[str, object, object]]) -> list[str]:
    return [f"{what} was {a}, here it is {b}" for what, a, b in pairs if a and b and a != b]


def cases(recorded: Recorded, problem: Problem, names: Sequence[str]) -> list[Case]:
    """The cases of these names: F1 for a finding, STAGE:INDEX for an evaluation; without names, all findings.

    STAGE is a position in the plan, or a method or kind of stage that occurs once. Raises `UnknownCase`.
    """
    if not names and not recorded.findings:
        raise UnknownCase(f"it has no finding; name an evaluation: {_stages(recorded)}")
    return [_case(recorded, problem, name) for name in names or [f.label for f in recorded.findings]]


def replayed(problem: Problem, chosen: Sequence[Case]) -> list[Replayed]:
    """Evaluate each case again, alone, from nothing but its own record."""
    single = slotted(problem.system).single() if any(case.single for case in chosen) else problem.system
    found = []
    for case in chosen:
        system = single if case.single else problem.system
        seeds = None if case.seed is None else np.array([case.seed], dtype=np.int64)
        batch, reasons = system.evaluate(case.vector[None, :], seeds)
        costs = np.asarray(batch.costs[0][: len(case.costs)], dtype=np.float64)
        found.append(Replayed(case, costs, int(batch.status[0]), reasons.get(0, "")))
    return found


def _case(recorded: Recorded, problem: Problem, name: str) -> Case:
    for finding in recorded.findings:
        if finding.label == name:
            vector = problem.vector(finding.parameters)
            return Case(name, vector, np.array([finding.cost]), OK, finding.realisation)
    place = re.fullmatch(r"([A-Za-z_0-9]+):([0-9]{1,12})", name)
    if place is None:
        labels = ", ".join(f.label for f in recorded.findings) or "none"
        raise UnknownCase(f"{name!r} is no finding of it (it has {labels}) and no evaluation: {_stages(recorded)}")
    position, index = _position(recorded, place[1]), int(place[2])
    columns = recorded.evaluations.get(position)
    stored = 0 if columns is None else len(columns.status)
    if columns is None or index >= stored:
        raise UnknownCase(f"stage {place[1]} has {count(stored)} evaluations, counted from 0; there is no {index}")
    plan, draws = recorded.plans[position], recorded.drawn.get(position, 0)
    seed = int(of_draws(recorded.sample_seed, index, 1)[0]) if index < draws else None
    own = recorded.seeds.get(position, ())
    seed = own[index] if index < len(own) else seed
    vector = problem.vectors(columns.points[index : index + 1])[0]
    status, costs = int(columns.status[index]), np.array(columns.costs[index], dtype=np.float64)
    name = f"evaluation {index} of {plan.method or plan.kind}"
    return Case(name, vector, costs, status, seed, declared()[plan.kind].independent)


def _position(recorded: Recorded, stage: str) -> int:
    if stage.isdigit() and int(stage) < len(recorded.plans):
        return int(stage)
    found = [at for at, plan in enumerate(recorded.plans) if stage in (plan.method, plan.kind)]
    if len(found) == 1:
        return found[0]
    why = "names several stages" if found else "is no stage of it"
    raise UnknownCase(f"{stage} {why}: {_stages(recorded)}")


def _stages(recorded: Recorded) -> str:
    listed = [
        f"{at}:INDEX for {plan.kind}{f' ({plan.method})' if plan.method else ''}"
        for at, plan in enumerate(recorded.plans)
        if at in recorded.evaluations
    ]
    return "; ".join(listed) or "it has no stored evaluations"


def values(found: Replayed, problem: Problem) -> tuple[list[float] | None, list[float] | None]:
    """The criteria's values in their own sign, stored and now; None where there is no cost."""
    results = problem.results[: len(found.costs)]
    pairs = ((found.case.status, found.case.costs), (found.status, found.costs))
    then, now = (in_own_sign(results, costs[None, :])[0].tolist() if status == OK else None for status, costs in pairs)
    return then, now
