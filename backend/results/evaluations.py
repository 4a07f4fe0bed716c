"""Reads evaluations from their column chunks, thinned for charts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple, cast

import numpy as np
import sqlalchemy as sa
from numpy.typing import NDArray

from backend.catalog.criteria import criteria
from backend.catalog.schemas import CriterionOut
from backend.catalog.service import bounds, described
from backend.db.rows import as_columns, stored_columns
from backend.db.tables import EvaluationChunk, Stage
from backend.http.written import finite_all
from backend.results import noise
from backend.results.schemas import EvaluationFailure, Evaluations, EvaluationSeries
from backend.runs.service import campaign
from campaigns import cube, thin
from campaigns.results.base import EXCLUDED, OK, STATUS, TIMEOUT
from campaigns.stored.records import Columns

MOST_FAILURES = 200

Bounds = Mapping[str, tuple[float, float, float]]


def read(reader: sa.Connection, run_id: int, most: int, position: int | None) -> Evaluations:
    """At most `most` evaluations of each stage, and the first failures with reasons; 404 if there is no such run."""
    run_campaign = campaign(reader, run_id)
    catalogue = described(reader, run_id)
    limits = bounds(run_campaign, catalogue)
    drawn = noise.drawn(reader, run_id, run_campaign)
    listed = criteria(run_campaign.document(), catalogue)
    paths = list(run_campaign.uncertain)
    query = sa.select(Stage.position, Stage.kind, Stage.method, Stage.evaluations, Stage.failed, Stage.excluded)
    query = query.where(Stage.run_id == run_id, Stage.evaluations > 0).order_by(Stage.position)
    if position is not None:
        query = query.where(Stage.position == position)
    found = Evaluations(criteria=listed, stages=[], failures=[])
    for stage in reader.execute(query).all():
        columns = stored_columns(reader, run_id, stage.position)
        if columns is not None:
            found.stages.append(_series(stage, columns, most, paths, limits, listed, drawn.get(stage.position, [])))
            found.failures += _failures(stage.position, columns, paths, limits)[: MOST_FAILURES - len(found.failures)]
    return found


class Evaluated(NamedTuple):
    """One stored evaluation: its index in its stage, its bit-identical parameters, {path: value}, and its cost if it
    has one."""

    position: int
    parameters: dict[str, float]
    cost: float | None
    seed: int | None
    """Of the noise realisation that it drew; None for those of the campaign."""


def drawn_first(reader: sa.Connection, run_id: int, position: int, most: int) -> list[Evaluated]:
    """A stage's first `most` non-excluded evaluations."""
    run_campaign = campaign(reader, run_id)
    of = (EvaluationChunk.run_id == run_id, EvaluationChunk.position == position)
    drawn = noise.drawn(reader, run_id, run_campaign).get(position, [])
    found: list[Evaluated] = []
    for row in reader.execute(sa.select(EvaluationChunk).where(*of).order_by(EvaluationChunk.first)):
        columns = as_columns(row)
        evaluated = np.flatnonzero(columns.status != EXCLUDED)[: most - len(found)]
        values = in_units(
            columns.points[evaluated], list(run_campaign.uncertain), bounds(run_campaign, described(reader, run_id))
        )
        rows = [dict(zip(values, one, strict=True)) for one in zip(*values.values(), strict=True)]
        costs = np.where(columns.status == OK, columns.costs[:, 0], np.nan)[evaluated]
        index = row.first + evaluated
        found += map(Evaluated, index.tolist(), rows, finite_all(costs), _seeds(drawn, index))
        if len(found) >= most:
            break
    return found


def _series(
    stage: Any,
    columns: Columns,
    most: int,
    paths: list[str],
    limits: Bounds,
    listed: list[CriterionOut],
    drawn: list[int],
) -> EvaluationSeries:
    costs = np.where(columns.status == OK, columns.costs[:, 0], np.nan)
    better = thin.improvements(costs)
    chosen = thin.with_kept(len(costs), most, better)
    return EvaluationSeries(
        position=stage.position,
        kind=stage.kind,
        method=stage.method,
        total=stage.evaluations,
        failed=stage.failed,
        timeouts=int((columns.status == TIMEOUT).sum()),
        excluded=stage.excluded,
        index=chosen.tolist(),
        seconds=columns.seconds[chosen].tolist(),
        cost=finite_all(costs[chosen]),
        further=_further(columns, chosen, listed),
        status=[STATUS[code] for code in columns.status[chosen].tolist()],
        parameters=in_units(columns.points[chosen], paths, limits),
        seeds=_seeds(drawn, chosen) if drawn else [],
        improvements=improved(costs, columns.seconds, better),
    )


def _further(columns: Columns, chosen: thin.Indices, listed: list[CriterionOut]) -> dict[str, list[float | None]]:
    """The other criteria's values of the chosen evaluations in their own sign; costs are always lower when worse."""
    found = {}
    for k, criterion in enumerate(listed[1 : columns.costs.shape[1]], 1):
        costs = np.where(columns.status[chosen] == OK, columns.costs[chosen, k], np.nan)
        found[criterion.name] = finite_all(0.0 - costs if criterion.worse == "high" else costs)
    return found


def _seeds(drawn: list[int], index: thin.Indices) -> list[int | None]:
    """The noise seeds of these evaluations of a stage whose first ones drew `drawn`."""
    return [drawn[at] if at < len(drawn) else None for at in index.tolist()]


def in_units(points: NDArray[np.float64], paths: list[str], limits: Bounds) -> dict[str, list[float]]:
    """Points of the unit cube as {path: values} in the parameters' units, bit-identical to those that were
    simulated."""
    found = {}
    for column, path in enumerate(paths):
        if path in limits and column < points.shape[1]:
            found[path] = cube.natural(points[:, column], *limits[path]).tolist()
    return found


def improved(costs: thin.Floats, seconds: thin.Floats, better: thin.Indices) -> dict[str, list[float]]:
    """The convergence history as a step line: its steps, and its end at the last evaluation."""
    last = len(costs) - 1
    index, best = better.tolist(), costs[better].tolist()
    if index and index[-1] != last:
        index, best = [*index, last], [*best, best[-1]]
    return {"index": index, "seconds": seconds[index].tolist() if index else [], "cost": best}


def _failures(position: int, columns: Columns, paths: list[str], limits: Bounds) -> list[EvaluationFailure]:
    found = np.flatnonzero(columns.status != OK)[:MOST_FAILURES]
    values = in_units(columns.points[found], paths, limits)
    return [
        EvaluationFailure(
            position=position,
            index=index,
            status=cast(Any, STATUS[columns.status[index]]),
            reason=columns.reasons.get(index, ""),
            parameters={path: column[row] for path, column in values.items()},
        )
        for row, index in enumerate(found.tolist())
    ]
