"""What the open health check says."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict


class Health(BaseModel):
    """Minimal, because anyone may ask."""

    model_config = ConfigDict(extra="forbid")

    status: Literal["ok"]
