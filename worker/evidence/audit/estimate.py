"""Recomputes the estimate of P(violation) from its stored draws and the density that they came from.

The numbers are computed here; the density, the origins of modes and the two alarms of the search for modes come from
the search that the engine repeats over the stored evaluations (`Searched`).
"""

from __future__ import annotations

import math
from statistics import NormalDist
from typing import Any, NamedTuple

import numpy as np

from campaigns.claims.spans import Spans
from campaigns.claims.stages import estimate as templates
from campaigns.results.base import EXCLUDED, OK
from worker.evidence.audit import draw, limits
from worker.evidence.audit.binomial import cumulative
from worker.evidence.audit.recompute import Run, Tree
from worker.evidence.audit.record import Missing

STREAM, SAMPLED = 2**25, 0.06
"""The random stream of the stage, which begins with the independent sample: this fraction of the budget."""
NOMINAL, UNIT, LEAST_SHARE, COVARIANCE = 0.1, 0.15, 0.3, 1.2
"""Of the density: the parts of the nominal one and of unit covariance, the least of an even share, a factor."""
WIDER, LARGEST, FEWEST, CHANCE, MOST = 1.25, 0.2, 30.0, 0.005, 20
TOLERANCE = 1e-4
"""Relative: a point is stored to 1e-16 of a range, of which a tail of probability 1e-12 has four digits."""
ERRORS = 5.0
"""Standard errors by which the mean of the weights may differ from 1."""
UNIFORM = np.vectorize(lambda x: math.erfc(-x / math.sqrt(2.0)) / 2.0, otypes=[float])
QUANTILE = np.vectorize(NormalDist().inv_cdf, otypes=[float])
"""The standard normal distribution function and its inverse."""


class Searched(NamedTuple):
    """The search of an estimate, repeated over its stored evaluations: why it refused, or its density, the stored
    violations that led to each mode, and its alarms."""

    refused: tuple[str, int] | None
    density: Tree
    origins: list[list[dict[str, int]]]
    alarms: dict[str, float]


UNKNOWN = Missing("the search of the estimate was not repeated: another engine made it")


def _again(run: Run, k: int) -> Searched | None:
    """The repeated search that is an estimate; None if it was not repeated, or refused."""
    found = run.searched.get(k)
    return found if isinstance(found, Searched) and found.refused is None else None


def placed(run: Run, k: int) -> Tree:
    """What the stored points must be, and are: the independent sample that follows from the seed, draws whose weights
    have the mean 1, and origins that violate."""
    stated = run.claims["results"][k]
    made = run.searched.get(k, UNKNOWN)
    follows: Tree = {f"search of stage {k}": (1, made if isinstance(made, Missing) else int(made is not None))}
    if stated.get("refused") is not None:
        return {} if run.calls.noisy else follows
    first, count = stated["independent"]["first"], stated["independent"]["count"]
    points, final = run.rows(k)[0], stated["final"]["count"]
    seed = np.random.SeedSequence(int(stated["seed"]), spawn_key=(STREAM,))
    normal = np.random.default_rng(seed).standard_normal((int(SAMPLED * run.plan[k].planned), len(run.bounds)))
    drawn = _cube(run, normal)
    near = np.abs(points[first : first + count] - drawn[:count]) <= draw.ROUNDING
    last = points[len(points) - final :]
    weights = np.where(_beyond(run, last), 0.0, _weights(_normal(run, last), stated["density"])[0])
    error, mean = float(weights.std(ddof=1)) / math.sqrt(len(weights)), float(weights.mean())
    fits = -run.outside() <= mean - 1.0 + ERRORS * max(error, 1e-9) and mean - 1.0 <= ERRORS * max(error, 1e-9)
    origins = [(one["position"], one["index"]) for mode in stated["modes"] for one in mode["origins"]]
    violating = sum(at < k and _violates(run, at)[index] for at, index in origins)
    return follows | {
        f"independent sample of stage {k}": (len(drawn), int(near.all(axis=1).sum())),
        f"weights of stage {k}": (1, int(fits)),
        f"origins of stage {k}": (len(origins), int(violating)),
    }


