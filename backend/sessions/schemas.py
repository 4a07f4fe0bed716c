"""What the API says of the visitor."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict


class SessionInfo(BaseModel):
    """Who is signed in, and how they came in."""

    model_config = ConfigDict(extra="forbid")

    user: str
    via: Literal["link", "token"]
