"""What follows from a run's stored evaluations alone, in the shape of the claims; `MISSING` where something is missing.

Clopper and Pearson (Biometrika 26, 1934); Wilks (Annals of Mathematical Statistics 12, 1941). Start at `Recomputed`.
"""

from __future__ import annotations

import math
from itertools import count
from typing import Any

import numpy as np

from campaigns.asked.check import parameters, seeded
from campaigns.asked.plan import plan
from worker.audit.record import MISSING, Columns, Record, at

FLOOR = 1e-6
"""Fraction of the scale of what is compared below which a difference is rounding."""


def cumulative(most: int, samples: int, p: float) -> Any:
    """The logarithms of P(Binomial(samples, p) <= i) for i = 0 .. most."""
    i = np.arange(most + 1)
    ways = np.concatenate([[0.0], np.cumsum(np.log((samples - i[:-1]) / i[1:]))])
    return np.logaddexp.accumulate(ways + i * math.log(p) + (samples - i) * math.log1p(-p))


def upper_bound(violations: int, samples: int, confidence: float) -> float:
    """The probability p of which P(Binomial(samples, p) <= violations) is 1 - confidence, by bisection."""
    low, high = 0.0, 1.0
    for _ in range(60 if violations < samples else 0):
        middle = (low + high) / 2
        above = cumulative(violations, samples, middle)[-1] > math.log1p(-confidence)
        low, high = (middle, high) if above else (low, middle)
    return high


def counts(columns: Columns) -> dict[str, Any]:
    """How many evaluations there are, and how they ended."""
    excluded, ok = (int(np.count_nonzero(columns.status == status)) for status in (3, 0))
    return {"evaluations": len(columns.status), "failed": len(columns.status) - ok - excluded, "excluded": excluded}


