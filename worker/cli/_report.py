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

from campaigns import Campaign
from campaigns.plan import plan
from worker.catalog import methods
from worker.stages.base import Tally
from worker.store import Conclusion, MemoryStore
from worker.wording import count, number, signed

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


def print_report(campaign: Campaign, store: MemoryStore, conclusion: Conclusion, out: Path | None) -> None:
    """The stages, the worst case, the verdict."""
    console = Console(width=None if sys.stdout.isatty() else 120)
    console.print(_stages(store, conclusion))
    worst = conclusion.summary["worst"]
    if worst is not None:
        console.print(_worst(campaign, store, conclusion))
    sign, word, colour = VERDICTS[conclusion.verdict]
    console.print(Text(f"{sign} {word}", style=f"bold {colour}"))
    console.print(Text(conclusion.reason), soft_wrap=not console.is_terminal)
    if out is not None:
        console.print(Text(f"Results in {out}"))


def _stages(store: MemoryStore, conclusion: Conclusion) -> Table:
    parts = conclusion.summary
    unit = parts["unit"]
    table = Table("Stage", title=None)
    for heading in (f"Lowest {parts['quantity']} [{unit}]", "Evaluations", "Failed", "Time [s]"):
        table.add_column(escape(heading), justify="right")
    table.add_column("Ended")
    for position, record in enumerate(store.stages):
        columns = store.evaluations(position)
        ok = None if columns is None else columns.costs[columns.status == 0, 0]
        failed = 0 if columns is None else int(((columns.status == 1) | (columns.status == 2)).sum())
        result = record.result or {}
        table.add_row(
            _named(record.plan.kind, record.plan.method),
            "" if ok is None or not len(ok) else number(float(ok.min())),
            "0" if columns is None else count(len(columns.status)),
            count(failed),
            f"{record.seconds:.2f}",
            result.get("stop", {}).get("text") or result.get("text") or "",
        )
        for minimum in result.get("minima", []):
            at = escape(f"at {_values(minimum['parameters'])}")
            cells = (number(minimum["cost"]), count(minimum["evaluations"]), "", "", at)
            table.add_row(escape(f"  {_start(minimum)}"), *cells, style="dim")
    return table


def _worst(campaign: Campaign, store: MemoryStore, conclusion: Conclusion) -> Table:
    parts = conclusion.summary
    finding = store.findings[0]
    nominal = (store.stages[0].result or {})["parameters"]
    table = Table("Parameter")
    for heading in ("Nominal", "Worst"):
        table.add_column(heading, justify="right")
    table.add_column("At bound")
    for path, value in finding.parameters.items():
        table.add_row(path, number(nominal[path]), number(value), finding.at_bounds.get(path, ""))
    cost = parts["nominal"]["cost"]
    table.add_section()
    table.add_row(
        escape(f"{parts['quantity']} [{parts['unit']}]"), "" if cost is None else number(cost), number(finding.cost)
    )
    table.add_row(f"margin to {number(campaign.criterion.threshold)} {parts['unit']}",
                  "" if cost is None else signed(parts["nominal"]["margin"]), signed(finding.margin))  # fmt: skip
    return table


def _named(kind: str, method: str | None) -> str:
    if method is None:
        return kind
    known = methods().get(method)
    return f"{kind}: {known.title if known else method}"


def _start(minimum: dict[str, Any]) -> str:
    return "minimum" if minimum["start"] is None else f"from {_values(minimum['start'])}"


def _values(parameters: dict[str, float]) -> str:
    return "[" + ", ".join(number(v) for v in parameters.values()) + "]"
