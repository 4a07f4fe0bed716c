"""What all results have in common: frozen, described by the lines below their fields, read from what was stored.

A field that an earlier version did not store has a default that says so. Start reading at `Result`.
"""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict

Values = dict[str, float]
"""Values by the path of a parameter, in its unit."""
Status = Literal["ok", "failed", "timeout", "excluded"]
"""How an evaluation ended."""
STATUS: tuple[Status, ...] = ("ok", "failed", "timeout", "excluded")
"""Its number, as evaluations store it, is the index."""
OK, FAILED, TIMEOUT, EXCLUDED = range(4)
MethodKind = Literal["global", "local", "random", "multi"]
"""How a search method searches."""
Worse = Literal["low", "high"]
"""Which end of a criterion is sought."""


class Result(BaseModel):
    """Part of what a run found. Unknown fields are ignored: a later version may have stored more."""

    model_config = ConfigDict(
        frozen=True, extra="ignore", use_attribute_docstrings=True, json_schema_serialization_defaults_required=True
    )


class Stop(Result):
    """How a search ended: by its own rule or by its budget, and in words."""

    kind: Literal["rule", "budget"]
    text: str
