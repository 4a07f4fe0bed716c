"""The audit: every claim of a record against what follows from its evaluations, and the verdict against the rules.

Start reading at `audit`; `closing` is the sentence at its end.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from campaigns.asked import extents
from campaigns.asked.check import parameters
from worker.audit.recompute import FLOOR, Recomputed
from worker.audit.record import MISSING, Record, UnreadableError, at

Tree = dict[str, Any]
AT_MOST, SPOT_CHECKS = 200, 200
"""How many stored violations, and how many random evaluations, a run simulates again."""


class Item(NamedTuple):
    """One claim: its path in the record, the value given there, and the recomputed one."""

    name: str
    given: Any
    recomputed: Any

    @property
    def agrees(self) -> bool | None:
        """None where one of the two is not known."""
        if MISSING in (self.given, self.recomputed):
            return None
        if isinstance(self.given, int | float) and isinstance(self.recomputed, int | float):
            return math.isclose(self.given, self.recomputed, rel_tol=1e-9, abs_tol=1e-15)
        return bool(self.given == self.recomputed)


def audit(record: Record, at_most: int = AT_MOST, spot_checks: int = SPOT_CHECKS) -> list[Item]:
    """Every claim with what was recomputed of it; raises `UnreadableError` for a record that has another shape."""
    try:
        return list(_compared("", *_claimed(Recomputed(record), at_most, spot_checks)))
    except (TypeError, ValueError, KeyError, IndexError, AttributeError) as error:
        raise UnreadableError(f"the record has not the shape of a run's: {type(error).__name__}: {error}") from None


def closing(items: Sequence[Item]) -> tuple[bool, str]:
    """Whether the verdict follows, and the sentence that says so."""
    wrong = [item.name for item in items if item.agrees is False]
    unknown = sum(item.agrees is None for item in items)
    left = f"; {unknown} of {len(items)} items could not be audited" if unknown else ""
    if wrong:
        return False, f"the verdict does not follow from what the run stored: {', '.join(wrong)} disagree{left}"
    if any(item.agrees is None for item in items if item.name == "verdict"):
        return False, f"it is not known whether the verdict follows{left}"
    return True, f"the verdict follows from the stored evaluations{left}"


def every(*flags: Any) -> Any:
    """Whether all hold; `MISSING` where that depends on one that is not known."""
    return False if False in flags else MISSING if MISSING in flags else True


def _compared(name: str, given: Any, recomputed: Any) -> Iterator[Item]:
    if isinstance(recomputed, dict) and isinstance(given, dict) and not name.endswith("at_bounds"):
        for key, value in recomputed.items():
            yield from _compared(f"{name}.{key}".lstrip("."), at(given, key), value)
    elif isinstance(recomputed, list) and isinstance(given, list):
        yield Item(f"{name}.count", len(given), len(recomputed))
        for k, value in enumerate(recomputed[: len(given)]):
            yield from _compared(f"{name}.{k}", given[k], value)
    else:
        yield Item(name, given, recomputed)


def _claimed(run: Recomputed, at_most: int, spot_checks: int) -> tuple[Tree, Tree]:
    """The claims, and the same as they should be."""
    claims, sample, given = run.claims, run.statistics(), at(run.claims, "results", len(run.plan) - 1)
    checks, findings, violating = _checks(run, given, sample), claims["findings"], run.total["violating"]
    rows = [{"kind": s.kind, "method": s.method, "best": run.best(k)} | run.rows[k] for k, s in enumerate(run.plan)]
    best = {k: run.best(k) for k in run.searches if run.best(k) is not None}
    method = run.plan[min(best, key=lambda k: best[k] or 0.0)].method if best else None
    worst = {"cost": run.lowest, "margin": run.margin(run.lowest), "method": method}
    cases = [{"name": "nominal", "cost": run.nominal} | run.case(at(given, "cases", 0))]
    cases += [{"name": f["label"], "cost": f["cost"]} | run.case(at(f, "validation")) for f in findings]
    below = [int(np.count_nonzero(costs <= run.threshold)) for costs in run.costs]
    stages = [{"position": k, "count": n} for k, n in enumerate(below) if n]
    spread = {"evaluations": len(run.all), "lowest": run.lowest, "highest": run.highest}
    violations = {"stored": violating, "by_stage": stages, "checked": min(violating, at_most)}
    validation = {"cases": cases, "ok": every(*(case["ok"] for case in cases)), "violations": violations}
    validation |= {"spot_checks": {"checked": min(spot_checks, len(run.all))}, "encounter": {"spread": spread}}
    said, expected = _sentence(run, sample)
    told: Tree = {
        "digests": dict.fromkeys(claims["digests"], run.campaign.digest),
        "sound": True,
        "stages": rows,
        "evaluations": run.total | {"lowest": run.lowest},
        "nominal": run.result(0),
        "worst": worst if len(run.all) else None,
        "findings": [{"label": f"F{k}"} | run.finding(f) for k, f in enumerate(findings, 1)],
        "results": [run.result(k) for k in range(len(run.plan) - 1)] + [validation],
        "comparison": [rows[k] | {"kind": run.method(k, "kind"), "position": k} for k in run.searches],
        "statistics": sample and {k: v for k, v in sample.items() if k in (claims["statistics"] or ())},
        "checks": checks,
        "sentence": expected,
        "verdict": _verdict(run, checks),
    }
    if "run" in claims:
        told["run"] = {"threshold": run.threshold, "nominal_cost": run.nominal, "worst_cost": run.lowest}
        told["run"] |= {"evaluations": run.total["stored"], "failed_evaluations": run.total["failed"]}
        told["run"] |= {"worst_method": method, "upper_bound": sample and sample["upper_bound"]}
        told["run"]["summary"] = {"verdict": told["verdict"]}
        told["components"] = at(claims, "components stored")
    listed = {check["name"]: check["ok"] for check in claims["checks"]}
    return claims | {"sound": run.sound, "checks": listed, "sentence": said}, told


def _sentence(run: Recomputed, sample: Tree | None) -> tuple[Any, Tree]:
    """The counts and values that the sentence states, as text, and those that it must state; None where it has none."""
    text, said, total = run.claims["reason"], run.claims["verdict"], run.total
    text = text.replace("\u202f", "").replace("\u2212", "-").replace("), ", ") and ")
    opening = {"cleared": "stayed above", "violated": "falls to or below"}.get(said, "Nothing may")
    opening = opening if len(run.all) else "No flight"
    shown, limit = (None, None) if said == "inconclusive" else (sample, f"{run.threshold:.6g}")
    excluded, violating = total["excluded"] if said == "cleared" else 0, total["violating"]
    bound = shown and shown["upper_bound"]
    spent: dict[Any, int] = {}
    for k in run.searches:
        spent[run.method(k, "title")] = spent.get(run.method(k, "title"), 0) + run.rows[k]["evaluations"]
    rules = {
        "opening": ("(stayed above|falls to or below|^Nothing may|^No flight)", opening),
        "threshold": (r"(?:stayed above|falls to or below) (\S+)", limit),
        "in all": (r"(\d+) evaluations, searched", str(total["succeeded" if said == "cleared" else "stored"])),
        "methods": (r"searched by (.+? \(\d+\))\.", " and ".join(f"{title} ({n})" for title, n in spent.items())),
        "worst": (r"worst case found has .+? = (\S+) ", f"{run.lowest or 0.0:.6g}"),
        "margin": (r"worst case found .+? a margin of (\S+) ", f"{(run.lowest or 0.0) - run.threshold:+.6g}"),
        "excluded": (r"(\d+) more were excluded", str(excluded) if excluded else None),
        "violating": (r"(\d+) stored evaluations? violates? the", str(violating) if violating else None),
        "drawn": (r"(\d+ of \d+) flights drawn", shown and f"{shown['violations']} of {shown['samples']}"),
        "bound": (r"P\(violation\) is at most (\S+) %", f"{100 * bound:.3g}" if isinstance(bound, float) else bound),
    }
    if not len(run.all):
        rules = {"opening": rules["opening"]}
    found = {name: re.search(pattern, text) for name, (pattern, _) in rules.items()}
    given: Any = {name: match and match[1] for name, match in found.items()}
    if "evaluations" not in run.claims and not given.get("methods"):
        given = {"opening": given["opening"]}  # as earlier versions worded it
    return given, {name: value for name, (_, value) in rules.items()}


def _checks(run: Recomputed, given: Any, sample: Tree | None) -> Tree:
    """Every check that the rules ask for, by name; `given` is the result of the validate stage."""
    findings = run.claims["findings"]
    checked, compared, beyond = (at(given, "spot_checks", name) for name in ("checked", "compared", "violating"))
    spot = MISSING if MISSING in (checked, compared, beyond) else beyond == 0 and (compared > 0 or checked == 0)
    cases = [run.case(at(given, "cases", 0)), *(run.case(at(f, "validation")) for f in findings)]
    ended = [at(stage, "state") in (MISSING, "done") for stage in run.claims["stages"]]
    found: Tree = {
        "nominal": run.nominal is not None and run.nominal > run.threshold,
        "search": every(*ended, *(run.best(k) is not None for k in run.searches)),
        "no violation": run.lowest is not None and run.lowest > run.threshold,
        "minimum": every(bool(findings) and findings[0]["cost"] <= run.lowest, at(given, "findings", "complete")),
        "agreement": _agreement(run, [f for f in findings if at(f, "validation", "realisation") in (None, MISSING)]),
        "validation": every(spot, *(case["ok"] for case in cases)),
        "evaluations": run.total["failed"] == 0,
    }
    return found | _encounter(run, at(given, "encounter")) | _distances(run) | _probability(run, sample)


def _agreement(run: Recomputed, stated: Sequence[Tree]) -> Any:
    """Two methods that searched came to the place and the cost of the worst case, every global one among them."""
    worst = min([f["cost"] for f in stated or run.claims["findings"]], default=None)
    kinds, counted = {k: run.method(k, "kind") for k in run.searches}, {}
    if MISSING in kinds.values() or worst is None or run.nominal is None or "global" not in kinds.values():
        return MISSING if MISSING in kinds.values() else False
    within = max(min(run.campaign.agreement, 0.2) * (run.nominal - worst), 1e-9 * max(abs(worst), 1.0))
    for k, kind in kinds.items():
        spent, best = len(run.columns[k].status), run.best(k)
        basin = at(run.claims, "comparison", run.searches.index(k), "basin")
        searched = spent >= len(run.bounds) * (25 if kind == "global" else 3)
        ended = kind == "global" or (kind == "local" and spent < run.plan[k].planned)
        place = basin if basin is MISSING else basin in {f["label"] for f in run.claims["findings"]}
        counted[k] = every(searched, ended, best is not None and best - worst <= within, place)
    reached = {run.plan[k].method: flag for k, flag in counted.items() if flag is not False}
    globally = [counted[k] for k, kind in kinds.items() if kind == "global"]
    return every(*globally, *reached.values(), len(reached) > 1, not run.varies or worst < run.nominal)


def _encounter(run: Recomputed, given: Any) -> Tree:
    """The conditions of the encounter by the values that are stored of it; what is intended holds."""
    nominal: Any = run.nominal
    closest, moved, unseen = at(given, "closest"), at(given, "moved"), at(given, "unseen", "cost")
    found: Tree = {"motion": moved, "avoidance": unseen, "influence": run.varies}
    if run.of in ("obstacles", MISSING):
        unknown = MISSING in (run.of, closest)
        found["closest approach"] = MISSING if unknown else every(*(at(c, "at") == "inside" for c in closest))
    if moved is not MISSING:
        found["motion"] = None not in (moved, nominal) and moved > 0.01 * abs(nominal)
    if unseen is not MISSING:
        least = FLOOR * max(abs(nominal or 0.0), abs(unseen or 0.0))
        found["avoidance"] = None not in (unseen, nominal) and nominal - unseen > least
    intended = {name.replace("_", " ") for name in run.campaign.encounter.intended}
    return {name: True if name in intended else holds for name, holds in found.items()}


def _distances(run: Recomputed) -> Tree:
    """A distance to centres whose threshold is within an obstacle never clears, unless the author states it."""
    criterion = run.campaign.criterion
    entry = run.components.component("criterion", criterion.component) if run.components else None
    if run.components is None or entry is None or entry.measured_to != "centre" or criterion.from_centre:
        return {}
    known = parameters(run.campaign, run.components)
    return {"distances": False} if extents.within(run.campaign, run.components, known) else {}


def _probability(run: Recomputed, sample: Tree | None) -> Tree:
    """The conditions under which a probability may be claimed."""
    asked, target, total, found = run.campaign.scenario.realisations, run.campaign.target_probability, run.total, {}
    noise, bound = (sample["noise"], sample["upper_bound"]) if sample else ("stated", 1.0)
    if run.random is not False:
        drawn = noise if noise is MISSING else noise == "drawn" and not (asked.combine == "mean" and asked.seeds[1:])
        found["noise"] = every(drawn, run.random)
    if total["excluded"]:
        fractions = (sample["excluded_fraction"] if sample else 0.0, total["excluded"] / total["stored"])
        found["exclusions"] = max(fractions) <= 0.1
    met = bound if bound is MISSING else bound <= (target or 0.05)
    if target is not None:
        found["target"] = every(met, noise if noise is MISSING else noise != "stated")
    elif sample is not None:
        found["probability"] = met
    return found


def _verdict(run: Recomputed, checks: Tree) -> Any:
    findings = [run.finding(f) for f in run.claims["findings"]]
    confirmed = [f["validation"]["violates"] for f in findings if f["cost"] is not None and f["margin"] <= 0.0]
    if True in confirmed or MISSING in confirmed:
        return "violated" if True in confirmed else MISSING
    held = every(*checks.values())
    return held if held is MISSING else "cleared" if held else "inconclusive"
