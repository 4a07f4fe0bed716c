"""The checks that the rules of the verdict require, each with whether it holds by what the record stores."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from campaigns.checked import extents, rates
from campaigns.checked.check import parameters
from campaigns.results.base import EXCLUDED
from worker.evidence.audit import limits
from worker.evidence.audit.agreement import agreement
from worker.evidence.audit.recompute import Run


def required_checks(run: Run, agreed: bool) -> dict[str, bool]:
    """Every check that the rules require, by name."""
    results, findings = run.claims["results"], run.claims["findings"]
    spot, system = results[-1]["spot_checks"], "validation" if run.campaign.simulator is None else "repetition"
    ended = all(stage.get("state", "done") == "done" for stage in run.claims["stages"])
    older = run.wording < limits.BESIDE and run.claims["verdict"] != "cleared" and spot["compared"] > 0
    compared = spot["violating"] == 0 and (spot["compared"] == spot["checked"] or older)
    compared = compared and not left_out(run).get("spot_checks")
    checks = {
        "nominal": run.nominal > run.threshold,
        "search": ended and not any(math.isnan(run.best[k]) for k in run.searches),
        "no violation": run.lowest > run.threshold and not run.confirmed,
        "minimum": bool(findings) and findings[0]["cost"] <= run.lowest and results[-1]["findings"]["complete"],
        "agreement": agreement(run),
        system: agreed and compared,
        "evaluations": run.made.failed == 0,
        "influence": run.calls.influence(run.varies, run.highest - run.lowest) and not _never(run),
    }
    checks |= _encounter(run) if run.campaign.simulator is None else {}
    if run.wording >= limits.MEASURED and 0 < run.lowest - run.threshold < run.resolution * (1 - 1e-9):
        checks["resolution"] = False
    checks |= run.calls.checks(run.claimed.noise if run.claimed else "stated", run.flaky)
    intended = {name.replace("_", " ") for name in run.campaign.encounter.intended}  # as stated by the author
    if {"closest approach"} <= intended & checks.keys() and not _permitted(run):
        intended -= {"closest approach"}
    if (results[-1].get("encounter") or {}).get("idle"):
        intended -= {"influence"}
    return {name: holds or name in intended for name, holds in checks.items()} | _probability(run)


def _never(run: Run) -> bool:
    """Whether a fault, or the environment, first changes or has its whole effect after the end of every flight, or
    changes none."""
    encounter, scenario = run.claims["results"][-1].get("encounter") or {}, run.campaign.scenario
    begins, whole = ((encounter.get(name) or {}).values() for name in ("begins", "whole"))
    horizon = math.inf if scenario is None else scenario.horizon
    late = any(first >= horizon for first, _ in begins) or any(first > horizon for first, _ in whole)
    return late or bool(encounter.get("idle"))


def as_stated(run: Run) -> dict[str, bool]:
    """The checks as the record has them, those that no rule here requires included."""
    return {check["name"]: check["ok"] for check in run.claims["checks"]}


def in_order(run: Run) -> tuple[str, str]:
    """The names of the checks as they stand in the record, and each of them once in the order of the rules."""
    stated = [check["name"] for check in run.claims["checks"]]
    coded = [str(check.get("code", check["name"])) for check in run.claims["checks"]]  # by which files name them
    once = sorted(set(stated), key=lambda name: (*limits.ORDER, name).index(name))
    return ", ".join(coded), ", ".join(once)


def left_out(run: Run) -> dict[str, int]:
    """What validation did not confirm because its allowance was used up; runs of earlier versions had none."""
    spent = run.claims["results"][-1].get("spent")
    return {} if spent is None else spent["left_out"]


def _encounter(run: Run) -> dict[str, bool]:
    """The checks of a scenario's encounter, and the one that distances to centres do not hide a vehicle inside."""
    campaign, components, encounter = run.campaign, run.claims["components"], run.claims["results"][-1]["encounter"]
    moved, unseen = (math.nan if c is None else c for c in (encounter["moved"], encounter["unseen"]["cost"]))
    shown = {
        "motion": moved > limits.MOVED * abs(run.nominal),
        "avoidance": run.nominal - unseen > limits.ROUNDING * max(abs(run.nominal), abs(unseen)),
    }
    criterion = components.component("criterion", campaign.criterion.component)
    if near(run):
        shown["closest approach"] = all(at == "inside" for at in _closest(run)) and _over(run)
    if criterion.measured_to == "centre" and not campaign.criterion.from_centre:
        inside = extents.within(campaign, components, parameters(campaign, components))
        shown |= {"distances": False} if inside or (run.wording >= limits.AFTER and _unmeasured(run)) else {}
    if run.wording >= limits.AFTER and near(run) and criterion.measured_to not in ("centre", "surface", "none"):
        shown |= {"distances": False}
    declares = near(run) and criterion.measured_to in ("centre", "surface")
    other_unit = run.wording >= limits.MEASURED and criterion.unit != "m"  # its threshold is compared with lengths
    if declares and (other_unit or encounter.get("mismeasured") is not None):
        shown |= {"distances": False}
    turning, step = rates.turning(campaign, components, parameters(campaign, components)), campaign.given_scenario.step
    shown |= {"sampling": False} if not all(each.rate * step <= limits.TURN for each in turning) else {}
    return shown


