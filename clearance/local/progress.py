"""Progress of a run in this process: a bar per stage in a terminal, an updated display in a notebook, else a line per
stage that has ended. All but the display are on standard error."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from contextlib import suppress
from html import escape
from typing import Any, NamedTuple, Protocol, Self

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bars

from campaigns import Campaign
from campaigns.claims.numbers import beside, count
from campaigns.stages.found import declared
from campaigns.stages.plan import left, plan
from worker.engine.stages.parts.context import Tally
from worker.running.catalogue.installed import methods

PAUSE = 0.3
"""Between two updates of a display in a notebook [s]."""


class Named(NamedTuple):
    """A stage of a run: its kind, its name, and the evaluations that it is planned to have; None: they depend on
    findings."""

    kind: str
    name: str
    planned: int | None

    def whole(self, tally: Tally) -> int | None:
        """Its evaluations with those that it has left; excluded samples are drawn again."""
        if self.planned is None:
            return None
        return tally.evaluations + left(self.kind, self.planned, tally.evaluations, tally.excluded)


Names = list[Named]
"""The stages of a run."""


class Shown(Protocol):
    """What shows the tallies of the stages."""

    def show(self, position: int, tally: Tally) -> None:
        """Update a stage."""

    def end(self) -> None:
        """No stage is updated any more."""


class Progress:
    """Shows a run as the place where it runs can."""

    def __init__(self, campaign: Campaign) -> None:
        kinds = declared()
        names = [
            Named(s.kind, named(s.kind, s.method), None if kinds[s.kind].of_findings else s.planned)
            for s in plan(campaign)
        ]
        console = Console(stderr=True)
        display = None if console.is_terminal else _display()
        of = names, campaign.criterion.threshold
        self._shown: Shown | None = (
            _Bars(*of, console) if console.is_terminal else _Display(*of, display) if display else _Lines(*of)
        )

    def show(self, position: int, tally: Tally) -> None:
        """Update a stage. A display that fails, such as a terminal that was closed, is given up, not the run."""
        try:
            if self._shown is not None:
                self._shown.show(position, tally)
        except Exception:
            self._shown = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        with suppress(Exception):
            if self._shown is not None:
                self._shown.end()


class _Bars:
    def __init__(self, names: Names, threshold: float, console: Console) -> None:
        self._names, self._threshold = names, threshold
        self._bars = Bars(
            TextColumn("{task.description:<24}"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[best]}"),
            TimeElapsedColumn(), console=console, transient=True,
        )  # fmt: skip
        self._tasks: dict[int, Any] = {}

    def show(self, position: int, tally: Tally) -> None:
        self._bars.start()  # not before the first evaluation: a campaign may turn out to be unusable
        if position not in self._tasks:
            of = self._names[position]
            self._tasks[position] = self._bars.add_task(of.name, total=of.planned, best="")
        whole = self._names[position].whole(tally)
        self._bars.update(
            self._tasks[position], total=whole, completed=tally.evaluations, best=_best(tally, self._threshold)
        )

    def end(self) -> None:
        self._bars.stop()


class _Lines:
    """A line for each stage once the next one has begun, or the run has ended, with the time of its last evaluation
    since the start: how long a stage took is measured by the run, and stated in its result."""

    def __init__(self, names: Names, threshold: float) -> None:
        self._names, self._threshold, self._now = names, threshold, -1
        self._began, self._seen, self._tally = time.monotonic(), 0.0, Tally()

    def show(self, position: int, tally: Tally) -> None:
        if position != self._now:
            self.end()
        self._now, self._tally, self._seen = position, tally, time.monotonic()

    def end(self) -> None:
        if self._now >= 0:
            parts = [
                _evaluations(self._tally),
                _best(self._tally, self._threshold),
                f"{self._seen - self._began:.1f} s after the start",
            ]
            print(f"{self._names[self._now].name}: {', '.join(filter(None, parts))}", file=sys.stderr, flush=True)
        self._now = -1


class _Display:
    """A table that is updated in place, by the display that the notebook has."""

    def __init__(self, names: Names, threshold: float, display: Callable[..., Any]) -> None:
        self._names, self._threshold, self._display = names, threshold, display
        self._tallies: dict[int, Tally] = {}
        self._handle: Any = None
        self._updated, self._ended = 0.0, False

    def show(self, position: int, tally: Tally) -> None:
        new = position not in self._tallies
        self._tallies[position] = tally
        if new or time.monotonic() - self._updated >= PAUSE:
            self._update()

    def end(self) -> None:
        self._ended = True
        if self._tallies:
            self._update()

    def _update(self) -> None:
        self._updated = time.monotonic()
        if self._handle is None:
            self._handle = self._display(self, display_id=True)
        else:
            self._handle.update(self)

    def __repr__(self) -> str:
        rows = [
            f"{self._names[at].name}: {_evaluations(tally)} {_best(tally, self._threshold)}"
            for at, tally in self._tallies.items()
        ]
        return "\n".join(map(str.rstrip, rows))

    def _repr_html_(self) -> str:
        cell = '<td style="text-align:left;padding:2px 10px">'
        rows = []
        for position, (_, name, planned) in enumerate(self._names):
            tally = self._tallies.get(position)
            done = position < max(self._tallies) or (self._ended and planned is None)
            whole = 0 if tally is None else self._names[position].whole(tally) or tally.evaluations
            most = max(1, planned or 0, whole)
            value = most if done else None if planned is None and tally else 0 if tally is None else tally.evaluations
            filled = "" if value is None else f' value="{value}"'
            bar = f'<progress max="{most}"{filled}></progress>'
            texts = [
                escape(name),
                bar,
                *(("", "") if tally is None else (_evaluations(tally), _best(tally, self._threshold))),
            ]
            rows.append(f"<tr>{''.join(f'{cell}{text}</td>' for text in texts)}</tr>")
        return f'<table style="font-variant-numeric:tabular-nums">{"".join(rows)}</table>'


def _display() -> Callable[..., Any] | None:
    """The display of the notebook in which this runs."""
    python = sys.modules.get("IPython")
    if python is None or python.get_ipython() is None:
        return None
    from IPython.display import display  # type: ignore[import-not-found,unused-ignore]

    shown: Callable[..., Any] = display
    return shown


def _evaluations(tally: Tally) -> str:
    return f"{count(tally.evaluations)} evaluation{'' if tally.evaluations == 1 else 's'}"


def _best(tally: Tally, threshold: float) -> str:
    return "" if tally.best is None else f"best {beside(tally.best, threshold)}"


def named(kind: str, method: str | None) -> str:
    """A stage by its kind and, of a search, the title of its method."""
    if method is None:
        return kind
    known = methods().get(method)
    return f"{kind}: {known.title if known else method}"
