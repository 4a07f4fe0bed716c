"""Certify: an independent sample from the campaign's distributions, declared before the run, and what follows from it.

Its random stream follows from a seed drawn at launch (`campaigns.sample_seed`); no point comes from an optimiser.
Excluded draws are counted and drawn again. If the scenario has noise, every draw simulates its own realisation
(`campaigns.results.draws`), so that the probability is that of the noisy system; of a simulator that does not repeat,
every draw is one call. A full grid, if requested, supports no claim beyond its own points.
"""

from __future__ import annotations

import numpy as np

from campaigns.asked.problem import Problem as Wrong
from campaigns.asked.spec import Campaign
from campaigns.asked.stages import Certify
from campaigns.checked import best_bound
from campaigns.claims.spans import Spans
from campaigns.claims.stages import ends
from campaigns.claims.stages import sample as sentences
from campaigns.limits import DRAWS
from campaigns.results.base import EXCLUDED, OK
from campaigns.results.draws import of_draws, of_indices
from campaigns.results.sample import Blocks, GridPoint, GridResult
from campaigns.results.sample import Sample as Statement
from campaigns.stages.certify import CertifyResult
from campaigns.stored.blocks import Counted, Scale
from campaigns.stored.records import Columns
from worker.engine.problem.problem import Problem
from worker.engine.search.base import Batch, Ended
from worker.engine.stages.parts import claims, noise
from worker.engine.stages.parts.base import all_columns, drive, stream
from worker.engine.stages.parts.context import Asking, Context, Seeded, Through
from worker.engine.stages.parts.counting import Counting, Drawing, kept
from worker.engine.stages.parts.ended import stop
from worker.engine.stages.parts.outcome import Outcome, Stage
from worker.engine.stages.parts.sample import DRAWN, Noise, Sample, certifying
from worker.engine.stages.parts.seeds import some
from worker.engine.systems.base import System, slotted

STREAM = 2**21
"""Index of the random stream; searches use those from 0 on."""

BLOCK = 4096


def run(context: Context, position: int) -> Outcome[CertifyResult]:
    """Draw and simulate the sample, then the grid."""
    problem, request = context.problem, context.campaign.stages.certify
    assert request is not None
    if request.keep == "lowest":
        return _counted(context, position, request)
    grid = 0 if request.grid is None else request.grid.points**problem.dimension
    seed = context.sample_seed
    single = slotted(problem.system).single() if noise.noisy(context) else None
    searching = _search(problem, request, seed.value, single)
    driven = drive(context, position, searching, DRAWS * request.samples + grid + 1)
    assert driven.columns is not None
    own = problem.realisations.random
    kind = DRAWN if own else Noise.of_calls(context, single=True)
    tally = driven.tally
    draws = tally.evaluations - grid
    rows = some(driven.columns, 0, draws)
    sample = Sample.of(rows, problem, context.campaign.confidence, kind, certifying(seed))
    stated, statement = _whole(sample, context, request)
    result = CertifyResult(
        sample=stated,
        grid=_grid(context, request.grid.points, driven.columns, draws) if request.grid is not None else None,
        seed=seed.value,
        drawn_at_launch=not seed.stated,
        drawn_realisations=draws if own else 0,
        evaluations=tally.evaluations,
        failed=tally.failed,
        excluded=tally.excluded,
        seconds=tally.seconds,
        stop=driven.how,
        statement=statement,
    )
    return Outcome(result)


def _counted(context: Context, position: int, request: Certify) -> Outcome[CertifyResult]:
    """Draw and simulate a sample of which a part is stored, and the counts of all."""
    problem, seed, allowed = context.problem, context.sample_seed, _allowed(context.campaign, context.problem)
    counting = _counting(context, position, request)
    found = counting.fly()
    kind = DRAWN if problem.realisations.random else Noise.of_calls(context, single=True)
    sample = Sample.of_counted(found, problem, context.campaign.confidence, kind, certifying(seed))
    columns, flights = kept(found), found.kept.indices
    context.store.keep(position, columns)
    context.columns[position] = columns
    own, more = problem.realisations.random, allowed is not None and found.violations > allowed
    # With its last block it is whole, whatever that has: its bound is that of a sample of this size.
    early = more and found.evaluated < request.samples and found.draws < DRAWS * request.samples
    stated, statement = _early(sample, found, context, request) if early else _whole(sample, context, request)
    result = CertifyResult(
        sample=stated,
        grid=None,
        seed=seed.value,
        drawn_at_launch=not seed.stated,
        drawn_realisations=len(flights) if own else 0,
        evaluations=found.draws,
        failed=found.failed,
        excluded=found.excluded,
        seconds=counting.tally.seconds,
        stop=stop("rule", Ended("drawn", ends.TARGET if early else ends.SAMPLE, flights=found.evaluated)),
        flights=flights.tolist(),
        realisations=of_indices(seed.value, flights).tolist() if own else None,
        blocks=_blocks(found, problem.threshold),
        statement=statement,
    )
    return Outcome(result)


def _counting(context: Context, position: int, request: Certify) -> Counting:
    problem = context.problem
    single = slotted(problem.system).single() if noise.noisy(context) else None
    before = [columns.costs[columns.status == OK, 0] for _, columns in all_columns(context, list(range(position)))]
    scale = Scale.over(np.concatenate([np.empty(0), *before]), problem.threshold)
    drawing = Drawing(problem, context.sample_seed.value)
    return Counting(
        context, position, request.samples, drawing, single, scale, _allowed(context.campaign, context.problem)
    )


