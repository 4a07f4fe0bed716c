"""How likely evaluations of a run are under its distributions: the densities, and the most likely violation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import sqlalchemy as sa
from numpy.typing import NDArray

from backend.catalog.criteria import criteria
from backend.catalog.service import bounds, described
from backend.db.rows import as_array, chunks
from backend.db.tables import EvaluationChunk, Stage
from backend.results import noise
from backend.runs.service import campaign
from campaigns import Campaign
from campaigns.cube import Floats
from campaigns.densities.joint import Joint, joint
from campaigns.densities.likelihood import Rows, most_likely
from campaigns.results.base import OK
from campaigns.results.likelihood import MostLikely

Limits = dict[str, tuple[float, float, float]]
"""Nominal value and bounds by path."""
_COSTS = [EvaluationChunk.first, EvaluationChunk.count, EvaluationChunk.costs, EvaluationChunk.status]


def densities(reader: sa.Connection, run_id: int, of: Campaign) -> tuple[Limits, Joint | None]:
    """Nominal values and bounds of a run's campaign, and its joint density; None if bounds are not known."""
    limits = bounds(of, described(reader, run_id))
    within = {path: (low, high) for path, (_, low, high) in limits.items()}
    return limits, joint(of, within) if within.keys() >= of.uncertain.keys() else None


def violation(reader: sa.Connection, run_id: int) -> MostLikely:
    """The most likely of the stored violations; 404 if there is no such run."""
    run_campaign = campaign(reader, run_id)
    limits, of = densities(reader, run_id, run_campaign)
    deciding = criteria(run_campaign.document(), described(reader, run_id))[0]
    nominal = {path: triple[0] for path, triple in limits.items()}
    alike = of is None or not of.distinguishes
    stored = (_counted if alike else _violating)(reader, run_id, run_campaign)
    return most_likely(run_campaign.criterion.threshold, of, nominal, stored, deciding.unit)


def _counted(reader: sa.Connection, run_id: int, run_campaign: Campaign) -> Iterator[Rows]:
    """Costs and status of every chunk, where no point is more likely than another; the points are not read."""
    for position in _positions(reader, run_id):
        for chunk in chunks(reader, run_id, position, *_COSTS):
            costs, status = _costs(chunk)
            yield Rows(position, chunk.first, np.empty((chunk.count, 0)), costs, status)


def _violating(reader: sa.Connection, run_id: int, run_campaign: Campaign) -> Iterator[Rows]:
    """The chunks that have a violation, stage by stage; of the others only costs and status are read."""
    drawn, threshold = noise.drawn(reader, run_id, run_campaign), run_campaign.criterion.threshold
    for position in _positions(reader, run_id):
        wanted = [chunk.first for chunk in chunks(reader, run_id, position, *_COSTS) if _violates(chunk, threshold)]
        where = EvaluationChunk.first.in_(wanted)
        for chunk in chunks(reader, run_id, position, *_COSTS, EvaluationChunk.points, where=where):
            costs, status = _costs(chunk)
            points = as_array(chunk.points, chunk.count)
            yield Rows(position, chunk.first, points, costs, status, drawn.get(position, noise.NONE).tolist())


def _violates(chunk: Any, threshold: float) -> bool:
    costs, status = _costs(chunk)
    return bool(((status == OK) & (costs[:, 0] <= threshold)).any())


def _costs(chunk: Any) -> tuple[Floats, NDArray[np.uint8]]:
    return as_array(chunk.costs, chunk.count), np.frombuffer(chunk.status, np.uint8)


def _positions(reader: sa.Connection, run_id: int) -> Sequence[int]:
    of = sa.select(Stage.position).where(Stage.run_id == run_id, Stage.evaluations > 0).order_by(Stage.position)
    return reader.scalars(of).all()
