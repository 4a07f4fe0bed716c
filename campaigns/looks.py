"""The appearance of components and methods: colour tokens, markers, shapes, and the parameters that give sizes.

A component or method declares its look, the catalogue contains it, and pages, scenes and reports use it, independent of
its name.
"""

from __future__ import annotations

from typing import Literal

from pydantic import ConfigDict

from campaigns.documented import Documented

Colour = Literal[
    "direct", "hybrid", "sqp", "ga", "global", "mc", "racing", "portfolio", "cma", "de", "mlsl", "nlopt", "direct-l",
    "nsga2", "lq", "turbo", "extra-1", "extra-2", "extra-3",
]  # fmt: skip
"""The token `--m-...` of the pages' theme. The extra ones are for methods of other packages."""

Marker = Literal[
    "square", "box", "diamond", "triangle", "down", "right", "circle", "hexagon", "pentagon", "star", "plus", "bow",
    "asterisk", "cross", "left", "hourglass", "ring",
]  # fmt: skip

Way = Literal["still", "goal", "waypoints", "orbit", "heading", "velocity"]


class Look(Documented):
    model_config = ConfigDict(extra="forbid", frozen=True)


class MethodLook(Look):
    """How a search method is drawn; each method should have its own pair of colour and marker."""

    colour: Colour
    """The token of its colour in both themes."""
    marker: Marker
    """The shape of its marker; the ring is for stages that do not search."""
    short: str = ""
    """Its name in narrow tables; empty: its title."""


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
