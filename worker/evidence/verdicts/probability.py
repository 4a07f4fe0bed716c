"""The probability of a violation: the statement of the independent sample, and checks of the conditions it needs.

The probability of draws outside the bounds counts with and without a sample: nothing is evaluated there.
"""

from __future__ import annotations

from campaigns import rules
from campaigns.asked.sample_bound import needed
from campaigns.checked.check import unvaried
from campaigns.checked.foreseen import MEAN, one_realisation, undeclared
from campaigns.claims.say import amount, at_most, count, goal, listed, percent, say
from campaigns.claims.say import probability as share
from campaigns.claims.spans import Spans
from campaigns.claims.stages.sample import violate
from campaigns.codes import CheckCode
from campaigns.results.sample import Sample
from campaigns.results.verdict import Check, Statistics
from worker.engine.problem.problem import Problem
from worker.evidence.verdicts.evidence import Evidence, check
from worker.evidence.verdicts.exclusions import exclusions


def statistics(evidence: Evidence) -> Statistics | None:
    """The statement of the sample, as the verdict stores it; None without one."""
    sample = evidence.sample
    if sample is None or sample.upper_bound is None:
        return None
    source = "search" if evidence.certificate is None else "certify"
    return Statistics.model_validate(vars(sample) | {"source": source})


def probability(problem: Problem, evidence: Evidence) -> list[Check]:
    """The checks of the noise, the exclusions, the draws outside the bounds, and the bound."""
    return [
        *_noise(problem, evidence),
        *exclusions(problem, evidence),
        _sampled(evidence),
        *_outside(problem),
        *_bound(problem, evidence),
    ]


def outside(problem: Problem) -> Spans:
    """The probability of draws outside the bounds, as a sentence without its full stop; empty if there are none."""
    much = problem.distributions.outside
    if not much:
        return ()
    bounded = problem.campaign.correlations or much > rules.CEILING.value
    stated = (at_most if bounded else share)(much, name="outside")
    most = "at most " if problem.campaign.correlations else ""
    return say(most, stated, " of the draws lie outside the bounds, where nothing was evaluated")


def _outside(problem: Problem) -> list[Check]:
    stated, most = outside(problem), rules.CEILING.value
    if not stated:
        return []
    ok = problem.distributions.outside <= most
    advice = () if ok else ("; widen the bounds until at most ", percent(most, 6, "most"), " do")
    return [check(CheckCode.OUTSIDE, ok, stated, *advice)]


def _noise(problem: Problem, evidence: Evidence) -> list[Check]:
    realised, code = problem.realisations, CheckCode.NOISE
    if few := unvaried(problem.campaign, {p.path: p.nominal for p in problem.system.parameters}):
        return [check(code, False, one_realisation(problem.campaign, few))]
    if realised.undeclared:
        return [check(code, False, undeclared(realised.undeclared))]
    if not realised.random:
        return []
    seeds = listed([str(seed) for seed in realised.seeds])
    if realised.several and realised.combine == "mean":
        return [check(code, False, MEAN)]
    sample = evidence.sample
    if sample is None or sample.noise != "drawn":
        only = ("only the noise realisations with seeds ", seeds, " were simulated; ")
        return [check(code, False, *only, "add a certify stage, which draws a realisation for every sample")]
    drew = "; the independent sample drew one for every evaluation"
    return [check(code, True, "the searches simulated the noise realisations with seeds ", seeds, drew)]


def _sampled(evidence: Evidence) -> Check:
    """Whether the campaign has an independent sample that is large enough and that no user could choose."""
    certificate, least = evidence.certificate, rules.SAMPLE.value
    if certificate is None:
        lacks = "not sampled: no independent sample was drawn, which would show what every search missed; "
        return check(CheckCode.SAMPLE, False, lacks, "add a certify stage of at least ", count(least, "least"))
    drawn = count(certificate.sample.samples, "samples")
    if certificate.sample.samples < least:
        return check(
            CheckCode.SAMPLE, False, "the independent sample has ", drawn, ", fewer than ", count(least, "least")
        )
    if not certificate.drawn_at_launch:
        stated = " was stated before the run, so a sample without a violation could have been chosen; "
        return check(
            CheckCode.SAMPLE,
            False,
            "the seed of the independent sample",
            stated,
            "run the campaign without a stated seed",
        )
    return check(CheckCode.SAMPLE, True, "an independent sample of ", drawn, " was drawn, with a seed drawn at launch")


def _advice(sample: Sample) -> Spans:
    """Advice on a bound above the ceiling: more samples help only if few of them violate, and few draws lie outside
    the bounds."""
    ceiling, drawn = rules.CEILING.value, amount(sample.samples, "sample", "samples")
    if not sample.samples:
        return say("all of its draws were excluded")
    if sample.violations > ceiling * sample.samples:
        return say(count(sample.violations, "violations"), " of its ", drawn, violate(sample.failed, sample.violations))
    if needed(sample.violations, sample.samples, ceiling - sample.outside, sample.confidence) is None:
        beyond = at_most(sample.outside, name="outside")
        of = (" of the draws lie outside the bounds, which the bound counts ", "whatever the sample; widen the bounds")
        return say("at most ", beyond, *of)
    return say("draw more than ", drawn)


def _bound(problem: Problem, evidence: Evidence) -> list[Check]:
    target, sample = problem.campaign.target_probability, evidence.sample
    required = rules.required(target)
    wanted = goal(required)
    if sample is None or sample.upper_bound is None:
        needs = ("the target P(violation) of ", wanted, " needs an independent sample; add a certify stage")
        return [] if target is None else [check(CheckCode.TARGET, False, *needs)]
    bound = say("the bound of ", at_most(sample.upper_bound, name="upper_bound"))
    if target is None:
        ok = sample.upper_bound <= required
        is_ = (bound, f" on P(violation) is {'within' if ok else 'above'} the required ", wanted)
        return [check(CheckCode.PROBABILITY, ok, *is_, *(() if ok else ("; ", _advice(sample))))]
    if sample.noise == "stated":
        of = "the stated noise realisations" if problem.realisations.random else "evaluations of several calls"
        return [check(CheckCode.TARGET, False, bound, f" holds only for {of}; add a certify stage")]
    ok = sample.upper_bound <= required
    meets = (bound, f" {'meets' if ok else 'does not meet'} the target of ", wanted)
    loose = (
        ("; the target of the campaign, ", goal(target, ""), ", is looser and does not apply")
        if target > required
        else ()
    )
    return [check(CheckCode.TARGET, ok, *meets, *loose)]
