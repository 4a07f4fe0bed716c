"""The schemas of a simulation on request. Start reading at `FlightRequest` and `FlightAnswer`."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from backend.catalog.schemas import CriterionOut
from backend.http.schema import Given, Schema
from backend.scenes.base.address import FLIGHT, KEY
from campaigns.asked.spec import MAX_SEED
from campaigns.results.base import Status
from campaigns.results.trace import TraceColumn, TraceHead

MOST_ROWS = 2000
Finite = Annotated[float, Field(allow_inf_nan=False)]
Uuid = Annotated[str, Field(pattern=f"^{KEY}$")]


class FlightRequest(Given):
    """Which flight of the run's scenario to simulate; nothing of it is stored."""

    parameters: Annotated[dict[str, Finite], Field(max_length=500, default_factory=dict)]
    """{path: value} of any parameters of the scenario, each within its component's limits; all others as `like`."""
    like: Annotated[str, Field(pattern=rf"^({FLIGHT})$")] = "nominal"
    """`nominal`, or the label of a finding: the parameters that are not given have its values."""
    seed: Annotated[int, Field(ge=0, lt=MAX_SEED)] | None = None
    """One noise realisation; left out: that of the finding where it drew its own, else those of the campaign."""
    view: Uuid | None = None
    """The key of an open 3D view of this visitor: the flight is drawn there as the what-if."""
    client: Uuid | None = None
    """Who asks, where several ask at once: a newer request of the same client overtakes an older one. Left out: the
    view; without one, the session or token."""
    rows: Annotated[int, Field(ge=0, le=MOST_ROWS)] = 0
    """The time series is answered with about so many rows; 0 for none."""


class FlightValue(CriterionOut):
    """A criterion, and its value in this simulation in its own sign and unit; null if there is none."""

    value: float | None


class FlightAnswer(Schema):
    """A simulated flight. The first criterion decides: `cost`, `threshold` and `margin` are of it."""

    run: str
    status: Status
    reason: str
    """Why the status is not ok, a sentence."""
    cost: float | None
    """As evaluations and findings have it, bit by bit; null unless the status is ok."""
    threshold: float
    margin: float | None
    """The cost less the threshold: above 0 is clear."""
    quantity: str
    unit: str
    """Of cost, threshold and margin."""
    criteria: list[FlightValue]
    like: str
    parameters: dict[str, float]
    """Of the uncertain parameters, and of those that were given, as they were simulated."""
    seed: int | None
    """The requested noise realisation, or that of the finding; null for those of the campaign."""
    drawn: str | None
    """The key of the 3D view that shows the flight, as far as it moved; null where none is open."""
    trace: TraceHead
    columns: list[TraceColumn]
    data: dict[str, list[float | None]]
    """The time series by column; empty unless `rows` were requested."""
