"""Auto: what searches where no method was chosen. Several methods share one budget by rules; one of them stays apart.

Several members lead together, and each learns from what the others evaluated: descents along gradients (Kraft 1988), a
CMA-ES whose quadratic model replaces most evaluations (lq-CMA-ES, Hansen 2019), an evolution strategy with restarts (of
few parameters differential evolution, SHADE, else CMA-ES, BIPOP), DIRECT for what none of them covers. The order is
that of what each needs: a first descent takes tens of evaluations per parameter and solves what is smooth; the model
goes on from there while it improves and evaluations are few; later, the evolution strategy (CMA-ES from where the model
has come, if that still improves) and descents from the lowest unexplored points take turns; from then on every other
one begins, of few parameters, where the cost is below its trend over the box, else anywhere. Once the evolution
strategy of few parameters has converged, most of its share goes to MLSL, which begins all over the box; of more
parameters, some goes to the descents. Up to three parameters MLSL comes first, alone:
with so few evaluations nothing can be cleared anyway. Later, where the lowest point has moved, each parameter takes
values of its whole range with the others as they are there, a star as lq-CMA-ES begins with: the opposite end of one
parameter can be far worse than where every member has come. Nothing is evaluated twice.

The witness is a search of another family that does not use the others' points: TuRBO where evaluations are few
and costly, else contrast racing. What both sides reached was found twice. Its share of the budget is a fifth while the
others are lower and improve, two fifths while both are equally low or the others are stuck, three fifths while it is
lower: separated and jumping valleys are its own (algorithm portfolios: Baudis and Posik, PPSN 2014). The record states
who requested what. No guarantee of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from pydantic import Field

from worker.engine.search.base import (
    Batch,
    Floats,
    Method,
    MethodLook,
    Minimum,
    Parallel,
    Search,
    Space,
)
from worker.engine.search.methods import (
    cma_es,
    contrast_racing,
    differential_evolution,
    direct,
    lq_cma_es,
    mlsl,
    sqp,
    turbo,
)
from worker.engine.search.parts.descent import Settings, descend
from worker.engine.search.parts.explored import Explored
from worker.engine.search.parts.portfolio_record import Record
from worker.engine.search.parts.running import Running
from worker.engine.search.parts.shared import Shared
from worker.engine.search.parts.trend import Trend
from worker.engine.search.parts.turns import taking_turns

OPENING, AMID_FAILURES = 150, 60
"""Evaluations per parameter at most until the first descent has ended and the other members begin: a curved valley of
20 parameters takes more than 100. The second is for where evaluations fail, since differences tell little there."""
MODELLED, AT_MOST = 250, 3000
"""Evaluations per parameter, and in all, up to which the model may lead where evaluations are cheap: its milliseconds
are then the time of the search."""
STALE = 30
"""Evaluations per parameter without a lower cost after which the model makes way for CMA-ES."""
COSTLY = 0.02
"""Time of an evaluation [s] from which the milliseconds of models do not count."""
STUCK = 100
"""Evaluations per parameter without a lower cost, of all and, until it has converged, of the evolution strategy by
itself, after which the others get no more than if the witness were equal."""
FEW = 60
"""Evaluations per parameter up to which TuRBO is the witness."""
WITNESS = {"above": 0.2, "equal": 0.4, "below": 0.6}
"""The witness's share of the evaluations while its lowest cost is above, equal to, or below that of the others."""
EQUAL = 1e-3
"""Two costs are equal if they differ by less than this fraction of the spread of the costs."""
DESCENTS, COVER = 0.08, 0.02
"""Shares of the leading members' evaluations that descents and DIRECT get beside an evolution strategy."""
SEVERAL, WIDE_COVER, BELOW = 0.7, 0.1, 0.1
"""Those that MLSL, DIRECT and descents get once the evolution strategy has converged; up to `SMALL` parameters."""
RESTARTS = 0.15
"""That of descents once the evolution strategy has converged, where MLSL takes no part."""
ACROSS, EVERY, MOVED = 4, 50, 0.05
"""Values of each parameter with the others as in the lowest point, from `MODELLED` on; evaluations per parameter after
which the next ones come, if some parameter of that point has moved by so much of its range since."""
LOW, EARLY = 3, 95
"""Parameters up to which MLSL leads first, and alone; evaluations per parameter until which it does."""
COUNTED = 25
"""Evaluations per parameter that count as a search, which the witness makes next there."""
SMALL = 6
"""Parameters up to which that is differential evolution; beyond, CMA-ES needs fewer evaluations."""
HANDED = 5
"""Points of its first population that others evaluated, up to `LOW` parameters: half of the population."""
FIRST = Settings("scipy", "forward", 1.5e-9, cost_tolerance=1e-13, iterations=1000, apart=True)
"""Differences near the square root of the rounding errors of a smooth cost."""
COARSE = replace(FIRST, difference=1e-5)
"""Differences for costs with larger errors, from the first descent on that moved nowhere."""
EPOCH = 150
"""Evaluations per parameter of the first budget of contrast racing, which doubles it when it is used up."""
PENDING = 16
"""Requested points below which a further member gets its turn in slots, whose number may change on a resume."""


