"""The schemas of an evaluation of a simulator on request."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from backend.flights.schemas import MOST_ROWS, FlightAnswer, Uuid
from backend.http.schema import Finite, Given, Schema
from backend.scenes.base.address import FLIGHT


class CaseRequest(Given):
    """Which case of the run's simulator to evaluate; nothing of it is stored."""

    parameters: Annotated[dict[str, Finite], Field(max_length=500, default_factory=dict)]
    """{path: value} of any parameters of the simulator, within its limits; others as `like`."""
    like: Annotated[str, Field(pattern=rf"^({FLIGHT})$")] = "nominal"
    """`nominal`, or the label of a finding: omitted parameters have its values."""
    view: Uuid | None = None
    """The key of an open 3D view of this visitor: the case is drawn there as the what-if."""
    client: Uuid | None = None
    """Identifies the client: a newer request of the same client supersedes an older one. If omitted: the view, or
    without one the session or token."""
    rows: Annotated[int, Field(ge=0, le=MOST_ROWS)] = 0
    """Approximate number of rows of the returned trace; 0 for none."""


class CaseAnswer(FlightAnswer):
    """An evaluated case of a simulator: one call, no evidence. `seed` is null."""

    seconds: float
    """Time of this evaluation [s], in a process that had been started before."""
    untraced: str
    """Why there is no trace, although the simulator declares one; empty otherwise."""


class CaseInstalled(Schema):
    """Whether cases of a run's simulator can be evaluated on the machine of the service."""

    installed: bool
    reason: str
    """Why not, a sentence without a full stop; empty if it is installed."""
