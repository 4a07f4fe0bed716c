"""Recomputes the alarms of an estimate of P(violation), and which stored violations may be of another mode."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from campaigns.claims.stages import estimate as templates
from campaigns.results.estimate import EstimateAlarm
from worker.evidence.audit import draw, limits
from worker.evidence.audit.binomial import cumulative
from worker.evidence.audit.parts import changed, made
from worker.evidence.audit.recompute import Run

LARGEST, FEWEST, CHANCE = 0.2, 30.0, 0.005
TOLERANCE = 1e-4
"""Relative, of a value that is as stated."""
LARGE, FARTHEST = 0.1, 8.2
"""Of the known modes as half-spaces, what a stored violation may add as one; how far it is in no tail."""
TAIL = np.vectorize(lambda x: math.erfc(x / math.sqrt(2.0)) / 2.0, otypes=[float])
"""The standard normal probability above a value."""


class Sampled(NamedTuple):
    """Of an independent sample: violations, failed evaluations among them, all that are not excluded, and how much
    more of it than of the estimate may violate, because correlated draws beyond the bounds were drawn again within."""

    violations: int
    failed: int
    samples: int
    outside: float = 0.0


class Weighted(NamedTuple):
    """The weights of the violations, their effective number, and the interval."""

    terms: Any
    effective: float
    low: float
    high: float


def raised(
    stating: tuple[Run, int, float], as_searched: dict[str, float], found: Weighted, own: Sampled
) -> list[EstimateAlarm]:
    """All alarms in their order; stating: the run, the stage and P; as_searched: values as stated, those of the search
    as repeated; own: the sample of the stage."""
    run, k, probability = stating
    certified = _certified(run)
    sample = own if certified is None or not _contradicts(certified, found) else certified
    largest = float(found.terms.max() / max(float(found.terms.sum()), 1e-300))
    alarms = {
        "unexplained": ("unexplained" in as_searched, as_searched.get("unexplained")),
        "weight": (largest > LARGEST, largest),
        "few": (found.effective < FEWEST, found.effective),
        "unsaturated": ("unsaturated" in as_searched, as_searched.get("unsaturated")),
        "sample": (_contradicts(sample, found), float(sample.violations)),
    }
    values: dict[Any, Any] = {why: _near(value, as_searched.get(why)) for why, (on, value) in alarms.items() if on}
    made_again = [made(EstimateAlarm, why=why, value=value) for why, value in values.items()]
    return [_stated(run, k, alarm, sample, probability) for alarm in made_again]


def _near(value: Any, claim: Any) -> Any:
    near = value is not None and claim is not None and math.isclose(value, claim, rel_tol=TOLERANCE)
    return claim if near else value


def _contradicts(sample: Sampled, found: Weighted) -> bool:
    """Whether it has too many or too few violations for every probability of the interval."""
    violations, _, size, outside = sample
    high, low = min(1.0, found.high + outside), found.low * (1.0 - outside)
    many, few = _at_most(size - violations, size, 1.0 - high), _at_most(violations, size, low)
    return min(many, few) < CHANCE / 2.0


def _at_most(events: int, samples: int, p: float) -> float:
    """P(Binomial(samples, p) <= events)."""
    if not 0.0 < p < 1.0 or events >= samples:
        return float(p <= 0.0 or events >= samples)
    return math.exp(cumulative(events, samples, p)[-1])


def _certified(run: Run) -> Sampled | None:
    """The run's independent sample, all of it, whichever draws are stored; earlier versions did not look at it."""
    at = run.certifying
    if run.wording < limits.WIDER or not at or not run.samples[at[0]].samples:
        return None
    of = run.samples[at[0]]
    drawn = of.samples + of.excluded
    redrawn = bool(draw.distributed(run.campaign, run.bounds).unbounded)
    outside = min(1.0, run.outside() * drawn / of.samples)
    return Sampled(of.violations, of.failed, of.samples, outside if redrawn else 0.0)


def of_no_mode(points: Any, designs: Any) -> int:
    """How many stored violations in standard normal space are beyond no tangent plane of a mode, and would add more
    than a little to its probability."""
    likely = LARGE * float(TAIL(np.linalg.norm(designs, axis=1)).sum())
    explained = (points @ designs.T >= (designs**2).sum(axis=1)).any(axis=1)
    near = (TAIL(np.linalg.norm(points, axis=1)) > likely) & (np.abs(points) < FARTHEST).all(axis=1)
    return int(np.count_nonzero(near & ~explained))


def _stated(run: Run, k: int, alarm: EstimateAlarm, sample: Sampled, probability: float) -> EstimateAlarm:
    """The alarm with its sentence."""
    value, budget = alarm.value, run.plan[k].planned
    failed = run.ended[k].failed > 0
    worded = {
        "unexplained": lambda: templates.unexplained(int(value), budget, failed),
        "weight": lambda: templates.single(value),
        "few": lambda: templates.few(value, FEWEST),
        "unsaturated": lambda: templates.unsaturated(int(value)),
        "sample": lambda: templates.contradicted(sample.violations, sample.samples, probability, sample.failed > 0),
    }
    return alarm if run.reworded else changed(alarm, statement=worded[alarm.why]())
