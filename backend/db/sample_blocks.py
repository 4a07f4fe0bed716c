"""Reads and writes the blocks of a sample of which only the lowest evaluations are stored.

They are there while the stage is carried out, so that it can go on; its result has what they show.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import sqlalchemy as sa

from backend.db import sizes
from backend.db.engine import now
from backend.db.rows import chunk_rows, lowered, lowest
from backend.db.tables import EvaluationChunk, SampleBlock, SampleShare, Stage, Worker
from backend.db.workers import beating
from campaigns.stored.blocks import Block, packed, unpacked
from campaigns.stored.records import Columns


def read(connection: sa.Connection, run_id: int, position: int, known: Collection[int] = ()) -> list[Block]:
    """The blocks of a stage in the order of their first draws, without the known ones."""
    of = _of(run_id, position)
    firsts = connection.execute(sa.select(SampleBlock.first).where(*of)).scalars()
    new = [first for first in firsts if first not in known]
    query = sa.select(SampleBlock.data).where(*of, SampleBlock.first.in_(new)).order_by(SampleBlock.first)
    return [unpacked(row.data) for row in connection.execute(query)] if new else []


def take(
    connection: sa.Connection, run_id: int, position: int, worker: str, firsts: Sequence[int], most: int, others: bool
) -> list[int]:
    """Note which blocks the worker flies, too, until they are stored; without any it flies none any more. See
    `RunStore.take`."""
    of = (SampleShare.run_id == run_id, SampleShare.position == position)
    stored = set(connection.execute(sa.select(SampleBlock.first).where(*_of(run_id, position))).scalars())
    done = [SampleShare.first.in_(sa.select(SampleBlock.first).where(*_of(run_id, position)))] if firsts else []
    connection.execute(sa.delete(SampleShare).where(*of, SampleShare.worker == worker, *done))
    alive = sa.select(Worker.name).where(Worker.name == SampleShare.worker, beating(now(connection)))
    elsewhere = (SampleShare.worker != worker, alive.exists())
    taken = set(connection.execute(sa.select(SampleShare.first).where(*of, *elsewhere)).scalars())
    left = [first for first in firsts if first not in stored]
    free = [first for first in left if first not in taken][:most]
    if free:
        # Those of one that is gone, or of an earlier process of this name.
        connection.execute(sa.delete(SampleShare).where(*of, SampleShare.first.in_(free)))
        rows = [{"run_id": run_id, "position": position, "first": first, "worker": worker} for first in free]
        connection.execute(sa.insert(SampleShare), rows)
    return free or (left[:most] if others else [])


def fresh(connection: sa.Connection, run_id: int, position: int, blocks: Sequence[Block]) -> list[Block]:
    """The blocks that are not stored: none, if a write is repeated because its answer was lost."""
    query = sa.select(SampleBlock.first).where(*_of(run_id, position), SampleBlock.first.in_([b.first for b in blocks]))
    stored = set(connection.execute(query).scalars())
    return [block for block in blocks if block.first not in stored]


def add(connection: sa.Connection, run_id: int, position: int, blocks: Sequence[Block]) -> None:
    """Store blocks that are fresh, and count them in the row of the stage."""
    rows = [{"run_id": run_id, "position": position, "first": b.first, "data": packed(b)} for b in blocks]
    connection.execute(sa.insert(SampleBlock), rows)
    mine = (Stage.run_id == run_id, Stage.position == position)
    stage = connection.execute(sa.select(Stage.best, Stage.kind, Stage.method).where(*mine)).one()
    counts = {
        "counted": Stage.counted + sum(b.draws for b in blocks),
        "violations": Stage.violations + sum(b.violations for b in blocks),
        "failed": Stage.failed + sum(b.failed for b in blocks),
        "excluded": Stage.excluded + sum(b.excluded for b in blocks),
        "seconds": max(b.seconds for b in blocks),
    }
    best = min((value for value in (stage.best, *(b.lowest for b in blocks)) if value is not None), default=None)
    connection.execute(sa.update(Stage).where(*mine).values(**counts, best=best))
    if best is not None:
        lowered(connection, run_id, stage.kind, stage.method, best)


def keep(connection: sa.Connection, run_id: int, position: int, columns: Columns) -> int | None:
    """Store the lowest evaluations, which are counted already; their size [bytes], None if they are stored."""
    mine = (Stage.run_id == run_id, Stage.position == position)
    if connection.execute(sa.select(Stage.evaluations).where(*mine)).scalar_one():
        return None
    chunks, kept = chunk_rows(run_id, position, 0, columns), len(columns.status)
    for chunk in chunks:
        connection.execute(sa.insert(EvaluationChunk).values(**chunk))
    values = {"evaluations": kept, "counted": Stage.counted - kept, "best_index": lowest(columns)[1]}
    connection.execute(sa.update(Stage).where(*mine).values(**values))
    return sum(map(sizes.of_chunk, chunks))


def drop(connection: sa.Connection, run_id: int, position: int) -> None:
    """Forget the blocks of a stage that has ended."""
    connection.execute(sa.delete(SampleBlock).where(*_of(run_id, position)))
    connection.execute(sa.delete(SampleShare).where(SampleShare.run_id == run_id, SampleShare.position == position))


def _of(run_id: int, position: int) -> tuple[sa.ColumnElement[bool], ...]:
    return SampleBlock.run_id == run_id, SampleBlock.position == position
