"""Recomputes what a run claims about the calls of a simulator: whether results repeat, and its independent calls."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from campaigns.results.base import EXCLUDED, OK
from campaigns.results.finding import Calls as Several
from campaigns.results.finding import Validation
from campaigns.results.measured import Measured
from worker.evidence.audit import limits
from worker.evidence.audit.binomial import interval
from worker.evidence.audit.parts import OMIT, REST, made
from worker.evidence.audit.record import MISSING, Record


class Calls:
    """The calls of a run's simulator, from the evaluations of its first stage and the recorded independent calls.

    Closed loops, and runs of versions that did not measure whether results repeat, have none; whole: those of others
    must have them; stepped: single calls would be confirmed at half the step.
    """

    def __init__(
        self, record: Record, points: Any, costs: Any, status: Any, wording: int, whole: bool, stepped: bool = False
    ) -> None:  # fmt: skip
        self.campaign, self.claims, simulator = record.campaign, record.claims, record.campaign.simulator
        self.measures = simulator is not None and (whole or len(status) > 1)
        self.number = simulator.calls if simulator is not None else 1
        self.measured = _measured(points, costs, status, whole) if self.measures else None
        stated = self.claims["results"][0].get("measured") if self.measures else None
        declared = stated is None or bool(stated["declared"])  # one that is absent is reported as such
        self.repeats = self.measured is None or (self.measured.identical and declared)
        self.noisy = self.measures and (self.number > 1 or not self.repeats)
        self.stepped, self.wording = stepped, wording

    def case(self, recorded: Any, name: str = OMIT, cost: float = OMIT) -> Validation:
        """The validation of a case by independent calls, whose values are stored; name, cost: to be stated of it."""
        threshold, confidence = self.campaign.criterion.threshold, self.campaign.confidence
        values = np.array(recorded["repeats"]["values"], dtype=np.float64)  # None becomes NaN
        violating, failed = int((values <= threshold).sum()), int(np.isnan(values).sum())
        low, high = interval(violating, len(values), confidence, failed)
        own = math.nan if recorded["cost"] is None else recorded["cost"]
        agrees = own > threshold and not violating and not failed
        ok = len(values) == self.campaign.stages.validate_.repeats and (agrees or violating > 0)
        repeats = made(Several, violating=violating, failed=failed, low=low, high=high, confidence=confidence, **REST)
        return made(
            Validation, name=name, cost=cost, repeats=repeats, agrees=agrees, violates=violating > 0, ok=ok, **REST
        )

    def checks(self, noise: str, flaky: Any) -> dict[str, bool]:
        """The checks that the rules require of a simulator's calls, by name; noise: that of the claimed sample."""
        simulator = self.campaign.simulator
        if not self.measures or simulator is None:
            return {}
        found: dict[str, bool] = {}
        if simulator.retries or (flaky is not MISSING and flaky):
            found["retries"] = flaky if flaky is MISSING else flaky == 0
        often = self.measured is not None and math.isfinite(self.measured.evaluations)
        found["noise of calls"] = often and (self._several(noise) if self.number > 1 else self.alike)
        return found

    @property
    def alike(self) -> bool:
        """Whether single calls repeated, when they were measured and in every later comparison."""
        return not self.measures or (self.number == 1 and self.repeats and self._later())

    def influence(self, varies: bool, spread: float) -> bool:
        """Whether the criterion varies by more than the noise alone would let it."""
        deviation = (self.measured and self.measured.deviation) or 0.0
        return varies and not (deviation and spread <= limits.ABOVE_NOISE * deviation)

    def _cases(self) -> Iterator[Any]:
        """The stored validations."""
        last = self.claims["results"][-1]
        yield last["nominal"]
        yield from (one["validation"] for one in (*self.claims["findings"], *last.get("incumbents", [])))
        yield from (one["confirmed"] for one in last.get("basins", []) if one.get("confirmed") is not None)

    def beside(self, noise: str) -> bool:
        """Whether nothing is wrong with several calls but that those of violations violate; noise: as of `checks`."""
        return self.number > 1 and self._several(noise, of_violations=False)

    def _several(self, noise: str, of_violations: bool = True) -> bool:
        simulator, threshold = self.campaign.simulator, self.campaign.criterion.threshold

        def sound(cost: Any, of: Validation) -> bool:
            failed = of.repeats is None or of.repeats.failed
            violation = cost is not None and cost <= threshold and of.violates and not failed
            return bool(of.ok and (of.agrees or (violation and not of_violations)))

        clear = all(sound(c["cost"], self.case(c)) for c in self._cases())
        spot = self.claims["results"][-1]["spot_checks"]
        clear = clear and spot["compared"] == spot["checked"]
        own = noise == "drawn" and self.measured is not None and not self.measured.by_process
        own = own and not (self.stepped and self.repeats)
        return clear and own and simulator is not None and simulator.combine == "worst"

    def _later(self) -> bool:
        spot = self.claims["results"][-1]["spot_checks"]
        same = all(case["again"]["difference"] == 0.0 or self._both_failed(case) for case in self._cases())
        return same and spot["compared"] == spot["checked"] and not spot["largest"]

    def _both_failed(self, case: Any) -> bool:
        """Whether a case has no value in either evaluation, which is no difference; before `GRANTED` it was one."""
        return self.wording >= limits.GRANTED and case["cost"] is None and case["again"]["cost"] is None


def _same(costs: Any, status: Any) -> bool:
    return len(set(status.tolist())) == 1 and len(set(costs[status == OK].tolist())) <= 1


def _measured(points: Any, costs: Any, status: Any, whole: bool) -> Measured:
    """Evaluations of the same points in rounds: do they have the same bits? whole: of so many, each so often."""
    groups: dict[bytes, list[int]] = {}
    used = True
    for row, point in enumerate(points):
        groups.setdefault(point.tobytes(), []).append(row)
    identical, several, squares = True, [], []
    for rows in groups.values():
        values = costs[rows][status[rows] == OK]
        identical &= _same(costs[rows], status[rows])
        used &= _same(costs[rows[:-1]], status[rows[:-1]])  # the last of each was in a fresh process
        if len(values) > 1:
            several.append(float(values.max() - values.min()))
            squares.append(float(np.var(values - values.min(), ddof=1)))
    failed = int(np.count_nonzero((status != OK) & (status != EXCLUDED)))
    even = not whole or all(len(rows) == limits.TIMES for rows in groups.values())
    number, total = (limits.POINTS, limits.POINTS * limits.TIMES) if whole else (len(groups), len(status))
    evaluations: Any = total if even and len(status) == total else math.nan
    return made(
        Measured, points=number, evaluations=evaluations, failed=failed, identical=identical,
        by_process=used and not identical, spread=max(several, default=None),
        deviation=math.sqrt(sum(squares) / len(squares)) if squares else None, **REST,
    )  # fmt: skip