def _cube(run: Run, normal: Any) -> Any:
    """Points of standard normal space in the unit cube; correlated normal values beyond a bound are on it."""
    return draw.distributed(run.campaign, run.bounds).quantile(UNIFORM(normal), redrawn=False)


def _beyond(run: Run, points: Any) -> Any:
    """Which points are no violations of the estimate, because a correlated normal value is on its bound."""
    return draw.distributed(run.campaign, run.bounds).beyond(points)


def estimated(run: Run, k: int) -> Tree:
    """What the result of the stage must state."""
    stated = run.claims["results"][k]
    found: Tree = {"outside": run.outside(), "confidence": run.campaign.confidence}
    if stated.get("refused") is not None:
        return found | _refused(run, k, stated)
    points, _, status = run.rows(k)
    outside = _beyond(run, points)
    violates, budget = _violates(run, k) & ~outside, run.plan[k].planned
    first, count, drawn = stated["independent"]["first"], int(SAMPLED * budget), stated["final"]["count"]
    last, own = len(status) - drawn, slice(first, first + count)
    weights, responsible = _weights(_normal(run, points[last:]), stated["density"])
    failed = (status[last:] != OK) & (status[last:] != EXCLUDED) & ~outside[last:]
    terms, kept = np.where(violates[last:], weights, 0.0), int(np.count_nonzero(status[own] != EXCLUDED))
    made = _interval(terms, np.where(failed, 0.0, terms), (kept, count), run.campaign.confidence)
    terms = terms if made["probability"] else np.zeros_like(terms)
    sample = int(np.count_nonzero(violates[own])), kept
    again = _again(run, k)
    searched = {alarm["why"]: float(alarm["value"]) for alarm in stated["alarms"]}
    if again is not None:
        kinds = searched.keys() - {"unexplained", "unsaturated"}
        searched = {why: searched[why] for why in kinds} | again.alarms
        found["density"] = _density(again, stated["density"])
    numbers, alarms = _numbers(terms, made, _tails(run, kept, count)), _alarms(searched, terms, made, sample)
    if alarms:
        numbers |= {"low": None, "high": None}
    numbers = {name: _near(value, stated[name]) for name, value in numbers.items()}
    shares = (terms @ responsible / max(float(terms.sum()), 1e-300)).tolist()
    found |= numbers | {"draws": drawn, "failed_draws": int(np.count_nonzero(failed))}
    found |= {
        "final": {"first": last},
        "independent": {"count": count},
        "modes": _modes(run, stated, shares, again),
    }
    found["alarms"] = [_with_statement(run, k, alarm, sample, numbers["probability"]) for alarm in alarms]
    return found if run.reworded else found | {"statement": _statement(run, stated, found, count - kept)}


def _density(again: Searched, stated: Tree) -> Tree:
    """The density that the search adapted; what differs by rounding is as stated."""
    made, near = again.density, {}
    for name, value in made.items():
        near[name] = np.shape(value) == np.shape(stated[name]) and np.allclose(value, stated[name], TOLERANCE)
    return {name: stated[name] if near[name] else value for name, value in made.items()}


def _violates(run: Run, k: int) -> Any:
    """Which evaluations of a stage violate, failed ones included."""
    _, costs, status = run.rows(k)
    return np.where(status == OK, costs <= run.threshold, status != EXCLUDED)


def _normal(run: Run, points: Any) -> Any:
    """Points of the unit cube in standard normal space."""
    uniform = draw.distributed(run.campaign, run.bounds).uniform(points)
    return QUANTILE(np.clip(uniform, 1e-300, 1.0 - 2.0**-53))