@dataclass(frozen=True)
class Options:
    """What is known of an evaluation beforehand."""

    seconds: Annotated[
        float,
        Field(ge=0, le=1e6, description="Time of an evaluation [s], if known; from 0.02 on, models take part longer"),
    ] = 0.0
    at_once: Annotated[int, Field(ge=1, le=100, description="Evaluations that run side by side")] = 1


def search(space: Space, options: Options) -> Parallel:
    """Give the members their turns until the budget ends."""
    team = Team(space, options)
    return (yield from taking_turns(space, team.members, team.turn, team.tell, PENDING))


class Team:
    """All members, and the rules by which they take turns."""

    def __init__(self, space: Space, options: Options) -> None:
        n = space.dimension
        self.space, self.costly = space, options.seconds >= COSTLY
        trend = Trend(n) if n <= SMALL else None
        self.shared = Shared(space, Explored(space, options.at_once), Record(n), MODELLED * n, trend=trend)
        self.descents = self._member(sqp.method, descents(self.shared, self._own(), self._broad))
        descent = lq_cma_es.Descent()
        self.model = self._member(lq_cma_es.method, modelled(self.shared, self._own(), options.at_once, descent))
        self.converged = False
        """Whether the evolution strategy has converged once."""
        if n <= SMALL:
            own = replace(self._own(), report=self._converge)
            self.evolving = self._member(differential_evolution.method, evolved(self.shared, own))
        else:
            own = replace(self._own(), report=self._converge)
            self.evolving = self._member(cma_es.method, adapted(own, descent, self._improves))
        self.cover = self._member(direct.method, direct.search(self._own(), direct.Options()))
        few = turbo.search(self._own(), turbo.Options(batch=max(options.at_once, 4)))
        self.few = self._member(turbo.method, few, apart=True)
        many = contrast_racing.search(self._own(), contrast_racing.Options())
        self.many = self._member(contrast_racing.method, many, apart=True)
        self.axes = Running(lq_cma_es.method.name, None, space)
        """Stars through the lowest point."""
        self.centre, self.due = np.full(n, np.inf), 0
        self.members = [self.descents, self.model, self.evolving, self.cover, self.few, self.many, self.axes]
        self.low = n <= LOW and not self.costly
        """Whether MLSL comes first."""
        self.several = self._several() if self.low else None

    def _member(self, of: Method, search: Parallel, apart: bool = False) -> Running:
        return Running(of.name, search, self.space, apart)

    def _several(self) -> Running:
        """MLSL; a further member."""
        own = replace(self._own(), report=self.shared.report)
        several = self._member(mlsl.method, mlsl.search(own, mlsl.Options()))
        self.members.append(several)
        return several

    def _own(self) -> Space:
        """The space of a member: with random numbers of its own."""
        n = self.space.dimension
        return self.space.of_member(EPOCH * n, np.empty((0, n)))

    def tell(self, member: Running, batch: Batch) -> None:
        """Pass a member its values, which all leading members learn from."""
        values = batch.ranked()
        if not member.apart:
            self.shared.see(member.requested, values)
        member.tell(batch, values)

    @property
    def used(self) -> int:
        """The evaluations of all members."""
        return sum(member.used for member in self.members)

    def turn(self, busy: Collection[Running]) -> list[Running]:
        """The member whose turn it is: every request of a member costs it credit, which all get by their shares."""
        star = self.axes not in busy and self._looks_across()
        able = [(m, w) for m, w in self._weights(star) if w > 0.0 and m not in busy and m.ready()]
        if not able:
            return []
        total = sum(w for _, w in able)
        needs = [(len(member.requested) - member.credit) * total / weight for member, weight in able]
        need = min(needs)
        chosen = able[needs.index(need)][0]
        for member, weight in able:
            member.credit += max(need, 0.0) * weight / total
        chosen.credit -= len(chosen.requested)
        return [chosen]

    def _weights(self, star: bool) -> list[tuple[Running, float]]:
        """The shares of the coming evaluations; star: whether one through the lowest point comes next."""
        n = self.space.dimension
        witness = self.few if self.costly and self.used < FEW * n else self.many
        share, several = self._share(), self.several
        if self.low and several and several.search and self.used < EARLY * n and not several.failing:
            return [(several, 1.0)]
        if star:
            return [(self.axes, 1.0 - share), (witness, share)]
        opening = AMID_FAILURES if self.descents.failing else OPENING
        if not (self.shared.opened or self.descents.search is None or self.descents.used >= opening * n):
            return [(self.descents, 1.0 - share), (witness, share)]
        if self.used < MODELLED * n and (self.costly or self.used < AT_MOST) and self._improves():
            return [(self.model, 1.0 - share), (witness, share)]
        lead = 1.0 - share
        others = [(self.descents, RESTARTS if self.converged else DESCENTS), (self.cover, COVER)]
        if self.converged and several and several.search:
            others = [(several, SEVERAL), (self.cover, WIDE_COVER), (self.descents, BELOW)]
        evolving = 1.0
        for _, part in others:
            evolving -= part
        others.insert(1, (self.evolving, evolving))
        return [*((member, part * lead) for member, part in others), (witness, share)]

    def _looks_across(self) -> bool:
        """Whether a star through the lowest point comes next; it begins where that has moved."""
        best = self.shared.best
        if self.axes.search is not None:
            return True
        if best is None or not self._broad() or self.used < self.due:
            return False
        if np.abs(best - self.centre).max() < MOVED:
            return False
        self.centre, self.due = best, self.used + EVERY * len(best)
        self.axes.begin(across(best, self._own().random))
        return True

    def _broad(self) -> bool:
        """Whether so much is evaluated that looking elsewhere is worth more than the lowest points."""
        return self.used >= MODELLED * self.space.dimension

    def _converge(self, minimum: Minimum) -> None:
        """A run of the evolution strategy has ended."""
        self.space.report(minimum)
        self.converged = True
        if self.space.dimension <= SMALL:
            self.several = self.several or self._several()

    def _improves(self) -> bool:
        """Whether the model improves."""
        return self.model.stale < STALE * self.space.dimension

    def _share(self) -> float:
        """The witness's share of the coming evaluations."""
        if self.low and self.many.used < COUNTED * self.space.dimension:
            return 1.0
        ours, its = self.shared.lowest, min(self.few.lowest, self.many.lowest)
        tie = EQUAL * self.shared.record.spread()
        if not np.isfinite(its) or its > ours + tie:
            alone = self.shared.stale if self.converged else min(self.shared.stale, self.evolving.stale)
            stuck = alone >= STUCK * self.space.dimension
            return WITNESS["equal" if stuck else "above"]
        return WITNESS["equal"] if its >= ours - tie else WITNESS["below"]


