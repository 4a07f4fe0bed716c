"""Which uncertain parameters alone change the criterion: along the slices through nominal point and findings."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from campaigns import rules
from campaigns.results.slices import Curve
from worker.evidence.verdicts.evidence import Evidence


@dataclass(frozen=True)
class Alone:
    """What the slices show of the parameters, by path."""

    known: frozenset[str]
    """Those of which a slice has several values."""
    changing: frozenset[str]
    """Those of which a slice changes by more than the rounding of its own values."""
    fewest: int
    """Values of a slice of the others, at least."""
    most: int

    @property
    def without(self) -> frozenset[str]:
        """Those that change nothing at the values of their slices."""
        return self.known - self.changing


def alone(evidence: Evidence, threshold: float) -> Alone:
    """What the slices of the run show. The range of all evaluations is no scale: it may have a large value that stands
    for "no encounter", next to which the effect of another parameter would be rounding."""
    known = [(curve.path, costs) for curve in _slices(evidence) if len(costs := _costs(curve)) > 1]
    changing = frozenset(path for path, costs in known if _changes(costs, threshold))
    counts = [len(costs) for path, costs in known if path not in changing] or [0]
    return Alone(frozenset(path for path, _ in known), changing, min(counts), max(counts))


def _slices(evidence: Evidence) -> Iterator[Curve]:
    for result in evidence.results:
        yield from result.slices
    for finding in evidence.findings:
        if finding.slices is not None:
            yield from finding.slices.curves


def _costs(curve: Curve) -> list[float]:
    return [cost for cost in curve.costs if cost is not None]


def _changes(costs: list[float], threshold: float) -> bool:
    """Whether values differ by more than their rounding, a tenth of the margin of the lowest at most."""
    size, margin = max(map(abs, costs)), abs(min(costs) - threshold)
    rounding = min(rules.ROUNDING.value * size, rules.TOLERANCE_OF_MARGIN.value * margin)
    return max(costs) - min(costs) > max(rounding, rules.AGREEMENT_ROUNDING.value * size)
