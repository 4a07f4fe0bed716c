"""Hand-written evidence for a verdict of cleared."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, TypeVar

from campaigns import Campaign
from campaigns.claims.say import say
from campaigns.claims.wording import WORDING
from campaigns.results import Finding, SearchResult, ValidateResult, Verdict
from campaigns.results.base import MethodKind, Result, Stop
from campaigns.results.finding import ClosestApproach, HalfStep, ReferenceCost, Validation
from campaigns.results.sample import QuantileBound, Sample
from campaigns.results.search import Apart, Best
from campaigns.results.validate import Compared, Encounter, Gathered, SpotChecks, Spread, Unseen, Violations
from campaigns.results.verdict import Check
from campaigns.stages.certify import CertifyResult
from campaigns.stages.nominal import NominalResult
from campaigns.versions import Versions
from clearance.testing.problems import Problem
from tests.given.case_campaigns import case1
from worker.engine.stages.parts.claims import bound
from worker.evidence.verdicts.conclude import conclude
from worker.evidence.verdicts.evidence import Evidence

NOMINAL, WORST = 0.94, 0.84
"""[m]; the threshold is 0.5 m, and 5 % of nominal minus worst is 0.005 m."""

CONVERGED = Stop(kind="rule", text="all starts converged")
TITLES = {
    "direct": "DIRECT", "sqp": "SQP multistart", "monte_carlo": "Monte Carlo", "ga": "Genetic algorithm",
    "portfolio": "Portfolio", "auto": "Auto", "nsga2": "NSGA-II",
}  # fmt: skip
KINDS: dict[str, MethodKind] = {"sqp": "local", "monte_carlo": "random", "nsga2": "multi"}
"""All others are global."""

R = TypeVar("R", bound=Result)


def changed(made: R, **changes: Any) -> R:
    """The result with other fields, validated as anything that is stored."""
    if "text" in changes:
        changes["statement"] = say(changes.pop("text"))
    assert changes.keys() <= type(made).model_fields.keys()
    return type(made).model_validate({**dict(made), **changes})


def search(method: str, cost: float | None = WORST, **changes: Any) -> SearchResult:
    """The result of one search stage."""
    made = SearchResult(
        method=method,
        title=TITLES[method],
        kind=KINDS.get(method, "global"),
        best=None if cost is None else Best(cost=cost, margin=cost - 0.5, parameters={}, index=0),
        evaluations=1000,
        failed=0,
        excluded=0,
        seconds=1.0,
        stop=CONVERGED if method == "sqp" else Stop(kind="budget", text="used its budget of 1000 evaluations"),
    )
    return changed(made, **changes)


def part_apart(member: str, family: str, cost: float = WORST, evaluations: int = 500) -> Apart:
    """A part of a search that was apart."""
    title = TITLES.get(member, member)
    return Apart(member=member, title=title, family=family, evaluations=evaluations, best=cost, index=0)


def sample(violations: int = 0, samples: int = 1000, **changes: Any) -> Sample:
    """What an independent sample states."""
    made = Sample(
        samples=samples,
        violations=violations,
        confidence=0.95,
        upper_bound=bound(violations, samples, 0.95),
        noise="none",
        text=f"{violations} of {samples} violate",
    )
    return changed(made, **changes)


QUANTILE = QuantileBound(share=0.05, bound=0.9, text="at most 5 % of the flights have d_min below 0.9 m")


def certificate(violations: int = 0, samples: int = 3000, **changes: Any) -> CertifyResult:
    """The result of a certify stage; `changes` are those of its sample."""
    drawn = sample(violations, samples, **{"quantile": QUANTILE} | changes)
    return CertifyResult(sample=drawn, grid=None, seed=1, drawn_at_launch=True, text=drawn.text)


def nominal(cost: float | None = NOMINAL, reason: str = "") -> NominalResult:
    """The result of the nominal stage; without a cost the evaluation failed."""
    if cost is None:
        return NominalResult(cost=None, margin=None, status="failed", reason=reason)
    return NominalResult(cost=cost, margin=cost - 0.5, status="ok", reason=reason)


def case(name: str = "F1", cost: float = WORST, confirmed: bool = True, **changes: Any) -> Validation:
    """A case simulated again: confirmed by the same costs, or not confirmed by half the step."""
    half = cost if confirmed else cost + 0.2
    made = Validation(
        name=name,
        step=0.005,
        cost=cost,
        half_step=HalfStep(step=0.0025, cost=half, difference=half - cost),
        integrator=ReferenceCost(name="DOP853", cost=cost, difference=0.0),
        allowed=1e-3,
        ok=confirmed,
        agrees=confirmed,
        violates=confirmed and cost <= 0.5,
    )
    return changed(made, **changes)


INSIDE = ClosestApproach(time=7.5, at="inside", obstacle=0)


def finding(cost: float = WORST, confirmed: bool = True, **changes: Any) -> Finding:
    """The worst case, validated."""
    made = Finding(
        label="F1", cost=cost, margin=cost - 0.5, parameters={"vehicle.m": 6.0}, point=[1.0], methods=["direct"],
        found=[], at_bounds={"vehicle.m": "high"}, validation=case("F1", cost, confirmed), closest=INSIDE,
    )  # fmt: skip
    return changed(made, **changes)


def encountered(**changes: Any) -> Encounter:
    """Evidence that the encounter took place, with changes."""
    made = Encounter(
        closest=INSIDE,
        moved=9.2,
        unseen=Unseen(cost=0.38, status="ok", reason="", deviation=0.7),
        spread=Spread(evaluations=3343, lowest=WORST, highest=1.0),
        influence={"vehicle.m": 0.1, "vehicle.J": 0.02},
    )
    return changed(made, **changes)


def gathered(**changes: Any) -> Gathered:
    """How the findings were distinguished, with changes."""
    made = Gathered(
        distance=0.1, barrier=0.05, at_most=8, candidates=3, left_out=0, complete=True,
        text="polished every distinct worst case",
    )  # fmt: skip
    return changed(made, **changes)


def validation(**changes: Any) -> ValidateResult:
    """The result of a validate stage by which everything is cleared, with changes; `comparison` is added later."""
    made = ValidateResult(
        ok=True,
        text="the step-halving check and DOP853 agree for nominal and F1",
        tolerance=1e-3,
        nominal=case("nominal", NOMINAL),
        findings=gathered(),
        violations=Violations(stored=0, checked=0, confirmed=0, text="no stored evaluation violates"),
        spot_checks=spot_checks(),
        encounter=encountered(),
    )
    return changed(made, **changes)


def spot_checks(**changes: Any) -> SpotChecks:
    """Random evaluations that the reference integrator confirms, with changes."""
    made = SpotChecks(
        checked=200, compared=200, largest=1e-9, median=1e-10, violating=0, at=None,
        text="200 random evaluations differ",
    )  # fmt: skip
    return changed(made, **changes)


def evidence(basins: dict[str, str | None] | None = None, **changes: Any) -> Evidence:
    """Evidence for cleared, with changes; basins: the finding whose basin contains a method's best, if not F1."""
    first = [changes.pop("nominal", None) or nominal(), changes.pop("baseline", None)]
    searches = [search("direct"), search("sqp"), search("monte_carlo", 0.85, sample=sample())]
    searches = changes.pop("searches", searches)
    drawn = certificate(samples=1000, quantile=None)
    rows = [_row(at, s, (basins or {}).get(s.method, "F1")) for at, s in enumerate(searches, 2)]
    validated = changed(changes.pop("validation", None) or validation(), comparison=rows)
    results = [*first, *searches, changes.pop("certificate", drawn), validated]
    made = Evidence(
        results=[result for result in results if result is not None],
        finding=finding(),
        evaluations=3343,
        failed=0,
        excluded=0,
    )
    made = replace(made, **changes)
    if made.finding is not None and "lowest" not in changes:
        made = replace(made, lowest=min(f.cost for f in made.findings))
    return made


