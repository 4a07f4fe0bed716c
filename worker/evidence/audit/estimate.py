"""Recomputes the estimate of P(violation) from its stored draws and the density that they came from.

The numbers are computed here; the density, the origins of modes and the two alarms of the search for modes come from
the search that the engine repeats over the stored evaluations (`Searched`).
"""

from __future__ import annotations

import math
from itertools import zip_longest
from statistics import NormalDist
from typing import Any, NamedTuple

import numpy as np

from campaigns.claims.spans import Spans
from campaigns.claims.stages import estimate as templates
from campaigns.results.base import EXCLUDED, OK
from campaigns.results.estimate import Estimation, ImportanceDensity, NoEstimate, Rows, ViolationMode
from worker.evidence.audit import draw, limits
from worker.evidence.audit.alarms import Sampled, Weighted, of_no_mode, raised
from worker.evidence.audit.parts import OMIT, REST, changed, made, read
from worker.evidence.audit.recompute import Run
from worker.evidence.audit.record import Missing

STREAM, SAMPLED, FINAL = 2**25, 0.06, 0.33
"""The random stream of the stage, which begins with the independent sample: this fraction of the budget; the least that
is counted."""
NOMINAL, UNIT, LEAST_SHARE, COVARIANCE = 0.1, 0.15, 0.3, 1.2
"""Of the density: the parts of the nominal one and of unit covariance, the least of an even share, a factor."""
WIDER, FLAT, RETURN, MOST = 1.25, 2.0, 0.1, 20
"""Of the interval: its factors, the second where so many violations have the value of others; the most modes."""
TOLERANCE = 1e-4
"""Relative: a point is stored to 1e-16 of a range, of which a tail of probability 1e-12 has four digits."""
ERRORS = 5.0
"""Standard errors by which the mean of the weights may differ from 1."""
UNIFORM = np.vectorize(lambda x: math.erfc(-x / math.sqrt(2.0)) / 2.0, otypes=[float])
QUANTILE = np.vectorize(NormalDist().inv_cdf, otypes=[float])
"""The standard normal distribution function and its inverse."""


class Drawn(NamedTuple):
    """What a search draws: where its independent sample begins and how large it is, how many draws are counted, the
    last of its evaluations, and these in standard normal space, where they are not rounded to a bound."""

    first: int
    sampled: int
    final: int
    points: Any


class Searched(NamedTuple):
    """The search of an estimate, repeated over its stored evaluations: its density, the stored violations that led to
    each mode, its alarms and its draws, or why it refused."""

    density: ImportanceDensity
    origins: list[list[dict[str, int]]]
    alarms: dict[str, float]
    drawn: Drawn = Drawn(0, 0, 0, None)
    refused: tuple[str, int] | None = None


UNKNOWN = Missing("the search of the estimate was not repeated: another engine made it")


def _again(run: Run, k: int) -> Searched | None:
    """The repeated search that is an estimate; None if it was not repeated, or refused."""
    found = run.searched.get(k)
    return found if isinstance(found, Searched) and found.refused is None else None


def placed(run: Run, k: int) -> dict[str, tuple[object, object]]:
    """What the stored points must be, and are: the independent sample that follows from the seed, draws whose weights
    have the mean 1, and origins that violate."""
    stated = run.claims["results"][k]
    again = run.searched.get(k, UNKNOWN)
    repeated = (1, again if isinstance(again, Missing) else int(again is not None))
    follows: dict[str, tuple[object, object]] = {f"search of stage {k}": repeated}
    if stated.get("refused") is not None:
        return {} if run.calls.noisy else follows
    first, count = stated["independent"]["first"], stated["independent"]["count"]
    points, final, least = run.rows(k)[0], _drawn(run, k).final, int(FINAL * run.plan[k].planned)
    seed = np.random.SeedSequence(int(stated["seed"]), spawn_key=(STREAM,))
    normal = np.random.default_rng(seed).standard_normal((int(SAMPLED * run.plan[k].planned), len(run.bounds)))
    drawn = _cube(run, normal)
    near = np.abs(points[first : first + count] - drawn[:count]) <= draw.ROUNDING
    last = points[len(points) - final :]
    weights, _ = _weights(_draws(run, k), read(ImportanceDensity, stated["density"]))
    weights = np.where(_beyond(run, last), 0.0, weights)
    error, mean = float(weights.std(ddof=1)) / math.sqrt(len(weights)), float(weights.mean())
    fits = -run.outside() <= mean - 1.0 + ERRORS * max(error, 1e-9) and mean - 1.0 <= ERRORS * max(error, 1e-9)
    origins = [(one["position"], one["index"]) for mode in stated["modes"] for one in mode["origins"]]
    violating = sum(at < k and _violates(run, at)[index] for at, index in origins)
    return follows | {
        f"independent sample of stage {k}": (len(drawn), int(near.all(axis=1).sum())),
        f"weights of stage {k}": (1, int(fits)),
        f"origins of stage {k}": (len(origins), int(violating)),
        f"draws of stage {k}": (least, min(final, least)),
    }


