"""The rows of a report's tables, from the stored data. Missing values are reported as unknown."""

from __future__ import annotations

import math

from markupsafe import Markup

from backend.reports import figures, validation, words
from backend.reports.record import Record
from backend.signoffs.schemas import Signoff, Standing
from campaigns.asked.distributions import Uncertain
from campaigns.asked.spec import Part, Simulator
from campaigns.catalogue import ComponentEntry, ParameterEntry, SimulatorEntry
from campaigns.checked.check import parts
from campaigns.checked.simulated import PREFIX
from campaigns.claims import numbers
from campaigns.claims.likelihood import lines
from campaigns.claims.numbers import NONE
from campaigns.claims.say import say
from campaigns.claims.spans import Spans
from campaigns.results import verdicts
from campaigns.results.regression import Standing as Outcome
from campaigns.results.unsearched import unsearched
from campaigns.results.validate import Compared
from campaigns.runs import ENDED, StageState

Row = dict[str, object]
"""One row of a table, by the names that the template uses."""


def uncertain(record: Record) -> list[Row]:
    worst = record.worst
    rows = []
    for path, parameter in record.campaign.uncertain.items():
        entry, limits = record.entry(path), record.limits.get(path)
        nominal, low, high = limits or (None, parameter.low, parameter.high)
        value = None if worst is None else worst.parameters.get(path)
        digits = 6 if limits is None else numbers.digits_between(*limits[1:])
        rows.append({
            "path": path,
            "symbol": record.symbol_html(path),
            "named": record.symbol(path) != path,
            "text": record.words(path) if entry else "not described",
            "unit": numbers.unit_in_print(entry.unit if entry else parameter.unit or ""),
            "nominal": numbers.plain(nominal, digits),
            "low": numbers.plain(low, digits),
            "high": numbers.plain(high, digits),
            "worst": numbers.plain(value, digits),
            "distribution": _distribution(parameter),
            "within": figures.within(limits[1], limits[2], limits[0], value) if limits else "",
        })  # fmt: skip
    return rows


def _distribution(parameter: Uncertain) -> str:
    values = parameter.distribution.model_dump()
    kind = values.pop("kind").replace("_", " ")
    options = ", ".join(f"{name} {numbers.plain(value)}" for name, value in values.items())
    return f"{kind} ({options})" if options else kind


def correlations(record: Record) -> list[str]:
    return [f"{' and '.join(c.between)}: {numbers.plain(c.value)}" for c in record.campaign.correlations]


def model(record: Record) -> list[Row]:
    """Every component of the scenario, or the simulator, with its text and its parameters' values."""
    rows = []
    if (simulator := record.campaign.simulator) is not None:
        described = None if record.catalogue is None else record.catalogue.simulator(simulator.name)
        own = described.parameters if described else ()
        values = [_value(record, f"{PREFIX}.{p.name}", p, simulator) for p in own] if described else _bare(simulator)
        rows.append(_part("Simulator", simulator.name, described, values))
    for prefix, _, role, part in parts(record.campaign):
        entry = None if record.catalogue is None else record.catalogue.component(role, part.component)
        values = [_value(record, f"{prefix}.{p.name}", p, part) for p in entry.parameters] if entry else _bare(part)
        if role == "vehicle" and entry:
            values += [_value(record, f"start.{p.name}", p, None) for p in entry.starts]
        if role == "avoider" and entry:
            values += [_value(record, f"goal.{p.name}", p, None) for p in entry.goals]
        rows.append(_part("Avoidance" if role == "avoider" else role.capitalize(), part.component, entry, values))
    return rows


def _part(role: str, name: str, entry: ComponentEntry | SimulatorEntry | None, values: list[Row]) -> Row:
    return {
        "role": role,
        "title": entry.title if entry else name,
        "name": name,
        "text": entry.text if entry else "",
        "known": entry is not None,
        "values": values,
    }


def _value(record: Record, path: str, entry: ParameterEntry, part: Part | Simulator | None) -> Row:
    values = part.parameters if part else _position(record, path)
    name = path.partition(".")[2] if part is None else entry.name
    known = record.known.get(path)
    how = "uncertain" if path in record.campaign.uncertain else "given" if name in values else "default"
    value = known[1] if known else values.get(name)
    prefix = {"start": "Start", "goal": "Goal"}.get(path.partition(".")[0], "")
    text = entry.text if not prefix or entry.text.startswith(prefix) else f"{prefix}: {entry.text}"
    return {
        "symbol": words.symbol_html(entry.symbol),
        "text": text,
        "value": numbers.plain(value, 8),
        "unit": numbers.unit_in_print(entry.unit),
        "how": how,
    }


def _position(record: Record, path: str) -> dict[str, float]:
    scenario = record.campaign.given_scenario
    return scenario.start if path.startswith("start.") else scenario.goal


def _bare(part: Part | Simulator) -> list[Row]:
    return [
        {"symbol": name, "text": "", "value": numbers.plain(value, 8), "unit": "", "how": "given"}
        for name, value in part.parameters.items()
    ]


