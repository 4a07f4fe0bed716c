"""The appearance of components and methods: colours, markers, shapes, and the parameters that give sizes.

A component or method declares its look, the catalogue contains it, and pages, scenes and reports use it, independent of
its name.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, model_validator

from campaigns.documented import Documented

EXTRA = {
    "extra-1": ("#6b4f00", "#b59a4d"),
    "extra-2": ("#2e8b3d", "#6fcf7f"),
    "extra-3": ("#7d5a8c", "#b79ac4"),
}
"""Named pairs of colours, in the light and the dark theme, that no shipped method has."""

Marker = Literal[
    "square", "box", "diamond", "triangle", "down", "right", "circle", "hexagon", "pentagon", "star", "plus", "bow",
    "asterisk", "cross", "left", "hourglass", "shield", "ring",
]  # fmt: skip

Way = Literal["still", "goal", "waypoints", "orbit", "heading", "velocity"]


class Look(Documented):
    model_config = ConfigDict(extra="forbid", frozen=True)


class MethodLook(Look):
    """How a search method is drawn; each method should have its own colours and marker."""

    colour: Annotated[str, Field(pattern="^#[0-9a-f]{6}$")]
    """Its colour in the light theme and in reports, as #rrggbb."""
    dark: Annotated[str, Field(pattern="^#[0-9a-f]{6}$")]
    """Its colour in the dark theme."""
    marker: Marker
    """The shape of its marker; the ring is for stages that do not search."""
    short: str = ""
    """Its name in narrow tables; empty: its title."""

    @model_validator(mode="before")
    @classmethod
    def _named(cls, document: Any) -> Any:
        """The name of a pair in place of a colour stands for both; without a dark colour, both are the same."""
        if not isinstance(document, dict):
            return document
        light, dark = EXTRA.get(document.get("colour", ""), (document.get("colour"), document.get("colour")))
        return {**document, "colour": light, "dark": document.get("dark") or dark}


def readable(look: Any) -> Any:
    """A stored look; None for one of earlier versions, whose colour was the name of a shipped method's."""
    named = isinstance(look, dict) and str(look.get("colour", "")) not in EXTRA and "#" not in str(look.get("colour"))
    return None if named else look


class ObstacleLook(Look):
    """How an obstacle is drawn; sizes are named by the parameters that give them.

    `way`: by which parameters it moves. goal: from position straight to goal at speed; waypoints: from position along
    waypoint1 to at most waypoint4, legs of them, at speed; orbit: about centre at the radius way, from phase at speed,
    and climb along z; heading: from position at speed along heading and climb; velocity: from position at velocity.
    """

    shape: Literal["circle", "sphere", "cylinder", "rectangle", "box"]
    radius: str = ""
    """Of a circle, sphere or cylinder."""
    height: str = ""
    """Of a cylinder or box."""
    sides: tuple[str, ...] = ()
    """Length and width of a rectangle or box."""
    angle: str = ""
    """Of the first side, from the x axis towards the y axis."""
    way: Way = "still"

    @property
    def named(self) -> tuple[str, ...]:
        """The parameters that it needs."""
        return tuple(filter(None, (self.radius, self.height, *self.sides, self.angle)))


class VehicleLook(Look):
    """How a vehicle is drawn."""

    mesh: Literal["robot", "two_wheels", "aircraft"]
    heading: str = ""
    """The start state that is its heading from the x axis; empty where it has none."""

    @property
    def named(self) -> tuple[str, ...]:
        """The start states that it needs."""
        return (self.heading,) if self.heading else ()
