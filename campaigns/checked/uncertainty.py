"""Validates uncertain parameters against the catalogue: paths, units, bounds, distributions, correlations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from campaigns.asked.distributions import Normal, Triangular, TruncatedNormal, Uncertain, matrix
from campaigns.asked.problem import Problem
from campaigns.asked.spec import Campaign
from campaigns.catalogue import ParameterEntry
from campaigns.checked import texts
from campaigns.claims.numbers import interval

LEAST_PIVOT = 1e-9


def bounded(path: str, uncertain: Uncertain, known: Mapping[str, tuple[ParameterEntry, float]]) -> Iterator[Problem]:
    """Whether the parameter exists, has this unit, and its bounds are within its own limits."""
    field = f"uncertain.{path}"
    if path not in known:
        yield Problem(field, path, f"the scenario has no such parameter; {texts.known(path, known)}")
        return
    entry, nominal = known[path]
    if uncertain.unit is not None and texts.unit(uncertain.unit) != texts.unit(entry.unit):
        yield Problem(f"{field}.unit", uncertain.unit, f"the unit of {path} is {entry.unit or '1 (no unit)'}")
    if nominal != nominal:  # a required value is missing, which is reported elsewhere
        return
    low, high = uncertain.interval(nominal)
    if not low < high:
        yield Problem(
            f"{field}.plus_minus",
            str(uncertain.plus_minus),
            f"around the nominal value {nominal:g} this is an empty interval; give low and high",
        )
        return
    for name, bound in (("low", low), ("high", high)):
        if not entry.low <= bound <= entry.high:
            key = name if uncertain.plus_minus is None else "plus_minus"
            yield Problem(f"{field}.{key}", texts.number(bound), f"{name} bound: {texts.limits(entry)}")
    if not low <= nominal <= high:
        yield Problem(
            field,
            interval(low, high),
            f"the nominal value {nominal:g} is outside the bounds; widen the bounds or change the nominal value",
        )
    yield from distributed(field, uncertain, low, high)


def distributed(field: str, uncertain: Uncertain, low: float, high: float) -> Iterator[Problem]:
    """Whether the middle of the distribution is within these bounds."""
    distribution = uncertain.distribution
    middle = {"mode": distribution.mode} if isinstance(distribution, Triangular) else {}
    if isinstance(distribution, Normal | TruncatedNormal):
        middle = {"mean": distribution.mean}
    for name, value in middle.items():
        if not texts.within(value, low, high):
            yield Problem(f"{field}.distribution.{name}", texts.number(value), f"must be within {interval(low, high)}")


def correlated(campaign: Campaign) -> Iterator[Problem]:
    """Whether the correlations are of uncertain parameters, each pair once, and are consistent with each other."""
    seen: dict[frozenset[str], int] = {}
    found = False
    for i, correlation in enumerate(campaign.correlations):
        field, (one, other) = f"correlations.{i}.between", correlation.between
        pair = frozenset(correlation.between)
        for path in correlation.between:
            if path not in campaign.uncertain:
                found = True
                text = f"not an uncertain parameter; {texts.known(path, campaign.uncertain)}"
                yield Problem(field, path, text)
        if one == other:
            found = True
            yield Problem(field, one, "a parameter cannot be correlated with itself; name two different parameters")
        elif pair in seen:
            found = True
            yield Problem(field, f"{one}, {other}", f"this pair is already given as correlations.{seen[pair]}")
        seen.setdefault(pair, i)
    if not found and not positive_definite(matrix(campaign.correlations, list(campaign.uncertain))):
        text = "the correlation matrix is not positive definite; reduce the magnitude of some correlations"
        yield Problem("correlations", f"{len(campaign.correlations)} pairs", text)


def positive_definite(rows: Sequence[Sequence[float]]) -> bool:
    """Whether a Cholesky factorisation has no squared pivot below 1e-9."""
    import numpy as np  # not with this module: clients of a service start without it

    try:
        return bool((np.diagonal(np.linalg.cholesky(rows)) ** 2 >= LEAST_PIVOT).all())
    except np.linalg.LinAlgError:
        return False