def descents(shared: Shared, space: Space, broad: Callable[[], bool]) -> Search:
    """A first descent from the centre, then from the lowest points away from all earlier starts; later, every other one
    from where the cost is below its trend, or from anywhere."""
    n, elsewhere = space.dimension, False
    start = None if shared.stale or shared.best is not None else np.full(n, 0.5)
    settings, coarse = (replace(each, most=OPENING * n) for each in (FIRST, COARSE))
    while True:
        while start is None:
            elsewhere = broad() and not elsewhere
            if elsewhere:
                below = (yield from shared.trend.closer(space.random)) if shared.trend else None
                start = space.random.random(n) if below is None else below
                continue
            yield from shared.explored.grow(2 * n)
            start = shared.record.start()
        end = yield from shared.archived(descend(start, settings))
        if settings is not coarse and end.cost < np.inf and np.abs(end.point - start).max() <= settings.difference:
            settings = coarse
            continue
        if not shared.opened and not end.cost < np.inf:
            start = None
            continue
        if end.cost < np.inf:
            space.report(Minimum(end.point, end.cost, start, end.evaluations, end.text))
        shared.left(start, end.point)
        start = None


def across(centre: Floats, random: np.random.Generator) -> Search:
    """One request: each parameter at values all over its range, with the others as in a point (n,)."""
    n = len(centre)
    points = np.repeat(centre[None], n * ACROSS, axis=0)
    drawn = (np.arange(ACROSS) + random.random((n, ACROSS))) / ACROSS
    points[np.arange(n * ACROSS), np.repeat(np.arange(n), ACROSS)] = drawn.ravel()
    yield points
    return "evaluated every value"


