"""GET and POST /tokens, DELETE of one."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, status

from backend.access.auth import CurrentVisitor
from backend.access.once import ONCE, OnceOnly
from backend.http.deps import Engine, Reader
from backend.http.errors import problems
from backend.tokens import service
from backend.tokens.schemas import NewToken, Token, TokenRequest

router = APIRouter(tags=["tokens"])

TokenName = Annotated[str, Path(max_length=64, description="The token by name.")]


@router.get("/tokens")
def list_tokens(visitor: CurrentVisitor, reader: Reader) -> list[Token]:
    """Your API tokens, newest first; for administrators those of all users."""
    return service.listed(reader, visitor)


@router.post(
    "/tokens",
    status_code=status.HTTP_201_CREATED,
    responses=problems("access-conflict", *ONCE),
)
def create_token(request: TokenRequest, once: OnceOnly, visitor: CurrentVisitor) -> NewToken:
    """Create an API token of your own; the answer is the only one that holds its secret."""
    made, otherwise = f"the token {request.name!r}", "revoke it and make another, with another name and key"
    return once.do_secretly(lambda writer: service.create(writer, request, visitor), made, otherwise)


@router.delete("/tokens/{token}", responses=problems("not-found"))
def revoke_token(token: TokenName, engine: Engine, visitor: CurrentVisitor) -> Token:
    """Revoke a token at once: your own, for administrators any."""
    return service.revoke(engine, token, visitor)
