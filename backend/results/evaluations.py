"""Reads evaluations from their column chunks, thinned for charts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple, cast

import numpy as np
import sqlalchemy as sa
from numpy.typing import NDArray

from backend.catalog.criteria import criteria
from backend.catalog.schemas import CriterionOut
from backend.catalog.service import bounds, described
from backend.db.rows import as_array, as_columns, chunks
from backend.db.tables import EvaluationChunk, Stage
from backend.http.written import finite_all
from backend.results import noise
from backend.results.improvements import Improvements
from backend.results.schemas import EvaluationFailure, Evaluations, EvaluationSeries
from backend.runs.service import campaign
from campaigns import cube, thin
from campaigns.results.base import EXCLUDED, OK, STATUS, TIMEOUT
from campaigns.stored.records import Columns, join

MOST_FAILURES = 200
_FEW = 200
"""Of so many chunks only those are read that hold what is shown."""
_COSTS, _SHOWN, _FAILURES = (
    [EvaluationChunk.first, EvaluationChunk.count, *(getattr(EvaluationChunk, name) for name in names)]
    for names in (
        ("costs", "status", "seconds"),
        ("points", "costs", "status", "seconds"),
        ("points", "status", "reasons"),
    )
)
"""What is read of a chunk."""

Without = tuple[dict[int, thin.Indices], dict[int, thin.Indices]]
"""The rows of the first evaluations that failed, by the first index of their chunk; of those that are excluded."""
Bounds = Mapping[str, tuple[float, float, float]]


def read(reader: sa.Connection, run_id: int, most: int, position: int | None) -> Evaluations:
    """Read at most `most` evaluations of each stage, and the first ones without a cost with reasons, those that failed
    before those that are excluded; 404 if there is no such run.

    Two passes over the chunks of a stage, because which evaluations are shown depends on all of its costs: memory is
    that of a few chunks, however many there are.
    """
    run_campaign = campaign(reader, run_id)
    catalogue = described(reader, run_id)
    of = _Read(
        reader,
        run_id,
        list(run_campaign.uncertain),
        bounds(run_campaign, catalogue),
        criteria(run_campaign.document(), catalogue),
    )
    drawn = noise.drawn(reader, run_id, run_campaign)
    timeouts = Stage.result["blocks", "beside", "timeouts"].as_integer().label("timeouts")
    columns = (Stage.position, Stage.kind, Stage.method, Stage.evaluations, Stage.counted, Stage.failed, Stage.excluded)
    query = sa.select(*columns, Stage.started, timeouts)
    query = query.where(Stage.run_id == run_id, Stage.evaluations > 0).order_by(Stage.position)
    if position is not None:
        query = query.where(Stage.position == position)
    found, read = Evaluations(criteria=of.criteria, stages=[], failures=[]), list[tuple[int, Without]]()
    for stage in reader.execute(query).all():
        costs = _Costs()
        for chunk in chunks(reader, run_id, stage.position, *_COSTS):
            costs.add(chunk)
        if costs.steps.read:
            found.stages.append(of.series(stage, costs, most, drawn.get(stage.position, noise.NONE)))
            read.append((stage.position, costs.without))
    for excluded in (False, True):
        for at, without in read:
            found.failures += of.failures(at, without[excluded], MOST_FAILURES - len(found.failures))
    found.failures.sort(key=lambda one: (one.position, one.index))
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
    drawn = noise.drawn(reader, run_id, run_campaign).get(position, noise.NONE)
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


@dataclass
class _Costs:
    """What one pass over the costs of a stage shows."""

    steps: Improvements = field(default_factory=Improvements)
    firsts: list[int] = field(default_factory=list)
    """The first index of each chunk."""
    timeouts: int = 0
    without: Without = field(default_factory=lambda: ({}, {}))

    def add(self, chunk: Any) -> None:
        self.steps.add(chunk)
        self.firsts.append(chunk.first)
        status = np.frombuffer(chunk.status, dtype=np.uint8)
        self.timeouts += int((status == TIMEOUT).sum())
        for excluded, first in enumerate(self.without):
            of = (status == EXCLUDED) if excluded else (status != OK) & (status != EXCLUDED)
            known = sum(map(len, first.values()))
            if known < MOST_FAILURES and of.any():
                first[chunk.first] = np.flatnonzero(of)[: MOST_FAILURES - known]


@dataclass(frozen=True)
class _Read:
    """Reads the evaluations that are shown of a run with these parameters and criteria."""

    reader: sa.Connection
    run_id: int
    paths: list[str]
    limits: Bounds
    criteria: list[CriterionOut]

    def series(self, stage: Any, costs: _Costs, most: int, drawn: noise.Seeds) -> EvaluationSeries:
        steps = costs.steps
        chosen = thin.with_kept(steps.read, most, np.array(steps.index, dtype=np.int64))
        columns = self._rows(stage.position, chosen, costs.firsts)
        return EvaluationSeries(
            position=stage.position,
            kind=stage.kind,
            method=stage.method,
            started=stage.started,
            total=stage.evaluations + stage.counted,
            stored=stage.evaluations,
            failed=stage.failed,
            timeouts=costs.timeouts + (stage.timeouts or 0),
            excluded=stage.excluded,
            index=chosen.tolist(),
            seconds=columns.seconds.tolist(),
            cost=finite_all(np.where(columns.status == OK, columns.costs[:, 0], np.nan)),
            further=self._further(columns),
            status=[STATUS[code] for code in columns.status.tolist()],
            parameters=in_units(columns.points, self.paths, self.limits),
            seeds=_seeds(drawn, chosen) if len(drawn) else [],
            improvements=_improved(steps),
        )

    def failures(self, position: int, without: dict[int, thin.Indices], most: int) -> list[EvaluationFailure]:
        """Read at most `most` of these evaluations without a cost."""
        if most <= 0 or not without:
            return []
        wanted = EvaluationChunk.first.in_(without)
        found: list[EvaluationFailure] = []
        for chunk in chunks(self.reader, self.run_id, position, *_FAILURES, where=wanted):
            rows = without[chunk.first]
            values = in_units(as_array(chunk.points, chunk.count)[rows], self.paths, self.limits)
            codes = np.frombuffer(chunk.status, dtype=np.uint8)[rows].tolist()
            found += [
                EvaluationFailure(
                    position=position,
                    index=index,
                    status=cast(Any, STATUS[code]),
                    reason=chunk.reasons.get(str(index), ""),
                    parameters={path: column[row] for path, column in values.items()},
                )
                for row, (index, code) in enumerate(zip((chunk.first + rows).tolist(), codes, strict=True))
            ]
        return found[:most]

    def _rows(self, position: int, chosen: thin.Indices, firsts: list[int]) -> Columns:
        """These evaluations of a stage, whose chunks begin with `firsts`; their indices are ordered."""
        chunk_indices = np.unique(np.searchsorted(firsts, chosen, side="right") - 1)
        where = EvaluationChunk.first.in_([firsts[i] for i in chunk_indices]) if len(chunk_indices) <= _FEW else None
        found = []
        for chunk in chunks(self.reader, self.run_id, position, *_SHOWN, where=where):
            first, last = np.searchsorted(chosen, [chunk.first, chunk.first + chunk.count])
            rows = chosen[first:last] - chunk.first
            data = (chunk.points, chunk.costs, chunk.seconds)
            points, costs, seconds = (as_array(column, chunk.count)[rows] for column in data)
            status = np.frombuffer(chunk.status, dtype=np.uint8)[rows]
            found.append(Columns(points, costs, status, seconds[:, 0], {}))
        joined = join(found)
        assert joined is not None
        return joined

    def _further(self, columns: Columns) -> dict[str, list[float | None]]:
        """The other criteria's values in their own sign; costs are always lower when worse."""
        found = {}
        for k, criterion in enumerate(self.criteria[1 : columns.costs.shape[1]], 1):
            costs = np.where(columns.status == OK, columns.costs[:, k], np.nan)
            found[criterion.name] = finite_all(0.0 - costs if criterion.worse == "high" else costs)
        return found


def _seeds(drawn: noise.Seeds, index: thin.Indices) -> list[int | None]:
    """The noise seeds of these evaluations of a stage whose first ones drew `drawn`."""
    return [int(drawn[at]) if at < len(drawn) else None for at in index.tolist()]


def in_units(points: NDArray[np.float64], paths: list[str], limits: Bounds) -> dict[str, list[float]]:
    """Points of the unit cube as {path: values} in the parameters' units, bit-identical to those that were
    simulated."""
    found = {}
    for column, path in enumerate(paths):
        if path in limits and column < points.shape[1]:
            found[path] = cube.natural(points[:, column], *limits[path]).tolist()
    return found


def _improved(steps: Improvements) -> dict[str, list[float]]:
    """The convergence history as a step line: its steps, and its end at the last evaluation."""
    if not steps.index or steps.index[-1] == steps.read - 1:
        return {"index": [*steps.index], "seconds": steps.seconds, "cost": steps.cost}
    return {
        "index": [*steps.index, steps.read - 1],
        "seconds": [*steps.seconds, steps.last],
        "cost": [*steps.cost, steps.cost[-1]],
    }
