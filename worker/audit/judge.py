"""The audit: every claim of a record against what follows from its evaluations, and the verdict against the rules.

Start reading at `audit`; `closing` is the sentence at its end.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from pydantic import TypeAdapter

from campaigns.catalogue import ComponentEntry
from campaigns.checked import extents
from campaigns.checked.check import parameters, seeded
from campaigns.claims import earlier
from campaigns.claims.numbers import count
from campaigns.claims.say import listed
from campaigns.claims.spans import Quantity, Said, words
from campaigns.results.base import OK, STATUS
from campaigns.results.verdict import SCOPE
from worker.audit.recompute import FLOOR, Run, Tree
from worker.audit.record import MISSING, Record, UnreadableError

AT_MOST, SPOT_CHECKS = 200, 200
"""How many stored violations, and how many random evaluations, a run simulates again."""

SAID: TypeAdapter[Said] = TypeAdapter(Said)


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
        run = Run(record)
        given = run.claims | {"sound": True, "checks": {c["name"]: c["ok"] for c in run.claims["checks"]}}
        try:
            run.describe()
            given["sentence"], said = _sentence(run)
            expected = _stored(run) | {"sentence": said} | _concluded(run, at_most, spot_checks)
        except (KeyError, TypeError):  # with a result or the catalogue absent or null, only a violation follows
            unknown = dict.fromkeys(("results", "comparison", "statistics", "sentence"), MISSING)
            expected = _stored(run) | unknown | {"checks": dict.fromkeys(given["checks"], MISSING)}
    except (TypeError, ValueError, KeyError, IndexError, AttributeError) as error:
        raise UnreadableError(f"the record has not the shape of a run's: {type(error).__name__}: {error}") from None
    return [*(Item(name, *pair) for name, pair in record.twice.items()), *_compared("", given, expected)]


def closing(items: Sequence[Item]) -> tuple[bool, str]:
    """Whether the verdict follows, and the sentence that says so."""
    wrong, unknown = ([item.name for item in items if item.agrees is flag] for flag in (False, None))
    left = f"; {len(unknown)} of {len(items)} items could not be audited" if unknown else ""
    if wrong:
        return False, f"the verdict does not follow from what the run stored: {', '.join(wrong)} disagree{left}"
    if "verdict" in unknown:
        return False, f"it is not known whether the verdict follows{left}"
    return True, f"the verdict follows from the stored evaluations{left}"


def _compared(name: str, given: Any, expected: Any) -> Iterator[Item]:
    if isinstance(expected, dict) and isinstance(given, dict) and not name.endswith("at_bounds"):
        for key, value in expected.items():
            yield from _compared(f"{name}.{key}".lstrip("."), given.get(key, MISSING), value)
    elif isinstance(expected, list) and isinstance(given, list):
        yield Item(f"{name}.count", len(given), len(expected))
        for k, pair in enumerate(zip(given, expected, strict=False)):
            yield from _compared(f"{name}.{k}", *pair)
    else:
        yield Item(name, given, None if expected != expected else expected)  # NaN: there is no such cost


def _stored(run: Run) -> Tree:
    """What the record must claim by its evaluations and findings alone."""
    searched = [k for k in run.searches if not math.isnan(run.best[k])]
    method = run.plan[min(searched, key=run.best.__getitem__)].method if searched else None
    worst = {"cost": run.lowest, "margin": run.lowest - run.threshold, "method": method}
    evaluations = {"stored": len(run.status), "succeeded": len(run.costs), "violating": sum(run.below)}
    stages = zip(run.plan, run.best, run.ended, strict=True)
    told: Tree = {
        "sound": bool((((run.status == OK) == np.isfinite(run.raw)) & (run.status < len(STATUS))).all()),
        "stages": [{"kind": s.kind, "method": s.method, "best": best} | ended for s, best, ended in stages],
        "evaluations": evaluations | {k: run.total[k] for k in ("failed", "excluded")} | {"lowest": run.lowest},
        "nominal": {"cost": run.nominal, "margin": run.nominal - run.threshold},
        "worst": worst if len(run.costs) else None,
        "findings": run.findings,
        "verdict": "violated" if run.confirmed else MISSING,
    }
    if "run" in run.claims:  # the columns of the database's table of runs
        told["run"] = {"threshold": run.threshold, "nominal_cost": run.nominal, "worst_cost": run.lowest}
        told["run"] |= {"evaluations": len(run.status), "failed_evaluations": run.total["failed"]}
        told["run"] |= {"worst_method": method, "upper_bound": run.bound}
    return told


def _concluded(run: Run, at_most: int, spot_checks: int) -> Tree:
    """What the record must claim by the results of the stages and the catalogue besides."""
    nominal = {"name": "nominal", "cost": run.nominal} | run.case(run.claims["results"][-1]["nominal"])
    agreed = bool(nominal["ok"]) and all(f["validation"]["ok"] for f in run.findings)
    below = [{"position": k, "count": n} for k, n in enumerate(run.below) if n]
    violations = {"stored": sum(run.below), "by_stage": below, "checked": min(sum(run.below), at_most)}
    spread = {"evaluations": len(run.costs), "lowest": run.lowest, "highest": run.highest}
    last: Tree = {"nominal": nominal, "ok": agreed, "violations": violations}
    last |= {"spot_checks": {"checked": min(spot_checks, len(run.costs))}, "encounter": {"spread": spread}}
    results: list[Tree] = [{"sample": run.samples[k]} if k in run.samples else {} for k in range(len(run.plan) - 1)]
    for k in run.searches:
        spent = run.ended[k]["evaluations"] >= run.plan[k].planned
        results[k] = run.ended[k] | {"sample": run.samples.get(k), "stop": {"kind": "budget" if spent else "rule"}}
    rows = [{"position": k, "kind": run.methods[k].kind, "best": run.best[k]} | run.ended[k] for k in run.searches]
    known = {finding["label"] for finding in run.findings}
    for row, given in zip(rows, run.claims["comparison"], strict=True):
        row["findings"] = [label for label in given["findings"] if label in known]
    checks, beside = _checks(run, agreed), ("outside", "lowest", "mean")
    sample = run.claimed and {k: v for k, v in run.claimed.items() if k not in beside}
    told: Tree = {"results": [*results, last], "comparison": rows, "checks": checks, "statistics": sample}
    if not run.confirmed:
        told["verdict"] = "cleared" if all(checks.values()) else "inconclusive"
    return told


def _checks(run: Run, agreed: bool) -> dict[str, bool]:
    """Every check that the rules ask for, by name; what the author states to be intended holds."""
    campaign, sample, threshold = run.campaign, run.claimed, run.threshold
    results, components, findings = run.claims["results"], run.claims["components"], run.claims["findings"]
    spot, nominal = results[-1]["spot_checks"], run.nominal
    ended = all(stage.get("state", "done") == "done" for stage in run.claims["stages"])
    compared = spot["violating"] == 0 and (spot["compared"] > 0 or spot["checked"] == 0)
    shown = {"influence": run.varies} | (_encounter(run) if campaign.simulator is None else {})
    told = {name: holds or name.replace(" ", "_") in campaign.encounter.intended for name, holds in shown.items()}
    told |= {
        "nominal": nominal > threshold,
        "search": ended and not any(math.isnan(run.best[k]) for k in run.searches),
        "no violation": run.lowest > threshold,
        "minimum": bool(findings) and findings[0]["cost"] <= run.lowest and results[-1]["findings"]["complete"],
        "agreement": _agreement(run),
        "validation" if campaign.simulator is None else "repetition": agreed and compared,
        "evaluations": run.total["failed"] == 0,
    }
    centre = campaign.simulator is None and _deciding(run).measured_to == "centre"
    stated = campaign.criterion.from_centre
    if centre and not stated and extents.within(campaign, components, parameters(campaign, components)):
        told["distances"] = False
    noise, bound = (sample["noise"], sample["upper_bound"]) if sample else ("stated", 1.0)
    excluded = run.total["excluded"] / max(len(run.status), 1)
    if seeded(campaign, components):
        asked = campaign.given_scenario.realisations
        told["noise"] = noise == "drawn" and not (asked.combine == "mean" and len(asked.seeds) > 1)
    if excluded:
        told["exclusions"] = max(sample["excluded_fraction"] if sample else 0.0, excluded) <= 0.1
    if campaign.target_probability is not None:
        told["target"] = bound <= campaign.target_probability and noise != "stated"
    elif sample is not None:
        told["probability"] = bound <= 0.05
    return told


def _deciding(run: Run) -> ComponentEntry:
    """The criterion of a scenario that decides."""
    known = {c.name: c for c in run.claims["components"].components if c.role == "criterion"}
    found: ComponentEntry = known[run.campaign.criterion.component]
    return found


def _encounter(run: Run) -> dict[str, bool]:
    """What must be shown of the encounter; a simulator shows none of it."""
    encounter, nominal = run.claims["results"][-1]["encounter"], run.nominal
    moved, unseen = (math.nan if c is None else c for c in (encounter["moved"], encounter["unseen"]["cost"]))
    shown = {
        "motion": moved > 0.01 * abs(nominal),
        "avoidance": nominal - unseen > FLOOR * max(abs(nominal), abs(unseen)),
    }
    if _deciding(run).of == "obstacles":
        closest = [encounter["closest"], *(f["closest"] for f in run.claims["findings"])]
        shown["closest approach"] = all(c["at"] == "inside" for c in closest)
    return shown


def _agreement(run: Run) -> bool:
    """Two methods that searched came to the place and the cost of the worst case, every global one among them."""
    findings, ends = run.claims["findings"], {}
    stated = [f["cost"] for f in findings if f["validation"]["realisation"] is None]
    worst = min(stated or [f["cost"] for f in findings], default=math.nan)
    fall = min(run.campaign.agreement, 0.2) * (run.nominal - worst)
    for k, row in zip(run.searches, run.claims["comparison"], strict=True):
        kind, spent = run.methods[k].kind, run.ended[k]["evaluations"]
        least, most = {"global": (25, math.inf), "local": (3, run.plan[k].planned - 1)}.get(kind, (math.inf, 0))
        near = run.best[k] - worst <= max(fall, 1e-9 * max(abs(worst), 1.0))
        there = near and row["basin"] in {f["label"] for f in findings}
        ends[k] = there and least * len(run.bounds) <= spent <= most
    globally = [ends[k] for k in run.searches if run.methods[k].kind == "global"]
    came = {run.plan[k].method for k in run.searches if ends[k]}
    return bool(globally) and all(globally) and len(came) > 1 and (not run.varies or worst < run.nominal)


def _sentence(run: Run) -> tuple[Tree, Tree]:
    """What the sentence states, its numbers by name, and what it must; its words must be those of its spans.

    Of versions that stored words alone the numbers are those in the words, with the digits that are written there.
    """
    claims, verdict, total = run.claims, run.claims["verdict"], run.claims["evaluations"] and run.total
    exact = "said" in claims
    said = SAID.validate_python(claims["said"]) if exact else earlier.verdict(claims["reason"])
    scope = f" {SCOPE}{words(SAID.validate_python(claims['holds_for']))}" if exact else ""
    stated = {span.name: span for span in said if isinstance(span, Quantity) and span.name}
    sample, spent = run.claimed if verdict != "inconclusive" else None, dict[str, int]()
    for k in run.searches:
        spent[run.methods[k].title] = spent.get(run.methods[k].title, 0) + run.ended[k]["evaluations"]
    methods, text = f"{words(listed([f'{title} ({count(n)})' for title, n in spent.items()]))}.", words(said)
    opening = {"cleared": "stayed above", "violated": "falls to or below"}.get(verdict, "Nothing may be claimed")
    one = "flight" if run.campaign.simulator is None else "case"
    opening, begun = opening if len(run.costs) else f"No {one} could be evaluated", text.partition(".")[0]
    must: Tree = {
        "threshold": None if verdict == "inconclusive" else run.threshold,
        "evaluations": len(run.costs if verdict == "cleared" else run.raw),
        "worst": run.lowest,
        "margin": run.lowest - run.threshold,
        "excluded": total["excluded"] or None if verdict == "cleared" else None,
        "violating": sum(run.below) or None,
    } | {name: sample and sample[name] for name in ("violations", "samples", "upper_bound")}

    def written(name: str, value: Any) -> Any:
        span = stated.get(name)
        return value if exact or not span or value is None else words((span.model_copy(update={"value": value}),))

    given: Tree = {"opening": opening if opening in begun else begun, "words": claims["reason"]}
    expected: Tree = {"opening": opening, "words": text + scope if exact else claims["reason"]}
    if len(run.costs):
        given |= {name: written(name, stated[name].value) if name in stated else None for name in must}
        given |= {"methods": text.partition("searched by ")[2][: len(methods)]}
        expected |= {name: written(name, value) for name, value in must.items()} | {"methods": methods}
    texts = {c["name"]: words(SAID.validate_python(c["said"])) for c in claims["checks"] if "said" in c}
    given["checks"] = {c["name"]: c["text"] for c in claims["checks"]}
    return given, expected | {"checks": texts}