def _row(position: int, search: SearchResult, basin: str | None) -> Compared:
    return Compared(
        position=position,
        method=search.method,
        title=search.title,
        kind=search.kind,
        best=None if search.best is None else search.best.cost,
        evaluations=search.evaluations,
        failed=search.failed,
        excluded=search.excluded,
        seconds=search.seconds,
        to_near_best=None,
        basin=basin,
        apart=[basin] * len(search.apart),
        findings=[],
        stop=search.stop,
    )


VERSIONS = Versions(clearance="test", wording=WORDING)


def concluded(campaign: Campaign | None = None, **changes: Any) -> Verdict:
    """The verdict over this evidence."""
    problem = case1() if campaign is None else Problem(campaign)
    return conclude(problem, evidence(**changes), VERSIONS)


def barred(code: str, campaign: Campaign | None = None, **changes: Any) -> Check:
    """The one check that does not hold; the verdict must be inconclusive and give its sentence."""
    conclusion = concluded(campaign, **changes)
    (check,) = (c for c in conclusion.checks if not c.ok)
    assert check.code == code
    assert conclusion.verdict == "inconclusive"
    assert conclusion.reason.partition(": ")[2].startswith(f"{check.text}. ")
    return check


def check_of(code: str, conclusion: Verdict) -> Check:
    """One check of a verdict."""
    (check,) = (c for c in conclusion.checks if c.code == code)
    return check


def violation(**changes: Any) -> dict[str, Any]:
    """Changes by which the worst case is a confirmed violation, with others."""
    worst = 0.49
    searches = [search("direct", worst), search("sqp", worst)]
    return {"finding": finding(worst), "searches": searches, **changes}
