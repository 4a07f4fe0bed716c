"""Sentences on the findings of an earlier run on this model: which were evaluated, and why others were not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from campaigns.asked.scenario import Repeats
from campaigns.claims.numbers import digits_of, interval, written
from campaigns.claims.say import Part, amount, count, joined, say
from campaigns.claims.spans import Spans


class Case(NamedTuple):
    """One finding; reason: why it was not evaluated, or has no value; assumed: its parameters that the
    earlier run did not vary."""

    label: str
    evaluated: bool
    has_value: bool
    reason: str
    assumed: Sequence[str]


def evaluated(
    run: str, cases: Sequence[Case], thresholds: tuple[float, float], unit: str, moved: Mapping[str, str] | None = None
) -> Spans:
    """thresholds: of that run, and of this one; moved: listed parts of which evaluated cases have values, and which are
    at another index here."""
    known = [case for case in cases if case.has_value]
    clauses: list[Part] = [
        say(count(len(known), "known"), " of ", amount(len(cases), "finding", "cases"), f" of {run} evaluated")
    ]
    clauses += [
        f"{case.label} {'has no value' if case.evaluated else 'was not evaluated'}: {case.reason}"
        for case in cases
        if not case.has_value
    ]
    clauses += [
        f"{', '.join(case.assumed)} of {case.label} {'is' if len(case.assumed) == 1 else 'are'} as in {run}, "
        f"which did not vary {'it' if len(case.assumed) == 1 else 'them'}"
        for case in known
        if case.assumed
    ]
    clauses += [other_index(there, run, here) for there, here in (moved or {}).items()]
    before, now = thresholds
    if before != now:
        there, here = (written(limit, unit, digits=digits_of(limit)) for limit in thresholds)
        clauses.append(f"the threshold of {run} was {there}, here it is {here}")
    return joined("; ", clauses)


def no_parameter(path: str) -> str:
    """The campaign lacks a parameter."""
    return f"there is no parameter {path}"


def other_index(there: str, run: str, here: str) -> str:
    """A listed part is at another index."""
    return f"{there} of {run} is {here} here"


def unidentified(part: str, run: str, component: str) -> str:
    """None of the listed parts is the part of the earlier run, or several may be; component: empty if not stored."""
    what = component or "its component is not stored"
    return f"{part} of {run} ({what}) cannot be identified with one part of this campaign"


def renumbered(there: str, run: str) -> str:
    """Its noise is another realisation, which is drawn by the number of the part."""
    return (
        f"the parts with noise are listed in another order, so that the noise of {there} of {run} is another one here"
    )


def certain(path: str, value: float, now: float) -> str:
    """A parameter has another value, and is not varied."""
    return f"{path} = {value:.9g} is no longer uncertain: it is {now:.9g}"


def outside(path: str, value: float, low: float, high: float) -> str:
    """A value is outside the bounds."""
    return f"{path} = {value:.9g} is outside the bounds {interval(low, high)} of this campaign"


def shorter(horizon: float, time: float | None, before: float) -> str:
    """The flights end before those of the baseline, or before the case's closest approach."""
    when = f"its closest approach is at {time:.9g} s" if time is not None else f"they lasted {before:.9g} s there"
    return f"flights last {horizon:.9g} s here, and {when}"


def other_noise(seeds: Sequence[int]) -> str:
    """Noise seeds of the baseline are not simulated, or are averaged."""
    those = f"seed {seeds[0]}" if len(seeds) == 1 else f"seeds {', '.join(map(str, seeds))}"
    return f"it was evaluated with the noise {those}, which this campaign does not simulate or averages"


def not_random(seed: int) -> str:
    """A noise seed has no effect."""
    return f"it drew the noise seed {seed}, but this campaign has no noise"


def unknown(path: str, run: str) -> str:
    """The earlier run did not vary a parameter, and its value there is not stored, or it had no such parameter."""
    return f"the value of {path} in {run} is not known"


def other_seed(path: str, value: float, now: float) -> str:
    """A seed is fixed in both at different values."""
    return f"{path} is {now:.9g} here and was {value:.9g}, which is another realisation of the noise"


def unknown_calls(run: str) -> str:
    """The calls of an evaluation there are not stored."""
    return f"how many calls an evaluation of {run} was is not known"


def other_calls(before: Repeats, now: Repeats) -> str:
    """An evaluation is fewer calls than there, or they are combined so that a rare violation does not count."""
    then, here = (_calls(each) for each in (before, now))
    return f"its evaluation was {then}; here it is {here}, which may not show what that did"


def _calls(each: Repeats) -> str:
    by = each.combine if each.quantile is None else f"{each.combine} {each.quantile:.9g}"
    return f"{each.count} call{'' if each.count == 1 else 's'}, combined by {by}"
