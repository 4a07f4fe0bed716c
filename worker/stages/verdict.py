"""The verdict: what may be claimed from a run's stages, with the sentence that says why and the scope it holds for.

violated: a finding at or below the threshold that the validate stage confirmed. cleared: every check holds. Anything
else is inconclusive, with the reasons. No verdict rests on one method or on the statistical bound alone.
Start reading at `conclude`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

from campaigns import Campaign
from worker.catalog import catalogue
from worker.problem import Problem
from worker.store import Conclusion, Finding
from worker.wording import count, listed, number, signed

Verdict = Literal["cleared", "violated", "inconclusive"]


@dataclass(frozen=True)
class Check:
    """One condition of "cleared": its name, whether it holds, and the sentence that says so."""

    name: str
    ok: bool
    text: str


@dataclass(frozen=True)
class Evidence:
    """What the stages found: results by kind, the worst finding, and how many evaluations failed in any stage."""

    nominal: dict[str, Any]
    searches: list[dict[str, Any]]
    validation: dict[str, Any]
    finding: Finding | None
    evaluations: int
    failed: int
    excluded: int
    complete: bool = True
    certificate: dict[str, Any] | None = None
    others: Sequence[Finding] = ()
    """The findings that are not the worst."""

    @property
    def violation(self) -> Finding | None:
        """The worst finding that violates and was confirmed."""
        known = [f for f in (self.finding, *self.others) if f is not None and f.margin <= 0 and f.validation["ok"]]
        return min(known, key=lambda f: f.cost) if known else None


def conclude(problem: Problem, evidence: Evidence, provenance: dict[str, Any]) -> Conclusion:
    """The verdict over the evidence, and everything that stands behind it."""
    campaign, finding = problem.campaign, evidence.finding
    checks = _checks(problem, evidence)
    verdict = _verdict(checks, evidence)
    statistics = _statistics(evidence)
    sentence = _sentence(problem, evidence, verdict, checks, statistics)
    scope = _scope(problem)
    summary = {
        "verdict": verdict,
        "sentence": sentence,
        "scope": scope,
        "checks": [asdict(c) for c in checks],
        "statistics": statistics,
        "nominal": {"cost": evidence.nominal["cost"], "margin": evidence.nominal["margin"]},
        "worst": None
        if finding is None
        else {
            "cost": finding.cost,
            "margin": finding.margin,
            "parameters": finding.parameters,
            "method": _best_method(evidence.searches),
            "finding": finding.label,
        },
        "quantity": problem.parts.criterion.quantity,
        "unit": problem.parts.criterion.unit,
        "provenance": provenance | {"digest": campaign.digest, "seed": campaign.seed},
    }
    return Conclusion(
        verdict=verdict,
        reason=f"{sentence} {scope}",
        nominal_cost=evidence.nominal["cost"],
        worst_cost=None if finding is None else finding.cost,
        worst_method=_best_method(evidence.searches),
        summary=summary,
    )


def _verdict(checks: Sequence[Check], evidence: Evidence) -> Verdict:
    if evidence.violation is not None:
        return "violated"
    return "cleared" if all(c.ok for c in checks) else "inconclusive"


def _checks(problem: Problem, evidence: Evidence) -> list[Check]:
    found = [
        _nominal(problem, evidence),
        _ended(evidence),
        _no_violation(problem, evidence),
        _agreement(problem, evidence),
        _validated(evidence),
        _none_failed(evidence),
    ]
    target = _target(problem.campaign, evidence)
    return found if target is None else [*found, target]


def _nominal(problem: Problem, evidence: Evidence) -> Check:
    nominal, unit = evidence.nominal, problem.parts.criterion.unit
    if nominal["status"] != "ok":
        return Check("nominal", False, f"the nominal flight was not evaluated: {nominal['reason']}")
    ok = nominal["margin"] > 0
    return Check(
        "nominal",
        ok,
        f"the nominal flight has {number(nominal['cost'])} {unit}, margin {signed(nominal['margin'])} {unit}",
    )


def _ended(evidence: Evidence) -> Check:
    ways = ", ".join(f"{s['title']} {s['stop']['text']}" for s in evidence.searches)
    empty = [s["title"] for s in evidence.searches if s["best"] is None]
    if empty:
        return Check("search", False, f"{' and '.join(empty)} evaluated no flight successfully")
    ended = "every search ended" if evidence.complete else "not every search ended"
    return Check("search", evidence.complete, f"{ended}: {ways}")


def _no_violation(problem: Problem, evidence: Evidence) -> Check:
    finding, unit = evidence.finding, problem.parts.criterion.unit
    if finding is None:
        return Check("no violation", False, "no flight was evaluated")
    if finding.margin > 0:
        return Check("no violation", True, f"the worst flight found keeps a margin of {signed(finding.margin)} {unit}")
    confirmed = "confirmed" if finding.validation["ok"] else "did not confirm"
    return Check(
        "no violation",
        False,
        f"{finding.label} violates the criterion by {number(-finding.margin)} {unit}; validation {confirmed} it",
    )


def _agreement(problem: Problem, evidence: Evidence) -> Check:
    """Global methods against the worst known from anywhere, and at least two searches that reached it."""
    finding, nominal, unit = evidence.finding, evidence.nominal["cost"], problem.parts.criterion.unit
    titles = [s["title"] for s in evidence.searches if s["kind"] == "global"]
    if finding is None or nominal is None:
        return Check("agreement", False, "there is no worst case to agree on")
    if not titles:
        return Check("agreement", False, "no global method searched; add one, such as DIRECT")
    allowed = max(problem.campaign.agreement * (nominal - finding.cost), 1e-9 * max(abs(finding.cost), 1.0))
    aiming = [s for s in evidence.searches if s["kind"] in ("global", "local")]
    above = [float("inf") if s["best"] is None else s["best"]["cost"] - finding.cost for s in aiming]
    late = [
        f"{s['title']} " + (f"stopped {number(by)} {unit} above it" if s["best"] is not None else "found no flight")
        for s, by in zip(aiming, above, strict=True)
        if s["kind"] == "global" and by > allowed
    ]
    if late:
        return Check("agreement", False, f"the worst case is {number(finding.cost)} {unit}, but {' and '.join(late)}")
    reached = {s["method"]: s["title"] for s, by in zip(aiming, above, strict=True) if by <= allowed}
    if len(reached) < 2:
        (only,) = reached.values()
        return Check(
            "agreement", False, f"only {only} reached the worst case; a verdict needs a second method to confirm it"
        )
    spread = number(max(by for by in above if by <= allowed))
    return Check("agreement", True, f"{listed(list(reached.values()))} agree on the worst case within {spread} {unit}")


def _validated(evidence: Evidence) -> Check:
    return Check("validation", bool(evidence.validation["ok"]), evidence.validation["text"])


def _none_failed(evidence: Evidence) -> Check:
    if evidence.failed:
        return Check(
            "evaluations", False, f"{count(evidence.failed)} of {count(evidence.evaluations)} evaluations failed"
        )
    left_out = f", {count(evidence.excluded)} excluded" if evidence.excluded else ""
    return Check("evaluations", True, f"none of {count(evidence.evaluations)} evaluations failed{left_out}")


def _target(campaign: Campaign, evidence: Evidence) -> Check | None:
    if campaign.target_probability is None:
        return None
    goal = f"{100 * campaign.target_probability:.4g} %"
    statistics = _statistics(evidence)
    if statistics is None:
        return Check(
            "target", False, f"the target P(violation) of {goal} needs an independent sample; add a certify stage"
        )
    ok = statistics["upper_bound"] <= campaign.target_probability
    word = "meets" if ok else "does not meet"
    return Check("target", ok, f"the bound of {100 * statistics['upper_bound']:.3g} % {word} the target of {goal}")


def _statistics(evidence: Evidence) -> dict[str, Any] | None:
    """The statement of the certify stage; without one, that of the first random search whose points are independent.

    Either was declared with the campaign, so the choice is not ours.
    """
    searched = [s["sample"] for s in evidence.searches if s["kind"] == "random" and s["sample"]]
    samples = [evidence.certificate["sample"]] if evidence.certificate is not None else searched
    sample = next((s for s in samples if s["upper_bound"] is not None), None)
    if sample is None:
        return None
    told = {k: sample[k] for k in ("samples", "violations", "confidence", "upper_bound", "text")}
    quantile = sample.get("quantile")
    source = "search" if evidence.certificate is None else "certify"
    return told | {"quantile": quantile, "source": source}


def _best_method(searches: Sequence[dict[str, Any]]) -> str | None:
    found = [s for s in searches if s["best"] is not None]
    return min(found, key=lambda s: s["best"]["cost"])["method"] if found else None


def _sentence(
    problem: Problem, evidence: Evidence, verdict: Verdict, checks: Sequence[Check], statistics: dict[str, Any] | None
) -> str:
    criterion, finding = problem.parts.criterion, evidence.finding
    quantity, unit = criterion.quantity, criterion.unit
    limit = f"{number(problem.threshold)} {unit}"
    if finding is None:
        return f"No flight could be evaluated: {checks[0].text}."
    worst = (
        f"The worst case found has {quantity} = {number(finding.cost)} {unit}, "
        f"a margin of {signed(finding.margin)} {unit}."
    )
    how = f"{count(evidence.evaluations)} evaluations, searched by {listed([s['title'] for s in evidence.searches])}"
    chance = f" {statistics['text']}." if statistics else ""
    if statistics and statistics["quantile"]:
        said = statistics["quantile"]["text"]
        chance += f" {said[0].upper()}{said[1:]}."
    if evidence.violation is not None:
        told = evidence.violation
        shown = "It was validated, and found"
        if told is not finding:
            milder = f"{told.label}, which has {number(told.cost)} {unit}"
            shown = f"Validation did not confirm it, but {milder}; both were found"
        return f"{quantity} falls to or below {limit}. {worst} {shown} in {how}.{chance}"
    if verdict == "cleared":
        return f"{quantity} stayed above {limit} in all {how}. {worst}{chance} A search can miss a worse case."
    why = "; ".join(c.text for c in checks if not c.ok)
    return f"Nothing may be claimed: {why}. {worst} It comes from {how}."


def _scope(problem: Problem) -> str:
    parts, scenario = problem.parts, problem.campaign.scenario
    entries = {f"{s.prefix}.{p.name}": p.unit for s in problem.loop.sections for p in s.parameters}
    bounds = ", ".join(
        f"{r.path} {number(r.low)} to {number(r.high)} {entries[r.path]}".rstrip() for r in problem.ranges
    )
    obstacles = len(parts.obstacles)
    return (
        f"Scope: {parts.vehicle.title}, {parts.controller.title}, {parts.avoider.title}, "
        f"{obstacles} {'obstacle' if obstacles == 1 else 'obstacles'}{_conditions(problem)}; {bounds}; "
        f"horizon {number(scenario.horizon)} s, step {number(scenario.step)} s. "
        f"It holds for this model within these bounds; components of clearance {catalogue().version}."
    )


def _conditions(problem: Problem) -> str:
    """The environment and the faults in the loop, and which realisations of them count."""
    parts, realised = problem.parts, problem.realisations
    titles = [e.title for e in parts.environment] + [f.fault.title for f in parts.faults]
    text = f", with {listed(titles)}" if titles else ""
    return f"{text}, {realised.combine} of {count(len(realised.seeds))} realisations" if realised.several else text
