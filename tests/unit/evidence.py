"""Evidence for a verdict written out by hand, by which everything is cleared. Start reading at `evidence`."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from campaigns import Campaign
from tests.unit.cases import case1
from worker.stages.parts.claims import bound
from worker.stages.parts.store import Conclusion, Finding
from worker.systems.problem import Problem
from worker.verdicts.conclude import conclude
from worker.verdicts.evidence import Evidence

NOMINAL, WORST = 0.94, 0.84
"""[m]; the threshold is 0.5 m, and 5 % of nominal minus worst is 0.005 m."""

CONVERGED = {"kind": "rule", "text": "every start ended"}
TITLES = {
    "direct": "DIRECT", "sqp": "SQP multistart", "monte_carlo": "Monte Carlo", "ga": "Genetic algorithm",
    "portfolio": "Portfolio", "nsga2": "NSGA-II",
}  # fmt: skip
KINDS = {"sqp": "local", "monte_carlo": "random", "nsga2": "multi"}
"""All others are global."""


def search(method: str, cost: float | None = WORST, **changes: Any) -> dict[str, Any]:
    """The result of one search stage."""
    made: dict[str, Any] = {
        "method": method,
        "title": TITLES[method],
        "kind": KINDS.get(method, "global"),
        "best": None if cost is None else {"cost": cost, "margin": cost - 0.5, "parameters": {}, "index": 0},
        "evaluations": 1000,
        "failed": 0,
        "excluded": 0,
        "stop": CONVERGED if method == "sqp" else {"kind": "budget", "text": "used its budget of 1000 evaluations"},
        "minima": [],
        "sample": None,
    }
    return made | changes


def sample(violations: int = 0, samples: int = 1000, **changes: Any) -> dict[str, Any]:
    upper = bound(violations, samples, 0.95)
    text = f"{violations} of {samples} violate"
    made = {"samples": samples, "violations": violations, "confidence": 0.95, "upper_bound": upper, "text": text}
    return made | {"noise": "none", "excluded_fraction": 0.0} | changes


QUANTILE = {"share": 0.05, "bound": 0.9, "text": "at most 5 % of the flights have d_min below 0.9 m"}


def certificate(violations: int = 0, samples: int = 3000) -> dict[str, Any]:
    """The result of a certify stage."""
    return {"sample": sample(violations, samples) | {"quantile": QUANTILE}, "grid": None}


def finding(cost: float = WORST, confirmed: bool = True) -> Finding:
    validation = {"name": "F1", "ok": confirmed, "violates": confirmed and cost <= 0.5, "realisation": None}
    return Finding(
        label="F1", cost=cost, margin=cost - 0.5, parameters={"vehicle.m": 6.0}, point=[1.0], methods=["direct"],
        found=[], at_bounds={"vehicle.m": "high"}, validation=validation,
    )  # fmt: skip


def encountered(**changes: Any) -> dict[str, Any]:
    """What shows that the encounter took place, with changes."""
    return {
        "closest": [{"name": name, "time": 7.5, "at": "inside", "obstacle": 0} for name in ("nominal", "F1")],
        "moved": 9.2,
        "unseen": {"cost": 0.38, "status": "ok", "reason": "", "deviation": 0.7},
        "spread": {"evaluations": 3343, "lowest": WORST, "highest": 1.0},
        "influence": {"vehicle.m": 0.1, "vehicle.J": 0.02},
    } | changes


def validation(**changes: Any) -> dict[str, Any]:
    """The result of a validate stage by which everything is cleared, with changes; `comparison` is added later."""
    return {
        "ok": True,
        "text": "half the step and DOP853 agree for nominal and F1",
        "findings": {"complete": True, "text": "polished every distinct worst case"},
        "violations": {
            "stored": 0,
            "checked": 0,
            "confirmed": 0,
            "text": "no stored evaluation violates",
        },
        "spot_checks": {"checked": 200, "compared": 200, "violating": 0, "text": "200 random evaluations compared"},
        "encounter": encountered(),
    } | changes


def evidence(basins: dict[str, str | None] | None = None, **changes: Any) -> Evidence:
    """Evidence by which everything is cleared, with changes; basins: where a method's best lies, if not in F1's."""
    given = Evidence(
        nominal={"cost": NOMINAL, "margin": NOMINAL - 0.5, "status": "ok", "reason": ""},
        searches=[search("direct"), search("sqp"), search("monte_carlo", 0.85, sample=sample())],
        validation=validation(),
        finding=finding(),
        evaluations=3343,
        failed=0,
        excluded=0,
    )
    made = replace(given, **changes)
    if made.finding is not None and "lowest" not in changes:
        made = replace(made, lowest=min(f.cost for f in made.findings))
    rows = [{"basin": (basins or {}).get(s["method"], "F1")} for s in made.searches]
    return replace(made, validation=made.validation | {"comparison": rows})


def concluded(asked: Campaign | None = None, **changes: Any) -> Conclusion:
    problem = case1() if asked is None else Problem(asked)
    return conclude(problem, evidence(**changes), {"clearance": "test"})


def barred(name: str, asked: Campaign | None = None, **changes: Any) -> str:
    """The sentence of the one check that does not hold; the verdict must be inconclusive and tell it."""
    conclusion = concluded(asked, **changes)
    wrong = [c for c in conclusion.summary["checks"] if not c["ok"]]
    assert [c["name"] for c in wrong] == [name]
    assert conclusion.verdict == conclusion.summary["verdict"] == "inconclusive"
    assert conclusion.reason.startswith(f"Nothing may be claimed: {wrong[0]['text']}. ")
    return str(wrong[0]["text"])


def said_by(name: str, conclusion: Conclusion) -> str:
    """The sentence of one check."""
    (text,) = (c["text"] for c in conclusion.summary["checks"] if c["name"] == name)
    return str(text)


def violation(**changes: Any) -> dict[str, Any]:
    worst = 0.49
    searches = [search("direct", worst), search("sqp", worst)]
    return {"finding": finding(worst), "searches": searches, **changes}
