"""The audit: compares every claim of a record with its evaluations, and the verdict with the rules.

Start reading at `audit`; `closing` is the final sentence.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from campaigns.asked.allowance import validation
from campaigns.checked import extents, rates
from campaigns.checked.check import parameters
from campaigns.claims import earlier
from campaigns.claims.numbers import Format, count
from campaigns.claims.say import listed
from campaigns.claims.spans import Quantity, Spans, values, words
from campaigns.claims.stages.surroundings import possible_gain
from campaigns.refusals import RefusalCode
from campaigns.results.base import OK, STATUS
from campaigns.results.draws import of_indices
from campaigns.results.verdict import SCOPE
from campaigns.stages.plan import most
from worker.evidence.audit import charts, counted, limits, modes
from worker.evidence.audit.agreement import agreement, apart, family
from worker.evidence.audit.attraction import attracted
from worker.evidence.audit.estimate import Searched, estimated
from worker.evidence.audit.likelihood import likely
from worker.evidence.audit.points import grid, required
from worker.evidence.audit.recompute import Run, Tree
from worker.evidence.audit.record import MISSING, Missing, Record, UnreadableError
from worker.evidence.audit.regression import evaluated, position, regression
from worker.evidence.audit.sentences import SPANS, needed, of_sample, of_stage, shown, unlike
from worker.evidence.audit.sureness import sureness

OPENINGS = {"cleared": "stayed above", "violated": "falls to or below"}
"""Words in the first sentence of these verdicts; any other says that nothing may be claimed."""
BESIDE = ("outside", "lowest", "mean", "deviation", "histogram", "distribution", "looks")
"""Fields of a sample that the statistics of the verdict do not have."""
ABSENT = "absent"
"""In place of a value that every run of this version stores."""


class Item(NamedTuple):
    """One claim: its path in the record, the value given there, and the recomputed one."""

    name: str
    given: Any
    recomputed: Any

    @property
    def agrees(self) -> bool | None:
        """Whether stored and recomputed values agree; None if one of the two is unknown."""
        if isinstance(self.given, Missing) or isinstance(self.recomputed, Missing):
            return None
        if isinstance(self.given, int | float) and isinstance(self.recomputed, int | float):
            return math.isclose(self.given, self.recomputed, rel_tol=1e-9, abs_tol=1e-15)
        return bool(self.given == self.recomputed)


class Known(NamedTuple):
    """What is known of a run besides its record. sentences: as stored and as made again, by path; titles: how checks
    are shown, likewise; components: how those that its record describes differ from the same ones here, as clauses; or
    why there is nothing to compare. searches: of estimates, by stage; None if its stored evaluations are not those that
    it requests."""

    sentences: Mapping[str, tuple[Any, Spans | Missing]] | Missing
    titles: Mapping[str, tuple[Any, Any]]
    components: list[str] | Missing
    searches: Mapping[int, Searched | Missing | None] = {}


NOTHING = Known(Missing("not made again"), {}, Missing("not compared"))


def audit(
    record: Record, known: Known = NOTHING, at_most: int = limits.VIOLATIONS, spot_checks: int = limits.SPOT_CHECKS
) -> list[Item]:
    """Every claim with its recomputed value; raises `UnreadableError` for a record with a different structure."""
    try:
        run = Run(record)
        run.searched = known.searches
        claims = run.claims | {"sound": True, "placed": True, "checks": _as_stated(run)}
        try:
            run.describe()
            claims["sentence"], sentence = _sentence(run)
            expected = _stored(run) | {"sentence": sentence} | _concluded(run, at_most, spot_checks)
            places = required(run)
            claims["points"], expected["points"] = ({name: pair[k] for name, pair in places.items()} for k in (0, 1))
            if run.sealed:
                claims["checks"] = dict.fromkeys(expected["checks"], ABSENT) | claims["checks"]
        except (KeyError, TypeError):  # with a result or the catalogue absent or null, only a violation follows
            unknown = dict.fromkeys(("results", "comparison", "statistics", "sentence"), MISSING)
            expected = _stored(run) | unknown | {"checks": dict.fromkeys(claims["checks"], MISSING)}
            if run.sealed:
                claims["whole"], expected["whole"] = "results or components are absent, or of another form", "whole"
        worded = [*_worded(run, known)] if run.sealed else [Item("words", MISSING, MISSING)]
    except (TypeError, ValueError, KeyError, IndexError, AttributeError) as error:
        message = f"the record is not that of a run: {type(error).__name__}: {error}"
        raise UnreadableError(message, RefusalCode.UNREADABLE) from None
    twice = [Item(name, *pair) for name, pair in record.twice.items()]
    return [*twice, *_compared("", claims, expected, ABSENT if run.sealed else MISSING), *worded]


def _worded(run: Run, known: Known) -> Iterator[Item]:
    """The sentences that were made again, texts that are not the words of their spans, and the components."""
    if isinstance(known.sentences, Missing):
        yield Item("words", known.sentences, MISSING)
    else:
        for path, (stored, made) in known.sentences.items():
            yield Item(f"words.{path}", *shown(stored, made))
    yield from (Item(f"words.checks.{path}.shown", *pair) for path, pair in known.titles.items())
    for path, stated, spans in unlike({k: v for k, v in run.claims.items() if isinstance(v, dict | list)}):
        yield Item(f"words.{path}", stated, spans)
    yield Item("components", [], known.components)


def closing(items: Sequence[Item]) -> tuple[bool, str]:
    """Whether the verdict follows, and the sentence that states this."""
    wrong, unknown = ([item.name for item in items if item.agrees is flag] for flag in (False, None))
    left = f"; {len(unknown)} of {len(items)} items could not be audited" if unknown else ""
    if "words" in unknown:
        left += ", the sentences of the record among them: judge by its values"
    if wrong:
        return False, f"the verdict does not follow from what the run stored: {', '.join(wrong)} disagree{left}"
    if "verdict" in unknown:
        return False, f"it is not known whether the verdict follows{left}"
    return True, f"the verdict follows from the stored evaluations{left}"


def _compared(name: str, stated: Any, expected: Any, absent: str) -> Iterator[Item]:
    if isinstance(expected, dict) and isinstance(stated, dict) and not name.endswith("at_bounds"):
        for key, value in expected.items():
            found = stated.get(key, absent if value is not None or isinstance(absent, Missing) else None)
            yield from _compared(f"{name}.{key}".lstrip("."), found, value, absent)
    elif isinstance(expected, list) and isinstance(stated, list):
        yield Item(f"{name}.count", len(stated), len(expected))
        for k, pair in enumerate(zip(stated, expected, strict=False)):
            yield from _compared(f"{name}.{k}", *pair, absent)
    elif isinstance(expected, tuple):  # a sentence
        yield Item(name, *shown(stated, expected))
    else:
        yield Item(name, stated, None if expected != expected else expected)  # NaN: there is no such cost


def _stored(run: Run) -> Tree:
    """The claims that follow from the evaluations and findings alone."""
    searched = [k for k in run.searches if not math.isnan(run.best[k])]
    method = run.plan[min(searched, key=run.best.__getitem__)].method if searched else None
    worst = {"cost": run.stated, "margin": run.stated - run.threshold, "method": method}
    beside = run.made["evaluations"] - len(run.status)
    total = {"stored": len(run.status), "lowest": run.lowest} | ({"counted": beside} if beside else {})
    total |= {name: run.made[name] for name in ("succeeded", "failed", "excluded", "violating")}
    stages = zip(run.plan, run.best, run.ended, strict=True)
    stops = [_stop(run, k) for k in range(len(run.plan))]
    expected: Tree = {
        "sound": bool((((run.status == OK) == np.isfinite(run.raw)) & (run.status < len(STATUS))).all()),
        "placed": bool((np.abs(run.points - 0.5) <= 0.5 + 1e-9).all() and (run.stage < len(run.plan)).all()),
        "stages": [
            {"kind": s.kind, "method": s.method, "best": best} | ended | stop
            for (s, best, ended), stop in zip(stages, stops, strict=True)
        ],
        "evaluations": total,
        "nominal": {"cost": run.nominal, "margin": run.nominal - run.threshold},
        "worst": worst if len(run.costs) else None,
        "findings": run.findings,
        "verdict": "violated" if run.confirmed else MISSING,
    }
    if "quantity" in run.claims:  # the table of runs has the whole verdict
        expected |= {"provenance": {"seed": run.campaign.seed}, "quantity": run.quantity, "unit": run.unit}
    elif "seed" in run.claims:
        expected["seed"] = run.campaign.seed
    if run.flaky is not MISSING and (run.flaky or "flaky" in run.claims["evaluations"]):
        expected["evaluations"]["flaky"] = run.flaky
    if "run" in run.claims:  # the columns of the database's table of runs
        expected["run"] = {"threshold": run.threshold, "nominal_cost": run.nominal, "worst_cost": run.stated}
        expected["run"] |= {"evaluations": run.made["evaluations"], "failed_evaluations": run.made["failed"]}
        for k, blocks in run.counted.items():  # of these a row has the stored ones, and how many there are beside them
            stored = int((run.stage == k).sum())
            expected["stages"][k] |= {"evaluations": stored, "counted": run.ended[k]["evaluations"] - stored}
            expected["stages"][k] |= {"violations": sum(blocks["violations"])}
        expected["run"] |= {"worst_method": method, "upper_bound": run.bound}
        if run.sealed:
            expected["run"] |= {"planned": most(run.campaign), "state": "done", "error": None}
    return expected


def _stop(run: Run, k: int) -> Tree:
    """How a stage of a folder ended, and its minima, which repeat its result; in a database, what its row repeats."""
    results = run.claims.get("results") or []
    if not run.sealed:
        return {}
    if k >= len(results) or "run" in run.claims:
        best = _best(run, k)
        return {"planned": run.plan[k].planned, "best_index": best and best["index"]}
    result = results[k] or {}
    return {"stop": (result.get("stop") or {}).get("text"), "minima": result.get("minima") or []}


def _concluded(run: Run, at_most: int, spot_checks: int) -> Tree:
    """The claims that follow if the results of the stages and the catalogue are also used."""
    nominal = {"name": "nominal", "cost": run.nominal} | run.case(run.claims["results"][-1]["nominal"])
    agreed = bool(nominal["ok"]) and all(f["validation"]["ok"] for f in run.findings)
    below = [{"position": k, "count": n} for k, n in enumerate(run.below) if n]
    out = _left_out(run)
    checked = min(sum(run.below), at_most) - out.get("violations", 0)
    violations = {"stored": sum(run.below), "by_stage": below, "checked": checked}
    spread = {"evaluations": len(run.costs), "lowest": run.lowest, "highest": run.highest}
    last: Tree = {"nominal": nominal, "ok": agreed, "violations": violations, "encounter": {"spread": spread}}
    last |= {"spot_checks": {"checked": min(spot_checks, len(run.costs)) - out.get("spot_checks", 0)}}
    if run.sealed:
        last |= _settings(run) | {"spent": _spent(run)} | modes.named(run)
    if run.claims["results"][-1]["encounter"].get("beyond") is not None:
        last["encounter"]["beyond"] = {"times": limits.CONTINUED, "flights": _continued(run)}
    results: list[Tree] = [_stage(run, k) for k in range(len(run.plan) - 1)]
    rows, known = [], {finding["label"] for finding in run.findings}
    for k, compared in zip(run.searches, run.claims["comparison"], strict=True):
        spent = run.ended[k]["evaluations"] >= run.plan[k].planned
        results[k] |= run.ended[k] | {"stop": {"kind": "budget" if spent else "rule"} | results[k].get("stop", {})}
        method = {"method": run.plan[k].method, "title": run.methods[k].title, "kind": run.methods[k].kind}
        results[k] |= method | {"best": _best(run, k)} | (_charts(run, k) if run.sealed else {})
        rows.append({"position": k, "best": run.best[k]} | method | run.ended[k])
        rows[-1]["findings"] = [label for label in compared["findings"] if label in known]
        if run.sealed:
            rows[-1]["stop"] = run.claims["results"][k]["stop"]
            rows[-1]["findings"] = [f["label"] for f in run.claims["findings"] if k in _positions(f)]
    checks = _checks(run, agreed)
    sample = run.claimed and {k: v for k, v in run.claimed.items() if k not in BESIDE}
    if sample and run.sealed:
        sample["source"] = "certify" if any(stage.kind == "certify" for stage in run.plan) else "search"
        if run.claimed and sample.get("quantile") and run.campaign.stages.certify is not None:
            least = needed(run.campaign.stages.certify.quantile - run.claimed["outside"], run.campaign.confidence)
            sample["quantile"] = sample["quantile"] | {"needed": least}
    if run.campaign.baseline is not None:
        results[position(run)] |= evaluated(run)
    if run.calls.measures:
        results[0]["measured"] = run.calls.measured
    if run.calls.noisy:
        best = zip([k for k in run.searches if not math.isnan(run.best[k])], _incumbents(run), strict=False)
        incumbents = [{"position": k, "cost": run.best[k], "validation": {"cost": run.best[k]} | v} for k, v in best]
        last["incumbents"] = incumbents
    if run.sealed:
        last["comparison"] = [dict(row) for row in run.claims["comparison"]]
    expected: Tree = {"results": [*results, last], "comparison": rows, "checks": checks, "statistics": sample}
    if run.campaign.baseline is not None:
        expected["regression"] = regression(run)
    if run.sealed:
        pairs = zip(run.findings, run.claims["findings"], strict=True)
        expected["findings"] = [found | _found(run, recorded) for found, recorded in pairs]
        expected |= likely(run, expected["findings"])
    if run.sealed and run.findings:
        expected["worst"] = _worst(run)
    if not run.reworded and (run.sealed or "sureness" in run.claims):
        expected["sureness"] = sureness(run)
    if not run.confirmed:
        stated = _as_stated(run)
        clear = all((stated | checks).values()) and stated.keys() >= checks.keys()
        expected["verdict"] = "cleared" if clear else "inconclusive"
    return expected


def _left_out(run: Run) -> dict[str, int]:
    """What validation did not confirm because its allowance was used up; runs of earlier versions had none."""
    spent = run.claims["results"][-1].get("spent")
    return {} if spent is None else spent["left_out"]


def _spent(run: Run) -> Tree:
    """What validation may take, and what it stored of it; the rest was evaluated again and is not stored."""
    return {"at_most": validation(run.campaign, run.calls.noisy).total, "stored": run.ended[-1]["evaluations"]}


def _stage(run: Run, k: int) -> Tree:
    """What the result of a stage states, as far as its evaluations and the campaign decide it."""
    if k == 0:
        return _nominal(run, run.claims["results"][0]) if run.sealed else {}
    sample = run.samples.get(k)
    if run.plan[k].kind == "sensitivity" and run.sealed:
        asked = run.campaign.stages.sensitivity
        return {"curves": charts.curves(run, k)} | ({} if asked is None else {"points": asked.points})
    if run.plan[k].kind == "estimate":
        return estimated(run, k)
    if run.plan[k].kind == "attraction":
        return attracted(run, k)
    if sample is None:
        return {"sample": None} if k in run.searches else {}
    if not run.sealed:
        return {"sample": sample}
    told = _with(sample, of_sample(run, k, sample))
    found: Tree = {"sample": told} | of_stage(run, k, told, (run.claims["results"][k] or {}).get("stop"))
    if run.plan[k].kind == "certify":
        found |= run.ended[k] | {"grid": grid(run, k) if run.grid(k) else None}
        found |= _blocks(run, k)
    return found


def _blocks(run: Run, k: int) -> Tree:
    """What a sample of which only the lowest are stored states of its blocks and of the noise of its flights."""
    certify, result = run.campaign.stages.certify, run.claims["results"][k]
    if certify is None or certify.keep == "all":
        return {"blocks": None, "flights": None, "realisations": None}
    flights, (_, raw, status) = np.array(result["flights"], dtype=np.int64), run.rows(k)
    seeds = of_indices(int(result["seed"]), flights).tolist() if run.random else None
    before = run.raw[(run.stage < k) & (run.status == OK)].tolist()
    beside = counted.beside(run.counted[k], int(np.count_nonzero(raw[status == OK] <= run.threshold)), status)
    told = {} if run.reworded else {"statement": counted.statement(run.counted[k], len(status))}
    return {"blocks": counted.scale(before, run.threshold) | {"beside": beside} | told, "realisations": seeds}


def _nominal(run: Run, stated: Tree) -> Tree:
    """The nominal case; earlier versions stored no parameters of it."""
    first = run.stage == 0
    state = dict(enumerate(STATUS)).get(run.status[first][0])
    found: Tree = {"cost": run.nominal, "margin": run.nominal - run.threshold, "status": state}
    found |= {"parameters": run.values(run.points[first][0])} if stated.get("parameters") else {}
    return found | ({"reason": ""} if state == STATUS[OK] else {})


def _with(sample: Tree, sentences: Tree) -> Tree:
    """The sample with its sentences, and those of its quantile."""
    quantile = {"quantile": sample["quantile"] | sentences["quantile"]} if "quantile" in sentences else {}
    return sample | sentences | quantile


def _best(run: Run, k: int) -> Any:
    """The lowest evaluation of a search, the first of equal ones."""
    if math.isnan(run.best[k]):
        return None
    points, raw, status = run.rows(k)
    index = int(np.argmin(np.where(status == OK, raw, np.inf)))
    best = {"cost": run.best[k], "margin": run.best[k] - run.threshold}
    return best | {"index": index, "parameters": run.values(points[index])} if run.sealed else best


def _settings(run: Run) -> Tree:
    """What the validate stage repeats of the campaign."""
    validate, findings = run.campaign.stages.validate_, run.campaign.stages.findings
    settings = {name: getattr(findings, name) for name in ("distance", "barrier", "at_most")}
    return {"tolerance": validate.tolerance, "findings": settings}


def _charts(run: Run, k: int) -> Tree:
    """What a search shows besides its best."""
    stated = run.claims["results"][k]
    found = charts.front(run, k) | {"minima": charts.minima(run, k, stated["minima"]), "family": family(run, k)}
    if stated.get("apart"):
        found["apart"] = apart(run, k)
    if stated.get("gap") and not run.reworded:
        gap = stated["gap"]
        best = gap["lower_bound"] + gap["gap"]  # of the centres alone, as taken
        numbers = (gap["rectangles"], gap["without_value"], run.quantity, gap["lower_bound"], best, run.unit)
        found["gap"] = {"statement": possible_gain(*numbers)}
    return found


def _found(run: Run, finding: Tree) -> Tree:
    """The slices of a finding, and the methods that found it, each by its position."""
    by = [{"method": run.plan[one["position"]].method} for one in finding["found"]]
    found: Tree = {"found": by, "methods": list(dict.fromkeys(one["method"] for one in by))}
    return found | (
        {"slices": charts.slices(run, finding["point"], finding["slices"])} if finding.get("slices") else {}
    )


def _positions(finding: Tree) -> set[int]:
    return {by["position"] for by in finding.get("found") or ()}


def _worst(run: Run) -> Tree:
    """The worst finding, or of a violated verdict the worst of those that were confirmed."""
    stated = run.worst or run.findings[0]
    searched = [k for k in run.searches if not math.isnan(run.best[k])]
    method = run.plan[min(searched, key=run.best.__getitem__)].method if searched else None
    found = {"cost": run.stated, "margin": run.stated - run.threshold, "method": method}
    found |= {"evaluated": stated["cost"], "parameters": stated["parameters"]}
    return found | ({"finding": stated["label"]} if "run" in run.claims else {})


def _as_stated(run: Run) -> dict[str, bool]:
    """The checks as the record has them, those that no rule here requires included."""
    return {check["name"]: check["ok"] for check in run.claims["checks"]}


def _incumbents(run: Run) -> Iterator[Tree]:
    """The independent calls of every search's best, recomputed; one too few is missing at the end."""
    stated = run.claims["results"][-1].get("incumbents", [])
    yield from (run.calls.case(best["validation"]) for best in stated)
    yield from ({"repeats": {"violating": MISSING}} for _ in range(len(run.searches) - len(stated)))


