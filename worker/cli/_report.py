"""What `clearance run` shows: progress while it works, then the table of stages and the verdict."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any, Self

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bars
from rich.table import Table
from rich.text import Text

from campaigns import Campaign, verdicts
from campaigns.asked.plan import plan
from campaigns.wording import count, listed, number, signed
from worker.catalogue.installed import methods
from worker.runs.store import MemoryStore
from worker.stages.parts.base import Tally
from worker.stages.parts.store import Conclusion

VERDICTS = {
    "cleared": ("✓", "Cleared", "green"),
    "violated": ("✗", "Violated", "red"),
    "inconclusive": ("?", "Inconclusive", "yellow"),
}


class Progress:
    """A bar per stage on standard error, where that is a terminal."""

    def __init__(self, campaign: Campaign) -> None:
        self._planned = plan(campaign)
        console = Console(stderr=True)
        self._bars = Bars(
            TextColumn("{task.description:<24}"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[best]}"),
            TimeElapsedColumn(), console=console, transient=True, disable=not console.is_terminal,
        )  # fmt: skip
        self._tasks: dict[int, Any] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._bars.stop()

    def show(self, position: int, tally: Tally) -> None:
        """Bring a stage's bar up to date."""
        stage = self._planned[position]
        self._bars.start()  # not before something flies: a campaign may turn out to be unusable
        if position not in self._tasks:
            name = _named(stage.kind, stage.method)
            self._tasks[position] = self._bars.add_task(name, total=stage.planned, best="")
        best = "" if tally.best is None else f"best {number(tally.best)}"
        self._bars.update(self._tasks[position], completed=tally.evaluations, best=best)


def print_report(
    campaign: Campaign,
    store: MemoryStore,
    conclusion: Conclusion,
    out: Path | None,
    cites: dict[str, Any] | None = None,
) -> None:
    """The stages, the methods side by side, the findings, the verdict."""
    console = Console(width=None if sys.stdout.isatty() else 120)
    if cites is not None:
        named = f"{cites['as']} continues" if "as" in cites else "Continues"
        console.print(Text(f"{named} {cites['run']} (campaign {cites['digest'][:12]})"))
        if "code" in cites and cites["code"] is None:
            console.print(Text(f"The code that flew {cites['run']} was not stored, so it could not be compared."))
    console.print(_stages(store, conclusion))
    console.print(_comparison(store, conclusion))
    if store.findings:
        console.print(_findings(campaign, store, conclusion))
        for line in _how_found(store):
            console.print(Text(line), soft_wrap=not console.is_terminal)
    console.print(_checks(conclusion))
    for line in _again(store):
        console.print(Text(line), soft_wrap=not console.is_terminal)
    sign, word, colour = VERDICTS[conclusion.verdict]
    console.print(Text(f"{sign} {word}", style=f"bold {colour}"))
    console.print(Text(conclusion.reason), soft_wrap=not console.is_terminal)
    if out is not None:
        console.print(Text(f"Results in {out}"))


def _stages(store: MemoryStore, conclusion: Conclusion) -> Table:
    parts = conclusion.summary
    unit = parts["unit"]
    table = Table("Stage", title=None)
    for heading in (f"Lowest {parts['quantity']} [{unit}]", "Evaluations", "Failed", "Excluded", "Time [s]"):
        table.add_column(escape(heading), justify="right")
    table.add_column("Ended")
    for position, record in enumerate(store.stages):
        columns = store.evaluations(position)
        ok = None if columns is None else columns.costs[columns.status == 0, 0]
        failed = 0 if columns is None else int(((columns.status == 1) | (columns.status == 2)).sum())
        excluded = 0 if columns is None else int((columns.status == 3).sum())
        result = record.result or {}
        table.add_row(
            _named(record.plan.kind, record.plan.method),
            "" if ok is None or not len(ok) else number(float(ok.min())),
            "0" if columns is None else count(len(columns.status)),
            count(failed),
            count(excluded),
            f"{record.seconds:.2f}",
            result.get("stop", {}).get("text") or result.get("text") or "",
        )
        for minimum in result.get("minima", []) if result.get("kind") == "local" else []:
            at = escape(f"at {_values(minimum['parameters'])}")
            cells = (number(minimum["cost"]), count(minimum["evaluations"]), "", "", "", at)
            table.add_row(escape(f"  from {_values(minimum['start'] or {})}"), *cells, style="dim")
    told = parts["evaluations"]
    lowest = "" if told["lowest"] is None else number(told["lowest"])
    time = f"{sum(record.seconds for record in store.stages):.2f}"
    table.add_section()
    table.add_row("all stages", lowest, *(count(told[k]) for k in ("stored", "failed", "excluded")), time, "")
    return table


