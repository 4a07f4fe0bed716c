"""What the API says of the visitor."""

from __future__ import annotations

from typing import Literal

from backend.http.schema import Schema


class SessionInfo(Schema):
    """Who is signed in, and how they came in."""

    user: str
    via: Literal["link", "token"]
