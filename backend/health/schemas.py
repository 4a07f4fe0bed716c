"""The API schema of the health check."""

from __future__ import annotations

from typing import Literal

from backend.http.schema import Schema


class Health(Schema):
    """Minimal, because no authentication is required."""

    status: Literal["ok"]
