"""Probability of what: the statement of the independent sample, and the checks of the conditions under which it holds.

Start reading at `probability`.
"""

from __future__ import annotations

from campaigns.claims.codes import CheckCode
from campaigns.claims.say import count, listed, percent, say
from campaigns.results.verdict import Check, Statistics
from worker.problem.problem import Problem
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
        said=sample.said,
    )


def probability(problem: Problem, evidence: Evidence) -> list[Check]:
    """The checks: the noise, what was excluded, and the bound."""
    return [*_noise(problem, evidence), *_excluded(evidence), *_bound(problem, evidence)]


def _noise(problem: Problem, evidence: Evidence) -> list[Check]:
    realised, code = problem.realisations, CheckCode.NOISE
    if not realised.random:
        return []
    seeds = listed([str(seed) for seed in realised.seeds])
    if realised.several and realised.combine == "mean":
        said = say(
            "every evaluation is the mean over noise realisations, in which a violation of one of them disappears; "
            "combine them by worst"
        )
        return [Check(code=code, ok=False, said=said)]
    sample = evidence.sample
    if sample is None or sample.noise != "drawn":
        said = say(
            *("the scenario has noise and only the realisations with seeds ", seeds, " were simulated; add a certify "),
            "stage, which draws a realisation with every flight",
        )
        return [Check(code=code, ok=False, said=said)]
    drew = "; the sample drew one with every flight"
    return [
        Check(code=code, ok=True, said=say("the searches simulated the noise realisations with seeds ", seeds, drew))
    ]


def _excluded(evidence: Evidence) -> list[Check]:
    drawn = 0.0 if evidence.sample is None else evidence.sample.excluded_fraction
    flown = evidence.excluded / max(evidence.evaluations, 1)
    if not evidence.excluded:
        return []
    much = max(drawn, flown)
    of = "draws of the sample" if drawn >= flown else "evaluations"
    excluded = f" of the {of} start at or below the threshold and were excluded: nothing is known of them"
    said = say(percent(much, name="excluded"), excluded)
    if much > EXCLUDED:
        said = say(said, "; narrow the bounds until at most ", percent(EXCLUDED, 6, "most"), " are")
    return [Check(code=CheckCode.EXCLUSIONS, ok=much <= EXCLUDED, said=said)]


def _bound(problem: Problem, evidence: Evidence) -> list[Check]:
    target, sample = problem.campaign.target_probability, evidence.sample
    goal = percent(target or CEILING, 4, "target")
    if sample is None or sample.upper_bound is None:
        said = say("the target P(violation) of ", goal, " needs an independent sample; add a certify stage")
        return [] if target is None else [Check(code=CheckCode.TARGET, ok=False, said=said)]
    bound = say("the bound of ", percent(sample.upper_bound, name="upper_bound"))
    if target is None:
        ok = sample.upper_bound <= CEILING
        said = say(bound, f" on P(violation) is {'within' if ok else 'above'} the ", goal, " that is needed")
        if not ok:
            more = "; draw more samples than "
            said = say(said, more, count(sample.samples, "samples"), ", or state a target_probability")
        return [Check(code=CheckCode.PROBABILITY, ok=ok, said=said)]
    if problem.realisations.random and sample.noise != "drawn":
        said = say(bound, " holds given stated noise realisations only; add a certify stage")
        return [Check(code=CheckCode.TARGET, ok=False, said=said)]
    ok = sample.upper_bound <= target
    said = say(bound, f" {'meets' if ok else 'does not meet'} the target of ", goal)
    return [Check(code=CheckCode.TARGET, ok=ok, said=said)]
