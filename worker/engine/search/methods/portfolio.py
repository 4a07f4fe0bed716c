"""Portfolio: several methods share one budget; those likely to improve the best value get more of it.

No method is best everywhere, so none needs to be chosen beforehand (Baudis and Posik, Online black-box algorithm
portfolios for continuous optimization, PPSN 2014). Members: contrast racing, DIRECT, GLOBAL, differential evolution,
CMA-ES, MLSL, and SQP, which starts at the lowest point found by any of them away from its earlier starts.
The rule: at first all get the same share. Later a member has a small base share, plus up to 1 depending on how soon it
would reach the best cost at its rate of improvement. A member that has not improved for long loses both, but members
that keep exploring retain their base share. A member that ends is restarted with new random numbers; an unpromising
descent is stopped in favour of a lower start. The record states which member requested which evaluation. Its guarantees
are those of its members.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from worker.engine.search.base import Batch, Floats, Method, MethodLook, Parallel, Space
from worker.engine.search.methods import (
    cma_es,
    contrast_racing,
    differential_evolution,
    direct,
    global_clustering,
    mlsl,
    sqp,
)
from worker.engine.search.parts.portfolio_record import Record
from worker.engine.search.parts.turns import Member, taking_turns


@dataclass(frozen=True)
class Part:
    """A member: method, options, base share, whether it keeps exploring, and whether it restarts after its end."""

    method: Method
    options: Any
    own: float
    explores: bool = False
    again: bool = True


SMALL = differential_evolution.Options(population=4, recombination=0.2)
"""Within thousands of evaluations, a small population that changes few parameters at a time does much better than the
default: it solves eight-dimensional Levy with 12 and five-dimensional Rastrigin with 10 of 12 seeds, the default with 1
and 0."""

MEMBERS = [
    Part(contrast_racing.method, contrast_racing.Options(abreast=4), 0.2, explores=True),
    Part(direct.method, direct.Options(), 0.1, explores=True, again=False),
    Part(mlsl.method, mlsl.Options(), 0.3, explores=True),
    Part(cma_es.method, cma_es.Options(), 0.3),
    Part(differential_evolution.method, SMALL, 0.2),
    Part(global_clustering.method, global_clustering.Options(), 0.02),
    Part(sqp.method, sqp.Options(), 0.1),
]

WINDOW = 20
"""Evaluations per parameter over which the rate of improvement of a member is measured."""
HORIZON = 10
"""A member that needs this many evaluations per parameter to beat the best gets half of the variable share."""
LOWER = 1e-3
"""To beat the best means to be lower by this fraction of the spread."""
PATIENCE = 20
"""Evaluations per parameter without improvement that halve the share of a member that does not explore."""
HOPELESS = 0.3
"""A descent with a lower promise is stopped if there is a lower start."""
EPOCH = 1000
"""The initial budget of contrast racing, which doubles it when it is used up."""
AHEAD = 100
"""Total evaluations by which a member may be ahead of its share, to allow large requests."""

PENDING = 64
"""Requested points below which another member gets a turn in slots, whose number may change when a run is resumed."""


@dataclass(frozen=True)
class Options:
    """Options of the portfolio."""

    fair: Annotated[
        int, Field(ge=0, le=1000, description="Evaluations per parameter of every member before shares differ")
    ] = 4


def search(space: Space, options: Options) -> Parallel:
    """Give the members their turns until the budget ends."""
    record = Record(space.dimension)
    members = [Running(part, space, record) for part in MEMBERS]
    fair = options.fair * space.dimension
    return (yield from taking_turns(space, members, lambda busy: _turn(members, fair, busy), Running.tell, PENDING))


class Running(Member):
    """One running method: the time of its next turn, and its progress."""

    def __init__(self, part: Part, space: Space, record: Record) -> None:
        super().__init__(part.method.name, space.dimension)
        self.part, self.method, self.space, self.record = part, part.method, space, record
        self.stale = 0
        self.ever = np.inf
        self.due = self.cost = 0.0
        self.past: deque[tuple[int, float]] = deque()
        self.best: Floats | None = None

    def ready(self) -> bool:
        """Whether it requests points; starts or restarts it if possible."""
        if self.search is not None:
            return True
        if self.used and not self.part.again:
            return False
        starts = np.empty((0, self.space.dimension))
        if self.method.starts:
            start = self.record.start()
            if start is None:
                return False
            starts = start[None, :]
        self.lowest = np.inf
        self.past.clear()
        self.search = self.method.search(self.space.of_member(EPOCH, starts), self.part.options)
        return self._advanced(None)

    def tell(self, batch: Batch) -> None:
        """Pass the values of the points that it requested."""
        values, record = batch.ranked(), self.record
        record.see(self.requested, values)
        self.used += len(values)
        lowest = float(values.min())
        if lowest < self.lowest:
            self.lowest, self.best = lowest, self.requested[int(values.argmin())].copy()
        self.stale += len(values)
        if self.lowest < self.ever - LOWER * record.spread():
            self.ever, self.stale = self.lowest, 0
        if np.isfinite(self.lowest):
            self.past.append((self.used, self.lowest))
        while len(self.past) > 2 and self.past[1][0] <= self.used - WINDOW * self.space.dimension:
            self.past.popleft()
        if self.method.starts and record.lowest_start() < self.lowest and self.promise() < HOPELESS:
            self._end()
        else:
            self._advanced(batch)

    def weight(self) -> float:
        """The member's share of the coming evaluations, relative to the others."""
        fresh = 1.0 / (1.0 + self.stale / (PATIENCE * self.space.dimension))
        return self.part.own * (1.0 if self.part.explores else fresh) + fresh * self.promise()

    def promise(self) -> float:
        """How soon the member would beat the best at its rate of improvement, from 0 to 1."""
        if len(self.past) < 2:
            return 0.5
        used, lowest = self.past[0]
        pace = (lowest - self.lowest) / (self.used - used)
        if not pace > 0.0:
            return 0.0
        gap = self.lowest - self.record.lowest + LOWER * self.record.spread()
        return float(1.0 / (1.0 + gap / (pace * HORIZON * self.space.dimension)))

    def _advanced(self, batch: Batch | None) -> bool:
        if not self.advance(batch):
            self._end()
        return self.search is not None

    def _end(self) -> None:
        self.close()
        if self.best is not None and self.method.starts:
            self.record.take(self.best)


def _turn(members: list[Running], fair: int, busy: Collection[Running]) -> list[Running]:
    """The members whose turn it is: a request delays the next one by its length divided by the member's share."""
    able = [m for m in members if m not in busy and m.ready()]
    if not able:
        return []
    early = sum(m.used for m in members) < fair * len(members)
    parts = [1.0 if early else m.weight() for m in able]
    now = min(m.due for m in able)
    for member, part in zip(able, parts, strict=True):
        member.due = max(member.due, now)
        member.cost = len(member.requested) * sum(parts) / part
    first = min(m.due + m.cost for m in able)
    turn = [m for m in able if m.due + m.cost <= first + AHEAD]
    for member in turn:
        member.due += member.cost
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
    compiles=True,
    repeats=True,
    extend=lambda options, more: options,
    family="portfolio",
    together={part.method.name: part.method.family for part in MEMBERS},
    whole_budget=True,
    parallel="every member on its own",
    suits="a criterion about which nothing is known",
    look=MethodLook(colour="#1b2733", dark="#f2f5f8", marker="asterisk"),
)
