"""What the API says of an open 3D view. Start reading at `ViewChange`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from backend.http.schema import Given, Schema
from backend.scenes.base.address import FLIGHT, Camera
from campaigns.asked.spec import MAX_SEED

Theme = Literal["light", "dark"]
Trails = Literal["whole", "so_far"]
WhatIfSource = Literal["page", "space"]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Point = tuple[Finite, Finite, Finite]
SPEEDS = (0.25, 0.5, 1.0, 2.0, 5.0)
VALUE, NONE = "value", "none"
"""Axes of the parameter space that are no parameter: the criterion's value, and none."""


class Eye(Schema):
    """A place of the visitor's own to look from, and what is looked at, as drawn [m]."""

    position: Point
    target: Point


class Layers(Schema):
    """What is drawn."""

    nominal: bool
    finding: bool
    what_if: bool
    velocity: bool
    relative: bool
    """The relative velocity."""
    trail: Trails
    sampled: bool
    field: bool
    """The avoider's field."""
    space: bool
    """The parameter space in place of the flights."""
    axes: tuple[str, str, str]
    """Of the parameter space: paths of uncertain parameters, `value` for the criterion's, or `none`."""


class LayersChange(Given):
    """What is to be drawn otherwise; what is left out stays."""

    nominal: bool | None = None
    finding: bool | None = None
    what_if: bool | None = None
    velocity: bool | None = None
    relative: bool | None = None
    trail: Trails | None = None
    sampled: bool | None = None
    field: bool | None = None
    space: bool | None = None
    axes: tuple[str, str, str] | None = None


class ViewChange(Given):
    """What is to be shown otherwise; what is left out stays. Going to a time stops the play unless told to."""

    flight: Annotated[str, Field(pattern=rf"^({FLIGHT})$")] | None = None
    """A finding's label; `nominal` for the nominal flight alone."""
    time: Annotated[Finite, Field(ge=0)] | None = None
    """[s] since the start; held at the horizon."""
    step: Finite | None = None
    """[s] from `time`, or from the time shown; held at start and horizon."""
    passing: bool = False
    """The time is pointed at in passing: a view that plays goes on and leaves it."""
    closest: bool = False
    """Go to the closest approach of the worst flight shown."""
    camera: Camera | None = None
    eye: Eye | None = None
    """A place of one's own instead of a camera by name."""
    playing: bool | None = None
    speed: Finite | None = None
    """Seconds of the flight in a second: 0.25, 0.5, 1, 2 or 5."""
    theme: Theme | None = None
    panel: bool | None = None
    """Show the view's own panel, or fold it."""
    layers: LayersChange | None = None
    what_if: dict[str, Finite] | None = None
    """Simulate the case with these uncertain parameters by path, the others nominal, and draw it as the what-if.

    `POST /runs/{run}/flights` draws it, too, and answers with its numbers."""
    what_if_seed: Annotated[int, Field(ge=0, lt=MAX_SEED)] | None = None
    """The noise seed of that flight, as a finding reports the one it drew; null for those that the campaign states."""

    @model_validator(mode="after")
    def _one_time(self) -> ViewChange:
        if self.closest and (self.time is not None or self.step is not None):
            raise ValueError("either the closest approach, or a time with or without a step")
        return self

    @model_validator(mode="after")
    def _seed_of_a_flight(self) -> ViewChange:
        if self.what_if_seed is not None and self.what_if is None:
            raise ValueError("what_if_seed goes with the parameters of a what_if flight")
        return self

    @model_validator(mode="after")
    def _one_camera(self) -> ViewChange:
        if self.camera is not None and self.eye is not None:
            raise ValueError("either a camera by name, or an eye")
        return self

    @model_validator(mode="after")
    def _known_speed(self) -> ViewChange:
        if self.speed is not None and self.speed not in SPEEDS:
            raise ValueError(f"speed is one of {', '.join(f'{speed:g}' for speed in SPEEDS)}, given {self.speed:g}")
        return self


class ViewState(Schema):
    """What an open view shows: `camera` is null once the visitor has moved it, `time` is [s] since the start."""

    opened: float
    """When this view was opened [s since 1970]; one whose socket was lost is opened anew, as its address says."""
    revision: int
    """Grows with everything that is shown otherwise, and from one view of a key to the next."""
    flight: str
    time: float
    camera: Camera | None
    eye: Eye | None
    """Where the visitor looks from; null where `camera` says it."""
    playing: bool
    speed: float
    theme: Theme
    panel: bool
    """Whether its panel was last shown or folded by a page; where no page has, one that a page opened is folded."""
    layers: Layers
    what_if: dict[str, float] | None
    """The parameters of the what-if flight that is drawn; null where there is none."""
    what_if_seed: int | None
    """Its noise seed, where it has one of its own; null for those that the campaign states."""
    what_if_source: WhatIfSource | None
    """Who chose it: a page, or the visitor by a click on an evaluation in the parameter space."""
