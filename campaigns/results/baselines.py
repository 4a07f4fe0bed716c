"""The baseline of a campaign, made from an earlier run; or why that run cannot be one. Read `with_baseline`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from campaigns.asked.lists import components, prefix_of
from campaigns.asked.load import load_document
from campaigns.asked.problem import CampaignError
from campaigns.asked.spec import Campaign, Criterion, Repeats
from campaigns.results.finding import Finding, Validation


class CannotCompare(ValueError):
    """The run cannot be a baseline; the message states why and what to do."""


def with_baseline(
    campaign: Campaign, run: str, other: Campaign, findings: Sequence[Finding], units: str = "",
    fixed: Mapping[str, float] | None = None,
) -> Campaign:  # fmt: skip
    """The campaign with the findings of the run `run` of the campaign `other` as its baseline.

    units: how those of the two differ, as a clause; fixed: the values of what the other one does not vary, None if they
    are not known (both by `campaigns.checked.units`). Raises `CannotCompare`.
    """
    reason = foreign(campaign, other) or units
    if reason:
        raise CannotCompare(f"{run} cannot be the baseline: {reason}")
    if not findings:
        raise CannotCompare(f"{run} cannot be the baseline: it has no findings to compare with; give another run")
    baseline = {
        "run": run,
        "digest": other.digest,
        "threshold": other.criterion.threshold,
        "cases": [_case(finding, other.criterion.threshold) for finding in findings],
    }
    if other.scenario is not None:
        shown = other.scenario
        baseline |= {"horizon": shown.horizon, "realisations": shown.realisations.model_dump(mode="json")}
    if other.simulator is not None:
        baseline["repeats"] = (other.simulator.repeats or Repeats(count=1)).model_dump(mode="json")
    if fixed is not None:
        baseline["fixed"] = dict(fixed)
        if other.scenario is not None:
            baseline["parts"] = components(other)
    document = {**campaign.document(), "baseline": baseline}
    try:
        return load_document(document, run)
    except CampaignError as error:
        raise CannotCompare(f"{run} cannot be the baseline: {'; '.join(map(str, error.problems))}") from None


def foreign(campaign: Campaign, other: Campaign) -> str:
    """Why runs of two campaigns cannot be compared, as a clause; empty if they can.

    Bounds, fixed parameters, components, methods and the threshold may differ: that is what is compared.
    """
    if (campaign.simulator is None) != (other.simulator is None):
        kinds = ("a scenario", "a simulator") if other.simulator is None else ("a simulator", "a scenario")
        return f"its campaign has {kinds[0]}, this one {kinds[1]}"
    before, here = other.simulator, campaign.simulator
    if before is not None and here is not None and before.name != here.name:
        return f"its simulator is {before.name}, here it is {here.name}"
    then, now = _measured(other.criterion), _measured(campaign.criterion)
    if then != now:
        return f"its criterion is {then}, here it is {now}; a comparison needs the same criterion"
    return "" if _varied(campaign) & _varied(other) else "it varies none of the parameters of this campaign"


def _varied(campaign: Campaign) -> set[str]:
    """What it varies; of listed parts without their index, which may be another part's there."""
    return {_unindexed(path) for path in campaign.uncertain}


def _unindexed(path: str) -> str:
    prefix = prefix_of(path)
    return prefix.partition(".")[0] + path.removeprefix(prefix) if prefix else path


def same_question(campaign: Campaign, other: Campaign) -> bool:
    """Whether a label may select a run of the other campaign: the same name, and comparable."""
    return campaign.name == other.name and not foreign(campaign, other)


def _measured(criterion: Criterion) -> str:
    values = ", ".join(f"{name} {value:.15g}" for name, value in sorted(criterion.parameters.items()))
    return (criterion.result or criterion.component) + (f" ({values})" if values else "")


def _case(finding: Finding, threshold: float) -> dict[str, object]:
    calls = None if finding.validation is None else finding.validation.repeats
    low = [] if calls is None else sorted(value for value in calls.values if value is not None and value <= threshold)
    there = {} if calls is None else {"calls": {"made": len(calls.values), "low": low}}
    called = {"called": finding.granted} if finding.granted <= threshold < finding.cost else {}
    time = {} if finding.closest is None or finding.closest.time is None else {"time": finding.closest.time}
    return (
        called
        | there
        | time
        | {
            "label": finding.label,
            "parameters": finding.parameters,
            "point": finding.point,
            "cost": finding.cost,
            "difference": difference(finding.validation),
            "realisation": finding.realisation,
        }
    )


def difference(case: Validation | None) -> float:
    """The largest difference between the integrations of a case, or between its evaluations; 0 if there is none."""
    if case is None:
        return 0.0
    others = [other for other in (case.half_step, case.integrator, case.again) if other is not None]
    return max((abs(o.difference) for o in others if o.difference is not None), default=0.0)
