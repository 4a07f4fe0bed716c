"""What a record states that follows once the results of its stages and the catalogue are also used.

Start reading at `of_results`; a stage whose result has rules of its own has a module of its own.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from campaigns.asked.allowance import validation
from campaigns.claims.stages.surroundings import possible_gain
from campaigns.results import validate as forms
from campaigns.results.base import OK, STATUS, Result, Stop
from campaigns.results.draws import of_indices
from campaigns.results.finding import Calls, Validation
from campaigns.results.nominal import NominalCase
from campaigns.results.sample import Blocks, Sample
from campaigns.results.search import Gap, Member, SearchResult
from campaigns.results.verdict import BoundSource, Statistics, Worst
from campaigns.stages.certify import CertifyResult
from campaigns.stages.sensitivity import SensitivityResult
from worker.evidence.audit import charts, counted, limits, modes
from worker.evidence.audit.agreement import apart, family
from worker.evidence.audit.attraction import attracted
from worker.evidence.audit.checks import as_stated, left_out, near, required_checks
from worker.evidence.audit.estimate import estimated
from worker.evidence.audit.finders import found_by, gathered, noise
from worker.evidence.audit.likelihood import likely
from worker.evidence.audit.parts import OMIT, REST, Finding, changed, made, read
from worker.evidence.audit.points import grid
from worker.evidence.audit.recompute import Run
from worker.evidence.audit.record import MISSING
from worker.evidence.audit.reevaluation import evaluated, position
from worker.evidence.audit.regression import examined, passing, regression
from worker.evidence.audit.sentences import budget, of_certified, of_sample
from worker.evidence.audit.stored import finder, lowest_of
from worker.evidence.audit.sureness import sureness

GAP = ("rectangles", "without_value", "lower_bound", "gap")
"""Numbers of DIRECT's possible gain."""
BESIDE = ("outside", "lowest", "mean", "deviation", "histogram", "distribution", "looks")
"""Fields of a sample that the statistics of the verdict do not have."""


def of_results(run: Run, at_most: int, spot_checks: int) -> list[tuple[str, object]]:
    """The claims that follow if the results of the stages and the catalogue are also used, by name."""
    last = validated(run, at_most, spot_checks)
    results: list[Result] = [_stage(run, k) for k in range(len(run.plan) - 1)]
    rows = [_row(run, k, row["findings"]) for k, row in zip(run.searches, run.claims["comparison"], strict=True)]
    checks = required_checks(run, last.ok)
    if run.campaign.baseline is not None:
        results[position(run)] = evaluated(run)
    if run.calls.noisy:
        last = changed(last, incumbents=[*_incumbents(run)])
    if run.sealed:
        last = changed(last, comparison=[dict(row) for row in run.claims["comparison"]])
    claims: list[tuple[str, object]] = [("results", [*results, last]), ("comparison", rows), ("checks", checks)]
    claims += [("statistics", _statistics(run)), ("possible", _possible(run))]
    if run.campaign.baseline is not None:
        claims.append(("regression", regression(run, as_stated(run) | checks)))
    if run.sealed:
        findings, most_likely = likely(run, [_found(run, k) for k in range(len(run.findings))])
        claims += [("findings", findings), ("most_likely_violation", most_likely)]
    if run.sealed and run.findings:
        claims.append(("worst", _worst(run)))
    if not run.reworded and (run.sealed or "sureness" in run.claims):
        claims.append(("sureness", sureness(run)))
    if not run.confirmed:
        stated = as_stated(run)
        clear = all((stated | checks).values()) and stated.keys() >= checks.keys()
        claims.append(("verdict", "cleared" if clear else "inconclusive"))
    return [(name, value) for name, value in claims if value is not OMIT]


