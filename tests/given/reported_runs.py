"""A finished run with a result of every kind, for reports and sign-offs."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from backend.db.queue import Queue
from backend.db.store import RunStore
from campaigns.claims.wording import WORDING
from campaigns.results import Finding, ValidateResult
from campaigns.results.finding import FoundBy
from campaigns.results.sample import Histogram, QuantileBound, Sample
from campaigns.results.slices import Curve, Slices
from campaigns.results.validate import Compared
from campaigns.results.verdict import Check, Provenance, Statistics
from campaigns.stages.certify import CertifyResult
from campaigns.stages.sensitivity import SensitivityResult
from campaigns.stored.records import StagePlan, Trace
from campaigns.versions import Processor
from tests import results
from tests.given.code_versions import VERSIONS, code
from tests.given.finished_runs import flight, search
from tests.given.service import Service

PLAN = [
    StagePlan("nominal", None, 1),
    StagePlan("sensitivity", None, 42),
    StagePlan("search", "direct", 1000),
    StagePlan("certify", None, 3000),
    StagePlan("validate", None, 300),
]
SENTENCE = "d_min stayed above 0.5 m in all 1\u202f000 evaluations. A search can miss a worse case."
PARAMETERS = {"vehicle.m": 6.0, "vehicle.J": 0.06}


def finish_fully(
    service: Service,
    verdict: Any = "cleared",
    text: str = SENTENCE,
    checked: str = "holds",
    criteria: int = 1,
    further: Sequence[Check] = (),
    nominal: Trace | None = None,
    found: Sequence[Finding] = (),
    **values: Any,
) -> None:
    """Finish the next run in the queue with every kind of result; `text`, `checked` and `further` are of the verdict.

    nominal: the trace of the nominal case, which failed; by default it succeeded. found: in place of two findings above
    the threshold. values: other parts of the verdict.
    """
    claim = Queue(service.engine).claim("w1")
    assert claim is not None
    store = RunStore(service.engine, claim)
    store.plan(PLAN)
    used = code(claim.document)
    store.record_versions(VERSIONS.model_copy(update={"code": used.digest}), used)
    for position in range(len(PLAN)):
        store.begin(position)
    store.append(2, 0, search(0, 1000, criteria))
    at_nominal = results.nominal(1.4) if nominal is None else results.failed_nominal()
    store.finish(0, at_nominal, 0.01, traces=[nominal or flight("nominal", 301)])
    store.finish(1, sensitivity(), 0.1)
    store.finish(2, results.searched(1.3, PARAMETERS), 1.0)
    store.finish(3, CertifyResult(sample=sample(), grid=None, stop=results.ENDED, text=""), 2.0)
    second = finding().model_copy(update={"label": "F2", "cost": 1.32, "margin": 0.82, "slices": None})
    store.finish(
        4,
        validated(),
        0.5,
        findings=list(found) or [finding(), second],
        traces=[flight("F1", 301, 0.8), flight("F2", 301, 0.85)],
    )
    stated = Statistics.model_validate(sample().model_dump() | {"source": "certify"})
    checks = [
        Check(code="nominal", ok=True, statement=results.statement("margin +0.9 m")),
        Check(code="x", ok=False, statement=results.statement(checked)),
        *further,
    ]
    origin = Provenance(
        seed=1, clearance="0.1.0", wording=WORDING, packages={"numpy": "2.4.6"}, cpu=Processor(model="A CPU")
    )
    scope = "Scope: one obstacle; horizon 15 s."
    known = {"scope": scope, "checks": checks, "statistics": stated, "provenance": origin, "worst": 1.3} | values
    store.conclude(results.verdict(verdict, text, 1.4, **known))


def sensitivity() -> SensitivityResult:
    """Two curves; one value of the second is not known."""
    return SensitivityResult(points=21, curves=curves(1.4))


def curves(middle: float) -> list[Curve]:
    """One for each parameter, through `middle`; the last value of the second is not known."""
    mass, inertia = np.linspace(4, 6, 21), np.linspace(0.04, 0.06, 21)
    costs: list[float | None] = (middle - 0.05 * (mass - 5)).tolist()
    missing = [*costs[:-1], None]
    drawn = [("vehicle.m", mass.tolist(), costs), ("vehicle.J", inertia.tolist(), missing)]
    return [Curve(path=p, values=v, costs=c, status=["ok"] * 21) for p, v, c in drawn]


def sample() -> Sample:
    """A sample without a violation, and its claims."""
    at_most = "at most 5 % of the flights have d_min below 1.33 m"
    return Sample(
        samples=3000,
        violations=0,
        confidence=0.95,
        upper_bound=0.0009980790119965865,
        noise="none",
        lowest=1.31,
        mean=1.4,
        deviation=0.02,
        histogram=Histogram(edges=[1.3, 1.35, 1.4, 1.45], counts=[400, 2000, 600]),
        statement=results.statement(
            "0 of 3\u202f000 samples drawn violate the criterion: P(violation) is at most 0.0998 %"
        ),
        quantile=QuantileBound(share=0.05, order=131, bound=1.33, statement=results.statement(at_most)),
    )


SEARCHED = Statistics.model_validate(sample().model_dump() | {"source": "search"})
"""The same of a random search, where there is no certify stage."""


def finding() -> Finding:
    """The worst case."""
    by = (FoundBy(position=2, method="direct", evaluations=417),)
    through = Slices(curves=curves(1.31), at=PARAMETERS)
    return results.finding("F1", 1.3, 0.8, PARAMETERS, by, slices=through)


def validated() -> ValidateResult:
    """Validation that agrees for both cases."""
    search = results.searched(1.3)
    row = Compared(
        position=2, method=search.method, title=search.title, kind=search.kind, best=1.3, evaluations=1000, failed=100,
        seconds=1.0, stop=search.stop, to_near_best=55, findings=["F1"],
    )  # fmt: skip
    text = "the step-halving check and DOP853 agree for nominal and F1"
    case = results.validation("nominal")
    return ValidateResult(ok=True, text=text, tolerance=1e-3, nominal=case, comparison=[row])


def missing(report: str) -> set[str]:
    """What the report of a run states that it does not have."""
    return set(re.findall(r'data-missing="(\w+)"', report))
