"""Findings: all distinct worst cases, from the local minima of every method and the low end of all evaluations.

Gathers candidates stage by stage, descends from them, merges what ends in one basin, polishes, evaluates neighbours
(the objective is not smooth), slices and the boundary. Any evaluation below the worst case becomes a candidate itself,
until the run has no lower stored evaluation. `worker.engine.search.parts.basins` tests which minima are distinct.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np

from campaigns.asked.allowance import USUAL, evidence, validation
from campaigns.claims.stages import ends
from campaigns.limits import ROUNDING, SAME_COST
from campaigns.results.base import EXCLUDED, OK
from campaigns.results.finding import Neighbours
from worker.engine.search.base import Batch, Search
from worker.engine.search.parts.basin import ROUGH, Basin, Rules, close, lower
from worker.engine.search.parts.basins import added, distinct
from worker.engine.search.parts.lowest import Lowest
from worker.engine.search.parts.polish import Polish, crossed, explored, sharpened
from worker.engine.stages.parts import between, modes, seeds
from worker.engine.stages.parts.base import stream
from worker.engine.stages.parts.boundary import Around, after
from worker.engine.stages.parts.candidates import Candidate, gather, promising_rows, walked
from worker.engine.stages.parts.context import Context
from worker.engine.stages.parts.falls import Falls, begun, fall
from worker.engine.stages.parts.left import Left
from worker.engine.stages.parts.noise import noisy
from worker.engine.stages.parts.rays import Evaluated, stored
from worker.engine.stages.parts.scales import rounding, scale, spanned
from worker.engine.systems.base import Floats

FINDINGS_STREAM = 2**20
"""Spawn key of this stage's random numbers; searches are numbered from 0."""
ROUNDS = 20
"""The largest number of rounds in which lower evaluations become candidates."""

T = TypeVar("T")

Part = Generator[Floats, Batch, None]
"""A part of the search."""


@dataclass
class Evidence:
    """What was evaluated around one worst case: its neighbours, slices through it, the boundary of a violation."""

    neighbours: Neighbours | None = None
    after: Around | None = None


@dataclass
class Found:
    """The state of the search: candidates, basins, the evidence of each basin, the lowest of all evaluations."""

    candidates: list[Candidate] = field(default_factory=list)
    basins: list[Basin] = field(default_factory=list)
    besides: list[Basin] = field(default_factory=list)
    """Basins of followed candidates that are not listed."""
    left_out: int = 0
    """Minima no worse than the nominal case."""
    unconfirmed: int = 0
    skipped: int = 0
    """Points that the allowance was too small to descend from."""
    rounds: int = 0
    descended: bool = False
    """Whether the descents from the cases of the baseline have ended."""
    seen: Lowest = field(default_factory=Lowest)
    falls: Falls = field(default_factory=Falls)
    lines: modes.Lines = field(default_factory=dict)
    """From the modes of an estimate to the worst cases."""
    since: between.Lines = field(default_factory=dict)
    """From the violations of the baseline to the worst cases."""
    evidence: dict[bytes, Evidence] = field(default_factory=dict)
    evaluated: list[Evaluated] = field(default_factory=list)

    def of(self, basin: Basin) -> Evidence:
        """The evidence of one worst case; empty until it is gathered."""
        return self.evidence.setdefault(basin.point.tobytes(), Evidence())

    def basin_of(self, position: int, cost: float, point: Floats | None) -> int | None:
        """The basin of a stage's best point, identified by its cost; None if it is in no listed basin.

        Where points of this cost are in several basins, that of the one nearest to the point, if that is known.
        """
        mine = {i: c.point for i, c in enumerate(self.candidates) if c.position == position and c.cost == cost}
        listed = [(m, i) for i, basin in enumerate(self.basins) for m in basin.members if m in mine]
        if not listed:
            return None
        away = {m: 0.0 if point is None else float(np.abs(mine[m] - point).max()) for m, _ in listed}
        return min(listed, key=lambda member: away[member[0]])[1]

    def basin_at(self, point: Floats) -> int | None:
        """The basin in which a candidate at this point ended, by index, that of `besides` after the listed ones; None
        if there is none."""
        wanted = {i for i, c in enumerate(self.candidates) if np.array_equal(c.point, point)}
        known = [*self.basins, *self.besides]
        return next((i for i, basin in enumerate(known) if wanted & set(basin.members)), None)

    def see(self, points: Floats, batch: Batch, context: Context) -> None:
        """Remember the evaluations, the lowest of them, and the violations."""
        ranked = batch.ranked()
        self.seen.see(points, ranked)
        self.evaluated.append(Evaluated.of(points.copy(), batch))
        self.falls.see(points, ranked, context.problem.threshold)

    def keep(self, listed: Sequence[Basin], dropped: Sequence[Basin]) -> None:
        """List these basins; of those dropped, the ones of followed candidates are remembered."""
        self.basins[:] = listed
        self.besides += [b for b in dropped if any(self.candidates[m].followed for m in b.members)]

    def minima_of(self, position: int) -> dict[int, int]:
        """The basin of each of a stage's own minima that is in a listed basin, by the index of the minimum."""
        mine = {i: c.minimum for i, c in enumerate(self.candidates) if c.position == position and c.minimum is not None}
        return {mine[m]: i for i, basin in enumerate(self.basins) for m in basin.members if m in mine}


