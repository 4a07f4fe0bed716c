"""Recomputes costs, counts, findings and the statistical bounds of random samples from a run's stored evaluations.

Wilks (Annals of Mathematical Statistics 12, 1941).
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from itertools import count
from typing import Any

import numpy as np

from campaigns import Campaign, Catalogue, cube
from campaigns.asked.values import Option
from campaigns.checked.check import parameters, seeded
from campaigns.claims.wording import reworded
from campaigns.results.base import EXCLUDED, OK
from campaigns.results.finding import HalfStep, ReferenceCost, Repeated, Validation
from campaigns.results.sample import Blocks, Histogram, Noise, QuantileBound, Sample
from campaigns.stages.plan import plan
from campaigns.versions import Versions
from worker.evidence.audit import counted, grids, limits, seeds
from worker.evidence.audit.binomial import cumulative, least, upper_bound
from worker.evidence.audit.calls import Calls
from worker.evidence.audit.distribution import Drawn
from worker.evidence.audit.parts import OMIT, REST, Counts, Finding, changed, made
from worker.evidence.audit.record import MISSING, SEAL, Missing, Record

COARSER = "with a tolerance of "
"""How a reason begins with which the reference integrator has a value."""


def _of_quantile(size: int, fraction: float, confidence: float) -> QuantileBound:
    """Wilks: the r-th lowest of the sample, in which a failed evaluation is the lowest, bounds its quantile."""
    most = min(size - 1, math.ceil(size * fraction))
    first = least(size, fraction) if fraction > 0 else 0
    below = cumulative(most, size, fraction, first) if size and fraction > 0 else np.empty(0)
    r = int(np.count_nonzero(below <= math.log1p(-confidence)))
    if not r:
        return made(QuantileBound, order=None, bound=None, confidence=None, **REST)
    return made(QuantileBound, order=first + r, bound=None, confidence=-math.expm1(below[r - 1]), **REST)


def _needed(fraction: float, confidence: float) -> int | None:
    """The smallest sample whose lowest value bounds the quantile at `fraction`; None if none does that may be drawn."""
    if fraction < limits.SMALLEST:
        return None
    return max(1, math.ceil(math.log1p(-confidence) / math.log1p(-fraction) * (1.0 - 4e-15)))  # but for rounding


def counts(status: Any) -> Counts:
    """The numbers of evaluations by status."""
    ok, excluded = (int(np.count_nonzero(status == code)) for code in (OK, EXCLUDED))
    return Counts(len(status), len(status) - ok - excluded, excluded)


def histogram(costs: Any) -> Histogram:
    """The counts of a sample's costs between the edges."""
    known = costs[np.isfinite(costs)]
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 0.0)
    if math.isinf(high - low):
        return made(Histogram, edges=[low, high], counts=[len(known)])
    try:
        found, edges = np.histogram(known, bins=min(40, max(5, int(np.sqrt(len(costs))))))
    except ValueError:  # no bin can divide what differs by rounding
        apart = max(0.5, 4 * float(np.spacing(abs(high))))
        return made(Histogram, edges=[low - apart, high + apart], counts=[len(known)])
    return made(Histogram, edges=edges.tolist(), counts=found.tolist())


def _tails(campaign: Campaign, bounds: Mapping[str, tuple[float, float]]) -> dict[str, float]:
    """The probability beyond its bounds of every unbounded normal parameter."""
    tails = {}
    for path, (low, high) in bounds.items():
        of = campaign.uncertain[path].distribution
        if of.kind == "normal":
            ends = (of.mean - low) / of.deviation, (high - of.mean) / of.deviation
            tails[path] = sum(math.erfc(end / math.sqrt(2)) / 2 for end in ends)
    return tails


def _mixed(campaign: Campaign) -> set[str]:
    """The correlated parameters."""
    return {path for c in campaign.correlations if c.value != 0.0 for path in c.between}


def _finite(value: float) -> float | None:
    """The value; None for one beyond the largest float, which a file cannot state."""
    return float(value) if math.isfinite(value) else None


