"""The schemas of a simulation on request."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from backend.catalog.schemas import CriterionOut
from backend.http.schema import Finite, Given, Schema
from backend.scenes.base.address import FLIGHT, KEY
from campaigns.asked.scenario import MAX_REALISATION
from campaigns.results.base import Status
from campaigns.results.trace import TraceColumn, TraceHead

MOST_ROWS = 2000
Uuid = Annotated[str, Field(pattern=f"^{KEY}$")]


class FlightRequest(Given):
    """Which flight of the run's scenario to simulate; nothing of it is stored."""

    parameters: Annotated[dict[str, Finite], Field(max_length=500, default_factory=dict)]
    """{path: value} of any parameters of the scenario, within their components' limits; others as `like`."""
    like: Annotated[str, Field(pattern=rf"^({FLIGHT})$")] = "nominal"
    """`nominal`, or the label of a finding: omitted parameters have its values."""
    seed: Annotated[int, Field(ge=0, lt=MAX_REALISATION)] | None = None
    """One noise realisation; if omitted, that of the finding if it has its own, else those of the campaign."""
    view: Uuid | None = None
    """The key of an open 3D view of this visitor: the flight is drawn there as the what-if."""
    client: Uuid | None = None
    """Identifies the client: a newer request of the same client supersedes an older one. If omitted: the view, or
    without one the session or token."""
    rows: Annotated[int, Field(ge=0, le=MOST_ROWS)] = 0
    """Approximate number of rows of the returned time series; 0 for none."""


class FlightValue(CriterionOut):
    """A criterion, and its value in this simulation in its own sign and unit; null if there is none."""

    value: float | None


class FlightAnswer(Schema):
    """A simulated flight. `cost`, `threshold` and `margin` refer to the first criterion, which decides."""

    run: str
    status: Status
    reason: str
    """The reason why the status is not ok, a sentence."""
    cost: float | None
    """Bit-identical to the cost of evaluations and findings; null unless the status is ok."""
    threshold: float
    margin: float | None
    """The cost minus the threshold: clear above 0."""
    quantity: str
    unit: str
    """The unit of cost, threshold and margin."""
    criteria: list[FlightValue]
    like: str
    parameters: dict[str, float]
    """The simulated values of the uncertain parameters and of the given ones."""
    seed: int | None
    """The noise seed that was requested, or that of the finding; null for those of the campaign."""
    code_changes: list[str]
    """What differs between the code that simulated it, which is the installed one, and that of the run: own files,
    packages, modules of the engine."""
    code_known: bool
    """Whether the code of both is identified; if not, it may differ as well."""
    drawn: str | None
    """The key of the 3D view that shows the flight; null if none is open."""
    trace: TraceHead
    columns: list[TraceColumn]
    data: dict[str, list[float | None]]
    """The time series by column; empty unless `rows` were requested."""