def _checks(run: Run, agreed: bool) -> dict[str, bool]:
    """Every check that the rules require, by name."""
    results, findings = run.claims["results"], run.claims["findings"]
    spot, system = results[-1]["spot_checks"], "validation" if run.campaign.simulator is None else "repetition"
    ended = all(stage.get("state", "done") == "done" for stage in run.claims["stages"])
    compared = spot["violating"] == 0 and (spot["compared"] > 0 or spot["checked"] == 0)
    compared = compared and not _left_out(run).get("spot_checks")
    checks = {
        "nominal": run.nominal > run.threshold,
        "search": ended and not any(math.isnan(run.best[k]) for k in run.searches),
        "no violation": run.lowest > run.threshold and not run.confirmed,
        "minimum": bool(findings) and findings[0]["cost"] <= run.lowest and results[-1]["findings"]["complete"],
        "agreement": agreement(run),
        system: agreed and compared,
        "evaluations": run.made["failed"] == 0,
        "influence": run.calls.influence(run.varies, run.highest - run.lowest),
    }
    checks |= _encounter(run) if run.campaign.simulator is None else {}
    checks |= run.calls.checks(run.claimed["noise"] if run.claimed else "stated", run.flaky)
    intended = {name.replace("_", " ") for name in run.campaign.encounter.intended}  # as stated by the author
    return {name: holds or name in intended for name, holds in checks.items()} | _probability(run)


