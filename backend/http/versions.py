"""Handles stored values of other versions, or damaged ones, whose form this version cannot read."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import sqlalchemy as sa
from pydantic import ValidationError

from backend.db.tables import Run
from backend.http.errors import RefusedError
from campaigns.version import VERSION


@contextmanager
def readable(what: str, reader: sa.Connection | None = None, run_id: int | None = None) -> Iterator[None]:
    """Raise 409 if a stored value does not have the form of this version; `what` starts the sentence.

    reader, run_id: of the run that it belongs to, whose version the sentence then names.
    """
    try:
        yield
    except ValidationError:
        executed_by = sa.select(Run.flown["clearance"].as_string()).where(Run.id == run_id)
        ran = None if reader is None else reader.scalar(executed_by)
        known = f" (version {ran} executed the run)" if ran else ""
        detail = (
            f"{what} cannot be read by this version, {VERSION}: another version of Clearance stored it, or it is "
            f"damaged{known}. Read it with the version that stored it, or restore a backup of the database"
        )
        raise RefusedError("other-version", detail) from None