def evolved(shared: Shared, space: Space) -> Parallel:
    """Differential evolution; of few parameters it begins with the lowest points, away from where descents were."""
    few = space.dimension <= LOW and shared.best is not None
    points = [shared.best, *shared.record.points[: HANDED - 1]] if few else []
    starts = np.array(points).reshape(-1, space.dimension)
    options = differential_evolution.Options()
    return (yield from differential_evolution.search(replace(space, starts=starts), options))


def adapted(space: Space, descent: lq_cma_es.Descent, improves: Callable[[], bool]) -> Search:
    """CMA-ES; it goes on from the distribution of the model's descent if that improves to the end of its share."""
    return (yield from cma_es.continued(space, cma_es.Options(), descent.distribution() if improves() else None))


def modelled(shared: Shared, space: Space, at_once: int, descent: lq_cma_es.Descent) -> Search:
    """lq-CMA-ES from the lowest point of all, with what the other leading members evaluated."""
    options = lq_cma_es.Options(at_once=at_once)
    return (yield from lq_cma_es.continued(space, options, shared.explored, shared.best, descent))


TOGETHER = [of.method for of in (sqp, lq_cma_es, differential_evolution, cma_es, direct, mlsl)]

method = Method(
    name="auto",
    title="Auto",
    kind="global",
    how="Global. Methods take turns by rules, one of them apart",
    source="Clearance 2026",
    evaluations=5000,
    options=Options,
    search=search,
    compiles=True,
    repeats=True,
    costly=True,
    extend=lambda options, more: options,
    family="auto",
    apart={m.name: m.family for m in (turbo.method, contrast_racing.method)},
    together={m.name: m.family for m in TOGETHER},
    whole_budget=True,
    parallel="every member on its own",
    at_once="at_once",
    takes="seconds",
    suits="everything, where nothing is known",
    proposed=1,
    confirms=125,  # a fifth of it is 25, which a global search must have
    look=MethodLook(colour="#3d4f60", dark="#dbe4ec", marker="shield"),
)