def validated(run: Run, at_most: int, spot_checks: int) -> forms.ValidateResult:
    """The result of validation, as far as it follows."""
    stated = run.claims["results"][-1]
    nominal, out, stored = run.case(stated["nominal"], "nominal", run.nominal), left_out(run), sum(run.below)
    one = True if run.wording >= limits.AFTER and run.one_point else OMIT
    grid = (run.resolution if run.wording >= limits.MEASURED else 0.0) or OMIT
    spread = made(
        forms.Spread, evaluations=len(run.costs), lowest=run.lowest, highest=run.highest, one_point=one, grid=grid
    )
    beyond = OMIT
    if stated["encounter"].get("beyond") is not None or (run.whole and near(run) and len(run.costs)):
        flights, beyond = _continued(run), stated["encounter"].get("beyond") or {}
        failed = OMIT if run.wording < limits.AFTER else min(max(beyond.get("cut_short") or 0, 0), flights)
        left = OMIT if run.wording < limits.WIDER and "not_continued" not in beyond else _others(run)[1]
        beyond = made(
            forms.Beyond, times=limits.CONTINUED, flights=flights, cut_short=failed, not_continued=left, **REST
        )
    checked = min(stored, at_most) - out.get("violations", 0), min(spot_checks, len(run.costs))
    by_stage = [made(forms.StageCount, position=k, count=n) for k, n in enumerate(run.below) if n]
    findings, spent, tolerance = OMIT, OMIT, OMIT
    if run.sealed:
        own, tolerance = run.campaign.stages.findings, run.campaign.stages.validate_.tolerance
        known = run.wording >= limits.WIDER and run.campaign.baseline is not None
        apart = min(own.distance, limits.SAME_PLACE) if known else own.distance
        findings = made(
            forms.Gathered, distance=apart, barrier=own.barrier, at_most=own.at_most,
            statement=OMIT if run.reworded else gathered(run), **REST,
        )  # fmt: skip
        most = validation(run.campaign, run.calls.noisy).total
        spent = made(forms.Spent, at_most=most, stored=run.ended[-1].evaluations, **REST)  # the rest was made again
    again = (passing(run, number) for number in range(len(stated.get("basins") or [])))
    cases = [*(f.validation for f in run.findings), *(case for case in again if case is not None)]
    return made(
        forms.ValidateResult, nominal=nominal, ok=bool(nominal.ok) and all(case.ok for case in cases),
        violations=made(forms.Violations, stored=stored, by_stage=by_stage, checked=checked[0], **REST),
        encounter=made(forms.Encounter, spread=spread, beyond=beyond, **REST),
        spot_checks=made(forms.SpotChecks, checked=checked[1] - out.get("spot_checks", 0), **REST), tolerance=tolerance,
        findings=findings, modes=(modes.named(run) if run.sealed else None) or OMIT, spent=spent,
    )  # fmt: skip


def _row(run: Run, k: int, stated: list[str]) -> forms.Compared:
    """The row of a search in the comparison; stated: the findings that it names."""
    known, stop = {finding.label for finding in run.findings}, OMIT
    labels = [label for label in stated if label in known]
    if run.sealed:
        stop = run.claims["results"][k]["stop"]
        by = [(f["label"], [one["position"] for one in f.get("found") or ()]) for f in run.claims["findings"]]
        labels = [label for label, positions in by if k in positions]
    evaluations, failed, excluded = run.ended[k]
    return made(
        forms.Compared, position=k, best=run.best[k], method=run.methods[k].name, title=run.methods[k].title,
        kind=run.methods[k].kind, evaluations=evaluations, failed=failed, excluded=excluded, findings=labels,
        stop=stop, **REST,
    )  # fmt: skip


def _statistics(run: Run) -> Sample | Statistics | None:
    """The sample that the probability is claimed by, without what the verdict has not."""
    if run.claimed is None or not run.sealed:
        return run.claimed and changed(run.claimed, **dict.fromkeys(BESIDE, OMIT))
    source: BoundSource = "certify" if run.certifying else "search"
    known = {name: value for name, value in vars(run.claimed).items() if name in run.claimed.model_fields_set}
    return made(Statistics, **{name: value for name, value in known.items() if name not in BESIDE}, source=source)


def _possible(run: Run) -> bool:
    """Whether what validation counted, as taken, is no more than what it counted of."""
    last = run.claims["results"][-1]
    spot, violations = last["spot_checks"], last["violations"]
    of = [
        (0, spot["compared"], spot["checked"]),
        (0, spot["violating"], spot["checked"]),
        (0, violations["confirmed"], violations["checked"]),
        (0, violations["checked"], violations["stored"]),
        *((0, left, math.inf) for left in left_out(run).values()),
    ]
    return examined(run) and _compared(run, spot) and all(low <= count <= most for low, count, most in of)


