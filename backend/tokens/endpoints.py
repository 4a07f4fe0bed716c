"""GET and POST /tokens, DELETE of one: each change with its row in the audit trail."""

from __future__ import annotations

from typing import Annotated

import sqlalchemy as sa
from fastapi import APIRouter, Path, status

from backend.access.auth import CurrentVisitor
from backend.access.once import ONCE, OnceOnly
from backend.db import access, audit
from backend.db.access import TokenInfo, Visitor
from backend.db.engine import now
from backend.http.deps import Engine, Reader
from backend.http.errors import not_found, problems
from backend.tokens.schemas import NewToken, Token, TokenRequest

router = APIRouter(tags=["tokens"])

DAY = 86400.0
TokenName = Annotated[str, Path(max_length=64, description="The token by name.")]


@router.get("/tokens")
def list_tokens(visitor: CurrentVisitor, reader: Reader) -> list[Token]:
    """Your API tokens, newest first; for administrators those of all users."""
    at = now(reader)
    return [_token(row, at) for row in reversed(access.tokens(reader, None if visitor.sees_all else visitor.account))]


@router.post("/tokens", status_code=status.HTTP_201_CREATED, responses=problems("access-conflict", *ONCE))
def create_token(request: TokenRequest, once: OnceOnly, visitor: CurrentVisitor) -> NewToken:
    """Create an API token of your own; the answer is the only one that holds its secret."""
    made, otherwise = f"the token {request.name!r}", "revoke it and make another, with another name and key"
    return once.do_secretly(lambda writer: _created(writer, request, visitor), made, otherwise)


@router.delete("/tokens/{token}", responses=problems("not-found"))
def revoke_token(token: TokenName, engine: Engine, visitor: CurrentVisitor) -> Token:
    """Revoke a token at once: your own, for administrators any."""
    with engine.begin() as writer:
        found = _one(writer, token)
        if found.owner != visitor.account and not visitor.sees_all:
            raise not_found("token", token)
        if found.revoked is None:
            access.revoke_token(writer, token)
            audit.note(writer, visitor, "token.revoked", token, {"owner": found.owner})
        return _one(writer, token)


def _created(writer: sa.Connection, request: TokenRequest, visitor: Visitor) -> NewToken:
    """Create a token of the visitor's account; `AccessError` if the name is taken or the scope wider than the role."""
    lifetime = None if request.days is None else request.days * DAY
    secret = access.create_token(writer, request.name, visitor.account, request.scope, lifetime)
    detail = {"owner": visitor.account, "scope": request.scope, "days": request.days}
    audit.note(writer, visitor, "token.created", request.name, detail)
    return NewToken(token=_one(writer, request.name), secret=secret)


def _one(reader: sa.Connection, name: str) -> Token:
    found = next((row for row in access.tokens(reader) if row.name == name), None)
    if found is None:
        raise not_found("token", name)
    return _token(found, now(reader))


def _token(row: TokenInfo, at: float) -> Token:
    expired = row.expires is not None and row.expires <= at
    state = "revoked" if row.revoked is not None else "expired" if expired else "active"
    return Token.model_validate({**row.__dict__, "state": state})