def _comparison(store: MemoryStore, conclusion: Conclusion) -> Table:
    """The methods side by side, as `worker.stages.parts.comparison` counted."""
    parts = conclusion.summary
    table = Table("Method")
    for heading in (f"Best [{parts['unit']}]", "Evaluations", "Failed", "Excluded", "Time [s]", "To 1 % of best"):
        table.add_column(escape(heading), justify="right")
    table.add_column("Best is in")
    table.add_column("Findings")
    for row in (store.stages[-1].result or {}).get("comparison", []):
        table.add_row(
            row["title"],
            "" if row["best"] is None else number(row["best"]),
            count(row["evaluations"]),
            count(row["failed"]),
            count(row["excluded"]),
            f"{row['seconds']:.2f}",
            "not reached" if row["to_near_best"] is None else count(row["to_near_best"]),
            row["basin"] or "no listed finding",
            f"{len(row['findings'])}: {', '.join(row['findings'])}" if row["findings"] else "0",
        )
        for member in (store.stages[row["position"]].result or {}).get("members", []):
            best = "" if member["best"] is None else number(member["best"])
            cells = (best, count(member["evaluations"]), "", "", "", "", "", "")
            table.add_row(f"  {member['title']}", *cells, style="dim")
    return table


def _findings(campaign: Campaign, store: MemoryStore, conclusion: Conclusion) -> Table:
    """Nominal and every finding, a column each; a mark where a parameter stands at a bound."""
    parts = conclusion.summary
    nominal = (store.stages[0].result or {})["parameters"]
    table = Table("Parameter")
    table.add_column("Nominal", justify="right")
    for finding in store.findings:
        table.add_column(finding.label, justify="right")
    signs = {"low": "↓", "high": "↑"}
    for path in nominal:
        cells = [number(f.parameters[path]) + signs.get(f.at_bounds.get(path, ""), "") for f in store.findings]
        table.add_row(path, number(nominal[path]), *cells)
    cost = parts["nominal"]["cost"]
    table.add_section()
    table.add_row(
        escape(f"{parts['quantity']} [{parts['unit']}]"),
        "" if cost is None else number(cost),
        *(number(f.cost) for f in store.findings),
    )
    table.add_row(
        f"margin to {number(campaign.criterion.threshold)} {parts['unit']}",
        "" if cost is None else signed(parts["nominal"]["margin"]),
        *(signed(f.margin) for f in store.findings),
    )
    nominal_case = (store.stages[-1].result or {})["cases"][0]
    table.add_row(
        "validation", verdicts.validated(nominal_case), *(verdicts.validated(f.validation) for f in store.findings)
    )
    if any(f.validation["realisation"] is not None for f in store.findings):
        seeds = [f.validation["realisation"] for f in store.findings]
        table.add_row("noise seed drawn", "", *("" if seed is None else str(seed) for seed in seeds))
    return table


def _checks(conclusion: Conclusion) -> Table:
    """Everything that must hold before a campaign is cleared."""
    signs = {"holds": ("✓", "green"), "open": ("?", "yellow"), "fails": ("✗", "red")}
    table = Table("", "Check", "Result")
    failed = conclusion.summary["evaluations"]["failed"]
    for check in verdicts.described(conclusion.summary["checks"], failed):
        sign, colour = signs[check["standing"]]
        text = f"{check['text']}; {check['but']}" if check["but"] else check["text"]
        table.add_row(Text(sign, style=colour), Text(check["title"]), Text(text))
    return table


def _again(store: MemoryStore) -> list[str]:
    """What the validate stage simulated again besides the findings."""
    result = store.stages[-1].result or {}
    told = [result["violations"]["text"], result["spot_checks"]["text"]]
    return [f"{text[:1].upper()}{text[1:]}." for text in told]


def _how_found(store: MemoryStore) -> list[str]:
    lines = []
    for finding in store.findings:
        ways = [f"{_named('search', k['method'])[8:]} after {count(k['evaluations'])}" for k in finding.found]
        by = (
            f"found by {listed(ways)} evaluations"
            if ways
            else "found by polishing only: no method came close by itself"
        )
        lines.append(f"{finding.label}: {by}")
    told = (store.stages[-1].result or {}).get("findings", {})
    if told.get("left_out"):
        lines.append(f"{count(told['left_out'])} local minima no worse than the nominal flight are left out")
    if any(f.at_bounds for f in store.findings):
        lines.append("↓ ↑ at its lower or upper bound")
    return lines


def _named(kind: str, method: str | None) -> str:
    if method is None:
        return kind
    known = methods().get(method)
    return f"{kind}: {known.title if known else method}"


def _values(parameters: dict[str, float]) -> str:
    return "[" + ", ".join(number(v) for v in parameters.values()) + "]"
