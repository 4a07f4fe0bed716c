"""The sentences of a verdict: what was found, and the scope it holds for. Start reading at `sentence`."""

from __future__ import annotations

from collections.abc import Sequence

from campaigns.results import SearchResult
from campaigns.results.finding import Validation
from campaigns.results.verdict import Check, Statistics, VerdictWord
from campaigns.wording import count, listed, number, signed
from worker.catalogue.installed import catalogue
from worker.stages.parts import distances
from worker.systems.problem import Problem
from worker.verdicts import encounter
from worker.verdicts.evidence import Evidence


def sentence(
    problem: Problem, evidence: Evidence, verdict: VerdictWord, checks: list[Check], statistics: Statistics | None
) -> str:
    """The verdict in words; every count is one of stored evaluations."""
    criterion, finding = problem.parts.criterion, evidence.finding
    quantity, unit = criterion.quantity, criterion.unit
    limit = f"{number(problem.threshold)} {unit}"
    if finding is None:
        return f"No flight could be evaluated: {checks[0].text}."
    worst = (
        f"The worst case found has {quantity} = {number(finding.cost)} {unit}, "
        f"a margin of {signed(finding.margin)} {unit}{_noise(finding.realisation)}."
    )
    how = f"{count(evidence.evaluations)} evaluations, searched by {_searched(evidence)}"
    chance, lost = _chance(statistics), _without_value(evidence)
    if evidence.violation is not None:
        told = evidence.violation
        shown = "It was validated, and found"
        if told is not finding:
            milder = f"{told.label}, which has {number(told.cost)} {unit}{_noise(told.realisation)}"
            shown = f"Validation did not confirm it, but {milder}; both were found"
        rest = f"{lost}{_apart(told.validation, unit)}{_counts(evidence)}{chance}"
        return f"{quantity} falls to or below {limit}. {worst} {shown} in {how}.{rest}"
    if verdict == "cleared":
        excluded = f" {count(evidence.excluded)} more were excluded." if evidence.excluded else ""
        stated = "".join(f" {text}" for text in encounter.stated(problem, checks))
        return (
            f"{quantity} stayed above {limit} in all {count(evidence.succeeded)} evaluations, searched by "
            f"{_searched(evidence)}.{excluded} {worst}{chance}{stated} A search can miss a worse case."
        )
    why = "; ".join(c.text for c in checks if not c.ok)
    return f"Nothing may be claimed: {why}. {worst} It comes from {how}.{lost}"


def scope(problem: Problem) -> str:
    """What the sentence holds for: components, conditions, bounds, horizon and step."""
    parts, scenario = problem.parts, problem.campaign.scenario
    entries = {f"{s.prefix}.{p.name}": p.unit for s in problem.loop.sections for p in s.parameters}
    bounds = ", ".join(
        f"{r.path} {number(r.low)} to {number(r.high)} {entries[r.path]}".rstrip() for r in problem.ranges
    )
    obstacles = len(parts.obstacles)
    return (
        f"Scope: {parts.vehicle.title}, {parts.controller.title}, {parts.avoider.title}, "
        f"{obstacles} {'obstacle' if obstacles == 1 else 'obstacles'}{_conditions(problem)}; {bounds}; "
        f"horizon {number(scenario.horizon)} s, step {number(scenario.step)} s{_measured(problem)}. "
        f"It holds for this model within these bounds; components of clearance {catalogue().version}."
    )


def _measured(problem: Problem) -> str:
    clause = distances.clause(problem)
    return f"; {clause}" if clause else ""


def _searched(evidence: Evidence) -> str:
    """Every method with what it evaluated itself."""
    spent: dict[str, int] = {}
    for search in evidence.searches:
        spent[search.title] = spent.get(search.title, 0) + search.evaluations
    return listed([f"{title} ({count(many)})" for title, many in spent.items()])


def _chance(statistics: Statistics | None) -> str:
    if statistics is None:
        return ""
    chance = f" {statistics.text}."
    if statistics.quantile is not None:
        said = statistics.quantile.text
        chance += f" {said[0].upper()}{said[1:]}."
    return chance


def _counts(evidence: Evidence) -> str:
    text = evidence.violations.text
    return f" {text[0].upper()}{text[1:]}."


def _without_value(evidence: Evidence) -> str:
    """How many evaluations failed or were excluded; empty where all have a value."""
    failed = f"{count(evidence.failed)} failed" if evidence.failed else ""
    excluded = f"{count(evidence.excluded)} {'was' if evidence.excluded == 1 else 'were'} excluded"
    parts = [part for part in (failed, excluded if evidence.excluded else "") if part]
    return f" Of these, {' and '.join(parts)}." if parts else ""


def _apart(case: Validation | None, unit: str) -> str:
    """The three values of a violation whose integrations are beyond tolerance apart; empty where they agree."""
    if case is None or case.agrees or case.agrees is None:
        return ""
    values = (case.cost, case.half_step.cost, case.integrator.cost)
    step, half, other = ("no value" if value is None else number(value) for value in values)
    return (
        f" Every integration of it violates, but they are beyond tolerance apart: {step} {unit} at the step, {half} "
        f"{unit} at half of it, {other} {unit} with {case.integrator.name}."
    )


def _noise(seed: int | None) -> str:
    return "" if seed is None else f", with the noise realisation of seed {seed}"


def _conditions(problem: Problem) -> str:
    """The environment and the faults in the loop, and which realisations of them the searches simulated."""
    parts, realised = problem.parts, problem.realisations
    titles = [e.title for e in parts.environment] + [f.fault.title for f in parts.faults]
    text = f", with {listed(titles)}" if titles else ""
    if not realised.random:
        return text
    seeds = listed([str(seed) for seed in realised.seeds])
    if realised.several:
        return f"{text}, {realised.combine} of {count(len(realised.seeds))} realisations (noise seeds {seeds})"
    return f"{text}, noise seed {seeds}"


def method_of(searches: Sequence[SearchResult]) -> str | None:
    """The method with the lowest best."""
    found = [(s.best.cost, i) for i, s in enumerate(searches) if s.best is not None]
    return searches[min(found)[1]].method if found else None
