"""What the open health check says."""

from __future__ import annotations

from typing import Literal

from backend.http.schema import Schema


class Health(Schema):
    """Minimal, because anyone may ask."""

    status: Literal["ok"]