def _encounter(run: Run) -> dict[str, bool]:
    """The checks of a scenario's encounter, and the one that distances to centres do not hide a vehicle inside."""
    campaign, components, encounter = run.campaign, run.claims["components"], run.claims["results"][-1]["encounter"]
    moved, unseen = (math.nan if c is None else c for c in (encounter["moved"], encounter["unseen"]["cost"]))
    shown = {
        "motion": moved > limits.MOVED * abs(run.nominal),
        "avoidance": run.nominal - unseen > limits.ROUNDING * max(abs(run.nominal), abs(unseen)),
    }
    criterion = components.component("criterion", campaign.criterion.component)
    if criterion.of == "obstacles":
        closest = [encounter["closest"], *(f["closest"] for f in run.claims["findings"])]
        shown["closest approach"] = all(c["at"] == "inside" for c in closest) and _over(run, encounter.get("beyond"))
    if criterion.measured_to == "centre" and not campaign.criterion.from_centre:
        inside = extents.within(campaign, components, parameters(campaign, components))
        shown |= {"distances": False} if inside else {}
    turning, step = rates.turning(campaign, components, parameters(campaign, components)), campaign.given_scenario.step
    shown |= {"sampling": False} if not all(each.rate * step <= limits.TURN for each in turning) else {}
    return shown