class Recomputed:
    """A run's evaluations by stage, and what they amount to."""

    def __init__(self, record: Record) -> None:
        self.campaign, self.components, columns, self.claims = record
        self.threshold, self.plan = self.campaign.criterion.threshold, plan(self.campaign)
        self.searches = [k for k, stage in enumerate(self.plan) if stage.kind == "search"]
        empty = Columns(np.empty((0, len(self.campaign.uncertain))), np.empty((0, 1)), np.empty(0, np.uint8))
        self.columns = [columns.get(k, empty) for k in range(len(self.plan))]
        self.costs = [c.costs[c.status == 0, 0] for c in self.columns]
        self.all = np.concatenate(self.costs)
        self.lowest, self.highest = (float(f(self.all)) if len(self.all) else None for f in (np.min, np.max))
        self.nominal = self.best(0)
        self.rows = [counts(c) for c in self.columns]
        stored, failed, excluded = (sum(r[k] for r in self.rows) for k in ("evaluations", "failed", "excluded"))
        self.total = {"stored": stored, "succeeded": len(self.all), "failed": failed, "excluded": excluded}
        self.total["violating"] = int(np.count_nonzero(self.all <= self.threshold))
        ok = [(c.status == 0) == np.isfinite(c.costs[:, 0]) for c in self.columns]
        self.sound = all(bool(o.all() and (c.status < 4).all()) for o, c in zip(ok, self.columns, strict=True))
        apart = (self.highest or 0.0) - (self.lowest or 0.0)
        self.varies = apart > FLOOR * max(abs(self.highest or 0.0), abs(self.lowest or 0.0))
        known = parameters(self.campaign, self.components) if self.components else {}
        self.bounds: dict[str, Any] = {
            path: u.interval(known[path][1] if path in known else 0.0)
            if path in known or u.low is not None
            else MISSING
            for path, u in self.campaign.uncertain.items()
        }
        criterion = self.components and self.components.component("criterion", self.campaign.criterion.component)
        self.of = getattr(criterion, "of", MISSING)
        self.random: Any = bool(seeded(self.campaign, self.components)) if self.components else MISSING

    def best(self, k: int) -> float | None:
        return float(self.costs[k].min()) if len(self.costs[k]) else None

    def margin(self, cost: float | None) -> float | None:
        return None if cost is None else cost - self.threshold

    def method(self, k: int, what: str) -> Any:
        """A method's kind or title, by what the catalogue was; by the record's own word where that is not stored."""
        named = self.components and self.components.method(self.plan[k].method or "")
        return getattr(named, what) if named else at(self.claims, "comparison", self.searches.index(k), what)

    def result(self, k: int) -> dict[str, Any]:
        """The result of a stage that is no validation."""
        kind, best, columns = self.plan[k].kind, self.best(k), self.columns[k]
        if kind == "nominal":
            return {"cost": best, "margin": self.margin(best)}
        told = self.rows[k] | {"sample": None} if kind != "sensitivity" else {}
        if kind == "certify" or (kind == "search" and self.method(k, "kind") == "random"):
            told["sample"] = self.sample(k)
        if kind == "search":
            index = int(np.where(columns.status == 0, columns.costs[:, 0], np.inf).argmin())
            told["best"] = None if best is None else {"cost": best, "margin": self.margin(best), "index": index}
            told["stop"] = {"kind": "budget" if len(columns.status) >= self.plan[k].planned else "rule"}
        return told

    def sample(self, k: int) -> dict[str, Any]:
        """The random sample of a search or the certify stage; the grid that comes after the draws is none of it."""
        asked = self.campaign.stages.certify if self.plan[k].kind == "certify" else None
        options = {} if asked else self.campaign.stages.search[k - self.searches[0]].options
        draws = len(self.columns[k].status) - (asked.grid.points ** len(self.bounds) if asked and asked.grid else 0)
        drawn = Columns(*(column[: max(draws, 0)] for column in self.columns[k]))
        costs, told = np.sort(drawn.costs[drawn.status == 0, 0]), counts(drawn)
        size, failed = told.pop("evaluations") - told["excluded"], told["failed"]
        violations, outside = failed + int(np.count_nonzero(costs <= self.threshold)), self.outside()
        level = confidence = self.campaign.confidence
        if options.get("interval"):  # look k at a sample that may stop early spends 1 / (k (k + 1)) of the error
            look = next(n for n in count(1) if math.ceil(100 * 1.5 ** (n - 1)) >= draws)
            level = 1.0 - (1.0 - confidence) / (look * (look + 1))
        told |= {"samples": size, "violations": violations, "outside": outside, "confidence": confidence}
        told |= {"excluded_fraction": told["excluded"] / max(draws, 1), "lowest": None, "mean": None, "noise": "none"}
        told |= {"lowest": float(costs[0]), "mean": float(costs.mean())} if len(costs) else {}
        if self.random is not False:
            own = at(self.claims, "results", k, "drawn_realisations") if asked else 0
            told["noise"] = MISSING if MISSING in (self.random, own) else "drawn" if own == draws else "stated"
        bound = outside if outside is MISSING else min(1.0, upper_bound(violations, size, level) + outside)
        independent = options.get("sampling", "plain") == "plain" and not options.get("continued")
        told["upper_bound"] = bound if independent else None
        if asked and size < asked.samples and draws < 20 * asked.samples:
            told["samples"] = asked.samples  # draws are missing: excluded ones are drawn again, up to 20 times as many
        if asked and outside is not MISSING:
            share = asked.quantile - outside
            below = (
                cumulative(min(size - 1, math.ceil(size * share)), size, share) if size and share > 0 else np.empty(0)
            )
            r = int(np.count_nonzero(below <= math.log1p(-confidence)))
            value = float(costs[r - 1 - failed]) if r > failed else None
            told["quantile"] = {
                "order": r or None,
                "bound": value,
                "confidence": -math.expm1(below[r - 1]) if r else None,
            }
        return told

    def statistics(self) -> dict[str, Any] | None:
        """The sample that a probability may be claimed from: that of certify, else of the first random search."""
        certify = [k for k, stage in enumerate(self.plan) if stage.kind == "certify"]
        drawn = certify or [k for k in self.searches if self.method(k, "kind") == "random"]
        return next((s for s in map(self.sample, drawn) if s["upper_bound"] is not None), None)

    def outside(self) -> Any:
        """The probability that unbounded normal draws lie beyond the bounds; the sum of tails where correlated."""
        tails = {}
        for path, uncertain in self.campaign.uncertain.items():
            given, bounds = uncertain.distribution, self.bounds[path]
            if given.kind == "normal" and bounds is MISSING:
                return MISSING
            if given.kind == "normal":
                ends = ((d / given.deviation / math.sqrt(2)) for d in (given.mean - bounds[0], bounds[1] - given.mean))
                tails[path] = sum(math.erfc(end) / 2 for end in ends)
        mixed = {path for c in self.campaign.correlations if c.value != 0.0 for path in c.between}
        if any(tail > 0.0 and path in mixed for path, tail in tails.items()):
            return min(1.0, sum(tails.values()))
        return 1.0 - math.prod(1.0 - tail for tail in tails.values())

    def finding(self, given: dict[str, Any]) -> dict[str, Any]:
        """A finding by the stored evaluation at its point."""
        point, values = np.array(given["point"], dtype=np.float64), dict(given["parameters"])
        here = np.concatenate([c.costs[(c.status == 0) & (c.points == point).all(axis=1), 0] for c in self.columns])
        cost = float(here[np.abs(here - given["cost"]).argmin()]) if len(here) else None
        ends = zip(self.bounds, point, strict=True)
        edges = {path: "low" if u < 0.5 else "high" for path, u in ends if min(u, 1 - u) <= 1e-9}
        for (path, bounds), u in zip(self.bounds.items(), point, strict=True):
            value = bounds if bounds is MISSING else float(bounds[0] + u * (bounds[1] - bounds[0]))
            if bounds is MISSING or abs(value - values[path]) > 1e-9 * (bounds[1] - bounds[0]):
                values[path] = value
        told = {"cost": cost, "margin": self.margin(cost), "at_bounds": edges, "parameters": values}
        return told | {"validation": self.case(at(given, "validation"))}

    def case(self, given: Any) -> dict[str, Any]:
        """What follows from the three costs of a case: the one at the campaign's step and the two others."""
        costs = [at(given, "cost"), at(given, "half_step", "cost"), at(given, "integrator", "cost")]
        if MISSING in costs:
            return dict.fromkeys(("agrees", "violates", "ok"), MISSING)
        cost, sides, allowed = costs[0], {c <= self.threshold for c in costs if c is not None}, None
        apart = [None if None in (cost, c) else c - cost for c in costs[1:]]
        if cost is not None:
            scale = max(abs(self.threshold), abs(self.nominal or 0.0), 1e-9)
            tolerance = self.campaign.stages.validate_.tolerance
            allowed = max(min(tolerance * abs(cost), 0.1 * abs(cost - self.threshold)), min(FLOOR, tolerance) * scale)
        agrees = len(sides) == 1 and all(d is not None and abs(d) <= (allowed or 0.0) for d in apart)
        violates = None not in costs and sides == {True}
        told = {"allowed": allowed, "agrees": agrees, "violates": violates, "ok": agrees or violates}
        return told | {"half_step": {"difference": apart[0]}, "integrator": {"difference": apart[1]}}
