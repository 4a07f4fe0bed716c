"""Computes our values for the published ones; everything is simulated in this run, and every search runs once."""

from __future__ import annotations

import dataclasses
import itertools
import time
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from campaigns import Campaign, library, load_file
from campaigns.asked.stages import Search as Asked
from campaigns.results import SearchResult
from campaigns.results.base import OK
from campaigns.stored.records import Columns, StagePlan, Trace
from worker.engine.problem.evaluate import InProcess
from worker.engine.problem.problem import Problem
from worker.engine.stages import search as stage
from worker.engine.stages.parts.context import Context
from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop.system import ClosedLoop
from worker.engine.systems.closed_loop.trace import trace
from worker.running.catalogue.installed import methods
from worker.running.opening.opened import closed_loop
from worker.running.reproduce.published import D_MIN, Case, Corners, Fly, How, Result, Search, Sweep
from worker.running.runs.store import MemoryStore

SWEEP = 41
"""Points of a sweep over one parameter."""

RIPPLE = 0.01
"""Fraction of a sweep's range of values below which a step against its direction is a ripple."""


class NotAvailable(Exception):
    """A published result cannot be computed by this installation; the message states what is missing."""


@dataclass(frozen=True)
class Found:
    """A computed value, the parameters of a worst case by path, evaluations and seconds used, a note."""

    value: float | str | None
    at: dict[str, float] | None = None
    evaluations: int | None = None
    seconds: float | None = None
    note: str = ""


@dataclass
class Flights:
    """The campaigns in use, compiled once, and computed values, stored for the rows and figures that share them."""

    threads: int | None = None
    compile_seconds: float = 0.0
    known: dict[tuple[str, How], Found] = field(default_factory=dict)
    columns: dict[tuple[str, How], Columns] = field(default_factory=dict)
    opened: dict[str, _Opened] = field(default_factory=dict)
    readable: set[str] = field(default_factory=set)

    def found(self, result: Result) -> Found:
        """Our value for a published result; raises `NotAvailable`."""
        found = self.computed(result.campaign, result.case, result.how)
        if result.quantity == D_MIN:
            return found
        if found.at is None:
            return Found(None, note=found.note)
        return Found(found.at[result.case.path(result.quantity)], note=found.note)

    def computed(self, name: str, case: Case, how: How) -> Found:
        """The result of one computation on one campaign; raises `NotAvailable`."""
        if (name, how) not in self.known:
            opened = self.open(name)
            opened.require(path for _, path in case.paths)
            if isinstance(how, Fly):
                found = opened.simulate(dict(how.values))
            elif isinstance(how, Corners):
                found = opened.corners()
            elif isinstance(how, Sweep):
                found = opened.trend(case.path(how.symbol))
            else:
                found, self.columns[name, how] = opened.search(case, how)
            self.known[name, how] = found
        return self.known[name, how]

    def open(self, name: str) -> _Opened:
        """A compiled campaign of the library; raises `NotAvailable`. Its compile time is counted separately."""
        if name not in self.opened:
            path = library().get(name)
            if path is None:
                raise NotAvailable(f"the library has no campaign {name}")
            began = time.perf_counter()
            loop = closed_loop(load_file(path))
            loop.warm()
            self.compile_seconds += time.perf_counter() - began
            problem = Problem(loop.campaign, loop)
            self.opened[name] = _Opened(loop, problem, InProcess(problem, self.threads))
        return self.opened[name]

    def traced(self, name: str, what: str, values: dict[str, float]) -> Trace:
        """The trace of a campaign at these values; compile time is counted separately."""
        loop = self.open(name).loop
        if name not in self.readable:
            began = time.perf_counter()
            rows = np.zeros((1, loop.loop.n_state + loop.loop.n_held))
            loop.loop.observe(rows, loop.nominal, loop.step)
            self.compile_seconds += time.perf_counter() - began
            self.readable.add(name)
        return trace(loop, what, values)

    def close(self) -> None:
        """Stop the threads."""
        for opened in self.opened.values():
            opened.evaluate.close()


