"""What users may change of others: nothing, unless they are administrators."""

from __future__ import annotations

from backend.db.access import Visitor
from backend.http.errors import RefusedError


def owns(visitor: Visitor, owner: str) -> bool:
    return visitor.sees_all or owner == visitor.account


def require_own(visitor: Visitor, owner: str | None, what: str) -> None:
    """Raise 403 unless the visitor's account owns it, itself or by a token, or the visitor is an administrator.

    owner: None where there is no such thing, which the caller reports.
    """
    if owner is None or owns(visitor, owner):
        return
    detail = (
        f"{what} belongs to {owner or 'another user'}, and you are {visitor.account}: only its owner and an "
        "administrator may change it"
    )
    raise RefusedError("not-yours", detail)
