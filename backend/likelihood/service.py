"""Re-weights the stored independent sample of a run to other distributions; nothing is evaluated or stored."""

from __future__ import annotations

from collections.abc import Mapping

import sqlalchemy as sa

from backend.db.rows import stored_columns
from backend.db.tables import Stage
from backend.http.errors import RefusedError
from backend.likelihood.schemas import ReweightRequest
from backend.results.likely import densities
from backend.runs.service import campaign
from backend.runs.versions import readable
from campaigns import Campaign, Problem
from campaigns.asked.distributions import Uncertain
from campaigns.checked.uncertainty import distributed
from campaigns.densities.joint import joined
from campaigns.densities.reweighting import Drawn, Terms, reweighted
from campaigns.results.reweighted import Reweighted
from campaigns.results.sample import Sample
from campaigns.runs import run_name
from campaigns.stages.found import stage_result

SHARES = (0.01, 0.05, 0.5)
"""The quantiles that are estimated, besides that of the campaign."""


def estimated(reader: sa.Connection, run_id: int, request: ReweightRequest) -> Reweighted:
    """The estimate under the moved distributions; `RefusedError` without a sample or a density."""
    asked = campaign(reader, run_id)
    limits, stated = densities(reader, run_id)
    if stated is None:
        raise RefusedError(409, "no-sample", f"the bounds of {run_name(run_id)} are not known here")
    position, sample = _sample(reader, run_id)
    moved = _moved(asked, limits, request.uncertain)
    bounds = {path: one.interval(limits[path][0]) for path, one in moved.items()}
    over = joined({path: one.distribution for path, one in moved.items()}, asked.correlations, bounds)
    own = [] if sample.quantile is None else [sample.quantile.share]
    terms = Terms(asked.criterion.threshold, asked.confidence, sorted({*SHARES, *own}))
    return reweighted(stated, over, _drawn(reader, run_id, position, sample), terms)


def _moved(
    asked: Campaign, limits: Mapping[str, tuple[float, float, float]], moved: Mapping[str, Uncertain]
) -> dict[str, Uncertain]:
    """The stated distributions with the moved ones in their place."""
    unknown = [
        Problem(f"uncertain.{path}", path, "not an uncertain parameter") for path in moved.keys() - asked.uncertain
    ]
    if unknown:
        raise RefusedError(422, "unknown-parameter", "the campaign has no such uncertain parameter", unknown)
    problems: list[Problem] = []
    for path, one in moved.items():
        problems += distributed(f"uncertain.{path}", one, *one.interval(limits[path][0]))
    if problems:
        raise RefusedError(422, "invalid-request", "a moved distribution does not fit its bounds", problems)
    return {**asked.uncertain, **moved}


def _sample(reader: sa.Connection, run_id: int) -> tuple[int, Sample]:
    """The position of the stage that drew the independent sample of a run, and the sample."""
    rows = reader.execute(
        sa.select(Stage.position, Stage.result).where(Stage.run_id == run_id).order_by(Stage.position)
    )
    with readable(f"a stage of {run_name(run_id)}"):
        results = [(row.position, stage_result(row.result)) for row in rows if row.result is not None]
    for position, result in results:
        if result.certificate is not None:
            return position, result.certificate.sample
    raise RefusedError(
        409,
        "no-sample",
        f"{run_name(run_id)} has no independent sample to re-weight: add a certify stage to its campaign and run it "
        "again",
    )


def _drawn(reader: sa.Connection, run_id: int, position: int, sample: Sample) -> Drawn:
    """The draws as stored, excluded ones included, without the grid that may follow them."""
    draws, columns = sample.samples + sample.excluded, stored_columns(reader, run_id, position)
    if columns is None or len(columns.status) < draws:
        raise RefusedError(409, "no-sample", f"the independent sample of {run_name(run_id)} is not stored whole")
    return Drawn(columns.points[:draws], columns.costs[:draws, 0], columns.status[:draws])