class Run:
    """The values recomputed from a run's evaluations. A missing cost is NaN; missing data raise `KeyError`.

    today: whether it is judged by the rules of today, whatever the version of its record."""

    def __init__(self, record: Record, today: bool = False) -> None:
        self.campaign, self.claims, twice, self.stage, self.points, costs, self.status, self.flaky, _ = record
        stored = self.claims.get("versions") or self.claims.get("provenance")
        self.reworded = reworded(Versions.of(stored))
        """Whose templates made the sentences, which are then not made again; empty if it is those of today."""
        self.written = Versions.of(stored).wording or 0
        self.wording = limits.RULES if today else self.written
        """The version of the rules by which it is judged."""
        self.older = self.wording < limits.ROUNDED and self.claims.get("verdict") != "cleared"
        """Whether what is rounding is judged as versions of before did: only where they cleared nothing by it."""
        self.sealed = SEAL not in twice or not isinstance(twice[SEAL][0], Missing)
        """Whether a version wrote it that states the evidence digest: then nothing of it may be absent."""
        self.whole = self.sealed or today
        """Whether what rules need is required, although versions before the evidence digest stored none of it."""
        self.plan, self.threshold = plan(self.campaign), self.campaign.criterion.threshold
        self.searches, self.certifying = (
            [k for k, planned in enumerate(self.plan) if planned.kind == kind] for kind in ("search", "certify")
        )
        self.every, self.raw, self.costs = costs, costs[:, 0], costs[self.status == OK, 0]
        by_stage = [self.raw[(self.stage == k) & (self.status == OK)] for k in range(len(self.plan))]
        self.ended = [counts(self.status[self.stage == k]) for k in range(len(self.plan))]
        self._early: dict[int, tuple[int, int | None]] = {}
        self.counted: dict[int, Blocks] = {}
        """The blocks of a sample of which only the lowest flights are stored, by its stage."""
        for k, result in enumerate(self.claims.get("results") or []):
            if result and result.get("blocks") is not None and self.plan[k].kind == "certify":
                self.counted[k] = counted.stored(result["blocks"])
                self.ended[k] = counted.ended(self.counted[k])
        self.best = [min(ok.tolist(), default=math.nan) for ok in by_stage]
        self.below = [int(np.count_nonzero(ok <= self.threshold)) for ok in by_stage]
        self.made = Counts(*map(sum, zip(*self.ended, strict=True)))
        """All evaluations, stored or only counted."""
        self.succeeded = self.made.evaluations - self.made.failed - self.made.excluded
        whole = {k: sum(blocks.violations) - sum(blocks.failed) for k, blocks in self.counted.items()}
        self.violating = sum(whole.get(k, below) for k, below in enumerate(self.below))
        if self.flaky is not MISSING:
            self.flaky += sum(blocks.beside.flaky for blocks in self.counted.values())
        first = np.flatnonzero(self.stage == 0)[:1]  # a simulator has further evaluations in the first stage
        self.nominal = float(self.raw[first][0]) if (self.status[first] == OK).any() else math.nan
        self.lowest = min(self.costs.tolist(), default=math.nan)
        self.others = self.means()
        stepped = "half_step" in self.others and self.wording >= limits.HALVED
        self.calls = Calls(record, *self.rows(0), self.wording, whole=self.whole, stepped=stepped)
        self.highest = max(self.costs.tolist(), default=math.nan)
        known = self.points[self.status == OK]
        self.one_point = len(known) > 0 and bool((known == known[0]).all())
        """Whether all evaluations with a cost are of one point."""
        lowest = grids.NEAREST if self.wording >= limits.NEAREST else ()
        self.resolution = grids.step(self.costs, self.wording >= limits.GRANTED, lowest, self.wording >= limits.EACH)
        self.varies = self.highest - self.lowest > self._rounding()
        self.findings = [self.finding(k) for k in range(len(self.claims["findings"]))]
        again = self._again()
        violating = [k for k, f in enumerate(self.findings) if f.validation.violates]
        violating = [k for k in violating if self.calls.noisy or (self.findings[k].margin <= 0.0 and again)]
        self.confirmed = bool(violating)
        known = "evaluated" in (self.claims.get("worst") or {})  # earlier versions stated the lowest evaluation
        costs = {k: self.granted(self.findings[k]) for k in violating}
        self.stated = min(costs.values(), default=self.lowest) if known else self.lowest
        self.worst = min(costs, key=costs.__getitem__, default=None)
        """The position of the worst confirmed finding."""
        self.bound: Any = MISSING
        self.searched: Mapping[int, Any] = {}
        """The searches of its estimates that were repeated, by stage."""

    def _decides(self, components: Catalogue) -> tuple[str, str]:
        """The quantity and unit of the deciding criterion."""
        criterion, simulator = self.campaign.criterion, self.campaign.simulator
        if simulator is None:
            entry: Any = components.component("criterion", criterion.component or "")
        else:
            entry = getattr(components.simulator(simulator.name), "result", lambda _: None)(criterion.result)
        if entry is None:
            raise KeyError("criterion")
        return entry.quantity, entry.unit

    def _rounding(self) -> float:
        """The spread of costs that is rounding; of what earlier versions did not clear, whatever the margin is."""
        size: float = max(abs(self.highest), abs(self.lowest))
        if self.older:
            return limits.ROUNDING * size
        beside: float = limits.AGREEMENT_OF_MARGIN * abs(self.lowest - self.threshold)
        return max(min(limits.ROUNDING * size, beside), limits.AGREEMENT_ROUNDING * size)

    def _again(self) -> bool:
        """Whether a stored violation violates again, as taken from the record."""
        last = next(reversed(self.claims.get("results") or [None]), None) or {}
        counts = last.get("violations") or {}
        return not counts.get("checked") or counts.get("confirmed", 0) > 0

    def granted(self, finding: Finding) -> float:
        """The mildest value of a violation whose values differ beyond tolerance, else its own."""
        case, label = finding.validation, finding.label
        claim: Any = next((f["validation"] for f in self.claims["findings"] if f["label"] == label), None)
        if case.agrees or not case.violates or (self.calls.noisy and self.wording < limits.CALLED):
            return float(finding.cost)
        if self.calls.noisy:
            return float(max(v for v in claim["repeats"]["values"] if v is not None and v <= self.threshold))
        return float(max(finding.cost, *(claim[k]["cost"] for k in self.others)))

    def means(self) -> tuple[str, ...]:
        """The independent means by which a case is confirmed."""
        simulator, known = self.campaign.simulator, self.claims.get("components")
        if simulator is None:
            return ("half_step", "integrator")
        entry = known.simulator(simulator.name) if known else None
        stepped = (entry is not None and entry.step is not None) or (self.wording >= limits.HALVED and self._of_fmu())
        return ("half_step", "again") if stepped else ("again",)

    def _of_fmu(self) -> bool:
        """Whether the scope states the settings of an FMU."""
        scope = "".join(str(span.get("text", "")) for span in self.claims.get("holds_for") or [])
        return re.search(r"; FMI \d\S* co-simulation from \S+ s to ", scope) is not None

    def finding(self, position: int) -> Finding:
        """A finding by the stored evaluation at its point."""
        recorded, name = self.claims["findings"][position], f"F{position + 1}"
        here = self.raw[(self.status == OK) & (self.points == np.array(recorded["point"])).all(axis=1)]
        cost = min(here.tolist(), key=lambda c: abs(c - recorded["cost"]), default=math.nan)
        ends = zip(self.campaign.uncertain, recorded["point"], strict=True)
        edges = {path: "low" if u < 0.5 else "high" for path, u in ends if min(u, 1 - u) <= 1e-9}
        case = self.case(recorded["validation"], name, cost)
        found = Finding(name, cost, cost - self.threshold, edges, case)
        earlier = not self.sealed or self.wording < limits.SHARED
        if "granted" not in recorded and (earlier or "run" in self.claims):  # in a database it follows
            return found
        granted = self.granted(found)
        return found._replace(granted=granted, margin=granted - self.threshold)

    def case(self, recorded: Any, name: str, stated_cost: float) -> Validation:
        """The validation of a case, from its cost as in the campaign and those by independent means; name, stated_cost:
        to be stated of it."""
        if self.calls.noisy:
            return self.calls.case(recorded, name, stated_cost)
        absent = (
            {} if self.campaign.simulator is None else {"half_step": {"cost": None}}
        )  # of an FMU, before it was due
        stated = (recorded["cost"], *((recorded[k] or absent[k])["cost"] for k in self.others))
        costs = np.array(stated, dtype=np.float64)  # None becomes NaN, for which every comparison is False
        cost, tolerance = float(costs[0]), self.campaign.stages.validate_.tolerance
        scenario = self.campaign.scenario if self.sealed else None
        size = self.nominal if self.wording < limits.WIDER else cost
        floor = min(limits.ROUNDING, tolerance) * max(abs(self.threshold), abs(size), 1e-9)
        allowed = max(min(tolerance * abs(cost), limits.TOLERANCE_OF_MARGIN * abs(cost - self.threshold)), floor)
        violates, clear = (bool(side.all()) for side in (costs <= self.threshold, costs > self.threshold))
        agrees = (violates or clear) and bool((np.abs(costs - cost) <= allowed).all())
        known = scenario is not None and math.isfinite(costs[2])
        known = known and not recorded["integrator"]["reason"].startswith(COARSER)
        step, half = (OMIT, OMIT) if scenario is None else (scenario.step, scenario.step / 2)
        named, reason = OMIT if scenario is None else "DOP853", "" if known else OMIT
        apart = {k: float(c) - cost for k, c in zip(self.others, costs[1:], strict=True)}
        by_half, by_other, by_call = (apart.get(k, OMIT) for k in ("half_step", "integrator", "again"))
        half_step = made(HalfStep, difference=by_half, step=half, **REST)
        integrator = made(ReferenceCost, difference=by_other, name=named, reason=reason, **REST)
        again = made(Repeated, difference=by_call, **REST)
        return made(
            Validation, name=name, cost=stated_cost, half_step=half_step if "half_step" in apart else OMIT,
            integrator=integrator if "integrator" in apart else OMIT, again=again if "again" in apart else OMIT,
            step=step, allowed=allowed, agrees=agrees, violates=violates, ok=agrees or violates,
        )  # fmt: skip

    def rows(self, k: int) -> tuple[Any, Any, Any]:
        """Points, first costs and status of a stage's evaluations."""
        here = self.stage == k
        return self.points[here], self.raw[here], self.status[here]

    def describe(self) -> None:
        """Look up the run's parameters and methods in the catalogue, and select the sample for the probability."""
        components = self.claims["components"]
        self.known = parameters(self.campaign, components)
        self.bounds = {path: u.interval(self.known[path][1]) for path, u in self.campaign.uncertain.items()}
        self.low, self.high = (np.array(ends) for ends in zip(*self.bounds.values(), strict=True))
        self.random = seeded(self.campaign, components)
        stated = [(path, self.campaign.uncertain.get(path), nominal) for path, (_, nominal) in self.known.items()]
        self.fixed_seeds = [each[0] for each in stated if self.wording >= limits.EACH and seeds.fixed(*each)]
        named = self.campaign.simulator and components.simulator(self.campaign.simulator.name)
        self.undeclared = bool(named and named.seeds) and self.wording >= limits.PARTS
        self.quantity, self.unit = self._decides(components)
        self.installed = {method.name: method for method in components.methods}
        self.methods = {k: self.installed[self.plan[k].method] for k in self.searches}
        random = {k for k in self.searches if self.methods[k].kind == "random"}
        self.samples = {k: self.sample(k) for k in sorted(random.union(self.certifying))}
        among = self.certifying or random
        claimable = (s for k, s in self.samples.items() if k in among and s.upper_bound is not None)
        self.claimed = next(claimable, None)
        self.bound = self.claimed and self.claimed.upper_bound
        points = [recorded["point"] for recorded in self.claims["findings"]]
        self.findings = [f._replace(parameters=self.values(at)) for f, at in zip(self.findings, points, strict=True)]

    def options(self, k: int) -> Mapping[str, Option]:
        """The options of a search; a certify stage has none."""
        return self.campaign.stages.search[self.searches.index(k)].options if k in self.searches else {}

    def grid(self, k: int) -> int:
        """How many points the grid of a certify stage has for each parameter; it comes after the draws."""
        certify = self.campaign.stages.certify if self.plan[k].kind == "certify" else None
        return certify.grid.points if certify and certify.grid else 0

    def draws(self, k: int) -> int:
        """How many draws a random sample has, excluded ones included."""
        return int(max(self.ended[k].evaluations - self.grid(k) ** len(self.bounds), 0))

    def values(self, point: Any) -> dict[str, float]:
        """A point (n,) of the unit cube as values by path."""
        nominal = [self.known[path][1] for path in self.bounds]
        return dict(zip(self.bounds, cube.natural(np.array(point), nominal, self.low, self.high).tolist(), strict=True))

    def sample(self, k: int) -> Sample:
        """The random sample of a search, or of the certify stage, whose grid comes after its draws."""
        certify, options = (self.campaign.stages.certify if self.plan[k].kind == "certify" else None), self.options(k)
        drawn = np.flatnonzero(self.stage == k)[: self.draws(k)]
        costs, blocks = np.sort(self.raw[drawn][self.status[drawn] == OK]), self.counted.get(k)
        draws, failed, excluded = counts(self.status[drawn]) if blocks is None else counted.ended(blocks)
        outside, level, size = self.outside(), self.campaign.confidence, draws - excluded
        below = failed + int(np.count_nonzero(costs <= self.threshold))
        violations = below if blocks is None else sum(blocks.violations)
        noise: Noise = "none"
        if self.random:
            own = certify and self.claims["results"][k]["drawn_realisations"] == (len(drawn) if blocks else draws)
            noise = "drawn" if own else "stated"
        if self.calls.noisy:
            noise = "drawn" if certify or self.calls.number == 1 else "stated"
        look = None
        if options.get("interval"):  # the k-th interim analysis spends 1 / (k (k + 1)) of the error
            look = next(n for n in count(1) if math.ceil(100 * 1.5 ** (n - 1)) >= draws)
            level = 1.0 - (1.0 - level) / (look * (look + 1))
        independent = options.get("sampling", "plain") == "plain" and not options.get("continued")
        _, before = self.early(k)
        bounding = size if before is None else before
        mean, deviation = (_finite(costs.mean()) if len(costs) else OMIT), OMIT
        if blocks is not None:
            moments = counted.moments(blocks)
            mean, deviation = (mean, None) if moments is None else moments
        elif self.sealed:
            deviation = _finite(costs.std(ddof=1)) if len(costs) > 1 else None
        found = made(
            Sample, failed=failed, excluded=excluded, samples=size, violations=violations, outside=outside,
            confidence=self.campaign.confidence, noise=noise, excluded_fraction=excluded / max(draws, 1),
            lowest=float(costs[0]) if len(costs) else OMIT, mean=mean, deviation=deviation,
            histogram=counted.histogram(blocks) if blocks is not None else histogram(costs) if self.sealed else OMIT,
            looks=look if self.sealed or look is not None else OMIT, quantile=None if self.sealed else OMIT,
            upper_bound=min(1.0, upper_bound(violations, bounding, level) + outside) if independent else None,
        )  # fmt: skip
        if certify is None:
            return found
        if before is not None:
            return changed(found, bound_samples=before, quantile=None, distribution=None)
        level = self.campaign.confidence
        # What fraction of those that are not excluded was moved is not known.
        moved = 1.0 if self.moved() > 0.0 and excluded else self.moved()
        stated = (self.claims["results"][k].get("sample") or {}).get("distribution") or {}
        function = Drawn(stated, level, moved, self.wording >= limits.ALIKE)
        quantile = _of_quantile(size, certify.quantile - outside, level)
        rank = quantile.order
        if blocks is not None:
            costs = costs[: counted.KEPT]
            shown = function.of_blocks(blocks, costs)
            bound = None if rank is None else counted.value(blocks, costs, rank)
        else:
            shown = function.of_costs(costs, failed) if self.sealed else OMIT
            bound = None if rank is None or rank <= failed else float(costs[rank - failed - 1])
        needed = _needed(certify.quantile - outside, level) if self.sealed else OMIT
        share = certify.quantile if self.sealed else OMIT
        quantile = changed(quantile, bound=bound, share=share, needed=needed)
        # Excluded draws are repeated, at most so often.
        short = size < certify.samples and draws < limits.draws(certify.samples, draws)
        return changed(found, distribution=shown, quantile=quantile, samples=certify.samples if short else size)

    def early(self, k: int) -> tuple[int, int | None]:
        """How many of the samples of a stage may violate, and how many its bound counts if it ended because more do."""
        certify, target = self.campaign.stages.certify, self.campaign.target_probability
        if k not in self.counted or certify is None or certify.until == "samples" or target is None:
            return -1, None
        if k not in self._early:
            most = target - self.outside()
            # Earlier versions counted a sample that was whole with its last block as one that ended early.
            by_size = self.wording >= limits.WHOLE or self.claims["results"][k]["sample"].get("bound_samples") is None
            numbers = certify.samples, most, self.campaign.confidence, by_size
            self._early[k] = counted.early(self.counted[k], *numbers)
        return self._early[k]

    def outside(self) -> float:
        """The probability that unbounded normal draws lie beyond the bounds; the sum of tails where correlated."""
        tails, mixed = _tails(self.campaign, self.bounds), _mixed(self.campaign)
        if any(tail > 0.0 and path in mixed for path, tail in tails.items()):
            return min(1.0, sum(tails.values()))
        return 1.0 - math.prod(1.0 - tail for tail in tails.values())

    def moved(self) -> float:
        """What the probability of a draw that was moved inside the bounds is at most: correlated ones are."""
        mixed = _mixed(self.campaign)
        return min(1.0, sum(tail for path, tail in _tails(self.campaign, self.bounds).items() if path in mixed))
