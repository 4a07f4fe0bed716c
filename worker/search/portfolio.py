"""Portfolio: several methods share one budget, side by side; who gets on gets more of it.

No method is best everywhere, so none should be chosen beforehand (Baudis and Posik, Online black-box algorithm
portfolios for continuous optimization, PPSN 2014). Members: contrast racing, DIRECT, GLOBAL, differential evolution,
CMA-ES, and SQP from the lowest points that any of them found. Each is first given the same share. From then on a
member's share grows with how near its lowest value is to the lowest of all and falls with the evaluations since it
last got lower; a floor keeps every member going. A member that ends begins anew with other random numbers.
The record tells which member asked for what. Guarantees nothing more than its members do. Start reading at `search`.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from worker.search import cma_es, contrast_racing, differential_evolution, direct, sqp
from worker.search.base import Batch, Floats, Method, Search, Space
from worker.search.portfolio_record import Record

MEMBERS: list[tuple[Method, Any]] = [
    (contrast_racing.method, contrast_racing.Options(abreast=4)),
    (direct.method, direct.Options()),
    (differential_evolution.method, differential_evolution.Options()),
    (cma_es.method, cma_es.Options()),
    (sqp.method, sqp.Options(starts=1)),
]

FLOOR = 0.1
"""The part of a member that does not get on, where one that is about to overtake the best has 1 more."""
WINDOW = 20
"""A member's pace is measured over so many of its evaluations per parameter."""
HORIZON = 10
"""A member that would take so many evaluations per parameter to overtake the best has half of that 1."""
LOWER = 1e-3
"""To overtake means to be lower than the best by this share of the spread."""
EPOCH = 2000
"""The budget that contrast racing first plans with; it doubles it itself."""
AHEAD = 200
"""So many evaluations of all a member may be ahead of its share, for the sake of large requests."""


@dataclass(frozen=True)
class Options:
    """When shares begin to differ."""

    fair: Annotated[
        int, Field(ge=0, le=1000, description="Evaluations per parameter of every member before shares differ")
    ] = 8


def search(space: Space, options: Options) -> Search:
    """One request holds the points of every member whose turn it is; it goes on for as long as it is asked."""
    record = Record(space.dimension)
    members = [Member(method, given, space, record) for method, given in MEMBERS]
    try:
        while True:
            turn = _turn(members, record, options.fair * space.dimension)
            if not turn:
                return "every member has ended"
            for member in turn:
                space.attribute(member.method.name, len(member.wanted))
            batch = yield np.concatenate([member.wanted for member in turn])
            at = 0
            for member in turn:
                rows = slice(at, at + len(member.wanted))
                at = rows.stop
                member.tell(Batch(batch.costs[rows], batch.status[rows]), record)
    finally:
        for member in members:
            member.close()


class Member:
    """One method at work: the points it wants, when its next turn is, and how it gets on."""

    def __init__(self, method: Method, options: Any, space: Space, record: Record) -> None:
        self.method, self.options, self.space = method, options, space
        self.wanted: Floats = np.empty((0, space.dimension))
        self.search: Search | None = None
        self.used = 0
        self.due = 0.0
        self.lowest = np.inf
        self.past: deque[tuple[int, float]] = deque()
        self.best: Floats | None = None

    def ready(self, record: Record) -> bool:
        """Whether it wants points; begins it, or begins it anew, where it can."""
        if self.search is not None:
            return True
        if self.used and not self.random:
            return False
        starts = np.empty((0, self.space.dimension))
        if self.method.starts:
            start = record.start()
            if start is None:
                return False
            starts = start[None, :]
        self.lowest = np.inf
        self.past.clear()
        given = replace(
            self.space,
            budget=EPOCH,
            random=np.random.default_rng(self.space.random.integers(2**63)),
            starts=starts,
            attribute=lambda member, points: None,
        )
        self.search = self.method.search(given, self.options)
        return self._advance(None, record)

    @property
    def random(self) -> bool:
        """Whether it would go another way if it began anew."""
        return self.method.name != "direct"

    def tell(self, batch: Batch, record: Record) -> None:
        """The values of the points it wanted."""
        values = batch.ranked()
        record.see(self.wanted, values)
        self.used += len(values)
        low = int(np.argmin(values))
        if values[low] < self.lowest:
            self.lowest, self.best = float(values[low]), self.wanted[low].copy()
        if np.isfinite(self.lowest):
            self.past.append((self.used, self.lowest))
        while len(self.past) > 2 and self.past[1][0] <= self.used - WINDOW * self.space.dimension:
            self.past.popleft()
        self._advance(batch, record)

    def part(self, record: Record) -> float:
        """Its part of the evaluations to come, in no unit: by how soon it would overtake the best at its pace."""
        if len(self.past) < 2:
            return 0.5
        spread = record.spread()
        used, lowest = self.past[0]
        pace = (lowest - self.lowest) / (self.used - used)
        if not pace > 0.0:
            return FLOOR
        gap = self.lowest - record.lowest + LOWER * spread
        return float(FLOOR + 1.0 / (1.0 + gap / (pace * HORIZON * self.space.dimension)))

    def close(self) -> None:
        """End it."""
        if self.search is not None:
            self.search.close()

    def _advance(self, batch: Batch | None, record: Record) -> bool:
        assert self.search is not None
        try:
            self.wanted = (next(self.search) if batch is None else self.search.send(batch)).copy()
        except StopIteration:
            self.search = None
            if self.best is not None and self.method.starts:
                record.take(self.best)
            return False
        return True


def _turn(members: list[Member], record: Record, fair: int) -> list[Member]:
    """Those whose turn it is: each request puts off a member's next by its length over the member's share."""
    able = [m for m in members if m.ready(record)]
    if not able:
        return []
    early = any(m.used < fair for m in able)
    parts = [1.0 if early else m.part(record) for m in able]
    first = min(m.due for m in able)
    turn = []
    for member, part in zip(able, parts, strict=True):
        member.due = max(member.due, first)
        if member.due <= first + AHEAD:
            member.due += len(member.wanted) * sum(parts) / part
            turn.append(member)
    return turn


method = Method(
    name="portfolio",
    title="Portfolio",
    kind="global",
    how="Global. Several methods share the budget",
    source="Baudis and Posik 2014",
    evaluations=5000,
    options=Options,
    search=search,
    repeats=True,
    extend=lambda options, more: options,
)