def _drawn(run: Run, k: int) -> Drawn:
    """The draws of the repeated search; of one that was not repeated as stated."""
    again, stated = _again(run, k), run.claims["results"][k]
    if again is not None:
        return again.drawn
    return Drawn(stated["independent"]["first"], stated["independent"]["count"], stated["final"]["count"], None)


def _draws(run: Run, k: int) -> Any:
    """The counted draws in standard normal space."""
    drawn, points = _drawn(run, k), run.rows(k)[0]
    return _normal(run, points[len(points) - drawn.final :]) if drawn.points is None else drawn.points


def _cube(run: Run, normal: Any) -> Any:
    """Points of standard normal space in the unit cube; correlated normal values beyond a bound are on it."""
    return draw.distributed(run.campaign, run.bounds).quantile(UNIFORM(normal), redrawn=False)


def _beyond(run: Run, points: Any) -> Any:
    """Which points are no violations of the estimate, because a correlated normal value is on its bound."""
    return draw.distributed(run.campaign, run.bounds).beyond(points)


def estimated(run: Run, k: int) -> Estimation:
    """What the result of the stage must state."""
    stated = run.claims["results"][k]
    found = made(Estimation, outside=run.outside(), confidence=run.campaign.confidence, **REST)
    if stated.get("refused") is not None or not _known(run, k, run.wording < limits.VIOLATING):
        return _refused(run, k, found)
    points, costs, status = run.rows(k)
    outside = _beyond(run, points)
    violates, budget = _violates(run, k) & ~outside, run.plan[k].planned
    count, drawn = int(SAMPLED * budget), _drawn(run, k).final
    again = _again(run, k)
    first = stated["independent"]["first"] if again is None else again.drawn.first
    last, own = len(status) - drawn, slice(first, first + count)
    density = read(ImportanceDensity, stated["density"])
    weights, responsible = _weights(_draws(run, k), density)
    terms, kept = np.where(violates[last:], weights, 0.0), int(np.count_nonzero(status[own] != EXCLUDED))
    lost = (status != OK) & (status != EXCLUDED) & ~outside
    values = np.where(status == OK, costs, math.nan)[last:][violates[last:]]
    flat = run.wording >= limits.EACH and len(np.unique(values)) < (1.0 - RETURN) * len(values)
    factor = FLAT if flat else WIDER
    interval = _interval(terms, np.where(lost[last:], 0.0, terms), (kept, count), run.campaign.confidence, factor)
    terms = terms if interval.probability else np.zeros_like(terms)
    sample = Sampled(int(np.count_nonzero(violates[own])), int(np.count_nonzero(lost[own])), kept)
    searched = {alarm["why"]: float(alarm["value"]) for alarm in stated["alarms"]}
    if again is not None:
        kinds = searched.keys() - {"unexplained", "unsaturated"}
        searched = {why: searched[why] for why in kinds} | again.alarms
        found = changed(found, density=_density(again.density, density))
    if left := _left(run, k, density):
        searched["unexplained"] = float(left)
    effective = float(terms.sum() ** 2 / max(float(np.sum(terms**2)), 1e-300))
    stating = run, k, _near(interval.probability, stated["probability"])
    alarms = raised(stating, searched, Weighted(terms, effective, interval.low, interval.high), sample)
    outer = interval.beyond(_tails(run, kept, count))
    low, high = (None, None) if alarms else (outer.low, outer.high)
    variation = interval.variation if math.isfinite(interval.variation) else None
    numbers: dict[str, float | None] = {"probability": interval.probability, "low": low, "high": high}
    numbers |= {"variation": variation, "effective": effective}
    near = {name: _near(value, stated[name]) for name, value in numbers.items()}
    shares = (terms @ responsible / max(float(terms.sum()), 1e-300)).tolist()
    found = changed(
        found, **near, draws=drawn, failed_draws=int(np.count_nonzero(lost[last:])), alarms=alarms,
        final=made(Rows, first=last, count=drawn), independent=made(Rows, first=first, count=count),
        modes=_modes(run, k, density, shares),
    )  # fmt: skip
    return found if run.reworded else changed(found, statement=_statement(run, k, found, count - kept))


