"""The output of `clearance run`: progress, then the table of stages and the verdict."""

from __future__ import annotations

import sys
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from campaigns import Campaign
from campaigns.claims.likelihood import lines
from campaigns.claims.numbers import NONE, beside, between, count, limit, number, signed
from campaigns.claims.say import listed, sentence
from campaigns.claims.spans import words
from campaigns.identity.identity import identity_of, simulator_of
from campaigns.results import StageResult, Verdict, verdicts
from campaigns.results.base import OK, Described
from campaigns.results.regression import Regression, Standing
from campaigns.results.unsearched import certificate_of, unsearched
from campaigns.results.verdict import Counts, NominalCost
from campaigns.rules import SAME_COST, SAME_PLACE, percent
from clearance.cli import CODES, INCONCLUSIVE, VIOLATED
from clearance.cli._ended import changes, code, sureness
from clearance.local.citation import Cited
from clearance.local.citation import lines as citing
from clearance.local.failures import lines as failures
from clearance.local.likelihood import Likelihoods, likelihoods
from clearance.local.progress import named
from clearance.local.summary import confirmed, made, searched
from worker.running.runs.store import MemoryStore

SIGNS = {0: ("✓", "green"), VIOLATED: ("✗", "red"), INCONCLUSIVE: ("?", "yellow")}
"""Of the exit codes: what fails a job has no tick, whatever the verdict, nor has what is not cleared."""
COLOURS = {
    Standing.NEW: "yellow",
    Standing.WORSE: "red",
    Standing.BETTER: "green",
    Standing.FIXED: "green",
    Standing.UNRESOLVED: "yellow",
    Standing.NOT_COMPARED: "yellow",
}
"""Of what has become of a finding since a baseline."""


def print_report(
    campaign: Campaign,
    store: MemoryStore,
    verdict: Verdict,
    out: Path | None,
    cites: Cited | None = None,
    note: str = "",
    likely: Likelihoods | None = None,
) -> None:
    """Print the tables and the verdict. note: the sentence on the baseline; likely: computed already."""
    console = Console(width=None if sys.stdout.isatty() else 120)
    for line in [] if cites is None else citing(cites):
        console.print(Text(line))
    console.print(_stages(store, verdict, campaign.criterion.threshold))
    console.print(_comparison(store, verdict, campaign.criterion.threshold))
    if store.findings:
        console.print(_findings(campaign, store, verdict))
        for line in [*_how_found(store), *_likely(likely or likelihoods(campaign, store, verdict.unit))]:
            console.print(Text(line), soft_wrap=not console.is_terminal)
    console.print(_checks(verdict))
    for line in [*failures(store), *_again(store), *_stated(store)]:
        console.print(Text(line), soft_wrap=not console.is_terminal)
    if note:
        console.print(Text(note), soft_wrap=not console.is_terminal)
    if verdict.regression is not None:
        console.print(_changes(verdict.regression))
    sign, colour = SIGNS[code(verdict) or CODES[verdict.verdict]]
    console.print(Text(f"{sign} {verdict.headline.capitalize()}", style=f"bold {colour}"))
    for line in [verdict.reason, *sureness(verdict), *changes(verdict)]:
        console.print(Text(line), soft_wrap=not console.is_terminal)
    identity = identity_of(verdict.provenance, simulator_of(campaign)).text
    console.print(Text(f"Code: {identity}"), soft_wrap=not console.is_terminal)
    if out is not None:
        console.print(Text(f"Results in {out}"))


