"""The outbox: which messages are due, and what became of them. Every method is one transaction. Read `Outbox.fill`.

A message is stored before it is sent, and an attempt is counted before it starts: a process that is killed loses no
message, and one that may have arrived already is sent again under the same id with a higher attempt number.
"""

from __future__ import annotations

import logging
import uuid
from collections.abc import Sequence

import sqlalchemy as sa

from backend.db.engine import insert, now, read
from backend.db.tables import Run, WebhookDelivery, WebhookTarget
from backend.db.tables_installed import DeliveryState
from backend.webhooks import body
from backend.webhooks.sending import Message, Sent
from campaigns.runs import ENDED

MOST = 15
"""Attempts for one message."""
FIRST, LONGEST = 10.0, 3600.0
"""The first pause between two attempts, which doubles, and the longest one [s]."""
LOST = 60.0
"""An attempt that has reported no outcome after this time counts as lost [s]."""
SLACK = 60.0
"""How long before it is noticed that the clock was put back runs that ended are reported [s]."""
NEAR = 1000
"""Runs below the oldest active one that are examined again: transactions may commit out of order."""
BATCH = 100
_log = logging.getLogger(__name__)


def pause(attempts: int) -> float:
    """The time until the next attempt, after this many [s]."""
    return float(min(LONGEST, FIRST * 2 ** (attempts - 1)))


class Outbox:
    def __init__(self, engine: sa.Engine, target: str, public_url: str) -> None:
        self.engine, self.target, self.public_url = engine, target, public_url
        self._from = 0
        """All runs with a lower number have ended and are reported."""

    def register(self) -> None:
        with self.engine.begin() as writer:
            row = insert(writer, WebhookTarget).values(id=self.target, since=now(writer))
            writer.execute(row.on_conflict_do_nothing())
        self._lower()

    def _lower(self) -> None:
        """Report what ends from now on if the target was configured before the clock was put back."""
        with read(self.engine) as reader:  # so that an idle service never writes
            ahead = (WebhookTarget.id == self.target, WebhookTarget.since > now(reader))
            if reader.scalar(sa.select(WebhookTarget.since).where(*ahead)) is None:
                return
        with self.engine.begin() as writer:
            at = now(writer)
            ahead = (WebhookTarget.id == self.target, WebhookTarget.since > at)
            writer.execute(sa.update(WebhookTarget).where(*ahead).values(since=at - SLACK))

    def fill(self) -> int:
        """Store a message for every run that has ended since the target was configured; returns how many were new."""
        count = 0
        self._lower()
        while ids := self._unreported():
            with self.engine.begin() as writer:
                for run_id in self._still(writer, ids):
                    values = {"run_id": run_id, "body": self._body(writer, run_id)}
                    row = insert(writer, WebhookDelivery).values(**_new(writer, self.target, body.ENDED), **values)
                    once = row.on_conflict_do_nothing(index_elements=["target", "run_id"])
                    count += writer.scalar(once.returning(WebhookDelivery.id)) is not None
        return count

    def _still(self, writer: sa.Connection, ids: Sequence[int]) -> Sequence[int]:
        """The runs of these that have ended, locked until the transaction ends: one may have been queued again since it
        was read."""
        ended_runs = sa.select(Run.id).where(Run.id.in_(ids), Run.state.in_(ENDED)).order_by(Run.id).with_for_update()
        return writer.scalars(ended_runs).all()

    def _body(self, reader: sa.Connection, run_id: int) -> str:
        """Never fails for one run, which would hold up all others."""
        try:
            return body.ended(reader, run_id, self.public_url)
        except sa.exc.SQLAlchemyError:
            raise
        except Exception:
            _log.exception("the results of run %d cannot be read; its message has none", run_id)
            return body.unreadable(run_id, now(reader))

    def _unreported(self) -> Sequence[int]:
        since = sa.select(WebhookTarget.since).where(WebhookTarget.id == self.target).scalar_subquery()
        of = (WebhookDelivery.target == self.target, WebhookDelivery.run_id == Run.id)
        reported = sa.select(WebhookDelivery.id).where(*of).exists()
        wanted = (Run.id >= self._from, Run.state.in_(ENDED), Run.finished >= since, Run.purged.is_(None), ~reported)
        with read(self.engine) as reader:
            found = reader.scalars(sa.select(Run.id).where(*wanted).order_by(Run.id).limit(BATCH)).all()
            if not found:
                active = sa.select(sa.func.min(Run.id)).where(Run.state.not_in(ENDED))  # a retried one may be old
                newest = sa.select(sa.func.max(Run.id))
                oldest = reader.scalar(active) or reader.scalar(newest) or 0
                self._from = oldest - NEAR
            return found

    def claim(self) -> Message | None:
        """The next message that is due, its attempt counted; None if there is none."""
        due = (WebhookDelivery.target == self.target, WebhookDelivery.state == DeliveryState.PENDING)
        columns = (WebhookDelivery.id, WebhookDelivery.body, WebhookDelivery.attempts)
        next_one = sa.select(*columns).order_by(WebhookDelivery.not_before, WebhookDelivery.created).limit(1)
        with read(self.engine) as reader:  # so that an idle service never writes
            if reader.execute(next_one.where(*due, _due(now(reader)))).first() is None:
                return None
        with self.engine.begin() as writer:
            at = now(writer)
            locked = next_one.where(*due, _due(at)).with_for_update(skip_locked=True)
            row = writer.execute(locked).first()
            if row is None:
                return None
            counted = {"attempts": row.attempts + 1, "attempted": at, "not_before": at + LOST}
            writer.execute(sa.update(WebhookDelivery).where(WebhookDelivery.id == row.id).values(**counted))
            return Message(row.id, row.body, row.attempts + 1)

    def record(self, message: Message, sent: Sent) -> None:
        """Store the outcome of an attempt, unless a later one has begun."""
        mine = (WebhookDelivery.id == message.id, WebhookDelivery.attempts == message.attempt)
        with self.engine.begin() as writer:
            at = now(writer)
            values: dict[str, object] = {"status": sent.status, "error": sent.error}
            if sent.error is None:
                values |= {"state": DeliveryState.DELIVERED, "delivered": at}
            elif message.attempt >= MOST:
                values |= {"state": DeliveryState.FAILED}
            else:
                values |= {"not_before": at + pause(message.attempt)}
            writer.execute(sa.update(WebhookDelivery).where(*mine).values(**values))


def test(writer: sa.Connection, target: str) -> str:
    """Store a test message, unless one is still waiting: whoever asks often gets no queue of them. Returns its id."""
    tests = sa.select(WebhookDelivery.id).where(WebhookDelivery.target == target, WebhookDelivery.type == body.TEST)
    waiting = writer.scalar(tests.where(WebhookDelivery.state == DeliveryState.PENDING).limit(1))
    if waiting is not None:
        return str(waiting)
    values = _new(writer, target, body.TEST)
    writer.execute(sa.insert(WebhookDelivery).values(**values, body=body.test(now(writer))))
    return str(values["id"])


def _due(at: float) -> sa.ColumnElement[bool]:
    """A pause further ahead than any is given is over: the clock was put back."""
    return sa.or_(WebhookDelivery.not_before <= at, WebhookDelivery.not_before > at + LONGEST)


def _new(writer: sa.Connection, target: str, kind: str) -> dict[str, object]:
    at = now(writer)
    return {"id": f"msg_{uuid.uuid4().hex}", "target": target, "type": kind, "created": at, "not_before": at}
