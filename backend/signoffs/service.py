"""Sign-offs of a run's results and their withdrawal; a sign-off is bound to the digest of the results.

Each write includes its row in the audit trail, in one transaction.
"""

from __future__ import annotations

import sqlalchemy as sa

from backend.access.auth import forbidden
from backend.access.own import require_own
from backend.access.rules import SIGN
from backend.db import audit, users
from backend.db.access import Visitor, account_of
from backend.db.digest import results_digest
from backend.db.engine import now
from backend.db.tables import Run
from backend.db.tables import Signoff as Row
from backend.http.errors import RefusedError, not_found
from backend.runs.removal import refuse_removed
from backend.runs.tombstones import refuse_purged
from backend.signoffs.schemas import Signoff, SignoffRequest, Signoffs
from campaigns.runs import run_name


def listed(reader: sa.Connection, run_id: int, visitor: Visitor | None = None) -> Signoffs:
    """The sign-offs of a run, oldest first, and why the visitor, if given, may not add one; 404 without such a run."""
    verdict = _verdict(reader, run_id)
    removed = reader.scalar(sa.select(Run.removed).where(Run.id == run_id)) is not None
    digest = results_digest(reader, run_id)
    rows = reader.execute(sa.select(Row.__table__).where(Row.run_id == run_id).order_by(Row.id)).mappings()
    launcher = _launcher(reader, run_id)
    items = [_signoff(reader, row, digest, launcher) for row in rows]
    can_sign = verdict is not None and not removed
    barred = None if visitor is None else _barred(reader, run_id, visitor)
    return Signoffs(digest=digest, can_sign=can_sign, barred=barred, items=items)


def sign(writer: sa.Connection, run_id: int, review: SignoffRequest, visitor: Visitor) -> Signoff:
    """Sign off the results. 409 without a verdict, for other results, for a repetition, and for a removed run.

    403 for the user who launched the run, unless an administrator permits it; then the sign-off states so (`own`).
    """
    refuse_removed(writer, run_id)
    if _verdict(writer, run_id) is None:
        raise _conflict("no-verdict", f"{run_name(run_id)} has no verdict: it cannot be signed off")
    own = _launcher(writer, run_id) == visitor.account
    dependent = _dependent(writer, run_id, visitor)
    if dependent is not None:
        raise dependent
    digest = results_digest(writer, run_id)
    if review.digest != digest:
        detail = (
            f"the results of {run_name(run_id)} have changed since the review (sha256 {review.digest[:16]}): "
            "load the run and review it again"
        )
        raise _conflict("results-changed", detail)
    same = (Row.run_id == run_id, Row.name == review.name, Row.role == review.role, Row.digest == digest)
    if writer.scalar(sa.select(Row.id).where(*same, Row.withdrawn.is_(None))) is not None:
        raise _conflict("already-signed", f"{review.name} has already signed off these results as {review.role}")
    values = review.model_dump() | {"run_id": run_id, "user": visitor.user, "created": now(writer)}
    signoff_id = writer.execute(sa.insert(Row).values(**values).returning(Row.id)).scalar_one()
    noted = {"signoff": signoff_id, **review.model_dump()} | ({"own": True} if own else {})
    audit.note(writer, visitor, "signoff.created", run_name(run_id), noted)
    return one(writer, run_id, signoff_id)


def withdraw(engine: sa.Engine, run_id: int, signoff_id: int, reason: str, visitor: Visitor) -> Signoff:
    """Withdraw a sign-off with a reason; it stays on record. 404 if there is none, 403 if it is another user's, 409 if
    it is already withdrawn.
    """
    with engine.begin() as writer:
        standing = one(writer, run_id, signoff_id)
        require_own(writer, visitor, standing.user, f"sign-off {signoff_id} of {run_name(run_id)}")
        if standing.withdrawn is not None:
            raise _conflict("withdrawn", f"this sign-off was already withdrawn by {standing.withdrawn_by}")
        values = {"withdrawn": now(writer), "withdrawn_by": visitor.user, "withdrawn_reason": reason}
        writer.execute(sa.update(Row).where(Row.id == signoff_id).values(**values))
        detail = {"signoff": signoff_id, "reason": reason}
        audit.note(writer, visitor, "signoff.withdrawn", run_name(run_id), detail)
        return one(writer, run_id, signoff_id)


def one(reader: sa.Connection, run_id: int, signoff_id: int) -> Signoff:
    """A sign-off as it is now; 404 if there is none."""
    _verdict(reader, run_id)
    query = sa.select(Row.__table__).where(Row.run_id == run_id, Row.id == signoff_id)
    row = reader.execute(query).mappings().one_or_none()
    if row is None:
        raise not_found(f"sign-off of {run_name(run_id)} with the number", str(signoff_id))
    return _signoff(reader, row, results_digest(reader, run_id), _launcher(reader, run_id))


def _signoff(reader: sa.Connection, row: sa.RowMapping, digest: str, launcher: str) -> Signoff:
    stored = {name: value for name, value in row.items() if name != "run_id"}
    own = account_of(reader, row["user"]) == launcher
    return Signoff.model_validate(stored | {"current": row["digest"] == digest, "own": own})


def _launcher(reader: sa.Connection, run_id: int) -> str:
    """The account that launched a run, itself or by a token."""
    return account_of(reader, reader.scalar(sa.select(Run.owner).where(Run.id == run_id)) or "")


def _verdict(reader: sa.Connection, run_id: int) -> str | None:
    """The verdict of a run, or 404; 410 if it was purged."""
    refuse_purged(reader, run_id)
    found = reader.execute(sa.select(Run.verdict).where(Run.id == run_id)).one_or_none()
    if found is None:
        raise not_found("run", run_name(run_id))
    verdict: str | None = found.verdict
    return verdict


def _dependent(reader: sa.Connection, run_id: int, visitor: Visitor) -> RefusedError | None:
    """The refusal of whoever launched the run, unless an administrator permits that."""
    if _launcher(reader, run_id) != visitor.account or users.own_sign_offs(reader):
        return None
    return RefusedError(403, "own-run", f"you launched {run_name(run_id)}: another reviewer must sign it off")


def _barred(reader: sa.Connection, run_id: int, visitor: Visitor) -> str | None:
    refusals = (_dependent(reader, run_id, visitor), forbidden(visitor, SIGN))
    return "; ".join(refusal.detail for refusal in refusals if refusal is not None) or None


def _conflict(kind: str, detail: str) -> RefusedError:
    return RefusedError(409, kind, detail)