def search(context: Context, position: int, found: Found) -> Search:
    """Request the evaluations that distinguish the worst cases; `found` is always up to date.

    A quarter of the allowance is reserved for the cases of the baseline that violate no more.
    """
    found.falls.cases = begun(context)
    waits = bool(found.falls.cases)

    def reserved() -> Part:
        nonlocal waits
        if waits and found.seen.evaluations > 0.75 * validation(context.campaign, noisy(context)).stored:
            waits = False
            yield from _recorded(context, found, _fall(context, position, found))

    return (yield from _recorded(context, found, _search(context, position, found), reserved))


def _recorded(
    context: Context, found: Found, part: Generator[Floats, Batch, T], after: Callable[[], Part] | None = None
) -> Generator[Floats, Batch, T]:
    """A part whose evaluations are recorded in `found`, with another one after every batch."""
    try:
        points = next(part)
        while True:
            batch = yield points
            found.see(points, batch, context)
            if after is not None:
                yield from after()
            points = part.send(batch)
    except StopIteration as end:
        result: T = end.value
        return result
    finally:
        part.close()


def settle(context: Context, position: int, found: Found, left: Left) -> bool:
    """Make the lowest stored evaluation the worst case if the budget ended too early; returns whether the worst cases
    are not all there.

    Of the basins not yet distinguished, the lowest are stored, as many as the campaign retains and can confirm.
    """
    lower = _lower(context, position, found, settled=True)
    if lower is not None:
        found.candidates.append(lower)
        found.basins.insert(0, Basin(lower.point, lower.cost, [len(found.candidates) - 1]))
    kept = min(context.campaign.stages.findings.at_most, len(found.basins))
    confirmed = left.findings(kept)
    found.keep(found.basins[:confirmed], found.basins[confirmed:])
    found.unconfirmed = kept - confirmed
    return lower is not None or confirmed < kept


