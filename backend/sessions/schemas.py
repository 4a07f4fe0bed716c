"""The API schema of the session."""

from __future__ import annotations

from typing import Literal

from backend.http.schema import Schema


class SessionInfo(Schema):
    """The user who is signed in, and how they authenticated."""

    user: str
    via: Literal["link", "token"]
