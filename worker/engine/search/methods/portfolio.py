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
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from worker.engine.search.base import Batch, Ended, Floats, Method, MethodLook, Parallel, Several, Space
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
    members = [Member(part, space) for part in MEMBERS]
    fair = options.fair * space.dimension
    try:
        return (yield from (_in_slots if space.slots else _in_batches)(space, members, record, fair))
    finally:
        for member in members:
            member.close()


def _in_batches(space: Space, members: list[Member], record: Record, fair: int) -> Parallel:
    """One request contains the points of every member whose turn it is."""
    while True:
        turn = _turn(members, record, fair)
        if not turn:
            return Ended("members", "every member has ended")
        for member in turn:
            space.attribute(member.method.name, len(member.requested))
        batch = yield np.concatenate([member.requested for member in turn])
        for member, own in zip(turn, batch.split([len(member.requested) for member in turn]), strict=True):
            member.tell(own, record)


def _in_slots(space: Space, members: list[Member], record: Record, fair: int) -> Parallel:
    """Each member continues when its own points have ended; others get a turn while the slots have too little to do."""
    pending: dict[int, Member] = {}
    while True:
        request = Several([])
        while sum(len(m.requested) for m in pending.values()) < PENDING:
            turn = _turn(members, record, fair, pending.values())
            if not turn:
                break
            for member in turn:
                space.attribute(member.method.name, len(member.requested))
                number = members.index(member)
                pending[number] = member
                request.groups.append((number, member.requested))
        if not pending:
            return Ended("members", "every member has ended")
        batch = yield request
        pending.pop(request.answered).tell(batch, record)


class Member:
    """One running method: the points it requests, the time of its next turn, and its progress."""

    def __init__(self, part: Part, space: Space) -> None:
        self.part, self.method, self.space = part, part.method, space
        self.requested: Floats = np.empty((0, space.dimension))
        self.search: Parallel | None = None
        self.used = self.stale = 0
        self.ever = np.inf
        self.due = self.cost = 0.0
        self.lowest = np.inf
        self.past: deque[tuple[int, float]] = deque()
        self.best: Floats | None = None

    def ready(self, record: Record) -> bool:
        """Whether it requests points; starts or restarts it if possible."""
        if self.search is not None:
            return True
        if self.used and not self.part.again:
            return False
        starts = np.empty((0, self.space.dimension))
        if self.method.starts:
            start = record.start()
            if start is None:
                return False
            starts = start[None, :]
        self.lowest = np.inf
        self.past.clear()
        space = replace(
            self.space,
            budget=EPOCH,
            random=np.random.default_rng(self.space.random.integers(2**63)),
            starts=starts,
            attribute=lambda member, points: None,
            slots=0,
        )
        self.search = self.method.search(space, self.part.options)
        return self._advance(None, record)

    def tell(self, batch: Batch, record: Record) -> None:
        """Pass the values of the points that it requested."""
        values = batch.ranked()
        record.see(self.requested, values)
        self.used += len(values)
        low = int(np.argmin(values))
        if values[low] < self.lowest:
            self.lowest, self.best = float(values[low]), self.requested[low].copy()
        self.stale += len(values)
        if self.lowest < self.ever - LOWER * record.spread():
            self.ever, self.stale = self.lowest, 0
        if np.isfinite(self.lowest):
            self.past.append((self.used, self.lowest))
        while len(self.past) > 2 and self.past[1][0] <= self.used - WINDOW * self.space.dimension:
            self.past.popleft()
        if self.method.starts and record.lowest_start() < self.lowest and self.promise(record) < HOPELESS:
            self._end(record)
        else:
            self._advance(batch, record)

    def weight(self, record: Record) -> float:
        """The member's share of the coming evaluations, relative to the others."""
        fresh = 1.0 / (1.0 + self.stale / (PATIENCE * self.space.dimension))
        return self.part.own * (1.0 if self.part.explores else fresh) + fresh * self.promise(record)

    def promise(self, record: Record) -> float:
        """How soon the member would beat the best at its rate of improvement, from 0 to 1."""
        if len(self.past) < 2:
            return 0.5
        used, lowest = self.past[0]
        pace = (lowest - self.lowest) / (self.used - used)
        if not pace > 0.0:
            return 0.0
        gap = self.lowest - record.lowest + LOWER * record.spread()
        return float(1.0 / (1.0 + gap / (pace * HORIZON * self.space.dimension)))

    def close(self) -> None:
        """Close the method's generator."""
        if self.search is not None:
            self.search.close()

    def _advance(self, batch: Batch | None, record: Record) -> bool:
        assert self.search is not None
        try:
            request = next(self.search) if batch is None else self.search.send(batch)
            assert isinstance(request, np.ndarray)
            self.requested = request.copy()
        except StopIteration:
            self._end(record)
            return False
        return True

    def _end(self, record: Record) -> None:
        self.close()
        self.search = None
        if self.best is not None and self.method.starts:
            record.take(self.best)


def _turn(members: list[Member], record: Record, fair: int, busy: Collection[Member] = ()) -> list[Member]:
    """The members whose turn it is: a request delays the next one by its length divided by the member's share."""
    able = [m for m in members if m not in busy and m.ready(record)]
    if not able:
        return []
    early = sum(m.used for m in members) < fair * len(members)
    parts = [1.0 if early else m.weight(record) for m in able]
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
    whole_budget=True,
    parallel="every member on its own",
    suits="a criterion about which nothing is known",
    look=MethodLook(colour="#1b2733", dark="#f2f5f8", marker="asterisk"),
)
