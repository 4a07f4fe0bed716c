"""Recomputes what a run claims about the calls of a simulator: whether results repeat, and its independent calls."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from campaigns import Campaign
from campaigns.documents import JsonObject
from campaigns.results.base import EXCLUDED, OK
from worker.evidence.audit import limits
from worker.evidence.audit.binomial import interval
from worker.evidence.audit.record import MISSING


class Calls:
    """The calls of a run's simulator, from the evaluations of its first stage and the recorded independent calls.

    Closed loops, and runs of versions that did not measure whether results repeat, have none.
    """

    def __init__(self, campaign: Campaign, claims: JsonObject, points: Any, costs: Any, status: Any) -> None:
        self.campaign, self.claims, simulator = campaign, claims, campaign.simulator
        self.measures = simulator is not None and len(status) > 1
        self.number = simulator.calls if simulator is not None else 1
        self.measured = _measured(points, costs, status) if self.measures else {}
        declared = not self.measures or bool(claims["results"][0]["measured"]["declared"])
        self.repeats = not self.measures or (self.measured["identical"] and declared)
        self.noisy = self.measures and (self.number > 1 or not self.repeats)

    def case(self, recorded: JsonObject) -> JsonObject:
        """The validation of a case by independent calls."""
        repeats, threshold = recorded["repeats"], self.campaign.criterion.threshold
        values = np.array(repeats["values"], dtype=np.float64)  # None becomes NaN
        violating, failed = int((values <= threshold).sum()), int(np.isnan(values).sum())
        low, high = interval(violating, len(values), self.campaign.confidence, failed)
        cost = math.nan if recorded["cost"] is None else recorded["cost"]
        agrees, violates = cost > threshold and not violating and not failed, violating > 0
        found = {"violating": violating, "failed": failed, "low": low, "high": high}
        found["confidence"] = self.campaign.confidence
        enough = len(values) == self.campaign.stages.validate_.repeats
        return {"repeats": found, "agrees": agrees, "violates": violates, "ok": enough and (agrees or violates)}

    def checks(self, noise: str, flaky: Any) -> dict[str, bool]:
        """The checks that the rules require of a simulator's calls, by name; noise: that of the claimed sample."""
        simulator = self.campaign.simulator
        if not self.measures or simulator is None:
            return {}
        found: dict[str, bool] = {}
        if simulator.retries:
            found["retries"] = flaky if flaky is MISSING else flaky == 0
        found["noise of calls"] = self._several(noise) if self.number > 1 else self.alike
        return found

    @property
    def alike(self) -> bool:
        """Whether single calls repeated, when they were measured and in every later comparison."""
        return not self.measures or (self.number == 1 and self.repeats and self._later())

    def influence(self, varies: bool, spread: float) -> bool:
        """Whether the criterion varies by more than the noise alone would let it."""
        deviation = self.measured.get("deviation") or 0.0
        return varies and not (deviation and spread <= limits.ABOVE_NOISE * deviation)

    def _cases(self) -> list[JsonObject]:
        last = self.claims["results"][-1]
        found = [f["validation"] for f in self.claims["findings"]]
        return [last["nominal"], *found, *(best["validation"] for best in last.get("incumbents", []))]

    def beside(self, noise: str) -> bool:
        """Whether nothing is wrong with several calls but that those of violations violate; noise: as of `checks`."""
        return self.number > 1 and self._several(noise, of_violations=False)

    def _several(self, noise: str, of_violations: bool = True) -> bool:
        simulator, threshold = self.campaign.simulator, self.campaign.criterion.threshold

        def sound(cost: Any, of: Any) -> bool:
            violation = cost is not None and cost <= threshold and of["violates"] and not of["repeats"]["failed"]
            return bool(of["ok"] and (of["agrees"] or (violation and not of_violations)))

        clear = all(sound(case["cost"], self.case(case)) for case in self._cases())
        spot = self.claims["results"][-1]["spot_checks"]
        clear = clear and spot["compared"] == spot["checked"]
        own = noise == "drawn" and not self.measured["by_process"]
        return clear and own and simulator is not None and simulator.combine == "worst"

    def _later(self) -> bool:
        spot = self.claims["results"][-1]["spot_checks"]
        same = all(case["again"]["difference"] == 0.0 for case in self._cases())
        return same and spot["compared"] == spot["checked"] and not spot["largest"]


def _same(costs: Any, status: Any) -> bool:
    return len(set(status.tolist())) == 1 and len(set(costs[status == OK].tolist())) <= 1


def _measured(points: Any, costs: Any, status: Any) -> JsonObject:
    """Evaluations of the same points in rounds: do they have the same bits?"""
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
    return {
        "points": len(groups),
        "evaluations": len(status),
        "failed": failed,
        "identical": identical,
        "by_process": used and not identical,
        "spread": max(several, default=None),
        "deviation": math.sqrt(sum(squares) / len(squares)) if squares else None,
    }
