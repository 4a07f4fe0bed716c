"""The API schema of a request to re-weight a sample."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from backend.http.schema import Given
from campaigns.asked.distributions import Uncertain


class ReweightRequest(Given):
    """Distributions in place of the stated ones; correlations stay as stated."""

    uncertain: Annotated[dict[str, Uncertain], Field(max_length=500, default_factory=dict)]
    """{path: bounds and distribution}, as in a campaign; parameters that are omitted stay as stated."""
