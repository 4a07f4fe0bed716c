"""Sign-offs of a run's results and their withdrawal; a sign-off is bound to the digest of the results.

Each write includes its row in the audit trail, in one transaction.
"""

from __future__ import annotations

import sqlalchemy as sa

from backend.access.auth import forbidden
from backend.access.own import require_own
from backend.access.rules import SIGN
from backend.db import audit, numbers, users
from backend.db.access import Visitor
from backend.db.digest import results_digest
from backend.db.engine import now, once
from backend.db.signed import signer
from backend.db.tables import Run
from backend.db.tables import Signoff as Row
from backend.http.errors import RefusedError, not_found
from backend.runs.removal import refuse_removed
from backend.runs.service import require
from backend.runs.violations import against, ways
from backend.signoffs.persons import folded, person, signs_as
from backend.signoffs.schemas import Signoff, SignoffRequest, Signoffs
from backend.signoffs.standing import UNSIGNED, signatures
from backend.signoffs.texts import texts
from campaigns import Problem
from campaigns.runs import run_name


def listed(reader: sa.Connection, run_id: int, visitor: Visitor | None = None) -> Signoffs:
    """The sign-offs of a run, with those that it carries on, oldest first, and why the visitor, if given, may not add
    one; 404 without such a run."""
    found = once(reader, ("signoffs", run_id), lambda: _listed(reader, run_id))
    if visitor is None:
        return found
    barred = _barred(reader, run_id, visitor, found.digest)
    return found.model_copy(update={"barred": barred, "signs_as": signs_as(reader, visitor)})


def _listed(reader: sa.Connection, run_id: int) -> Signoffs:
    verdict = _verdict(reader, run_id)
    removed = reader.scalar(sa.select(Run.removed).where(Run.id == run_id)) is not None
    digest = results_digest(reader, run_id)
    signed = signatures(reader, [run_id]).get(run_id, UNSIGNED)
    items = [one.signoff() for one in signed.signatures]
    can_sign = verdict is not None and not removed
    return Signoffs(
        digest=digest,
        can_sign=can_sign,
        texts=texts(reader, [run_id]).of_run(run_id),
        against=_against(reader, run_id),
        not_carried=signed.not_carried,
        items=items,
    )


def sign(writer: sa.Connection, run_id: int, review: SignoffRequest, visitor: Visitor) -> Signoff:
    """Sign off the results. 409 without a verdict, for other results, for a repetition, and for a removed run.

    403 for the user who launched the run, unless an administrator permits it; then the sign-off states so (`own`).
    """
    refuse_removed(writer, run_id)  # locks the run, so that two sign-offs at the same time take turns
    if _verdict(writer, run_id) is None:
        raise RefusedError("no-verdict", f"{run_name(run_id)} has no verdict: it cannot be signed off")
    name = _name(writer, review, visitor)
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
        raise RefusedError("results-changed", detail)
    repeated = _repeated(writer, run_id, visitor.account, name, digest)
    if repeated is not None:
        raise repeated
    values = {"run_id": run_id, "name": name, "role": review.role, "comment": review.comment, "digest": digest}
    values |= {"user": visitor.user, "account": visitor.account, "created": now(writer)}
    values["texts"] = _reviewed(writer, run_id, review)
    values["known"] = _known(writer, run_id, review)
    values |= numbers.following(writer, Row)
    signoff_id = writer.execute(sa.insert(Row).values(**values).returning(Row.id)).scalar_one()
    signed = signer(visitor.account, name)
    noted = {"signoff": signoff_id, **review.model_dump(exclude={"texts"}), **signed._asdict()} | (
        {"own": True} if own else {}
    )
    audit.note(writer, visitor, "signoff.created", run_name(run_id), noted)
    return one(writer, run_id, signoff_id)


def _reviewed(writer: sa.Connection, run_id: int, review: SignoffRequest) -> dict[str, str]:
    """The texts that the sign-off is bound to; 409 if the reviewer read others."""
    now = texts(writer, [run_id]).of_run(run_id)
    if review.texts is not None and review.texts != now:
        (other, *_) = sorted(key for key in now.keys() | review.texts.keys() if now.get(key) != review.texts.get(key))
        raise RefusedError(
            "text-changed", f"the text of {other} has changed since the review: read it again, then sign"
        )
    return now


def _against(reader: sa.Connection, run_id: int) -> dict[str, str]:
    return ways(against(reader, [run_id]).get(run_id, ()))


