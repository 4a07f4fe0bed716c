"""The API schemas of an open 3D view."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from backend.http.schema import Finite, Given, Instant, Schema
from backend.scenes.base.address import FLIGHT, Camera
from campaigns.asked.scenario import MAX_REALISATION

Theme = Literal["light", "dark"]
Trails = Literal["whole", "so_far"]
Point = tuple[Finite, Finite, Finite]
SPEEDS = (0.25, 0.5, 1.0, 2.0, 5.0)


class Eye(Schema):
    """A free camera: position and target in scene coordinates [m]."""

    position: Point
    target: Point


class Layers(Schema):
    """The visible layers."""

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


class LayersChange(Given):
    """Changes of the visible layers; omitted fields stay unchanged."""

    nominal: bool | None = None
    finding: bool | None = None
    what_if: bool | None = None
    velocity: bool | None = None
    relative: bool | None = None
    trail: Trails | None = None
    sampled: bool | None = None
    """Simulates or evaluates them when first shown."""
    field: bool | None = None
    """Simulated for every displayed time."""


class ViewChange(Given):
    """A change of a view; omitted fields stay unchanged. Setting a time pauses playback unless `playing` is set."""

    flight: Annotated[str, Field(pattern=rf"^({FLIGHT})$")] | None = None
    """A finding's label; `nominal` for the nominal flight alone."""
    time: Annotated[Finite, Field(ge=0)] | None = None
    """[s] since the start; clipped to the horizon."""
    step: Finite | None = None
    """[s] relative to `time`, or to the displayed time; clipped to start and horizon."""
    passing: bool = False
    """The time is only hovered: a view that is playing ignores it."""
    closest: bool = False
    """Go to the closest approach of the worst flight shown."""
    camera: Camera | None = None
    eye: Eye | None = None
    """A free camera instead of a named one."""
    playing: bool | None = None
    speed: Finite | None = None
    """Playback speed: 0.25, 0.5, 1, 2 or 5."""
    theme: Theme | None = None
    panel: bool | None = None
    """Show or fold the view's own panel."""
    layers: LayersChange | None = None
    what_if: dict[str, Finite] | None = None
    """Simulate the case with these uncertain parameters by path, the others nominal, and draw it as the what-if.

    `POST /runs/{run}/flights` also draws it, and returns its numbers."""
    what_if_seed: Annotated[int, Field(ge=0, lt=MAX_REALISATION)] | None = None
    """The noise seed of that flight, such as that of a finding; null for those of the campaign."""

    @property
    def simulates(self) -> bool:
        """Whether the view simulates or evaluates something for it."""
        layers = self.layers or LayersChange()
        return self.what_if is not None or bool(layers.sampled or layers.field)

    @model_validator(mode="after")
    def _consistent(self) -> ViewChange:
        if self.closest and (self.time is not None or self.step is not None):
            raise ValueError("either the closest approach, or a time with or without a step")
        if self.what_if_seed is not None and self.what_if is None:
            raise ValueError("what_if_seed goes with the parameters of a what_if flight")
        if self.camera is not None and self.eye is not None:
            raise ValueError("either a camera by name, or an eye")
        if self.speed is not None and self.speed not in SPEEDS:
            raise ValueError(f"speed is one of {', '.join(f'{speed:g}' for speed in SPEEDS)}, given {self.speed:g}")
        return self


class ViewState(Schema):
    """What an open view shows: `camera` is null once the visitor has moved it, `time` is [s] since the start."""

    opened: Instant
    """Time at which this view was opened [s since 1970]; after a lost connection it is reopened from its address."""
    revision: int
    """Increases with every change of the display, and from one view of a key to the next."""
    flight: str
    time: float
    horizon: float
    """The end of the time [s]."""
    camera: Camera | None
    eye: Eye | None
    """The free camera; null if `camera` is set."""
    playing: bool
    speed: float
    theme: Theme
    panel: bool
    """Whether a page last showed or folded its panel; initially folded in a view that a page opened."""
    layers: Layers
    what_if: dict[str, float] | None
    """The parameters of the drawn what-if flight; null if there is none."""
    what_if_seed: int | None
    """Its noise seed; null for those of the campaign."""