def _search(context: Context, position: int, found: Found) -> Search:
    found.candidates, found.skipped = gather(context, position)
    yield from _drawn(context, position, found)
    if not found.candidates:
        return ends.NOTHING
    random = stream(context.campaign.seed, FINDINGS_STREAM)
    starts = [Basin(c.point, c.cost, [i]) for i, c in enumerate(found.candidates)]
    alone = walked(context, position, found.candidates, starts)
    yield from _followed(context, found, starts)
    yield from _distinguished(context, found, starts, random, alone, lambda of: _spare(context, found, of) // 2)
    yield from _sharpened(context, found, random)
    yield from _further(context, position, found, random)
    yield from _joined(context, found)
    yield from _evidence(context, position, found, random)
    compared = True
    while compared:
        yield from _polished(context, position, found, random)
        compared = yield from _joined(context, found)
        compared |= yield from _fall(context, position, found)
        compared |= yield from modes.joined(context, found.basins, found.lines, _room(context, found))
    return ends.FINDINGS


def _joined(context: Context, found: Found) -> Generator[Floats, Batch, bool]:
    return between.joined(context, found.basins, found.basin_at, found.since, _room(context, found))


def _room(context: Context, found: Found) -> int:
    return validation(context.campaign, noisy(context)).stored - found.seen.evaluations


def _followed(context: Context, found: Found, starts: Sequence[Basin]) -> Part:
    """Descend from the cases of the baseline that violate no more first, if that takes half of the allowance at most;
    `starts` move to where the descents end."""
    cases = {case.point.tobytes() for case in found.falls.cases.values()}
    own = [b for b in starts if b.point.tobytes() in cases]
    room = validation(context.campaign, noisy(context)).stored // 2
    if own and len(own) * ROUGH.iterations * (context.problem.dimension + 2) <= room:
        yield from lower(own, ROUGH)
        found.descended = True


def _fall(context: Context, position: int, found: Found) -> Generator[Floats, Batch, bool]:
    """Compare the cases of the baseline with stored violations, as far as the allowance goes."""
    measured = context.results[0].repeatability
    spread = 0.0 if measured is None or measured.spread is None else measured.spread
    worst = min([c.cost for c in found.candidates] + [b.cost for b in found.basins])
    # By nominal minus worst, whatever the nominal case is: with a lower barrier more would count as fixed.
    barrier = max(context.campaign.stages.findings.barrier, ROUNDING) * scale(context, worst)
    barrier = max(barrier, spread)
    return (yield from fall(context, position, found.falls, _room(context, found), barrier))


def _polished(context: Context, position: int, found: Found, random: np.random.Generator) -> Part:
    """Until the run has no evaluation below its worst case, the lowest one becomes a candidate itself."""
    while found.rounds < ROUNDS and (lower := _lower(context, position, found)) is not None:
        if _same(context, found, lower):
            continue
        found.rounds += 1
        found.candidates.append(lower)
        fresh = Basin(lower.point, lower.cost, [len(found.candidates) - 1])
        yield from _distinguished(context, found, [*found.basins, fresh], random)
        yield from _evidence(context, position, found, random)


def _drawn(context: Context, position: int, found: Found) -> Part:
    """Points that drew their own noise, evaluated again under the campaign's realisations, as candidates."""
    for at, columns, _ in seeds.drawn(context, range(position)):
        known = context.results[at].followed
        points = columns.points[promising_rows(context, columns)]
        ranked = (yield points).ranked() if len(points) else np.empty(0)
        found.candidates += [
            Candidate(p.copy(), float(c), position, followed=known)
            for p, c in zip(points, ranked, strict=True)
            if np.isfinite(c)
        ]
    found.candidates.sort(key=lambda c: c.cost)


def _distinguished(
    context: Context,
    found: Found,
    starts: list[Basin],
    random: np.random.Generator,
    alone: frozenset[int] = frozenset(),
    room: Callable[[Sequence[Basin]], int] = lambda basins: 0,
) -> Part:
    """Descend from these starts and merge; the end of a descent takes over what its start represented."""
    points, costs = np.array([b.point for b in starts]), np.array([b.cost for b in starts])
    basins: list[Basin] = []
    rules = replace(_rules(context, float(costs.min())), alone=alone)
    followed = (i for i, b in enumerate(starts) if any(found.candidates[m].followed for m in b.members))
    distinguished = False
    try:
        polish = Polish(lambda: room(basins), random)
        yield from distinct(points, costs, replace(rules, followed=frozenset(followed)), basins, polish)
        found.descended = distinguished = True
    finally:  # when the budget ends, none is lost
        apart = basins if distinguished else close(basins, rules.distance)
        known = [Basin(b.point, b.cost, [m for i in b.members for m in starts[i].members]) for b in apart]
        listed = rules.at_most if distinguished else len(known)
        found.keep(known[:listed], known[listed:])
        _keep_the_worst(context, found)


def _further(context: Context, position: int, found: Found, random: np.random.Generator) -> Part:
    """Look for further worst cases where coordinates of known ones meet, and from random points, with what the evidence
    of the known ones leaves, until a round finds none."""
    most, ends = context.campaign.stages.findings.at_most, list[Basin]()
    if most <= USUAL or found.falls.cases:
        return
    while True:
        worst, limit, known = found.basins[0].cost, _limit(context), [*found.basins, *ends]
        rules = _rules(context, worst)
        same = worst + rules.same
        room = _room(context, found)
        few = min(room // 10, _spare(context, found, found.basins) or room)  # without spare, evidence is short already
        fresh = yield from crossed(known, same, rules, few, random)
        if not fresh and len(found.basins) < most:
            fresh = yield from explored(known, limit, rules, _spare(context, found, found.basins) // 2, random)
        ends += fresh
        affordable = _spare(context, found, found.basins) // (2 * sum(evidence(context.campaign)))
        worse = [b for i, b in enumerate(sorted(fresh, key=lambda b: b.cost)) if i < affordable or b.cost <= same]
        if not worse:
            return
        first = len(found.candidates)
        found.candidates += [Candidate(b.point.copy(), b.cost, position) for b in worse]
        starts = [Basin(b.point, b.cost, [first + i]) for i, b in enumerate(worse)]
        yield from added(found.basins, starts, rules)
        del found.basins[most:]


def _sharpened(context: Context, found: Found, random: np.random.Generator) -> Part:
    """Lower the worst cases that are nearly as low as the lowest with what their evidence leaves."""
    room = _spare(context, found, found.basins) // 2
    if room > 0:
        rules = _rules(context, found.basins[0].cost)
        yield from sharpened(found.basins, rules.same, rules, room, random)


def _spare(context: Context, found: Found, basins: Sequence[Basin]) -> int:
    """What the evidence of these worst cases leaves, where more are listed than usual; cases of a baseline need it."""
    if context.campaign.stages.findings.at_most <= USUAL or found.falls.cases:
        return 0
    each = evidence(context.campaign)
    violating = sum(b.cost <= context.problem.threshold for b in basins)
    return max(0, _room(context, found) - each.around * len(basins) - each.boundary * violating)


def _evidence(context: Context, position: int, found: Found, random: np.random.Generator) -> Part:
    """The neighbours of every worst case that has none yet, then slices and the boundary."""
    for basin in found.basins:
        if found.of(basin).neighbours is None:
            yield from _neighbours(context, found, basin, random)
    unseen = any(b.cost <= context.problem.threshold and found.of(b).after is None for b in found.basins)
    earlier = stored(context, range(position)) if unseen else []
    for basin in found.basins:
        if found.of(basin).after is None:
            every = [*earlier, *found.evaluated]
            found.of(basin).after = yield from after(context.problem, basin.point, basin.cost, every)


def _same(context: Context, found: Found, lower: Candidate) -> bool:
    """Replace the worst case by a nearby point that is lower only by rounding; it is not a new candidate."""
    worst = found.basins[0]
    near = np.abs(worst.point - lower.point).max() <= context.campaign.stages.validate_.reach
    if not near or worst.cost - lower.cost > rounding(context, worst.cost):
        return False
    found.evidence[lower.point.tobytes()] = found.of(worst)
    worst.point, worst.cost = lower.point, lower.cost
    return True


def _lower(context: Context, position: int, found: Found, settled: bool = False) -> Candidate | None:
    """The lowest evaluation of the run if it is lower than the worst case; settled: this stage has ended."""
    known, seen = found.basins[0].cost if found.basins else np.inf, found.seen
    candidates = [] if seen.point is None else [Candidate(seen.point, seen.cost, position)]
    for at, columns in seeds.stated(context, range(position + settled)):
        row = int(np.argmin(columns.ranked()))
        candidates.append(Candidate(columns.points[row].copy(), float(columns.ranked()[row]), at))
    low = min(candidates, key=lambda c: c.cost, default=None)
    return low if low is not None and low.cost < known else None


def _rules(context: Context, worst: float) -> Rules:
    request = context.campaign.stages.findings
    fall = spanned(context, worst)
    limits = between.distance(context), request.barrier * fall, request.at_most
    return Rules(*limits, rugged=ROUNDING * fall, same=SAME_COST * fall, ceiling=between.ceiling(context))


def _keep_the_worst(context: Context, found: Found) -> None:
    """Keep the minima that are worst cases: worse than the nominal case, violating, or the lowest."""
    limit = _limit(context)
    kept = [b for i, b in enumerate(found.basins) if i == 0 or b.cost < limit]
    dropped = [b for b in found.basins if not any(b is k for k in kept)]
    found.left_out += len(dropped)
    found.keep(kept, dropped)


def _limit(context: Context) -> float:
    """What a worst case is below: the nominal case, or the threshold if that is higher."""
    nominal = context.nominal_cost
    return max(np.inf if nominal is None else nominal, context.problem.threshold)


def _neighbours(context: Context, found: Found, basin: Basin, random: np.random.Generator) -> Part:
    """Evaluate a few hundred neighbours of a worst case, which moves to the lowest of them."""
    request = context.campaign.stages.validate_
    if request.neighbours == 0:
        return
    offsets = random.uniform(-request.reach, request.reach, (request.neighbours, len(basin.point)))
    points = np.clip(basin.point + offsets, 0.0, 1.0)
    batch: Batch = yield points
    ranked = batch.ranked()
    low = int(np.argmin(ranked))
    neighbours = Neighbours(
        flown=len(points),
        failed=int(np.count_nonzero((batch.status != OK) & (batch.status != EXCLUDED))),
        lowest=float(ranked[low]) if np.isfinite(ranked[low]) else None,
        lower_by=max(0.0, basin.cost - float(ranked[low])),
    )
    if ranked[low] < basin.cost:
        basin.point, basin.cost = points[low].copy(), float(ranked[low])
    found.of(basin).neighbours = neighbours
