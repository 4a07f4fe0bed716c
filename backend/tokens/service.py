"""Creating and revoking API tokens, each with its row in the audit trail."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db import access, audit
from backend.db.access import TokenInfo, Visitor
from backend.db.engine import now
from backend.http.errors import existing, not_found
from backend.tokens.schemas import NewToken, Token, TokenRequest

DAY = 86400.0


def listed(reader: sa.Connection, visitor: Visitor) -> list[Token]:
    """The visitor's tokens, for administrators all, newest first."""
    at = now(reader)
    return [_token(row, at) for row in reversed(access.tokens(reader, None if visitor.sees_all else visitor.account))]


def create(writer: sa.Connection, request: TokenRequest, visitor: Visitor) -> NewToken:
    """Create a token of the visitor's account; `AccessError` if the name is taken or the scope wider than the role."""
    lifetime = None if request.days is None else request.days * DAY
    secret = access.create_token(writer, request.name, visitor.account, request.scope, lifetime)
    detail = {"owner": visitor.account, "scope": request.scope, "days": request.days}
    audit.note(writer, visitor, "token.created", request.name, detail)
    return NewToken(token=_one(writer, request.name), secret=secret)


def revoke(engine: sa.Engine, name: str, visitor: Visitor) -> Token:
    """Revoke a token; 404 if there is none of that name, or it is another user's. Revoked ones are unchanged."""
    with engine.begin() as writer:
        token = _one(writer, name)
        if token.owner != visitor.account and not visitor.sees_all:
            raise not_found("token", name)
        if token.revoked is None:
            access.revoke_token(writer, name)
            audit.note(writer, visitor, "token.revoked", name, {"owner": token.owner})
        return _one(writer, name)


def _one(reader: sa.Connection, name: str) -> Token:
    found = next((row for row in access.tokens(reader) if row.name == name), None)
    return _token(existing(found, "token", name), now(reader))


def _token(row: TokenInfo, at: float) -> Token:
    expired = row.expires is not None and row.expires <= at
    state = "revoked" if row.revoked is not None else "expired" if expired else "active"
    return Token.model_validate({**row.__dict__, "state": state})
