"""Agreement, judged again: the methods, and parts of one that were apart, which reached the worst case and its cost."""

from __future__ import annotations

import math
from itertools import combinations
from typing import Any

import numpy as np

from campaigns.catalogue import MethodEntry
from campaigns.results.base import OK
from campaigns.results.search import Apart
from worker.evidence.audit import limits
from worker.evidence.audit.parts import OMIT, REST, made
from worker.evidence.audit.recompute import Run
from worker.evidence.audit.record import MISSING


def agreement(run: Run) -> bool:
    """Whether methods that searched, of two families and all global ones, reached the worst case and its cost."""
    if math.isnan(run.nominal):
        return False
    findings, came, by = run.claims["findings"], dict[int, bool](), set[frozenset[str]]()
    stated = [f["cost"] for f in findings if f["validation"]["realisation"] is None]
    worst = min(stated or [f["cost"] for f in findings], default=math.nan)
    fall = min(run.campaign.agreement, limits.AGREEMENT_AT_MOST) * (run.nominal - worst)
    if worst > run.threshold:
        fall = min(fall, limits.AGREEMENT_OF_MARGIN * (worst - run.threshold))
    for k, row in zip(run.searches, run.claims["comparison"], strict=True):
        kind, spent = run.methods[k].kind, run.ended[k].evaluations
        within = max(fall, _rounding(run, worst)) if run.varies or run.older else math.inf
        least, labels = limits.LEAST.get(kind, math.inf) * len(run.bounds), {f["label"] for f in findings}
        searched = spent >= least and not (kind == "local" and spent >= run.plan[k].planned)
        came[k] = searched and run.best[k] - worst <= within and row["basin"] in labels
        parts = run.claims["results"][k].get("apart") or []
        if came[k] and not parts and not _started(run, k, row["basin"]):
            by.add(_principles(run, k, None, family(run, k)))
        for part, basin in zip(parts, row.get("apart") or [], strict=True):
            reached = part["evaluations"] >= least and part["best"] - worst <= within and basin in labels
            if came[k] and reached and not _started(run, k, basin):
                led = run.methods[k].apart.get(part["member"], part["family"])
                by.add(_principles(run, k, part["member"], led))
    globally = [came[k] for k in run.searches if run.methods[k].kind == "global"]
    several = any(a.isdisjoint(b) for a, b in combinations(by, limits.METHODS))
    return bool(globally) and all(globally) and several and (not run.varies or worst < run.nominal)


def _principles(run: Run, k: int, member: str | None, leading: str) -> frozenset[str]:
    """The principles of a search, or of its part that this member led: of members that shared what they knew all of
    theirs, in earlier versions the leading one's and their method, or that one's alone."""
    of, rows = run.methods[k], run.claims["results"][k].get("members") or []
    alone = member in of.apart if member else not (of.apart or rows)
    if alone or run.wording < limits.SHARED:
        return frozenset([leading])
    sharing = [row for row in rows if row["member"] not in of.apart and run.wording >= limits.ALIKE]
    return frozenset([leading, of.name, *(_principle(run, row["member"], row.get("family", "")) for row in sharing)])


def _principle(run: Run, member: str, stated: str) -> str:
    """That of a member, with its usual options; as stated of a method that is not installed."""
    known = run.installed.get(member)
    if known is None:
        return stated or member
    return _chosen(known, {}) or known.name


def _started(run: Run, k: int, label: str) -> bool:
    """Whether the campaign started a search at the worst case of this label; earlier versions let it agree."""
    if run.wording < limits.LOWEST:
        return False
    for start in run.campaign.stages.search[run.searches.index(k)].starts:
        for found in (f for f in run.findings if f.label == label):
            apart = [
                abs(start.get(path, run.known[path][1]) - found.parameters[path]) / (high - low)
                for path, (low, high) in run.bounds.items()
            ]
            if max(apart) <= limits.SAME_PLACE:
                return True
    return False


def _rounding(run: Run, worst: float) -> float:
    """The difference of costs that is rounding; what earlier versions allowed, only where nothing was cleared."""
    if run.older:
        return 1e-9 * max(abs(worst), 1.0)
    return limits.AGREEMENT_ROUNDING * max(abs(worst), abs(run.nominal), abs(run.threshold))


def apart(run: Run, k: int) -> list[Apart]:
    """The parts of a search: their bests as its evaluations have them; at most one part of members that its method does
    not declare apart, and no more evaluations than the search has."""
    parts, declared = run.claims["results"][k].get("apart") or [], run.methods[k].apart
    costs = np.where(run.status == OK, run.raw, np.nan)[run.stage == k]
    together = [part["member"] not in declared for part in parts]
    sound = len(parts) > 1 and sum(together) <= 1 and len({part["member"] for part in parts}) == len(parts)
    sound = sound and sum(part["evaluations"] for part in parts) <= len(costs)
    if parts and not sound:
        return [_part(member=MISSING)]
    return [_part(float(costs[part["index"]]), declared.get(part["member"], part["family"])) for part in parts]


def _part(best: float = OMIT, family: str = OMIT, member: str = OMIT) -> Apart:
    return made(Apart, member=member, best=best, family=family, **REST)


def family(run: Run, k: int) -> str:
    """The principle by which a search searched; that of a portfolio's leading member is taken as given."""
    method, result = run.methods[k], run.claims["results"][k]
    options = run.campaign.stages.search[run.searches.index(k)].options
    if result.get("apart"):
        lowest = min(part["best"] for part in result["apart"])
        tied = [method.apart.get(p["member"], p["family"]) for p in result["apart"] if p["best"] == lowest]
        return str(result["family"] if result.get("family") in tied else tied[0])
    if result.get("members"):
        return str(result.get("family") or method.name)
    return _chosen(method, options) or method.name


def _chosen(method: MethodEntry, options: Any) -> str:
    """The family of a method with these options."""
    chosen: list[str] = [
        by.get(str(options.get(name, _usual(method, name))), "") for name, by in method.families.items()
    ]
    return next(filter(None, chosen), method.family)


def _usual(method: MethodEntry, option: str) -> Any:
    return method.options.get("properties", {}).get(option, {}).get("default")