def methods(record: Record) -> list[Row]:
    validated, ended = record.validated, record.searched
    compared = {} if validated is None else {row.position: row for row in validated.comparison}
    begun = [stage for stage in record.stages if stage.method is not None]
    bests = [stage.best for stage in begun]
    decimals = record.of.decimals(bests, numbers.decimals_apart(bests, 4, 6))
    lowest = min((b for b in bests if b is not None), default=None)
    rows = []
    for i, search in enumerate(record.campaign.stages.search):
        stage = begun[i] if i < len(begun) else None
        result, comparison = (ended.get(stage.position), compared.get(stage.position)) if stage else (None, None)
        entry = record.catalogue.method(search.method) if record.catalogue else None
        best = stage.best if stage else None
        above = None if best is None or lowest is None else best - lowest
        rows.append({
            "title": record.titled(search.method),
            "how": entry.how if entry else "",
            "source": entry.source if entry else "",
            "evaluations": numbers.count(stage.evaluations if stage else 0),
            "budget": numbers.count(search.evaluations),
            "failed": numbers.count(stage.failed if stage else 0),
            "excluded": numbers.count(stage.excluded if stage else 0),
            "best": numbers.fixed(best, decimals),
            "above": "best" if above == 0 else numbers.difference(above, decimals),
            "near": _near(comparison),
            "seconds": numbers.duration(stage.seconds) if stage else NONE,
            "stop": result.stop.statement if result and result.stop else say("not ended"),
            "findings": (", ".join(comparison.findings) or "none") if comparison else NONE,
            "basin": (comparison.basin or "no listed finding") if comparison else NONE,
            "options": ", ".join(f"{name} = {value}" for name, value in search.options.items()) or "defaults",
            "starts": len(search.starts),
        })  # fmt: skip
    return rows


def _near(other: Compared | None) -> str:
    """The number of evaluations until a method came near the best known value; a dash before the comparison."""
    if other is None:
        return NONE
    return numbers.count(other.to_near_best) if other.to_near_best else "not reached"


def _state(record: Record, state: StageState) -> str:
    """The word for the state of a stage: in a run that has ended, no stage runs or waits."""
    if record.run.state not in ENDED:
        return state
    never = {StageState.RUNNING: "not finished", StageState.WAITING: "not started"}
    return never.get(state, str(state))


def stages(record: Record) -> list[Row]:
    """All stages with their evaluations, so that every one is counted."""
    rows: list[Row] = [
        {
            "name": stage.title + (f", {record.titled(stage.method)}" if stage.method else ""),
            "state": _state(record, stage.state),
            "evaluations": numbers.count(stage.evaluations),
            "failed": numbers.count(stage.failed),
            "excluded": numbers.count(stage.excluded),
            "seconds": numbers.duration(stage.seconds),
        }
        for stage in record.stages
    ]
    run, time = record.run, numbers.duration(sum(s.seconds for s in record.stages))
    total = {"failed": numbers.count(run.failed_evaluations), "excluded": numbers.count(run.excluded_evaluations)}
    counted = numbers.count(run.evaluations)
    return [*rows, {"name": "Total", "state": "", "evaluations": counted, "seconds": time, **total}] if rows else []


def findings(record: Record) -> list[Row]:
    values = [value for f in record.findings for value in (f.granted, f.cost)]
    decimals = record.of.decimals(values, numbers.decimals_apart(values, 4, 7))
    return [
        {
            "label": f.label,
            "cost": numbers.fixed(f.granted, decimals),
            "evaluated": "" if f.granted == f.cost else numbers.fixed(f.cost, decimals),
            "margin": numbers.margin(f.margin, decimals),
            "violates": f.margin <= 0,
            "methods": ", ".join(map(record.titled, f.methods)) or unsearched(f.validation, record.certificate),
            "bounds": [(record.symbol_html(path), side) for path, side in f.at_bounds.items()],
            "validated": verdicts.validated(f.validation),
            "seed": validation.seed(f.validation),
            "boundary": () if f.boundary is None else f.boundary.statement,
        }
        for f in record.findings
    ]


def likely(record: Record) -> list[Spans]:
    """How likely each finding is under the stated distributions, and the most likely violation."""
    stated = {f.label: f.likelihood.statement for f in record.findings if f.likelihood is not None}
    return lines(stated, () if record.most_likely.case is None else record.most_likely.statement)


def criteria(record: Record) -> list[Row]:
    """Every criterion of a campaign with several: its value in the nominal case and in each worst case."""
    if len(record.run.criteria) < 2:
        return []
    rows: list[Row] = []
    for i, criterion in enumerate(record.run.criteria):
        values = [None if record.nominal is None else record.nominal.values.get(criterion.name)]
        values += [finding.values.get(criterion.name) for finding in record.findings]
        decimals = numbers.decimals_apart(values, 4, 6)
        decimals = record.of.decimals(values, decimals) if i == 0 else decimals
        rows.append({
            "title": criterion.title,
            "symbol": words.symbol_html(criterion.quantity),
            "unit": numbers.unit_in_print(criterion.unit),
            "worse": "more is worse" if criterion.worse == "high" else "less is worse",
            "decides": i == 0,
            "values": [numbers.fixed(value, decimals) for value in values],
        })  # fmt: skip
    return rows