def _weights(points: Any, density: Tree) -> tuple[Any, Any]:
    """The nominal density relative to the stated one (m,), and the responsibilities of its modes (m, k)."""
    n, modes = points.shape[1], len(density["shares"])
    shares = LEAST_SHARE / modes + (1.0 - LEAST_SHARE) * np.array(density["shares"])
    nominal = _log_normal(points, np.zeros(n), np.eye(n))
    parts = [np.full(len(points), NOMINAL)]
    for share, design, centre, spread in zip(shares, *(density[f] for f in FIELDS), strict=True):
        adapted = _log_normal(points, centre, COVARIANCE * np.array(spread))
        unit = _log_normal(points, design, np.eye(n))
        likely = (1.0 - NOMINAL - UNIT) * np.exp(adapted - nominal) + UNIT * np.exp(unit - nominal)
        parts.append(share * likely)
    whole = np.array(parts)
    return 1.0 / whole.sum(axis=0), (whole[1:] / whole[1:].sum(axis=0)).T


def _log_normal(points: Any, centre: Any, covariance: Any) -> Any:
    """Without the factor of 2 pi, which every density here has."""
    apart = points - np.array(centre)
    squares = np.einsum("mi,im->m", apart, np.linalg.solve(covariance, apart.T))
    return -(squares + np.linalg.slogdet(covariance)[1]) / 2.0


FIELDS = ("designs", "centres", "covariances")


def _interval(high: Any, low: Any, sample: tuple[int, int], confidence: float) -> Tree:
    """The log-normal interval, wider by its factor, relative to what is not excluded."""
    kept, count = sample
    share, z = kept / count, WIDER * NormalDist().inv_cdf((1.0 + confidence) / 2.0)
    if not high.any() or not kept:
        return {"probability": 0.0, "low": 0.0, "high": 1.0, "variation": math.inf}

    def variation(terms: Any) -> float:
        mean = float(terms.mean())
        return math.sqrt(terms.var(ddof=1) / len(terms) / mean**2 + (1.0 - share) / (share * count)) if mean else 0.0

    wide, narrow = variation(high), variation(low)
    ends = float(low.mean()) * math.exp(-z * narrow) / share, float(high.mean()) * math.exp(z * wide) / share
    made = {"probability": min(1.0, float(high.mean()) / share), "low": ends[0]}
    return made | {"high": min(1.0, ends[1]), "variation": wide}


def _tails(run: Run, kept: int, drawn: int) -> float:
    """The probability beyond the bounds per probability of what is not excluded; earlier versions left that out."""
    share = kept / drawn if run.wording >= limits.TAILS else 1.0
    return min(1.0, run.outside() / share) if share else 1.0


def _numbers(terms: Any, made: Tree, outside: float) -> Tree:
    effective = float(terms.sum() ** 2 / max(float(np.sum(terms**2)), 1e-300))
    variation = made["variation"] if math.isfinite(made["variation"]) else None
    return made | {
        "low": made["low"] * (1.0 - outside),
        "high": min(1.0, made["high"] + outside),
        "variation": variation,
        "effective": effective,
    }


def _alarms(alarm_values: dict[str, float], terms: Any, made: Tree, sample: tuple[int, int]) -> list[Tree]:
    """All alarms in their order; alarm_values: as stated, those of the search as repeated."""
    largest = float(terms.max() / max(float(terms.sum()), 1e-300))
    effective, (violations, size) = _numbers(terms, made, 0.0)["effective"], sample
    many = _at_most(size - violations, size, 1.0 - made["high"])
    few = _at_most(violations, size, made["low"])
    raised = {
        "unexplained": ("unexplained" in alarm_values, alarm_values.get("unexplained")),
        "weight": (largest > LARGEST, largest),
        "few": (effective < FEWEST, effective),
        "unsaturated": ("unsaturated" in alarm_values, alarm_values.get("unsaturated")),
        "sample": (min(many, few) < CHANCE / 2.0, float(violations)),
    }
    return [{"why": why, "value": _near(value, alarm_values.get(why))} for why, (on, value) in raised.items() if on]