def _unmeasured(run: Run) -> bool:
    """Whether an obstacle does not declare how far it extends from its centre."""
    entries = (
        run.claims["components"].component("obstacle", o.component) for o in run.campaign.given_scenario.obstacles
    )
    return any(entry.reach is None for entry in entries)


def near(run: Run) -> bool:
    """Whether the criterion is one of obstacles, which have a closest approach."""
    scenario, components = run.campaign.scenario, run.claims["components"]
    return (
        scenario is not None and components.component("criterion", run.campaign.criterion.component).of == "obstacles"
    )


def _over(run: Run) -> bool:
    """Whether no flight comes closer beyond the horizon than any evaluation, and all that approaches there is known;
    versions before the evidence digest did not look there, nor does a run of which no evaluation has a value."""
    beyond = run.claims["results"][-1]["encounter"].get("beyond")
    if beyond is None:
        return not run.whole or math.isnan(run.lowest)
    low = run.lowest - limits.ROUNDING * max(abs(run.lowest), abs(run.threshold))
    if run.wording >= limits.AFTER and not _counted(beyond):
        return False
    if run.wording >= limits.WIDER and not isinstance(beyond.get("not_continued"), int):
        return False
    above = beyond["lowest"] is None or beyond["lowest"]["value"] >= low
    return not beyond["closer"] and above and beyond.get("unknown") is None


def _counted(beyond: Any) -> bool:
    """Whether the flights that fail after the horizon are counted; versions before counted nothing of what those meet
    until then."""
    failed = beyond.get("cut_short")
    return isinstance(failed, int) and 0 <= failed <= beyond["flights"]


def _closest(run: Run) -> list[str]:
    """When the closest approaches of the nominal case and the findings were. None is known of a nominal case without a
    value, of which versions before stated that of what was simulated until it failed."""
    of_nominal = run.claims["results"][-1]["encounter"]["closest"]["at"]
    known = run.wording < limits.AFTER or not math.isnan(run.nominal)
    return [of_nominal if known else "none", *(f["closest"]["at"] for f in run.claims["findings"])]


def _permitted(run: Run) -> bool:
    """Whether the author may state that the closest approach is as intended: at the start or at the end of the horizon,
    with nothing at or below the threshold beyond it."""
    beyond = run.claims["results"][-1]["encounter"].get("beyond")
    if beyond is None:
        return not run.whole or math.isnan(run.lowest)
    if run.wording >= limits.AFTER and not _counted(beyond):
        return False
    unknown = beyond.get("unknown") is not None or any(at not in ("start", "inside", "end") for at in _closest(run))
    return not unknown and (beyond["lowest"] is None or beyond["lowest"]["value"] > run.threshold)


def _probability(run: Run) -> dict[str, bool]:
    campaign, sample, checks = run.campaign, run.claimed, dict[str, bool]()
    noise, bound = (sample.noise, run.bound) if sample else ("stated", 1.0)
    excluded = run.made.excluded / max(run.made.evaluations, 1)
    if excluded and run.wording >= limits.EACH:
        searched = [run.rows(k)[2] == EXCLUDED for k in run.searches]
        excluded = max([excluded, *(float(np.mean(one)) for one in searched if len(one))])
    if run.fixed_seeds or run.undeclared:
        checks["noise"] = False
    elif run.random:
        realisations = campaign.given_scenario.realisations
        checks["noise"] = noise == "drawn" and not (realisations.combine == "mean" and len(realisations.seeds) > 1)
    if excluded:
        checks["exclusions"] = max(sample.excluded_fraction if sample else 0.0, excluded) <= limits.EXCLUDED
    checks["sample"] = _sampled(run)
    if run.outside():
        checks["outside the bounds"] = run.outside() <= limits.CEILING
    if campaign.target_probability is not None:
        checks["target"] = bound <= min(campaign.target_probability, limits.CEILING) and noise != "stated"
    elif sample is not None:
        checks["probability"] = bound <= limits.CEILING
    return checks


def _sampled(run: Run) -> bool:
    """Whether the certify stage drew enough, with a seed that nobody chose."""
    drawn = [k for k in run.certifying if run.claims["results"][k].get("drawn_at_launch") is True]
    return any(run.samples[k].samples >= limits.SAMPLE for k in drawn)