def _known(writer: sa.Connection, run_id: int, review: SignoffRequest) -> dict[str, str] | None:
    """The runs in whose knowledge it is signed; 409 if the reviewer saw others, 422 without a reason."""
    if review.against is None:
        return None
    now = _against(writer, run_id)
    if review.against != now:
        detail = f"which runs speak against {run_name(run_id)} has changed since the review: read it again, then sign"
        raise RefusedError("results-changed", detail)
    if now and not review.comment:
        detail = "other runs speak against this verdict: state in the comment why it is signed off all the same"
        raise RefusedError("invalid-request", detail, [Problem("comment", "", detail)])
    return now


def withdraw(engine: sa.Engine, run_id: int, signoff_id: int, reason: str, visitor: Visitor) -> Signoff:
    """Withdraw a sign-off with a reason; it stays on record. 404 if there is none, 403 if it is another user's, 409 if
    it is already withdrawn.
    """
    with engine.begin() as writer:
        mine = (Row.run_id == run_id, Row.id == signoff_id)
        account = writer.scalar(sa.select(Row.account).where(*mine).with_for_update())
        standing = one(writer, run_id, signoff_id)
        require_own(visitor, account, f"sign-off {signoff_id} of {run_name(run_id)}")
        if standing.withdrawn is not None:
            raise RefusedError("withdrawn", f"this sign-off was already withdrawn by {standing.withdrawn_by}")
        values = {"withdrawn": now(writer), "withdrawn_by": visitor.user, "withdrawn_reason": reason}
        writer.execute(sa.update(Row).where(Row.id == signoff_id).values(**values))
        detail = {"signoff": signoff_id, "reason": reason}
        audit.note(writer, visitor, "signoff.withdrawn", run_name(run_id), detail)
        return one(writer, run_id, signoff_id)


def one(reader: sa.Connection, run_id: int, signoff_id: int) -> Signoff:
    """A sign-off of a run's own results as it is now; 404 if there is none."""
    _verdict(reader, run_id)
    for signature in signatures(reader, [run_id]).get(run_id, UNSIGNED).signatures:
        if signature.row.id == signoff_id and signature.row.run_id == run_id:
            return signature.signoff()
    raise not_found(f"sign-off of {run_name(run_id)} with the number", str(signoff_id))


def _name(reader: sa.Connection, review: SignoffRequest, visitor: Visitor) -> str:
    """The typed name; empty for an account, which signs under its own. 422 for a name of which there is no need."""
    account = signs_as(reader, visitor)
    if account is None:
        if review.name is not None:
            return review.name
        detail = "this service has no accounts: give the name of the person who signs"
    elif review.name in (None, account):
        return ""
    else:
        detail = f"{account} is signed in, and the sign-off is under that name: leave `name` out"
    raise RefusedError("invalid-request", detail, [Problem("name", review.name or "", detail)])


def _repeated(reader: sa.Connection, run_id: int, account: str, name: str, digest: str) -> RefusedError | None:
    """The refusal of a second sign-off by the same person; name: as typed, empty for an account."""
    rows = reader.execute(sa.select(Row).where(Row.run_id == run_id, Row.digest == digest, Row.withdrawn.is_(None)))
    for row in rows:
        if person(row) == (True, folded(name)) if name else row.account == account:
            who = signer(row.account, row.name).name
            detail = f"{who} has already signed off these results, as {row.role}: withdraw that sign-off to sign again"
            return RefusedError("already-signed", detail)
    return None


def _launcher(reader: sa.Connection, run_id: int) -> str:
    """The account that launched a run, itself or by a token."""
    return reader.scalar(sa.select(Run.owner).where(Run.id == run_id)) or ""


def _verdict(reader: sa.Connection, run_id: int) -> str | None:
    """The verdict of a run, or 404; 410 if it was purged."""
    require(reader, run_id)
    return reader.scalar(sa.select(Run.verdict).where(Run.id == run_id))


def _dependent(reader: sa.Connection, run_id: int, visitor: Visitor) -> RefusedError | None:
    """The refusal of whoever launched the run, unless an administrator permits that."""
    if _launcher(reader, run_id) != visitor.account or users.own_sign_offs(reader):
        return None
    return RefusedError("own-run", f"you launched {run_name(run_id)}: another reviewer must sign it off")


def _barred(reader: sa.Connection, run_id: int, visitor: Visitor, digest: str) -> str | None:
    refusals = [_dependent(reader, run_id, visitor), forbidden(visitor, SIGN)]
    if signs_as(reader, visitor) is not None:
        refusals.append(_repeated(reader, run_id, visitor.account, "", digest))
    return "; ".join(refusal.detail for refusal in refusals if refusal is not None) or None