def _compared(run: Run, spot: Any) -> bool:
    """Whether the lowest value by the reference integrator may be that of what was compared."""
    lowest, at = spot.get("lowest_reference"), spot["at"]
    if run.written < limits.CALLED or not run.sealed:
        return True
    if lowest is None or at is None:
        return lowest is at and not spot["compared"]
    return bool(lowest <= at["reference"] and (lowest <= run.threshold or not spot["violating"]))


def _continued(run: Run) -> int:
    """The flights that are simulated on: nominal case, findings and sample, under each of their realisations."""
    findings, each = run.claims["findings"], len(run.campaign.given_scenario.realisations.seeds)
    own = sum(f["validation"]["realisation"] is not None for f in findings)
    total = own + each * (1 + len(findings) - own)
    for k in run.certifying:
        succeeded, drawn = run.status[run.stage == k] == OK, run.claims["results"][k]["drawn_realisations"]
        total += int(succeeded[:drawn].sum()) + each * int(succeeded[drawn:].sum())
    return total + each * _others(run)[0]


def _others(run: Run) -> tuple[int, int]:
    """How many evaluations with a value besides the sample are simulated on, and how many are not: stored ones, and
    those of a sample that are counted only. Versions before simulated none of them on, and do not state this."""
    beyond = run.claims["results"][-1]["encounter"].get("beyond") or {}
    if run.wording < limits.WIDER and "not_continued" not in beyond:
        return 0, 0
    stored = int(((run.status == OK) & ~np.isin(run.stage, run.certifying)).sum())
    counted = [run.counted[k].beside for k in run.certifying if k in run.counted]
    some = min(limits.OTHERS, stored)
    return some, stored - some + sum(each.evaluations - each.failed - each.excluded for each in counted)


def _stage(run: Run, k: int) -> Result:
    """What the result of a stage states, as far as its evaluations and the campaign decide it."""
    if k == 0:
        return _nominal(run)
    if run.plan[k].kind == "sensitivity" and run.sealed:
        request = run.campaign.stages.sensitivity
        points = OMIT if request is None else request.points
        return made(SensitivityResult, curves=charts.curves(run, k), points=points)
    if run.plan[k].kind == "estimate":
        return estimated(run, k)
    if run.plan[k].kind == "attraction":
        return attracted(run, k)
    if run.plan[k].kind == "certify":
        return _certified(run, k)
    if k in run.searches:
        return _searched(run, k)
    return made(Result)


def _certified(run: Run, k: int) -> CertifyResult:
    sample = run.samples[k]
    if not run.sealed:
        return made(CertifyResult, sample=sample, **REST)
    sample, (evaluations, failed, excluded) = of_sample(run, k, sample), run.ended[k]
    found = made(
        CertifyResult, sample=sample, statement=of_certified(run, k, sample) or OMIT, evaluations=evaluations,
        failed=failed, excluded=excluded, grid=grid(run, k) if run.grid(k) else None,
    )  # fmt: skip
    certify, result = run.campaign.stages.certify, run.claims["results"][k]
    if certify is None or certify.keep == "all":
        return changed(found, blocks=None, flights=None, realisations=None)
    # Of a sample of which only the lowest are stored: its blocks and the noise of its flights.
    blocks, flights, (_, raw, status) = run.counted[k], np.array(result["flights"], dtype=np.int64), run.rows(k)
    seeds = of_indices(int(result["seed"]), flights).tolist() if run.random else None
    low, width = counted.scale(run.raw[(run.stage < k) & (run.status == OK)].tolist(), run.threshold)
    beside = counted.beside(blocks, int(np.count_nonzero(raw[status == OK] <= run.threshold)), status)
    statement = OMIT if run.reworded else counted.statement(blocks, len(status))
    shown = made(Blocks, low=low, width=width, beside=beside, statement=statement, **REST)
    return changed(found, blocks=shown, realisations=seeds)


def _nominal(run: Run) -> NominalCase:
    """The nominal case; earlier versions stored no parameters of it."""
    measured = run.calls.measured or OMIT
    if not run.sealed:
        return made(NominalCase, measured=measured, **REST)
    first = run.stage == 0
    state: Any = dict(enumerate(STATUS)).get(run.status[first][0])
    return made(
        NominalCase, cost=run.nominal, margin=run.nominal - run.threshold, status=state,
        parameters=run.values(run.points[first][0]),
        reason="" if state == STATUS[OK] else OMIT, measured=measured,
    )  # fmt: skip


