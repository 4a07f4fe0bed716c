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
    findings, came, by = run.claims["findings"], dict[int, bool](), set[tuple[str, str]]()
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
            by.add((family(run, k), _sharing(run, k, None)))
        for part, basin in zip(parts, row.get("apart") or [], strict=True):
            reached = part["evaluations"] >= least and part["best"] - worst <= within and basin in labels
            if came[k] and reached and not _started(run, k, basin):
                by.add((run.methods[k].apart.get(part["member"], part["family"]), _sharing(run, k, part["member"])))
    globally = [came[k] for k in run.searches if run.methods[k].kind == "global"]
    several = any(_independent(*pair) for pair in combinations(by, limits.METHODS))
    return bool(globally) and all(globally) and several and (not run.varies or worst < run.nominal)


def _independent(a: tuple[str, str], b: tuple[str, str]) -> bool:
    """Whether families differ, and not only the members that led two searches of a method whose members share."""
    return a[0] != b[0] and (a[1] == "" or a[1] != b[1])


def _sharing(run: Run, k: int, member: str | None) -> str:
    """The method whose members shared what they knew, of a search or of its part that this member led; earlier versions
    let several searches of it confirm each other."""
    of = run.methods[k]
    alone = member in of.apart if member else not (of.apart or run.claims["results"][k].get("members"))
    return "" if alone or run.wording < limits.SHARED else of.name


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
    chosen: list[str] = [
        by.get(str(options.get(name, _usual(method, name))), "") for name, by in method.families.items()
    ]
    return next(filter(None, chosen), method.family or method.name)


def _usual(method: MethodEntry, option: str) -> Any:
    return method.options.get("properties", {}).get(option, {}).get("default")
