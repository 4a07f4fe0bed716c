"""Does the verdict of a stored run follow from its stored evaluations? A program to be read in a quarter of an hour.

It uses nothing of Clearance but the campaign as read, and simulates nothing: costs, the values of cases evaluated
again, basins and traces are taken as stored. Start reading at `verify`; the rules are in the order of the argument.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from campaigns.asked.spec import Campaign

UNCHECKED = "words, quantiles, units, what the catalogue states, basins, traces, how many cases were evaluated again"
OK, EXCLUDED = 0, 3  # how an evaluation ended; 1 is failed, 2 is timeout
SEARCHED = {"global": 25, "local": 3}  # the fewest evaluations per parameter that count as a search, by kind of method
ROUNDING = 1e-6  # differences below this fraction of what is compared are rounding
Compared = Iterator[tuple[str, Any, Any]]  # what is compared, as stated, as recomputed


class Run:
    """Campaign, claims (JSON), and for each of m evaluations the stage (m,), point (m, n), costs (m, k), status (m,);
    flaky: how many are ok only because a call of the simulator was tried again."""

    def __init__(self, campaign: Campaign, claims: Any, stage: Any, points: Any, costs: Any, status: Any, flaky: int):
        self.campaign, self.claims, asked = campaign, claims, campaign.simulator
        self.threshold = campaign.criterion.threshold
        self.stage, self.points, self.costs, self.status, self.flaky = stage, points, costs[:, 0], status, flaky
        self.kinds = [given["kind"] for given in claims["stages"]]
        self.searches = [k for k, kind in enumerate(self.kinds) if kind == "search"]
        self.total, self.counts = counts(self, stage >= 0), [counts(self, stage == k) for k in range(len(self.kinds))]
        self.nominal = counts(self, np.flatnonzero(stage == 0)[:1])["best"]
        low, high = self.total["best"], max(self.costs[status == OK].tolist(), default=math.nan)
        self.spread = high - low if high - low > ROUNDING * max(abs(low), abs(high)) else 0.0  # of all costs
        self.results = [result or {} for result in claims.get("results") or [{}]]  # null: the stage did not end
        self.measured = measured(self) if asked and self.counts[0]["evaluations"] > 1 else {}
        identical = self.measured.get("identical") and self.results[0].get("measured", {}).get("declared", True)
        self.noisy = bool(self.measured and asked and (asked.calls > 1 or not identical))


def counts(run: Run, here: Any) -> dict[str, Any]:
    """The counts of evaluations; best is NaN if none is ok."""
    status, ok, excluded = run.status[here], run.status[here] == OK, run.status[here] == EXCLUDED
    found = {"evaluations": len(status), "failed": int((~ok & ~excluded).sum()), "excluded": int(excluded.sum())}
    return found | {"best": min(run.costs[here][ok].tolist(), default=math.nan)}


def verify(run: Run) -> tuple[bool, list[str]]:
    """Whether the verdict follows, and the sentence that states so, or every disagreement in a sentence."""
    wrong, unknown = list[str](), dict[str, None]()
    for rule in (evaluations, findings, cases, statistics, verdict):
        try:
            for what, stated, found in rule(run):  # what comes before a field that is not stored counts
                wrong += [] if same(stated, found) else [f"{what}: stated {stated}, recomputed {found}"]
        except LookupError as field:
            unknown[f"{field.args[0]} is not stored by the version that made this run"] = None
            wrong += ["it is not known whether the verdict follows"] if rule is verdict else []
        except (TypeError, ValueError, AttributeError) as error:
            wrong.append(f"{rule.__name__}: the record is malformed: {error}")
    said = f"the verdict {run.claims['verdict']} follows from the {len(run.status)} stored evaluations"
    return not wrong, [*wrong, *unknown] if wrong else ["; ".join([f"{said}; not checked: {UNCHECKED}", *unknown])]


def same(stated: Any, found: Any) -> bool:
    """Equal, numbers up to rounding; NaN is a missing value, stated as null."""
    if isinstance(found, float | int) and isinstance(stated, float | int):
        return math.isclose(stated, found, rel_tol=1e-9, abs_tol=1e-15)
    return bool(stated == (found if found == found else None))


def evaluations(run: Run) -> Compared:
    """An evaluation has a cost if and only if it is ok, and is within the bounds. The counts leave nothing out. The
    worst case is the minimum over every stored evaluation of every stage; nominal is the first evaluation."""
    yield "digest of the campaign", run.claims["digest"], run.campaign.digest
    broken = ((run.status == OK) != np.isfinite(run.costs)) | (run.status > EXCLUDED)
    yield "evaluations whose status and cost contradict each other", 0, int(broken.sum())
    yield "evaluations outside the bounds", 0, int((~(np.abs(run.points - 0.5) <= 0.5 + 1e-9).all(axis=1)).sum())
    yield "evaluations of no stage", 0, int((run.stage >= len(run.kinds)).sum())
    ok, total = run.costs[run.status == OK], run.total
    whole = {"stored": total["evaluations"], "lowest": total["best"], "succeeded": len(ok), "flaky": run.flaky}
    whole |= {"failed": total["failed"], "excluded": total["excluded"], "violating": int((ok <= run.threshold).sum())}
    stated = {"flaky": 0} | run.claims["evaluations"]  # omitted if there are none
    yield from ((f"evaluations.{name}", stated[name], count) for name, count in whole.items())
    for k, stage in enumerate(run.claims["stages"]):
        yield from ((f"stages.{k}.{name}", stage[name], count) for name, count in run.counts[k].items())
    asked = [search.method for search in run.campaign.stages.search]
    yield "searches", [run.claims["stages"][k]["method"] for k in run.searches], asked
    for name, cost in {"worst": run.total["best"], "nominal": run.nominal}.items():
        given = run.claims[name] or {"cost": None, "margin": None}
        yield f"{name}.cost", given["cost"], cost
        yield f"{name}.margin", given["margin"], cost - run.threshold


def findings(run: Run) -> Compared:
    """Every finding is a stored evaluation, at its point."""
    for k, given in enumerate(run.claims["findings"], 1):
        yield f"finding {k}", given["label"], f"F{k}"
        here = [axis == u for axis, u in zip(run.points.T, given["point"], strict=True)]
        costs = run.costs[np.logical_and.reduce([run.status == OK, *here])].tolist()
        cost = min(costs, key=lambda c: abs(c - given["cost"]), default=math.nan)
        yield f"F{k}.cost", given["cost"], cost
        yield f"F{k}.margin", given["margin"], cost - run.threshold


def measured(run: Run) -> dict[str, float]:
    """Does a simulator repeat? Its first stage evaluates each point several times, the last time in a fresh process."""
    groups = dict[bytes, list[tuple[int, float]]]()
    for k in np.flatnonzero(run.stage == 0):
        cost = float(run.costs[k]) if run.status[k] == OK else 0.0
        groups.setdefault(run.points[k].tobytes(), []).append((int(run.status[k]), cost))
    identical, used = (all(len(set(rows[:end])) <= 1 for rows in groups.values()) for end in (None, -1))
    ok = [np.array([cost for status, cost in rows if status == OK]) for rows in groups.values()]
    apart = [float(np.var(costs - costs.min(), ddof=1)) for costs in ok if len(costs) > 1]
    deviation = math.sqrt(sum(apart) / len(apart)) if apart else math.nan
    return {"identical": identical, "by_process": used and not identical, "deviation": deviation}


def case(run: Run, given: Any) -> dict[str, float]:
    """A case evaluated again is a violation if every value violates, and clear if all are clear and within tolerance.
    Where results do not repeat, one violating call is a violation, and clear means that no call violates or fails."""
    asked, threshold, simulator = run.campaign.stages.validate_, run.threshold, run.campaign.simulator
    if run.noisy:
        values = np.array(given["repeats"]["values"], dtype=np.float64)  # null becomes NaN, on neither side
        m, violating, failed = len(values), int((values <= threshold).sum()), int(np.isnan(values).sum())
        level = (1 + run.campaign.confidence) / 2  # two-sided; a failed call is clear below, a violation above
        low, high = 1 - upper_bound(m - violating, m, level), upper_bound(violating + failed, m, level)
        agrees = given["cost"] is not None and given["cost"] > threshold and not violating and not failed
        found = {"violating": violating, "failed": failed, "low": low, "high": high, "agrees": agrees}
        return found | {"violates": violating > 0, "ok": m == asked.repeats and (agrees or violating > 0)}
    halved = simulator is None or any(s.get("step") for s in run.claims["components"]["simulators"])
    means = (["half_step"] if halved else []) + ["integrator" if simulator is None else "again"]
    costs = np.array([given["cost"], *(given[name]["cost"] for name in means)], dtype=np.float64)
    floor = min(ROUNDING, asked.tolerance) * max(abs(threshold), abs(run.nominal), 1e-9)
    allowed = max(min(asked.tolerance * abs(costs[0]), 0.1 * abs(costs[0] - threshold)), floor)
    violates, clear = bool((costs <= threshold).all()), bool((costs > threshold).all())
    agrees = (violates or clear) and bool((np.abs(costs - costs[0]) <= allowed).all())
    return {"allowed": allowed, "agrees": agrees, "violates": violates, "ok": agrees or violates}


def again(run: Run) -> list[tuple[str, Any, Any]]:
    """Label, validation and cost of nominal, findings, and, where results do not repeat, the best of every search."""
    last, found = run.results[-1], [(f["label"], f["validation"], f["cost"]) for f in run.claims["findings"]]
    best = [(b["position"], b["validation"]) for b in last["incumbents"]] if run.noisy else []
    return [("nominal", last["nominal"], run.nominal), *found, *((k, v, run.counts[k]["best"]) for k, v in best)]


def cases(run: Run) -> Compared:
    """The statements on cases evaluated again follow from their values; a simulator repeats or not, as measured."""
    for label, given, cost in again(run):
        stated, found = given | (given.get("repeats") or {}), case(run, given) | {"cost": cost}
        yield from ((f"{label}.validation.{name}", stated[name], value) for name, value in found.items())
    yield from ((f"measured.{name}", run.results[0]["measured"][name], value) for name, value in run.measured.items())
    if run.noisy:
        best = [k for k in run.searches if not math.isnan(run.counts[k]["best"])]
        yield "searches whose best is called again", [b["position"] for b in run.results[-1]["incumbents"]], best


def upper_bound(violations: int, samples: int, confidence: float) -> float:
    """Clopper and Pearson 1934: the p with P(Binomial(samples, p) <= violations) = 1 - confidence, by bisection."""
    i, low, high = np.arange(violations + 1), 0.0, 1.0
    ways = np.concatenate([[0.0], np.cumsum(np.log((samples - i[:-1]) / i[1:]))])  # logarithms of binomial coefficients
    for _ in range(60 if violations < samples else 0):
        p = (low + high) / 2
        tail = np.logaddexp.reduce(ways + i * math.log(p) + (samples - i) * math.log1p(-p))
        low, high = (p, high) if tail > math.log1p(-confidence) else (low, p)
    return high


def sample(run: Run) -> dict[str, Any]:
    """The independent, pre-declared sample: that of the certify stage, or of the first plain random search."""
    certify, scenario = run.campaign.stages.certify, run.campaign.scenario
    parts = {part.component for part in (*scenario.environment, *scenario.faults)} if scenario else set()
    known = [c for c in run.claims["components"]["components"] if c["name"] in parts]
    noise = "stated" if run.noisy or any(p["name"] == "seed" for c in known for p in c["parameters"]) else "none"
    kinds = {method["name"]: method["kind"] for method in run.claims["components"]["methods"]}
    asked = [(k, s.options) for k, s in enumerate(run.campaign.stages.search) if kinds[s.method] == "random"]
    plain = [(k, o) for k, o in asked if o.get("sampling", "plain") == "plain" and not o.get("continued")]
    if not (certify or plain):
        return {"noise": noise}
    k = run.kinds.index("certify") if certify else run.searches[plain[0][0]]
    grid = certify.grid.points ** len(run.campaign.uncertain) if certify and certify.grid else 0  # after the draws
    here = np.flatnonzero(run.stage == k)[: max(run.counts[k]["evaluations"] - grid, 0)]
    found, level, draws = counts(run, here), run.campaign.confidence, len(here)
    excluded, violations = found["excluded"], found["failed"] + int((run.costs[here] <= run.threshold).sum())
    if not certify and plain[0][1].get("interval"):  # interim analysis n spends 1 / (n (n + 1)) of the error
        n = next(n for n in range(1, 200) if math.ceil(100 * 1.5 ** (n - 1)) >= draws)
        level = 1 - (1 - level) / (n * (n + 1))
    single = run.campaign.simulator is not None and run.campaign.simulator.calls == 1  # each draws its own noise
    if noise == "stated" and (single or (certify and (run.noisy or run.results[k]["drawn_realisations"] == draws))):
        noise = "drawn"
    size = draws - excluded  # an excluded draw is repeated, up to 20 times
    size = max(size, certify.samples) if certify and draws < 20 * certify.samples else size
    found = {"samples": size, "violations": violations, "failed": found["failed"], "excluded": excluded, "noise": noise}
    found |= {"excluded_fraction": excluded / max(draws, 1), "confidence": run.campaign.confidence}
    return found | {"upper_bound": min(1.0, upper_bound(violations, size, level) + outside(run))}


def outside(run: Run) -> float:
    """The probability of unbounded normal distributions beyond the bounds; a sum of tails holds if correlated."""
    tails, mixed = dict[str, float](), {path for c in run.campaign.correlations if c.value for path in c.between}
    for path, given in run.campaign.uncertain.items():
        if given.distribution.kind == "normal":
            mean, deviation = given.distribution.mean, given.distribution.deviation * math.sqrt(2)
            low, high = given.interval(run.results[0]["parameters"][path])
            tails[path] = (math.erfc((mean - low) / deviation) + math.erfc((high - mean) / deviation)) / 2
    correlated = any(tails[path] > 0 for path in mixed & tails.keys())
    return min(1.0, sum(tails.values())) if correlated else 1 - math.prod(1 - tail for tail in tails.values())


def statistics(run: Run) -> Compared:
    """The statement on P(violation) is that of the independent sample."""
    found, stated = sample(run), run.claims["statistics"]
    yield "a statement on P(violation) is made", stated is not None, "samples" in found
    yield from ((f"statistics.{name}", stated[name], value) for name, value in found.items() if stated)


def verdict(run: Run) -> Compared:
    """violated: a finding of which every evaluation violates, or, if results do not repeat, one call. cleared: every
    check holds. inconclusive: anything else."""
    held = [(f["margin"], case(run, f["validation"])) for f in run.claims["findings"]]
    if any(found["violates"] and (margin <= 0 or run.noisy) for margin, found in held):
        yield "verdict", run.claims["verdict"], "violated"
        return
    intended = {name.replace("_", " ") for name in run.campaign.encounter.intended}  # as the author states
    holds = {name: ok or name in intended for name, ok in (*checks(run), *conditions(run))}
    stated = {check["name"]: check["ok"] for check in run.claims["checks"]}
    yield from ((f"check '{name}'", stated.get(name, "nothing"), ok) for name, ok in holds.items())
    yield "verdict", run.claims["verdict"], "cleared" if all((stated | holds).values()) else "inconclusive"


def checks(run: Run) -> Iterator[tuple[str, bool]]:
    """What must hold before a campaign is cleared, by the name of the check; no one method or bound is enough."""
    last, lowest, simulator = run.results[-1], run.total["best"], run.campaign.simulator
    spot, held = last["spot_checks"], [case(run, given) for _, given, _ in again(run)]
    yield "nominal", run.nominal > run.threshold
    ended = all(stage.get("state", "done") == "done" for stage in run.claims["stages"])
    yield "search", ended and not any(math.isnan(run.counts[k]["best"]) for k in run.searches)
    yield "no violation", lowest > run.threshold
    yield "minimum", last["findings"]["complete"] and any(f["cost"] <= lowest for f in run.claims["findings"][:1])
    yield "agreement", agreement(run)
    compared = spot["violating"] == 0 and (spot["compared"] > 0 or spot["checked"] == 0)
    first = held[: 1 + len(run.claims["findings"])]
    yield "validation" if simulator is None else "repetition", compared and all(found["ok"] for found in first)
    yield "evaluations", run.total["failed"] == 0
    yield "influence", run.spread > 0 and not run.spread <= 10 * run.measured.get("deviation", 0.0)
    if simulator is None:  # the encounter took place: inside the horizon, with a manoeuvre, and the avoider matters
        moved, unseen = last["encounter"]["moved"] or 0.0, last["encounter"]["unseen"]["cost"]
        blind = math.nan if unseen is None else unseen
        yield "motion", moved > 0.01 * abs(run.nominal)
        yield "avoidance", run.nominal - blind > ROUNDING * max(abs(run.nominal), abs(blind))
        known = [c for c in run.claims["components"]["components"] if c["name"] == run.campaign.criterion.component]
        closest = [(c["closest"] or {}).get("at") == "inside" for c in (last["encounter"], *run.claims["findings"])]
        yield from [("closest approach", all(closest)) for c in known if c["of"] == "obstacles"]


def conditions(run: Run) -> Iterator[tuple[str, bool]]:
    """Noise is drawn for every sample, few evaluations are excluded, the bound on P(violation) meets its target. A
    simulator that does not repeat is cleared only by the worst of several calls, and by calls of their own."""
    drawn, asked, last, target = sample(run), run.campaign.simulator, run.results[-1], run.campaign.target_probability
    noise, bound, spot = drawn["noise"], drawn.get("upper_bound", 1.0), last["spot_checks"]
    if asked and run.measured:
        if asked.retries:
            yield "retries", run.flaky == 0
        single = asked.calls == 1 and not run.noisy and not spot["largest"]
        repeats = single and all(given["again"]["difference"] == 0 for _, given, _ in again(run))
        held = [found["agrees"] and found["ok"] for found in (case(run, given) for _, given, _ in again(run))]
        own = asked.calls > 1 and asked.combine == "worst" and noise == "drawn" and not run.measured["by_process"]
        yield "noise of calls", spot["compared"] == spot["checked"] and (repeats or (own and all(held)))
    elif noise != "none" and run.campaign.scenario:
        given = run.campaign.scenario.realisations
        yield "noise", noise == "drawn" and not (given.combine == "mean" and len(given.seeds) > 1)
    if excluded := run.total["excluded"]:
        yield "exclusions", max(excluded / len(run.status), drawn.get("excluded_fraction", 0.0)) <= 0.1
    if target is not None:
        yield "target", bound <= target and noise != "stated"
    elif "upper_bound" in drawn:
        yield "probability", bound <= 0.05


def agreement(run: Run) -> bool:
    """At least two methods that searched, all global ones among them, reached the worst case and its cost."""
    found = {f["label"]: f for f in run.claims["findings"]}
    stated = [f["cost"] for f in found.values() if f["validation"]["realisation"] is None]  # with the noise of searches
    worst = min(stated or [f["cost"] for f in found.values()], default=math.nan)
    within = max(min(run.campaign.agreement, 0.2) * (run.nominal - worst), 1e-9 * max(abs(worst), 1.0))
    kinds = {method["name"]: method["kind"] for method in run.claims["components"]["methods"]}
    basins, came = {row["position"]: row["basin"] for row in run.claims["comparison"]}, dict[int, bool]()
    methods = dict(zip(run.searches, run.campaign.stages.search, strict=True))
    for k, asked in methods.items():
        kind, spent = kinds[asked.method], run.counts[k]["evaluations"]
        searched = kind in SEARCHED and spent >= SEARCHED[kind] * len(run.campaign.uncertain)
        searched = searched and not (kind == "local" and spent >= asked.evaluations)  # ended before it converged
        came[k] = searched and run.counts[k]["best"] - worst <= within and basins[k] in found
    globally = [came[k] for k, asked in methods.items() if kinds[asked.method] == "global"]
    several = len({methods[k].method for k in came if came[k]}) > 1
    return bool(globally) and all(globally) and several and (not run.spread or worst < run.nominal)