def _at_most(events: int, samples: int, p: float) -> float:
    """P(Binomial(samples, p) <= events)."""
    if not 0.0 < p < 1.0 or events >= samples:
        return float(p <= 0.0 or events >= samples)
    return math.exp(cumulative(events, samples, p)[-1])


def _with_statement(run: Run, k: int, alarm: Tree, sample: tuple[int, int], probability: float) -> Tree:
    value, budget = alarm["value"], run.plan[k].planned
    made = {
        "unexplained": lambda: templates.unexplained(int(value), budget),
        "weight": lambda: templates.single(value),
        "few": lambda: templates.few(value, FEWEST),
        "unsaturated": lambda: templates.unsaturated(int(value)),
        "sample": lambda: templates.contradicted(*sample, probability),
    }
    return alarm if run.reworded else alarm | {"statement": made[alarm["why"]]()}


def _modes(run: Run, stated: Tree, shares: list[float], again: Searched | None) -> list[Tree]:
    """The modes at the centres of the density, with the stored violations that led to them."""
    found: list[Tree] = []
    for design, share, mode in zip(stated["density"]["designs"], shares, stated["modes"], strict=True):
        point = _cube(run, np.array([design]))[0]
        near = share if abs(share - mode["share"]) > TOLERANCE else mode["share"]
        found.append({"share": near, "parameters": run.values(point), "distance": float(np.linalg.norm(design))})
    for mode, origins in zip(found, () if again is None else again.origins, strict=False):
        mode["origins"] = origins
    return found


def _statement(run: Run, stated: Tree, found: Tree, excluded: int) -> Spans:
    if found["alarms"]:
        return templates.alarmed([alarm["statement"] for alarm in found["alarms"]])
    size, seed_stated = stated["independent"]["count"], not stated["drawn_at_launch"]
    beyond = _tails(run, size - excluded, size)
    numbers = found["draws"], found["effective"], found["failed_draws"], excluded, size, beyond
    about = templates.estimated(
        found["probability"],
        (found["low"], found["high"]),
        run.campaign.confidence,
        templates.Draws(*numbers, seed_stated),
    )
    shares = [mode["share"] for mode in found["modes"]]
    hidden = [share for share, mode in zip(shares, stated["modes"], strict=True) if not mode["origins"]]
    return templates.whole(about, templates.modes(shares, len(hidden), sum(hidden)))


def _refused(run: Run, k: int, stated: Tree) -> Tree:
    """Why there is no estimate; the least budget is taken as given if the search cannot be repeated."""
    n, budget, again = len(run.bounds), run.plan[k].planned, run.searched.get(k)
    why, limit = str(stated["refused"]["why"]), int(stated["refused"]["limit"])
    if run.calls.noisy:
        why, limit = "noise", 0
    elif not any(_violates(run, at).any() for at in range(k)):
        why, limit = "no_violation", 0
    elif n > MOST:
        why, limit = "parameters", MOST
    elif isinstance(again, Searched) and again.refused is not None:
        why, limit = again.refused
    else:
        why, limit = "budget", max(limit, budget + 1)
    statement = {
        "noise": templates.NOISE,
        "no_violation": templates.NO_VIOLATION,
        "parameters": templates.too_many(limit, n),
        "budget": templates.too_few(limit, n, budget),
    }[why]
    none: Tree = dict.fromkeys(("probability", "low", "high", "variation", "effective"))
    none |= {"draws": 0, "failed_draws": 0, "modes": [], "alarms": [], "refused": {"why": why, "limit": limit}}
    if run.reworded:
        return none
    none["refused"]["statement"] = statement
    return none | {"statement": templates.refused(statement)}


def _near(value: Any, claim: Any) -> Any:
    """What the record has, if this differs from it by rounding."""
    both = isinstance(value, float) and isinstance(claim, int | float)
    return claim if both and math.isclose(value, claim, rel_tol=TOLERANCE) else value