@dataclass
class _Opened:
    loop: ClosedLoop
    problem: Problem
    evaluate: InProcess

    @property
    def campaign(self) -> Campaign:
        return self.problem.campaign

    def require(self, paths: Iterable[str]) -> None:
        """Raise `NotAvailable` unless all these paths are uncertain in the campaign."""
        missing = set(paths) - {r.path for r in self.problem.ranges}
        if missing:
            raise NotAvailable(f"{', '.join(sorted(missing))} are not uncertain in the campaign {self.campaign.name!r}")

    @cached_property
    def lows_and_highs(self) -> Floats:
        """Every corner of the unit cube (2^n, n)."""
        return np.array(list(itertools.product((0.0, 1.0), repeat=self.problem.dimension)))

    def simulate(self, values: dict[str, float]) -> Found:
        try:
            vector = self.problem.vector(values)
        except KeyError as error:
            raise NotAvailable(f"the campaign {self.campaign.name!r} has no parameter {error.args[0]}") from None
        batch, reasons = self.loop.simulate_vectors(vector[None, :])
        if batch.status[0] != OK:
            return Found(None, note=reasons[0])
        return Found(float(batch.costs[0, 0]), evaluations=1)

    def corners(self) -> Found:
        batch, _ = self.evaluate(self.lows_and_highs)
        row = int(np.argmin(batch.ranked()))
        lost = int(np.count_nonzero(batch.status != OK))
        note = f"{lost} of {len(batch.status)} corners could not be simulated" if lost else ""
        at = self.problem.named(self.lows_and_highs[row])
        return Found(float(batch.costs[row, 0]), at, len(batch.status), note=note)

    def sweep(self, path: str, points: int = SWEEP) -> tuple[Floats, Floats]:
        """Values of one parameter over its range, the others nominal, and d_min at each; NaN if it failed."""
        index = [r.path for r in self.problem.ranges].index(path)
        unit = np.repeat(self.problem.nominal_point[None, :], points, axis=0)
        unit[:, index] = np.linspace(0.0, 1.0, points)
        batch, _ = self.evaluate(unit)
        return self.problem.values(unit)[:, index], batch.costs[:, 0]

    def trend(self, path: str) -> Found:
        _, costs = self.sweep(path)
        trend, against = direction(costs)
        note = f"ranges over {float(np.ptp(costs)):.4g} m" + (
            f", with ripples up to {against:.2g} m" if against else ""
        )
        return Found(trend, evaluations=len(costs), note=note)

    def search(self, case: Case, how: Search) -> tuple[Found, Columns]:
        """Run one search as the only stage of the campaign, with the campaign's seed."""
        method = next((methods()[name] for name in how.names if name in methods()), None)
        if method is None:
            raise NotAvailable(f"this installation has no method {how.title}")
        known = {f.name for f in dataclasses.fields(method.options)}
        starts = [] if how.start is None else [dict(zip((p for _, p in case.paths), how.start, strict=True))]
        planned = Asked(
            method=method.name,
            evaluations=how.evaluations,
            options={name: value for name, value in how.options if name in known},
            starts=starts,
        )
        campaign = self.campaign.model_copy(
            update={"stages": self.campaign.stages.model_copy(update={"search": [planned]})}
        )
        store = MemoryStore()
        store.plan([StagePlan("search", method.name, how.evaluations)])
        context = Context(
            campaign,
            self.problem,
            self.evaluate,
            store,
            plan=[record.plan for record in store.stages],
            methods=methods(),
        )
        return _found(stage.run(context, 0).result), context.columns[0]


def _found(result: SearchResult) -> Found:
    """The end of a local method's only descent, else the lowest evaluation."""
    best = result.minima[0] if result.kind == "local" and result.minima else result.best
    spent = (result.evaluations, result.seconds)
    if best is None:
        return Found(None, None, *spent, note="no evaluation succeeded")
    lost = f"{result.failed} evaluations failed" if result.failed else ""
    return Found(best.cost, best.parameters, *spent, note=lost)


def direction(costs: Floats) -> tuple[str, float]:
    """Whether a curve rises or falls from end to end, or neither; and its largest step in the opposite direction.

    Opposite steps smaller than `RIPPLE` of its range of values are tolerated.
    """
    steps = np.diff(costs)
    if not np.isfinite(steps).all():
        return "neither", 0.0
    sign = 1.0 if costs[-1] > costs[0] else -1.0
    against = float(max(0.0, -(sign * steps).min()))
    if against > max(RIPPLE * float(np.ptp(costs)), 2e-4):
        return "neither", against
    return ("rises" if sign > 0 else "falls"), against
