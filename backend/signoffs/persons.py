"""One person signs once: by the account, or without accounts by the name as typed, whatever its case or spaces."""

from __future__ import annotations

import unicodedata
from typing import Any

import sqlalchemy as sa

from backend.db import users
from backend.db.access import Visitor
from backend.db.roles import LOCAL
from backend.db.signed import signer
from campaigns.alike import plain


def signs_as(reader: sa.Connection, visitor: Visitor) -> str | None:
    """The account under which a visitor signs; None while `local` is the only user, so that a name is typed."""
    return None if visitor.account == LOCAL and users.only_local(reader) else visitor.account


def person(row: Any) -> tuple[bool, str]:
    """Equal for two sign-offs of one person, as far as the service can tell."""
    name, typed = signer(row.account, row.name)
    return typed, folded(name) if typed else name


def folded(name: str) -> str:
    """Equal for names that a reader would take for the same: case, spaces, punctuation and the form of characters are
    no difference."""
    text = plain(name)
    return "".join(character for character in text if unicodedata.category(character)[0] not in "PSZ") or text