def _left(run: Run, k: int, density: ImportanceDensity) -> int:
    """Of an earlier version, judged by the rules of today: how many stored violations may be of another mode. Of those
    the search of today examines each."""
    if not run.written < limits.WIDER <= run.wording:
        return 0
    before = [run.rows(at)[0][_violates(run, at)] for at in range(k)]
    return of_no_mode(_normal(run, np.concatenate(before)), np.array(density.designs))


def _density(adapted: ImportanceDensity, stated: ImportanceDensity) -> ImportanceDensity:
    """The density that the search adapted; what differs by rounding is as stated."""
    near = adapted
    for name in (*FIELDS, "shares"):
        value, claim = getattr(adapted, name), getattr(stated, name)
        if np.shape(value) == np.shape(claim) and np.allclose(value, claim, TOLERANCE):
            near = changed(near, **{name: claim})
    return near


def _violates(run: Run, k: int) -> Any:
    """Which evaluations of a stage violate, failed ones included."""
    _, costs, status = run.rows(k)
    return np.where(status == OK, costs <= run.threshold, status != EXCLUDED)


def _normal(run: Run, points: Any) -> Any:
    """Points of the unit cube in standard normal space."""
    uniform = draw.distributed(run.campaign, run.bounds).uniform(points)
    return QUANTILE(np.clip(uniform, 1e-300, 1.0 - 2.0**-53))


def _weights(points: Any, density: ImportanceDensity) -> tuple[Any, Any]:
    """The nominal density relative to the stated one (m,), and the responsibilities of its modes (m, k)."""
    n, modes = points.shape[1], len(density.shares)
    shares = LEAST_SHARE / modes + (1.0 - LEAST_SHARE) * np.array(density.shares)
    nominal = _log_normal(points, np.zeros(n), np.eye(n))
    parts = [np.full(len(points), NOMINAL)]
    for share, design, centre, spread in zip(shares, *(getattr(density, f) for f in FIELDS), strict=True):
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


class Interval(NamedTuple):
    """The estimate, its interval, and the coefficient of variation of its terms."""

    probability: float
    low: float
    high: float
    variation: float

    def beyond(self, outside: float) -> Interval:
        """With so much probability beyond the bounds."""
        return self._replace(low=self.low * (1.0 - outside), high=min(1.0, self.high + outside))


def _interval(high: Any, low: Any, sample: tuple[int, int], confidence: float, factor: float) -> Interval:
    """The log-normal interval, wider by its factor, relative to what is not excluded."""
    kept, count = sample
    share, z = kept / count, factor * NormalDist().inv_cdf((1.0 + confidence) / 2.0)
    if not high.any() or not kept:
        return Interval(0.0, 0.0, 1.0, math.inf)

    def variation(terms: Any) -> float:
        mean = float(terms.mean())
        return math.sqrt(terms.var(ddof=1) / len(terms) / mean**2 + (1.0 - share) / (share * count)) if mean else 0.0

    wide, narrow = variation(high), variation(low)
    ends = float(low.mean()) * math.exp(-z * narrow) / share, float(high.mean()) * math.exp(z * wide) / share
    return Interval(min(1.0, float(high.mean()) / share), ends[0], min(1.0, ends[1]), wide)