def _over(run: Run, beyond: Tree | None) -> bool:
    """Whether no flight comes closer beyond the horizon than any evaluation, and all that approaches there is known;
    earlier versions did not look there."""
    if beyond is None:
        return True
    low = run.lowest - limits.ROUNDING * max(abs(run.lowest), abs(run.threshold))
    above = beyond["lowest"] is None or beyond["lowest"]["value"] >= low
    return not beyond["closer"] and above and beyond.get("unknown") is None


def _continued(run: Run) -> int:
    """The flights that are simulated on: nominal case, findings and sample, under each of their realisations."""
    findings, each = run.claims["findings"], len(run.campaign.given_scenario.realisations.seeds)
    own = sum(f["validation"]["realisation"] is not None for f in findings)
    total = own + each * (1 + len(findings) - own)
    for k in (k for k, planned in enumerate(run.plan) if planned.kind == "certify"):
        succeeded, drawn = run.status[run.stage == k] == OK, run.claims["results"][k]["drawn_realisations"]
        total += int(succeeded[:drawn].sum()) + each * int(succeeded[drawn:].sum())
    return total


def _probability(run: Run) -> dict[str, bool]:
    """The checks of the noise, of excluded evaluations, and of the bound on P(violation)."""
    campaign, sample, checks = run.campaign, run.claimed, dict[str, bool]()
    noise, bound = (sample["noise"], sample["upper_bound"]) if sample else ("stated", 1.0)
    excluded = run.made["excluded"] / max(run.made["evaluations"], 1)
    if run.random:
        realisations = campaign.given_scenario.realisations
        checks["noise"] = noise == "drawn" and not (realisations.combine == "mean" and len(realisations.seeds) > 1)
    if excluded:
        checks["exclusions"] = max(sample["excluded_fraction"] if sample else 0.0, excluded) <= limits.EXCLUDED
    checks["sample"] = _sampled(run)
    if run.outside():
        checks["outside the bounds"] = run.outside() <= limits.CEILING
    if campaign.target_probability is not None:
        checks["target"] = bound <= min(campaign.target_probability, limits.CEILING) and noise != "stated"
    elif sample is not None:
        checks["probability"] = bound <= limits.CEILING
    return checks


