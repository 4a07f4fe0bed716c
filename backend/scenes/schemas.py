"""What the API says of an open 3D view. Start reading at `ViewChange`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from backend.scenes.address import FLIGHT, Camera

Theme = Literal["light", "dark"]
Seconds = Annotated[float, Field(allow_inf_nan=False)]


class Schema(BaseModel):
    model_config = ConfigDict(extra="forbid")


class ViewChange(Schema):
    """What is to be shown otherwise; what is left out stays. Going to a time stops the play unless told to."""

    flight: Annotated[str, Field(pattern=rf"^({FLIGHT})$")] | None = None
    """A finding's label; `nominal` for the nominal flight alone."""
    time: Annotated[Seconds, Field(ge=0)] | None = None
    """[s] since the start; held at the horizon."""
    step: Seconds | None = None
    """[s] from `time`, or from the time shown; held at start and horizon."""
    passing: bool = False
    """The time is pointed at in passing: a view that plays goes on and leaves it."""
    closest: bool = False
    """Go to the closest approach of the worst flight shown."""
    camera: Camera | None = None
    playing: bool | None = None
    theme: Theme | None = None

    @model_validator(mode="after")
    def _one_time(self) -> ViewChange:
        if self.closest and (self.time is not None or self.step is not None):
            raise ValueError("either the closest approach, or a time with or without a step")
        return self


class ViewState(Schema):
    """What an open view shows: `camera` is null once the visitor has moved it, `time` is [s] since the start."""

    opened: float
    """When this view was opened [s since 1970]; one whose socket was lost is opened anew, as its address says."""
    flight: str
    time: float
    camera: Camera | None
    playing: bool
    theme: Theme