def _stages(store: MemoryStore, verdict: Verdict, threshold: float) -> Table:
    table = Table("Stage", title=None)
    for heading in (f"Lowest {verdict.quantity} [{verdict.unit}]", "Evaluations", "Failed", "Excluded", "Time [s]"):
        table.add_column(escape(heading), justify="right")
    table.add_column("Ended")
    for position, record in enumerate(store.stages):
        columns = store.evaluations(position)
        ok = None if columns is None else columns.costs[columns.status == OK, 0]
        table.add_row(
            named(record.plan.kind, record.plan.method),
            "" if ok is None or not len(ok) else beside(float(ok.min()), threshold),
            *map(count, made(store, position)),
            f"{record.seconds:.2f}",
            _ended(record.result),
        )
        search = searched(store, position)
        for minimum in search.minima if search is not None and search.kind == "local" else []:
            at = escape(f"at {_values(minimum.parameters)}")
            cells = (beside(minimum.cost, threshold), count(minimum.evaluations), "", "", "", at)
            table.add_row(escape(f"  from {_values(minimum.start or {})}"), *cells, style="dim")
        if shared := _shared(store, position):
            table.add_row("  counted for several starts", "", f"−{count(shared)}", "", "", "", "", style="dim")
    counts = verdict.evaluations or Counts(stored=0, succeeded=0, failed=0, excluded=0)
    lowest = "" if counts.lowest is None else beside(counts.lowest, threshold)
    time = f"{sum(record.seconds for record in store.stages):.2f}"
    table.add_section()
    table.add_row("all stages", lowest, *map(count, (counts.made, counts.failed, counts.excluded)), time, "")
    return table


def _shared(store: MemoryStore, position: int) -> int:
    """Evaluations of a local search that several of its descents count, as each requested the same point."""
    search = searched(store, position)
    if search is None or search.kind != "local" or search.stop is None:
        return 0
    every = sum(minimum.evaluations for minimum in search.minima)
    return max(0, every - made(store, position)[0]) if search.stop.kind == "rule" else 0


def _ended(result: StageResult | None) -> str:
    if result is not None and result.ended is not None:
        return result.ended.text
    if result is not None and result.repeatability is not None:
        return result.repeatability.text
    return result.text if isinstance(result, Described) else ""


def _stated(store: MemoryStore) -> list[str]:
    """The sentences of an estimate of P(violation), of which findings its modes are, and of a region of attraction."""
    results = [stage.result for stage in store.stages if stage.result is not None]
    validated = confirmed(store)
    modes = None if validated is None else validated.modes
    parts = (*(result.estimation for result in results), modes, *(result.attraction for result in results))
    return [words(sentence(part.statement)) for part in parts if part is not None]


def _comparison(store: MemoryStore, verdict: Verdict, threshold: float) -> Table:
    """The comparison of the methods, from `worker.engine.stages.parts.comparison`."""
    table = Table("Method")
    near = f"Within {percent(SAME_COST)} of best"
    for heading in (f"Best [{verdict.unit}]", "Evaluations", "Failed", "Excluded", "Time [s]", near):
        table.add_column(escape(heading), justify="right")
    table.add_column("Best is in")
    table.add_column("Findings")
    validated = confirmed(store)
    for row in [] if validated is None else validated.comparison:
        table.add_row(
            row.title,
            "" if row.best is None else beside(row.best, threshold),
            count(row.evaluations),
            count(row.failed),
            count(row.excluded),
            f"{row.seconds:.2f}",
            "not reached" if row.to_near_best is None else count(row.to_near_best),
            row.basin or "not in a finding",
            f"{len(row.findings)}: {', '.join(row.findings)}" if row.findings else "0",
        )
        search = searched(store, row.position)
        for member in [] if search is None else search.members:
            best = "" if member.best is None else beside(member.best, threshold)
            cells = (best, count(member.evaluations), "", "", "", "", "", "")
            table.add_row(f"  {member.title}{', apart' if member.apart else ''}", *cells, style="dim")
    return table