def assist(context: Context, position: int) -> None:
    """Fly blocks of a sample that another worker draws, if it may be shared."""
    request = context.campaign.stages.certify
    assert request is not None
    if context.campaign.shared:
        _counting(context, position, request).assist()


def _allowed(campaign: Campaign, problem: Problem) -> int | None:
    """The violations that the target allows among all samples; None of a sample that does not end by it.

    A campaign whose target allows none, not even no violation, is refused before (`unattainable`).
    """
    request, target = campaign.stages.certify, campaign.target_probability
    if request is None or request.until == "samples" or target is None:
        return None
    return max(0, claims.allowed(request.samples, target - problem.distributions.outside, campaign.confidence))


def unattainable(problem: Problem) -> list[Wrong]:
    """The error if no sample of this size meets the target by which it ends, as the check of campaigns states it."""
    return best_bound.unattainable(problem.campaign, {r.path: (r.low, r.high) for r in problem.ranges})


def _whole(sample: Sample, context: Context, request: Certify) -> tuple[Statement, Spans]:
    """What a whole sample shows, and the sentence of its stage."""
    problem, drawing = context.problem, sample.statement()
    quantile = sample.quantile(request.quantile, problem.quantity, problem.unit)
    statement = sentences.certified(drawing.statement, quantile.statement, sample.size, request.samples)
    return drawing.model_copy(update={"quantile": quantile, "distribution": sample.distribution()}), statement


def _early(sample: Sample, found: Counted, context: Context, request: Certify) -> tuple[Statement, Spans]:
    """The statement of a sample that ended early: its size follows from its results, so it bounds P(violation) only."""
    counted, target = found.evaluated - found.blocks[-1].evaluated, context.campaign.target_probability
    drawing, allowed = sample.statement(counted=counted), _allowed(context.campaign, context.problem)
    assert allowed is not None
    assert target is not None
    statement = sentences.curtailed(drawing.statement, allowed, target, request.samples, counted)
    return drawing.model_copy(update={"statement": statement}), statement


def _blocks(found: Counted, threshold: float) -> Blocks:
    return Blocks(
        draws=[block.draws for block in found.blocks],
        violations=[block.violations for block in found.blocks],
        failed=[block.failed for block in found.blocks],
        excluded=[block.excluded for block in found.blocks],
        lowest=[block.lowest for block in found.blocks],
        digests=[block.digest for block in found.blocks],
        totals=[block.total for block in found.blocks],
        squares=[block.squares for block in found.blocks],
        low=found.scale.low,
        width=found.scale.width,
        places=np.flatnonzero(found.bins).tolist(),
        counts=found.bins[found.bins > 0].tolist(),
        highest=found.highest,
        beside=found.beside(threshold),
        statement=sentences.counted(found.draws, len(found.blocks), len(found.kept.indices)),
    )


def _search(problem: Problem, request: Certify, seed: int, single: System | None) -> Asking[str]:
    random, drawn, evaluated = stream(seed, STREAM), 0, 0
    most = DRAWS * request.samples
    while evaluated < request.samples and drawn < most:
        draws = min(BLOCK, request.samples - evaluated, most - drawn)
        drawn_points = problem.quantile(random.random((draws, problem.dimension)))
        own = of_draws(seed, drawn, draws) if problem.realisations.random else None
        if single is not None:
            batch: Batch = yield Through(drawn_points, single)
        else:
            batch = yield drawn_points if own is None else Seeded(drawn_points, own)
        drawn += draws
        evaluated += int(np.count_nonzero(batch.status != EXCLUDED))
    if request.grid is None:
        return Ended("drawn", ends.SAMPLE, flights=evaluated)
    points = request.grid.points
    total = points**problem.dimension
    for first in range(0, total, BLOCK):
        index = np.arange(first, min(first + BLOCK, total))
        yield np.stack(np.unravel_index(index, (points,) * problem.dimension), axis=1) / (points - 1)
    return Ended("drawn", ends.GRID, flights=evaluated, grid=total)


def _grid(context: Context, points: int, columns: Columns, first: int) -> GridResult:
    """The lowest point of the grid and its spacing; nothing is known between its points."""
    problem = context.problem
    rows = some(columns, first)
    sample = Sample.of(rows, problem, context.campaign.confidence)
    lowest = stated = None
    if sample.shape.known:
        row = int(np.nanargmin(rows.costs[:, 0]))
        cost = float(rows.costs[row, 0])
        lowest = GridPoint(cost=cost, margin=cost - problem.threshold, parameters=problem.named(rows.points[row]))
        stated = (problem.quantity, cost, problem.unit)
    return GridResult(
        points=points,
        total=len(rows.status),
        spacing={r.path: (r.high - r.low) / (points - 1) for r in problem.ranges},
        lowest=lowest,
        violations=sample.violations,
        failed=sample.failed,
        excluded=sample.excluded,
        statement=sentences.grid(points, len(rows.status), stated, sample.violations, sample.failed),
    )


stage = Stage("certify", run, assist, unattainable)
