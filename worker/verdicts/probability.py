"""Probability of what: the statement of the independent sample, and the checks of the conditions under which it holds.

Start reading at `probability`.
"""

from __future__ import annotations

from campaigns.results.verdict import Check, Statistics
from campaigns.wording import count, listed
from worker.systems.problem import Problem
from worker.verdicts.evidence import Evidence

CEILING = 0.05
"""The largest bound on P(violation) that a campaign without a target is cleared with."""
EXCLUDED = 0.1
"""The largest excluded fraction, of the draws or of all evaluations, that a campaign is cleared with."""


def statistics(evidence: Evidence) -> Statistics | None:
    """The statement of the sample, as the verdict keeps it; None without one."""
    sample = evidence.sample
    if sample is None or sample.upper_bound is None:
        return None
    return Statistics(
        samples=sample.samples,
        violations=sample.violations,
        failed=sample.failed,
        excluded=sample.excluded,
        excluded_fraction=sample.excluded_fraction,
        confidence=sample.confidence,
        upper_bound=sample.upper_bound,
        noise=sample.noise,
        quantile=sample.quantile,
        source="search" if evidence.certificate is None else "certify",
        text=sample.text,
    )


def probability(problem: Problem, evidence: Evidence) -> list[Check]:
    """The checks: the noise, what was excluded, and the bound."""
    return [*_noise(problem, evidence), *_excluded(evidence), *_bound(problem, evidence)]


def _noise(problem: Problem, evidence: Evidence) -> list[Check]:
    realised = problem.realisations
    if not realised.random:
        return []
    seeds = listed([str(seed) for seed in realised.seeds])
    if realised.several and realised.combine == "mean":
        text = (
            "every evaluation is the mean over noise realisations, in which a violation of one of them disappears; "
            "combine them by worst"
        )
        return [Check(name="noise", ok=False, text=text)]
    sample = evidence.sample
    if sample is None or sample.noise != "drawn":
        text = (
            f"the scenario has noise and only the realisations with seeds {seeds} were simulated; add a certify stage, "
            "which draws a realisation with every flight"
        )
        return [Check(name="noise", ok=False, text=text)]
    text = f"the searches simulated the noise realisations with seeds {seeds}; the sample drew one with every flight"
    return [Check(name="noise", ok=True, text=text)]


def _excluded(evidence: Evidence) -> list[Check]:
    drawn = 0.0 if evidence.sample is None else evidence.sample.excluded_fraction
    flown = evidence.excluded / max(evidence.evaluations, 1)
    if not evidence.excluded:
        return []
    much = max(drawn, flown)
    of = "draws of the sample" if drawn >= flown else "evaluations"
    text = f"{100 * much:.3g} % of the {of} start at or below the threshold and were excluded: nothing is known of them"
    if much > EXCLUDED:
        text += f"; narrow the bounds until at most {100 * EXCLUDED:g} % are"
    return [Check(name="exclusions", ok=much <= EXCLUDED, text=text)]


def _bound(problem: Problem, evidence: Evidence) -> list[Check]:
    target, sample = problem.campaign.target_probability, evidence.sample
    goal = f"{100 * (target or CEILING):.4g} %"
    if sample is None or sample.upper_bound is None:
        text = f"the target P(violation) of {goal} needs an independent sample; add a certify stage"
        return [] if target is None else [Check(name="target", ok=False, text=text)]
    bound = f"{100 * sample.upper_bound:.3g} %"
    if target is None:
        ok = sample.upper_bound <= CEILING
        text = f"the bound of {bound} on P(violation) is {'within' if ok else 'above'} the {goal} that is needed"
        help_ = f"; draw more samples than {count(sample.samples)}, or state a target_probability"
        return [Check(name="probability", ok=ok, text=text if ok else text + help_)]
    if problem.realisations.random and sample.noise != "drawn":
        text = f"the bound of {bound} holds given stated noise realisations only; add a certify stage"
        return [Check(name="target", ok=False, text=text)]
    ok = sample.upper_bound <= target
    return [
        Check(
            name="target", ok=ok, text=f"the bound of {bound} {'meets' if ok else 'does not meet'} the target of {goal}"
        )
    ]
