"""Synthetic results of the right types, for tests of storage and display."""

from __future__ import annotations

from typing import Any, NamedTuple

from campaigns.claims import earlier
from campaigns.claims.spans import Spans
from campaigns.claims.wording import WORDING
from campaigns.results import Finding, SearchResult, TraceHead, ValidateResult, Verdict
from campaigns.results.base import Stop, Values
from campaigns.results.finding import FoundBy, HalfStep, ReferenceCost, Validation
from campaigns.results.sample import Sample
from campaigns.results.search import Best
from campaigns.results.trace import TraceColumn
from campaigns.results.verdict import NominalCost, Provenance, VerdictWord, Worst
from campaigns.stages.certify import CertifyResult
from campaigns.stages.nominal import NominalResult

TERMS = earlier.Terms({"d_min": "d_min", "vehicle.m": "m", "vehicle.J": "J"}, {"m", "s"})


class Marks(NamedTuple):
    """What a verdict in large states besides its word."""

    not_sampled: bool | None = None
    earlier_rules: bool | None = None


def statement(text: str) -> Spans:
    """A sentence of a run of case 1 as spans."""
    return earlier.spans(text, TERMS)


ENDED = Stop(kind="rule", text="completed the 100 iterations")


def columns(*described: tuple[str, str, Any]) -> list[TraceColumn]:
    """Columns of a trace by name, unit and group."""
    return [TraceColumn(name=n, symbol=n, unit=u, group=g) for n, u, g in described]


def head(**values: Any) -> TraceHead:
    """The head of a flight."""
    return TraceHead.model_validate(values)


def nominal(cost: float = 0.9, threshold: float = 0.5) -> NominalResult:
    """A nominal stage whose evaluation succeeded."""
    return NominalResult(cost=cost, margin=cost - threshold, status="ok")


def failed_nominal(reason: str = "the state diverged (non-finite or above 1e12)") -> NominalResult:
    """A nominal stage whose evaluation failed."""
    return NominalResult(cost=None, margin=None, status="failed", reason=reason)


def searched(best: float | None = None, parameters: Values | None = None, method: str = "direct") -> SearchResult:
    """A search stage of 1,000 evaluations, a tenth of them failed."""
    found = None if best is None else Best(cost=best, margin=best - 0.5, parameters=parameters or {}, index=4)
    return SearchResult(
        method=method, title="DIRECT", kind="global", best=found, evaluations=1000, failed=100, excluded=0,
        seconds=1.0, stop=ENDED,
    )  # fmt: skip


def certified(drawn: int = 0) -> CertifyResult:
    """A certify stage without a violation, whose first evaluations each drew a noise realisation."""
    sample = Sample(samples=3, violations=0, confidence=0.95, upper_bound=0.64, text="0 of 3 violate the criterion")
    return CertifyResult(sample=sample, grid=None, drawn_realisations=drawn, text=sample.text)


def validated() -> ValidateResult:
    """A validate stage whose integrations agree."""
    return ValidateResult(ok=True, text="they agree", tolerance=1e-3, nominal=validation("nominal"))


def validation(name: str, cost: float = 1.3, **values: Any) -> Validation:
    """A case whose integrations agree."""
    half = HalfStep(step=0.0025, cost=cost + 1e-4, difference=1e-4)
    other = ReferenceCost(name="DOP853", cost=cost + 2e-4, difference=2e-4)
    stated = {"ok": True, "agrees": True, "violates": False} | values
    return Validation(name=name, step=0.005, cost=cost, half_step=half, integrator=other, allowed=1e-3, **stated)


def finding(
    label: str, cost: float, margin: float, parameters: Values, by: tuple[FoundBy, ...] = (), **values: Any
) -> Finding:
    """A worst case at the upper bounds, found by DIRECT."""
    at = {"point": [1.0] * len(parameters), "methods": ["direct"], "found": list(by)}
    known = {"validation": validation(label, cost), "at_bounds": dict.fromkeys(parameters, "high")} | at | values
    return Finding(label=label, cost=cost, margin=margin, parameters=parameters, **known)


def verdict(
    word: VerdictWord = "inconclusive",
    sentence: str = "A test.",
    nominal: float | None = 0.9,
    worst: float | None = 0.8,
    **values: Any,
) -> Verdict:
    """A verdict without checks."""
    today = Provenance(wording=WORDING)
    known: dict[str, Any] = {"scope": "", "checks": [], "quantity": "d_min", "unit": "m", "provenance": today} | values
    found = None
    if worst is not None:
        found = Worst(cost=worst, margin=worst - 0.5, parameters={}, method="direct", finding="F1")
    at_nominal = NominalCost(cost=nominal, margin=None if nominal is None else nominal - 0.5)
    return Verdict(verdict=word, statement=statement(sentence), nominal=at_nominal, worst=found, **known)