def _sampled(run: Run) -> bool:
    """Whether the certify stage drew enough, with a seed that nobody chose."""
    certify = [k for k, planned in enumerate(run.plan) if planned.kind == "certify"]
    drawn = [k for k in certify if run.claims["results"][k].get("drawn_at_launch") is True]
    return any(run.samples[k]["samples"] >= limits.SAMPLE for k in drawn)


def _sentence(run: Run) -> tuple[Tree, Tree]:
    """The stated and the required content of the sentence: its opening, methods, numbers by name, and all words.

    Versions that stored only text rounded the numbers to the digits of the text: they are compared as written.
    """
    claims, exact, spent = run.claims, "statement" in run.claims, dict[str, int]()
    statement = SPANS.validate_python(claims["statement"]) if exact else earlier.verdict(claims["reason"])
    text, scope = words(statement), words(SPANS.validate_python(claims["holds_for"] if exact else ()))
    spans = {span.name: span for span in statement if isinstance(span, Quantity)}
    numbers, begun = _numbers(run), text.partition(".")[0]
    for k in run.searches:
        spent[run.methods[k].title] = spent.get(run.methods[k].title, 0) + run.ended[k]["evaluations"]
    methods = f"{words(listed([f'{title} ({count(n)})' for title, n in spent.items()]))}."
    nothing = f"No {'flight' if run.campaign.simulator is None else 'case'} could be evaluated"
    opening = OPENINGS.get(claims["verdict"], "Nothing may be claimed") if len(run.costs) else nothing

    def written(name: str, value: Any) -> Any:
        if exact or value is None or name not in spans:
            return value
        span = spans[name].model_copy(update={"value": value})
        upward = words((span.model_copy(update={"format": Format.AT_MOST}),)) if name == "upper_bound" else ""
        return upward if upward == words((spans[name],)) else words((span,))

    stated: Tree = {"opening": opening if opening in begun else begun, "words": claims["reason"]}
    expected: Tree = {"opening": opening, "words": f"{text} {SCOPE}{scope}" if scope else text}
    if run.sealed:
        stated |= {k: claims.get(k) for k in ("sentence", "scope", "values")}
        expected |= {"sentence": text, "scope": f"{SCOPE}{scope}" if scope else "", "values": values(statement)}
    if len(run.costs):
        stated |= {name: written(name, spans[name].value if name in spans else None) for name in numbers}
        expected |= {name: written(name, value) for name, value in numbers.items()}
        stated["methods"], expected["methods"] = text.partition("searched by ")[2][: len(methods)], methods
    stated["checks"] = {c["name"]: c["text"] for c in claims["checks"]}
    checks = {c["name"]: words(SPANS.validate_python(c["statement"])) for c in claims["checks"] if "statement" in c}
    return stated, expected | {"checks": checks}


def _numbers(run: Run) -> Tree:
    """The numbers that the sentence must state, by name; None for one that it must not state."""
    verdict, sample = run.claims["verdict"], run.claimed
    numbers: Tree = {
        "threshold": None if verdict == "inconclusive" else run.threshold,
        "evaluations": run.made["succeeded" if verdict == "cleared" else "evaluations"],
        "worst": run.stated,
        "margin": run.stated - run.threshold,
        "excluded": run.made["excluded"] or None if verdict == "cleared" else None,
        "violating": run.made["violating"] or None,
    }
    claimed = sample if verdict != "inconclusive" else None
    return numbers | {name: claimed and claimed[name] for name in ("violations", "samples", "upper_bound")}
