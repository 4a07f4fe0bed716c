"""A finished run with a result of every kind, for reports and sign-offs. Start reading at `finish_fully`."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from backend.db.queue import Queue
from backend.db.records import Conclusion, Finding, StagePlan
from backend.db.store import RunStore
from tests.api.finished import flight, search
from tests.api.flown import CODE, FLOWN
from tests.api.server import Service

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
    service: Service, verdict: Any = "cleared", text: str = SENTENCE, checked: str = "holds", criteria: int = 1
) -> None:
    """Work off the next run in the queue, with every kind of result; `text` and `checked` stand in the verdict."""
    claim = Queue(service.engine).claim("w1")
    assert claim is not None
    store = RunStore(service.engine, claim)
    store.plan(PLAN)
    store.flies(FLOWN, CODE)
    for position in range(len(PLAN)):
        store.begin(position)
    store.append(2, 0, search(0, 1000, criteria))
    store.finish(0, {"cost": 1.4, "margin": 0.9, "status": "ok"}, 0.01, traces=[flight("nominal", 301)])
    store.finish(1, sensitivity(), 0.1)
    store.finish(2, searched(), 1.0)
    store.finish(3, {"sample": sample(), "grid": None, "stop": ENDED, "text": ""}, 2.0)
    found = [finding(), replace(finding(), label="F2", cost=1.32, margin=0.82)]
    store.finish(4, validated(), 0.5, findings=found, traces=[flight("F1", 301, 0.8), flight("F2", 301, 0.85)])
    summary = {
        "verdict": verdict,
        "sentence": text,
        "scope": "Scope: one obstacle; horizon 15 s.",
        "checks": [
            {"name": "nominal", "ok": True, "text": "margin +0.9 m"},
            {"name": "x", "ok": False, "text": checked},
        ],
        "statistics": {k: v for k, v in sample().items() if k != "histogram"},
        "quantity": "d_min",
        "unit": "m",
        "provenance": {"seed": 1, "clearance": "0.1.0", "packages": {"numpy": "2.4.6"}, "cpu": {"model": "A CPU"}},
    }
    store.conclude(Conclusion(verdict, text, 1.4, 1.3, "direct", summary))


ENDED = {"kind": "rule", "text": "did the 100 iterations asked for"}
COUNTS = {"evaluations": 1000, "failed": 100, "excluded": 0, "seconds": 1.0, "stop": ENDED}


def searched() -> dict[str, Any]:
    """DIRECT, which ended by its own rule."""
    best = {"cost": 1.3, "margin": 0.8, "parameters": PARAMETERS, "index": 4}
    named = {"method": "direct", "title": "DIRECT", "kind": "global"}
    return {**named, **COUNTS, "best": best, "minima": [], "sample": None, "gap": None}


def sensitivity() -> dict[str, Any]:
    """Two curves; one value of the second is not known."""
    return {"points": 21, "morris": None, "sobol": None, "curves": curves(1.4)}


def curves(middle: float) -> list[dict[str, Any]]:
    """One for each parameter, through `middle`; the last value of the second is not known."""
    mass, inertia = np.linspace(4, 6, 21), np.linspace(0.04, 0.06, 21)
    costs: list[float | None] = (middle - 0.05 * (mass - 5)).tolist()
    missing = [*costs[:-1], None]
    drawn = [("vehicle.m", mass.tolist(), costs), ("vehicle.J", inertia.tolist(), missing)]
    return [{"path": p, "values": v, "costs": c, "status": ["ok"] * 21} for p, v, c in drawn]


def sample() -> dict[str, Any]:
    """A sample without a violation, and its claims."""
    return {
        "samples": 3000,
        "violations": 0,
        "failed": 0,
        "excluded": 0,
        "confidence": 0.95,
        "upper_bound": 0.0009980790119965865,
        "lowest": 1.31,
        "mean": 1.4,
        "deviation": 0.02,
        "histogram": {"edges": [1.3, 1.35, 1.4, 1.45], "counts": [400, 2000, 600]},
        "text": "0 of 3\u202f000 flights drawn violate the criterion: P(violation) is at most 0.0998 %",
        "outside": 0.0,
        "quantile": {
            "share": 0.05,
            "order": 131,
            "bound": 1.33,
            "text": "at most 5 % of the flights have d_min below 1.33 m",
        },
    }


def finding() -> Finding:
    """The worst case."""
    by = [{"position": 2, "method": "direct", "evaluations": 417}]
    at = {"vehicle.m": "high", "vehicle.J": "high"}
    return Finding("F1", 1.3, 0.8, PARAMETERS, [1.0, 1.0], ["direct"], at, {"ok": True}, by)


def validated() -> dict[str, Any]:
    """Validation that agrees for both cases."""
    half = {"step": 0.0025, "cost": 1.3001, "difference": 1e-4}
    other = {"name": "DOP853", "cost": 1.3002, "difference": 2e-4, "reason": ""}
    cases = [
        {"name": name, "step": 0.005, "cost": 1.3, "half_step": half, "integrator": other, "allowed": 1e-3, "ok": True}
        for name in ("nominal", "F1")
    ]
    named = {"position": 2, "method": "direct", "title": "DIRECT", "kind": "global", "best": 1.3}
    beside = {**named, **COUNTS, "to_near_best": 55, "findings": ["F1"]}
    text = "half the step and DOP853 agree for nominal and F1"
    through = {"curves": curves(1.31), "at": PARAMETERS}
    after = {"F1": {"slices": through, "boundary": None}}
    return {"ok": True, "text": text, "tolerance": 1e-3, "cases": cases, "comparison": [beside], "after": after}
