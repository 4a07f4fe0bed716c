"""Writes that a repeated request with the same Idempotency-Key does not do again.

An endpoint that makes something takes a `Once` and does its work in one of its transactions.
"""

from __future__ import annotations

import hashlib
import json
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar

import sqlalchemy as sa
from fastapi import Depends, Request
from pydantic import TypeAdapter, ValidationError

from backend.access.auth import CurrentVisitor
from backend.db.engine import read
from backend.http import keys
from backend.http.deps import Engine
from backend.http.errors import RefusedError
from backend.http.keys import Key, Keyed

Answer = TypeVar("Answer")
Work = Callable[[sa.Connection], Answer]
ONCE = ("idempotency-key-reused", "already-made")
"""The problems of a repeated request; in the `responses=` of each endpoint that takes a `Once`."""


@dataclass(frozen=True)
class Once:
    """A request whose work is done once for its key; without a key, each time. What is refused leaves no key."""

    engine: sa.Engine
    request: Keyed

    def do(
        self,
        kind: Any,
        work: Work[Answer],
        made: Callable[[Answer], str],
        present: Callable[[sa.Connection, Answer], Answer] | None = None,
    ) -> Answer:
        """The answer of the work, or the stored answer of the first request.

        kind: the type of the answer. work: writes in the given transaction. made: names what was made, for sentences.
        present: the present form of a stored answer, if that may contain less than the stored one.
        """
        answers: TypeAdapter[Answer] = TypeAdapter(kind)
        with self.engine.begin() as writer:
            row = keys.claimed(writer, self.request)
            if row is None:
                answer = work(writer)
                keys.keep(writer, self.request, made(answer), zlib.compress(answers.dump_json(answer)))
                return answer
        stored = self._stored(answers, row)
        if present is None:
            return stored
        with read(self.engine) as reader:
            return present(reader, stored)

    def do_secretly(self, work: Work[Answer], made: str, otherwise: str) -> Answer:
        """Do an operation whose answer has a secret, which is stored nowhere: a repeated request is refused (409).

        otherwise: what to do about it.
        """
        with self.engine.begin() as writer:
            row = keys.claimed(writer, self.request)
            if row is None:
                answer = work(writer)
                keys.keep(writer, self.request, made)
                return answer
        raise self._done(row.made, f"what it was answered with is shown only once: {otherwise}")

    def _stored(self, answers: TypeAdapter[Answer], row: sa.Row[Any]) -> Answer:
        detail = "its answer is no longer kept: read what it made"
        if row.answer is None:
            raise self._done(row.made, detail)
        try:
            return answers.validate_json(zlib.decompress(row.answer))
        except ValidationError:  # an earlier version answered in another form
            raise self._done(row.made, detail) from None

    def _done(self, made: str, detail: str) -> RefusedError:
        done = f"the request with the Idempotency-Key {self.request.key!r} was done already and made {made}; {detail}"
        return RefusedError("already-made", done)


async def _once(request: Request, engine: Engine, visitor: CurrentVisitor, key: Key = None) -> Once:
    operation = request.scope["route"].name
    digest = "" if key is None else _digest(request, await request.body())
    return Once(engine, Keyed(key, visitor.user, operation, digest))


def _digest(request: Request, body: bytes) -> str:
    head = json.dumps([request.path_params, request.url.query], sort_keys=True)
    return hashlib.sha256(head.encode() + b"\0" + body).hexdigest()


OnceOnly = Annotated[Once, Depends(_once)]
