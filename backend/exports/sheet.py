"""Evaluations as rows, read chunk by chunk, so that a run never has to fit into memory.

Each block of chunks is read in its own transaction, so that a slow download does not keep a snapshot open.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import repeat, starmap
from typing import Any, NamedTuple

import numpy as np
import sqlalchemy as sa
from numpy.typing import NDArray
from pydantic_core import to_json

from backend.catalog.criteria import criteria
from backend.catalog.schemas import CriterionOut
from backend.catalog.service import bounds, described
from backend.db.engine import read
from backend.db.rows import as_columns
from backend.db.tables import EvaluationChunk, Stage
from backend.http.written import cells, headed
from backend.results.evaluations import Bounds
from campaigns import Campaign, cube
from campaigns.checked.check import parameters
from campaigns.cube import Floats
from campaigns.results.base import OK, STATUS
from campaigns.runs import run_name

BLOCK = 16
"""Number of chunks per read."""

SHARE = "share of range"
"""The unit of a parameter whose bounds are unknown, because the catalogue does not have it."""


@dataclass(frozen=True)
class Evaluated:
    """A stage that has evaluations; evaluations stored later are ignored."""

    position: int
    kind: str
    method: str | None
    evaluations: int


class Block(NamedTuple):
    """Consecutive evaluations of a stage as columns: their indices, what is not ok and why, the criteria in their own
    sign and the parameters in their units."""

    indices: range
    status: NDArray[np.uint8]
    reasons: dict[int, str]
    seconds: Floats
    costs: list[Floats]
    """NaN where the status is not ok."""
    values: list[Floats]
    draws: list[int | None] | None
    """Which draw of a sample each is of which only a part is stored; None of a run without such a sample."""

    def written(
        self,
        missing: bytes,
        text: Callable[[str | None], bytes],
        number: Callable[[Floats], list[bytes]] = cells,
    ) -> Iterator[Iterable[bytes]]:
        """The evaluations as cells, a column at a time, because a row of Python objects takes four times as long.

        number: writes working times and parameters.
        """
        yield to_json([*self.indices])[1:-1].split(b",")
        statuses = [text(status) for status in STATUS]
        yield [statuses[code] for code in self.status.tolist()]
        reasons = self.reasons
        yield [text(reasons.get(i)) for i in self.indices] if reasons else repeat(missing, len(self.indices))
        yield number(self.seconds)
        yield from (known(costs, missing) for costs in self.costs)
        yield from map(number, self.values)
        if self.draws is not None:
            yield [missing if draw is None else b"%d" % draw for draw in self.draws]


def known(values: Floats, missing: bytes) -> list[bytes]:
    """The cells of numbers; `missing` for those that are not finite."""
    written = cells(values)
    for i in np.flatnonzero(~np.isfinite(values)).tolist():
        written[i] = missing
    return written


@dataclass(frozen=True)
class Sheet:
    """The columns of a run's evaluations: criteria and parameters with their units."""

    run_id: int
    stages: list[Evaluated]
    criteria: list[tuple[str, str]]
    """Name and unit of each criterion, the deciding one first."""
    turned: list[bool]
    """The criteria for which high is worse: costs have the opposite sign, which is reversed here."""
    parameters: list[tuple[str, str]]
    """Path and unit of each parameter."""
    limits: Bounds
    draws: Mapping[int, Sequence[int]] = field(default_factory=dict)
    """By the position of a stage of which only a part is stored: which draw of its sample each evaluation is."""

    @property
    def columns(self) -> list[str]:
        """The headers of the evaluations; `index` counts from 0 within the stage."""
        named = starmap(headed, [*self.criteria, *self.parameters])
        return ["index", "status", "reason", "seconds [s]", *named, *(["draw"] if self.draws else [])]

    def blocks(self, engine: sa.Engine, stage: Evaluated) -> Iterator[Block]:
        """The evaluations of one stage."""
        done = 0
        while done < stage.evaluations:
            with read(engine) as reader:
                chunks = _chunks(reader, self.run_id, stage.position, done)
            if not chunks:  # an ending stream would be taken for the whole
                raise RuntimeError(f"{run_name(self.run_id)} lost its evaluations while they were exported")
            for chunk in chunks:
                if chunk.first < stage.evaluations:
                    yield self._block(stage.position, chunk)
            done = chunks[-1].first + chunks[-1].count

    def _block(self, position: int, chunk: Any) -> Block:
        columns, draws = as_columns(chunk), self.draws.get(position)
        known: list[int | None] = (
            [None] * chunk.count if draws is None else [*draws[chunk.first : chunk.first + chunk.count]]
        )
        turned = [0.0 - c if turn else c for c, turn in zip(columns.costs.T, self.turned, strict=False)]
        return Block(
            indices=range(chunk.first, chunk.first + chunk.count),
            status=columns.status,
            reasons=columns.reasons,
            seconds=columns.seconds,
            costs=[np.where(columns.status == OK, column, np.nan) for column in turned],
            values=[
                cube.natural(columns.points[:, k], *self.limits[path]) if path in self.limits else columns.points[:, k]
                for k, (path, _) in enumerate(self.parameters)
            ],
            draws=known if self.draws else None,
        )


def sheet(reader: sa.Connection, run_id: int, campaign: Campaign) -> Sheet:
    catalogue = described(reader, run_id)
    limits = bounds(campaign, catalogue)
    units = {} if catalogue is None else {path: e.unit for path, (e, _) in parameters(campaign, catalogue).items()}
    query = sa.select(Stage.position, Stage.kind, Stage.method, Stage.evaluations)
    rows = reader.execute(query.where(Stage.run_id == run_id, Stage.evaluations > 0).order_by(Stage.position))
    criterion_list = criteria(campaign.document(), catalogue)[: _width(reader, run_id)]
    return Sheet(
        run_id=run_id,
        stages=[Evaluated(*row) for row in rows],
        criteria=headings(criterion_list),
        turned=[c.worse == "high" for c in criterion_list],
        parameters=[(path, units.get(path, "") if path in limits else SHARE) for path in campaign.uncertain],
        limits=limits,
        draws=_draws(reader, run_id),
    )


def _draws(reader: sa.Connection, run_id: int) -> dict[int, list[int]]:
    query = sa.select(Stage.position, Stage.result["flights"].label("flights"))
    return {row.position: row.flights for row in reader.execute(query.where(Stage.run_id == run_id, Stage.counted > 0))}


def headings(criterion_list: list[CriterionOut]) -> list[tuple[str, str]]:
    """Quantity and unit of every criterion, with unique names."""
    named: list[tuple[str, str]] = []
    for criterion in criterion_list:
        name = criterion.quantity or criterion.component
        again = sum(known.partition(" ")[0] == name for known, _ in named)
        named.append((f"{name} {again + 1}" if again else name, criterion.unit))
    return named


def _width(reader: sa.Connection, run_id: int) -> int:
    sizes = sa.select(EvaluationChunk.count.label("rows"), sa.func.length(EvaluationChunk.costs).label("bytes"))
    row = reader.execute(sizes.where(EvaluationChunk.run_id == run_id).limit(1)).one_or_none()
    return 1 if row is None else max(1, int(row.bytes) // (8 * int(row.rows)))


def _chunks(reader: sa.Connection, run_id: int, position: int, done: int) -> list[Any]:
    of = (EvaluationChunk.run_id == run_id, EvaluationChunk.position == position, EvaluationChunk.first >= done)
    return list(reader.execute(sa.select(EvaluationChunk).where(*of).order_by(EvaluationChunk.first).limit(BLOCK)))
