"""Handles stored values of other versions whose form this version cannot read."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from pydantic import ValidationError

from backend.http.errors import RefusedError


@contextmanager
def readable(what: str) -> Iterator[None]:
    """Raise 409 if a stored value does not have the form of this version; `what` starts the sentence."""
    try:
        yield
    except ValidationError:
        detail = f"{what} was stored by another version of Clearance and can only be read by that version"
        raise RefusedError(409, "other-version", detail) from None