def _searched(run: Run, k: int) -> SearchResult:
    """What a search states: its sample if it is random, its end, its best, and what it shows besides."""
    planned, method, stated, sample = run.plan[k].planned, run.methods[k], run.claims["results"][k], run.samples.get(k)
    spent, worded = run.ended[k].evaluations >= planned, OMIT
    if sample is not None and run.sealed:
        sample = of_sample(run, k, sample)
        if spent and not run.reworded and ((stated or {}).get("stop") or {}).get("kind") == "budget":
            worded = budget(planned)
    stop = made(Stop, kind="budget" if spent else "rule", statement=worded, **REST)
    found = made(SearchResult, sample=sample, stop=OMIT if worded is OMIT else stop, **REST)
    named = {"method": method.name, "title": method.title, "kind": method.kind, "best": lowest_of(run, k)}
    found = changed(found, **run.ended[k]._asdict(), stop=stop, **named)
    if not run.sealed:
        return found
    (criteria, front, size), minima = charts.front(run, k), charts.minima(run, k)
    parts = apart(run, k) if stated.get("apart") else OMIT
    absent = run.whole and method.apart and not stated.get("members")
    gap = OMIT
    if stated.get("gap") and run.wording >= limits.BASELINES:
        gap = _gap(run, k, read(Gap, {name: stated["gap"][name] for name in GAP}))
    return changed(
        found, criteria=criteria, front=front, front_size=size, minima=minima, family=family(run, k), apart=parts,
        gap=gap, members=[made(Member, **REST)] if absent else OMIT,
    )  # fmt: skip


def _gap(run: Run, k: int, gap: Gap) -> Gap:
    """The sentence on DIRECT's possible gain; its lower bound and gap must end at the lowest value of the search, of
    earlier versions at that of some evaluation, and the gap is not negative."""
    _, raw, status = run.rows(k)
    best = gap.lower_bound + gap.gap  # the sum has lost digits
    known = raw[status == OK]
    if run.wording >= limits.LOWEST:
        known = np.array([run.best[k]])
    nearest = float(known[np.argmin(np.abs(known - best))]) if len(known) else math.nan
    lost = 4 * np.finfo(float).eps * max(abs(gap.lower_bound), abs(gap.gap))
    numbers = (gap.rectangles, gap.without_value, run.quantity, gap.lower_bound, nearest, run.unit)
    ends = abs(nearest - best) <= lost and gap.gap >= 0.0
    return made(
        Gap, statement=OMIT if run.reworded else possible_gain(*numbers),
        rectangles=min(gap.rectangles, run.ended[k].evaluations), lower_bound=OMIT if ends else math.nan, **REST,
    )  # fmt: skip


def _found(run: Run, position: int) -> Finding:
    """The slices of a finding, the methods that found it, each by its position, and its noise."""
    finding, recorded = run.findings[position], run.claims["findings"][position]
    by, slices = found_by(run, position), recorded.get("slices")
    finding = finding._replace(found=by, methods=list(dict.fromkeys(one.method for one in by)))
    finding = finding._replace(validation=noise(run, position, finding.validation))
    if not slices:
        return finding
    return finding._replace(slices=charts.slices(run, recorded["point"], slices["at"]))


def _worst(run: Run) -> Worst:
    """The worst finding, or of a violated verdict the worst of those that were confirmed."""
    stated = run.findings[run.worst or 0]
    return made(
        Worst, cost=run.stated, margin=run.stated - run.threshold, method=finder(run), evaluated=stated.cost,
        parameters=stated.parameters, finding=stated.label if "run" in run.claims else OMIT,
    )  # fmt: skip


def _incumbents(run: Run) -> Iterator[forms.Incumbent]:
    """The independent calls of every search's best, recomputed; one too few is missing at the end."""
    stated = run.claims["results"][-1].get("incumbents", [])
    unknown = made(Calls, violating=MISSING, **REST)
    for number, k in enumerate(k for k in run.searches if not math.isnan(run.best[k])):
        case = made(Validation, cost=run.best[k], repeats=unknown, **REST)
        if number < len(stated):
            case = run.calls.case(stated[number]["validation"], cost=run.best[k])
        yield made(forms.Incumbent, position=k, cost=run.best[k], validation=case, **REST)
