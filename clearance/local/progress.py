"""Progress of a run in this process: a bar per stage on standard error."""

from __future__ import annotations

from typing import Any, Self

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bars

from campaigns import Campaign
from campaigns.claims.numbers import number
from campaigns.stages.found import declared
from campaigns.stages.plan import plan
from worker.engine.stages.parts.base import Tally
from worker.running.catalogue.installed import methods


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
        """Update a stage's bar."""
        stage = self._planned[position]
        self._bars.start()  # not before the first evaluation: a campaign may turn out to be unusable
        if position not in self._tasks:
            name = named(stage.kind, stage.method)
            total = (
                None if declared()[stage.kind].of_findings else stage.planned
            )  # how much it repeats depends on what was found
            self._tasks[position] = self._bars.add_task(name, total=total, best="")
        best = "" if tally.best is None else f"best {number(tally.best)}"
        self._bars.update(self._tasks[position], completed=tally.evaluations, best=best)


def named(kind: str, method: str | None) -> str:
    """A stage by its kind and, of a search, the title of its method."""
    if method is None:
        return kind
    known = methods().get(method)
    return f"{kind}: {known.title if known else method}"