def _findings(campaign: Campaign, store: MemoryStore, verdict: Verdict) -> Table:
    first = store.stages[0].result
    nominal = first.at_nominal.parameters if first is not None and first.at_nominal is not None else {}
    table = Table("Parameter")
    table.add_column("Nominal", justify="right")
    for finding in store.findings:
        table.add_column(finding.label, justify="right")
    signs = {"low": "↓", "high": "↑"}
    for path in nominal:
        low, high = campaign.interval(path, nominal[path])
        at = [signs.get(f.at_bounds.get(path, ""), "") for f in store.findings]
        values = [between(f.parameters[path], low, high) for f in store.findings]
        table.add_row(path, between(nominal[path], low, high), *map("".join, zip(values, at, strict=True)))
    threshold = campaign.criterion.threshold
    at_nominal = verdict.nominal or NominalCost(cost=None, margin=None)
    table.add_section()
    table.add_row(
        escape(f"{verdict.quantity} [{verdict.unit}]"),
        "" if at_nominal.cost is None else beside(at_nominal.cost, threshold),
        *(beside(f.granted, threshold) for f in store.findings),
    )
    table.add_row(
        f"margin to {limit(threshold)} {verdict.unit}",
        "" if at_nominal.margin is None else signed(at_nominal.margin),
        *(signed(f.granted - threshold) for f in store.findings),
    )
    validated = confirmed(store)
    nominal_case = None if validated is None else validated.nominal
    table.add_row(
        "validation", verdicts.validated(nominal_case), *(verdicts.validated(f.validation) for f in store.findings)
    )
    seeds = [f.realisation for f in store.findings]
    if any(seed is not None for seed in seeds):
        table.add_row("noise seed drawn", "", *("" if seed is None else str(seed) for seed in seeds))
    return table


def _checks(verdict: Verdict) -> Table:
    signs = {"holds": ("✓", "green"), "open": ("?", "yellow"), "fails": ("✗", "red")}
    table = Table("", "Check", "Result")
    for check in verdicts.checks_of(verdict):
        sign, colour = signs[check.standing]
        text = f"{check.text}; {check.but}" if check.but else check.text
        table.add_row(Text(sign, style=colour), Text(check.title), Text(text))
    return table


def _changes(regression: Regression) -> Table:
    found = Table(f"Since {regression.run}", "")
    unit = f" [{regression.unit}]" if regression.unit else ""
    for heading in (f"Margin there{unit}", f"Same case here{unit}", f"Lowest here{unit}", f"Change{unit}"):
        found.add_column(escape(heading), justify="right")
    found.add_column("Here")
    for case in regression.cases:
        margins = (case.margin_before, case.margin_again, case.margin, case.change)
        standing = Text(f"{case.standing}{', fails' if case.fails else ''}", style=COLOURS.get(case.standing, ""))
        numbers = (NONE if margin is None else signed(margin) for margin in margins)
        found.add_row(case.before or "", standing, *numbers, case.now or "")
    return found


def _again(store: MemoryStore) -> list[str]:
    """Sentences on what the validate stage simulated again besides the findings."""
    validated = confirmed(store)
    parts = () if validated is None else (validated.violations, validated.spot_checks)
    return [f"{part.text[:1].upper()}{part.text[1:]}." for part in parts if part is not None]


def _how_found(store: MemoryStore) -> list[str]:
    lines = []
    certificate = certificate_of(stage.result for stage in store.stages if stage.result is not None)
    for finding in store.findings:
        ways = [f"{named('search', by.method)[8:]} after {count(by.evaluations)}" for by in finding.found]
        noun = "evaluation" if ways and finding.found[-1].evaluations == 1 else "evaluations"
        by = f"{words(listed(ways))} {noun}" if ways else unsearched(finding.validation, certificate)
        how = f"found by {by}"
        if not ways and finding.realisation is None:
            how += (
                f": none evaluated a point with nearly its cost within {percent(SAME_PLACE)} of every range; it was "
                "refined from another, or evaluated in another stage"
            )
        lines.append(f"{finding.label}: {how}")
    validated = confirmed(store)
    gathered = None if validated is None else validated.findings
    if gathered is not None and gathered.left_out:
        minima = "local minimum" if gathered.left_out == 1 else "local minima"
        are = "is" if gathered.left_out == 1 else "are"
        lines.append(f"{count(gathered.left_out)} {minima} no worse than the nominal case {are} omitted")
    if any(f.at_bounds for f in store.findings):
        lines.append("↓ ↑ at its lower or upper bound")
    return lines


def _likely(likely: Likelihoods) -> list[str]:
    stated = {label: of.statement for label, of in likely.findings.items()}
    case = () if likely.violation is None or likely.violation.case is None else likely.violation.statement
    return [words(sentence(line)) for line in lines(stated, case)]


def _values(parameters: dict[str, float]) -> str:
    return "[" + ", ".join(number(v) for v in parameters.values()) + "]"
