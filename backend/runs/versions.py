"""What another version stored in a shape that this one does not read. Start reading at `readable`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from pydantic import ValidationError

from backend.http.errors import RefusedError


@contextmanager
def readable(what: str) -> Iterator[None]:
    """409 where a stored value does not have the shape that this version reads; `what` begins the sentence."""
    try:
        yield
    except ValidationError:
        told = f"{what} was stored by another version of Clearance and can only be read by that version"
        raise RefusedError(409, "other-version", told) from None