def _tails(run: Run, kept: int, drawn: int) -> float:
    """The probability beyond the bounds per probability of what is not excluded; earlier versions left that out."""
    share = kept / drawn if run.wording >= limits.TAILS else 1.0
    return min(1.0, run.outside() / share) if share else 1.0


def _modes(run: Run, k: int, density: ImportanceDensity, shares: list[float]) -> list[ViolationMode]:
    """The modes at the centres of the density, with the stored violations that led to them."""
    found = []
    for design, share, mode in zip(density.designs, shares, run.claims["results"][k]["modes"], strict=True):
        at = run.values(_cube(run, np.array([design]))[0])
        near = share if abs(share - mode["share"]) > TOLERANCE else mode["share"]
        distance = float(np.linalg.norm(design))
        found.append(made(ViolationMode, share=near, parameters=at, distance=distance, **REST))
    if (again := _again(run, k)) is None:
        return found
    pairs = zip_longest(found, again.origins[: len(found)], fillvalue=OMIT)
    return [changed(mode, origins=origins) for mode, origins in pairs]


def _statement(run: Run, k: int, found: Estimation, excluded: int) -> Spans:
    if found.alarms:
        return templates.alarmed([alarm.statement for alarm in found.alarms])
    stated = run.claims["results"][k]
    size, seed_stated = stated["independent"]["count"], not stated["drawn_at_launch"]
    beyond = _tails(run, size - excluded, size)
    numbers = found.draws, found.effective or 0.0, found.failed_draws, excluded, size, beyond
    draws = templates.Draws(*numbers, seed_stated)
    about = templates.estimated(
        found.probability or 0.0, (found.low or 0.0, found.high or 0.0), run.campaign.confidence, draws
    )
    shares = [mode.share for mode in found.modes]
    hidden = [share for share, mode in zip(shares, stated["modes"], strict=True) if not mode["origins"]]
    failed = _failed(run, k)
    return templates.whole(about, templates.modes(shares, len(hidden), sum(hidden), failed), failed)


def _failed(run: Run, k: int) -> bool:
    """Whether evaluations of the stage failed, which its sentences count among violations."""
    return any(status not in (OK, EXCLUDED) for status in np.unique(run.rows(k)[2]))


def _refused(run: Run, k: int, found: Estimation) -> Estimation:
    """Why there is no estimate; the least budget is taken as given if the search cannot be repeated."""
    n, budget, again = len(run.bounds), run.plan[k].planned, run.searched.get(k)
    stated = run.claims["results"][k].get("refused") or {"why": "", "limit": 0}
    why, limit = str(stated["why"]), int(stated["limit"])
    if run.calls.noisy:
        why, limit = "noise", 0
    elif not _known(run, k, run.wording < limits.VIOLATING and why != "no_violation"):
        why, limit = "no_violation", 0
    elif n > MOST:
        why, limit = "parameters", MOST
    elif isinstance(again, Searched) and again.refused is not None:
        why, limit = again.refused
    elif isinstance(again, Missing) and why == "too_far":
        limit = 0
    else:
        why, limit = "budget", max(limit, budget + 1)
    statement = {
        "noise": templates.NOISE,
        "no_violation": templates.NO_VIOLATION,
        "too_far": templates.TOO_FAR,
        "parameters": templates.too_many(limit, n),
        "budget": templates.too_few(limit, n, budget),
    }[why]
    reason: Any = why
    refused = made(NoEstimate, why=reason, limit=limit, statement=OMIT if run.reworded else statement)
    none = dict.fromkeys(("probability", "low", "high", "variation", "effective"))
    found = changed(found, **none, draws=0, failed_draws=0, modes=[], alarms=[], refused=refused)
    return found if run.reworded else changed(found, statement=templates.refused(statement))


def _known(run: Run, k: int, failed: bool) -> bool:
    """Whether a stage before has a violation, without which nothing is estimated; failed: whether a failed evaluation
    is enough, as in earlier versions."""
    return any((_violates(run, at) & (failed | (run.rows(at)[2] == OK))).any() for at in range(k))


def _near(value: Any, claim: Any) -> Any:
    """What the record has, if this differs from it by rounding."""
    both = isinstance(value, float) and isinstance(claim, int | float)
    return claim if both and math.isclose(value, claim, rel_tol=TOLERANCE) else value
