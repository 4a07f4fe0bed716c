"""Re-weights the stored independent sample of a run to other distributions; nothing is evaluated or stored."""

from __future__ import annotations

from collections.abc import Mapping

import sqlalchemy as sa

from backend.db.rows import as_columns, chunks
from backend.db.tables import EvaluationChunk, Stage
from backend.http.errors import RefusedError
from backend.http.versions import readable
from backend.likelihood.schemas import ReweightRequest
from backend.results.likely import densities
from backend.runs.service import campaign
from campaigns import Campaign, Problem
from campaigns.asked.distributions import Uncertain
from campaigns.checked.uncertainty import distributed
from campaigns.claims import reweighted as claims
from campaigns.densities.joint import joined
from campaigns.densities.reweighting import Drawn, Terms, reweighted, without
from campaigns.results.reweighted import Reweighted
from campaigns.results.sample import Sample
from campaigns.runs import run_name
from campaigns.stages.found import stage_result
from campaigns.stored.records import join

MOST = 200_000
"""Draws that are re-weighted: half a second, however large a sample is."""
SHARES = (0.01, 0.05, 0.5)
"""The quantiles that are estimated, besides that of the campaign."""


def estimated(reader: sa.Connection, run_id: int, request: ReweightRequest) -> Reweighted:
    """The estimate under the moved distributions, or why there is none; `RefusedError` for what is no distribution."""
    run_campaign = campaign(reader, run_id)
    limits, stated = densities(reader, run_id, run_campaign)
    if stated is None:
        return without(claims.NO_BOUNDS, run_campaign.confidence)
    moved = _moved(run_campaign, limits, request.uncertain)
    found = _sample(reader, run_id)
    if found is None:
        return without(claims.NO_SAMPLE, run_campaign.confidence)
    position, sample = found
    if sample.bound_samples is not None:
        return without(claims.ENDED_EARLY, run_campaign.confidence)
    drawn = _drawn(reader, run_id, position, sample)
    if drawn is None:
        return without(claims.NOT_WHOLE, run_campaign.confidence)
    bounds = {path: one.interval(limits[path][0]) for path, one in moved.items()}
    over = joined({path: one.distribution for path, one in moved.items()}, run_campaign.correlations, bounds)
    own = [] if sample.quantile is None else [sample.quantile.share]
    terms = Terms(run_campaign.criterion.threshold, run_campaign.confidence, sorted({*SHARES, *own}))
    return reweighted(stated, over, drawn, terms)


def _moved(
    run_campaign: Campaign, limits: Mapping[str, tuple[float, float, float]], moved: Mapping[str, Uncertain]
) -> dict[str, Uncertain]:
    """The stated distributions with the moved ones in their place."""
    unknown = [
        Problem(f"uncertain.{path}", path, "not an uncertain parameter")
        for path in moved.keys() - run_campaign.uncertain
    ]
    if unknown:
        raise RefusedError("unknown-parameter", "the campaign has no such uncertain parameter", unknown)
    problems: list[Problem] = []
    for path, one in moved.items():
        low, high = one.interval(limits[path][0])
        if low < high:
            problems += distributed(f"uncertain.{path}", one, low, high)
        else:
            problems.append(Problem(f"uncertain.{path}", f"{low:g} to {high:g}", "low must be below high"))
    if problems:
        raise RefusedError("invalid-request", "a moved distribution does not fit its bounds", problems)
    return {**run_campaign.uncertain, **moved}


def _sample(reader: sa.Connection, run_id: int) -> tuple[int, Sample] | None:
    """The position of the stage that drew the independent sample of a run, and the sample; None without one."""
    of = sa.select(Stage.position, Stage.result).where(Stage.run_id == run_id).order_by(Stage.position)
    with readable(f"a stage of {run_name(run_id)}", reader, run_id):
        results = [(row.position, stage_result(row.result)) for row in reader.execute(of) if row.result is not None]
    certified = ((position, result.certificate) for position, result in results)
    return next(((position, one.sample) for position, one in certified if one is not None), None)


def _drawn(reader: sa.Connection, run_id: int, position: int, sample: Sample) -> Drawn | None:
    """The first draws, excluded ones included, without the grid that may follow; None if they are not stored whole.

    As many draws of an independent sample are one, too, if their number does not follow from what came out.
    """
    draws, of = sample.samples + sample.excluded, (Stage.run_id == run_id, Stage.position == position)
    if int(reader.scalar(sa.select(Stage.evaluations).where(*of)) or 0) < draws:
        return None
    used = min(draws, MOST)
    rows = chunks(reader, run_id, position, *EvaluationChunk.__table__.columns, where=EvaluationChunk.first < used)
    columns = join([as_columns(row) for row in rows])
    if columns is None:
        return None
    return Drawn(columns.points[:used], columns.costs[:used, 0], columns.status[:used])