def doubts(record: Record) -> list[str]:
    """Warnings that the component descriptions (texts, defaults, bounds) may differ from those of the run."""
    if record.catalogue is None:
        return ["this installation has no catalogue of components: units, bounds and texts are unknown"]
    found = []
    clearance = None if record.verdict is None else record.verdict.provenance.clearance
    if clearance is not None and clearance != record.catalogue.version:
        kept = "are described by" if record.changes is None else "were stored with the run as described by"
        found.append(
            f"the run used clearance {clearance}, and the components {kept} {record.catalogue.version}: "
            "their texts and default values may differ from those of the run"
        )
    nominal = {} if record.nominal is None else record.nominal.parameters
    for path, (value, _, _) in record.limits.items():
        if path in nominal and not math.isclose(nominal[path], value, rel_tol=1e-12, abs_tol=1e-300):
            flew, here = numbers.plain(nominal[path], 12), numbers.plain(value, 12)
            found.append(f"{path} was {flew} in the nominal case of the run; its nominal value here is {here}")
    return found


def signoffs(record: Record) -> list[Row]:
    return [
        {
            "name": s.name,
            "note": _note(s),
            "role": s.role,
            "when": words.moment(s.created),
            "user": s.user,
            "comment": s.comment,
            "digest": s.digest[:12],
            "good": s.standing in ("standing", "carried on"),
            "own": s.own,
            "tone": _TONES.get(s.standing, "bad b"),
            "standing": s.sentence,
        }
        for s in record.signoffs.items
    ]


_TONES: dict[Standing, str] = {"standing": "ok", "carried on": "ok", "suspect": "unk b"}


def _note(signoff: Signoff) -> str:
    """How the name is known."""
    if signoff.typed:
        return "name as typed, without an account"
    return "account" + (f"; name typed then: {signoff.stated}" if signoff.stated else "")


def components(record: Record) -> dict[str, str]:
    """Titles of vehicle, controller and avoider, or of the simulator, by role."""
    rows = [row for row in model(record) if row["role"] in ("Vehicle", "Controller", "Avoidance", "Simulator")]
    return {str(row["role"]).lower(): str(row["title"]) for row in rows}


LEAST = 5
"""Number of least covered pairs that are listed."""


def least_covered(record: Record) -> list[tuple[Markup, Markup, int]]:
    """The least covered pairs of parameters, and how many of their bins have an evaluation; none if all have one."""
    least = [pair for pair in record.coverage.pairs[:LEAST] if pair.touched < record.coverage.bins]
    return [(record.symbol_html(pair.first), record.symbol_html(pair.second), pair.touched) for pair in least]


def empty_centre(record: Record) -> list[tuple[Markup, str, str]]:
    """The centre of the empty ball: symbol, value and unit of each parameter."""
    at = {} if record.coverage.ball is None else record.coverage.ball.centre
    entries = [(path, value, record.entry(path)) for path, value in at.items()]
    return [
        (record.symbol_html(path), numbers.plain(value), numbers.unit_in_print(entry.unit) if entry else "")
        for path, value, entry in entries
    ]


def since(record: Record) -> dict[str, object] | None:
    """The comparison with the baseline, or the sentence on why there is none; None without a baseline."""
    regression = None if record.verdict is None else record.verdict.regression
    if regression is None:
        baseline = record.run.baseline
        if baseline is None:
            return None
        text = (
            baseline.sentence
            if baseline.run is None
            else f"{baseline.sentence} The run has no verdict, so nothing was compared."
        )
        return {"run": baseline.run or "", "cases": [], "statement": say(text), "lost": []}
    decimals = numbers.decimals_for(
        [m for c in regression.cases for m in (c.margin_before, c.margin_again, c.margin)], 5
    )
    changes = [c.change for c in regression.cases if c.change]
    # A change that is not 0 is not printed as 0, down to a millionth.
    smallest = min(6, max([3, *(numbers.decimals_for([change], 2) for change in changes)]))
    rows = [
        {
            "standing": str(case.standing),
            "fails": case.fails,
            "violates": case.margin is not None and case.margin <= 0,
            "before": case.before or NONE,
            "now": case.now or NONE,
            "margin_before": numbers.margin(case.margin_before, decimals),
            "margin_again": numbers.margin(case.margin_again, decimals),
            "margin": numbers.margin(case.margin, decimals),
            "change": numbers.difference(case.change, smallest),
            "tolerance": numbers.plain(case.tolerance, 2),
        }
        for case in regression.cases
    ]
    lost = [case.statement for case in regression.cases if case.standing in (Outcome.NOT_COMPARED, Outcome.UNRESOLVED)]
    return {"run": regression.run, "cases": rows, "statement": regression.statement, "lost": lost}
