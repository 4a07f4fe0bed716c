"""Draws velocities as arrows: of vehicles and moving obstacles, over ground and relative.

The length of an arrow is the distance travelled in `ahead` seconds, the same for all arrows of a scene. The relative
velocity is the vehicle's minus that of the obstacle with the nearest centre: at constant velocities it is the vehicle's
path as seen from the obstacle.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import viser

from backend.scenes.base.axes import Floats
from backend.scenes.base.palette import Palette, Rgb, linear, rgb, shade
from backend.scenes.base.part import Part
from backend.scenes.base.setting import Setting
from backend.scenes.drawing import shapes
from backend.scenes.drawing.bodies import nearest
from backend.scenes.drawing.drawn import Drawn
from backend.scenes.drawing.flights import Flights
from backend.scenes.drawing.labels import Label, Tag
from backend.scenes.drawing.solids import Solids
from backend.scenes.drawing.world import World

LENGTH = 2.5
"""Approximate length of the arrow of a typical velocity [vehicle lengths]."""
HEAD = 0.3
"""Length of an arrow's head; shorter arrows are omitted [vehicle lengths]."""
WIDTH = 3.5
"""Line width [pixels]."""


def speeds(drawn: Drawn, time: float) -> tuple[float, float | None]:
    """Speeds of the flight at a time [m/s]: over ground, and relative to the nearest obstacle, None without one."""
    assert drawn.flight is not None
    relative = relative_velocity(drawn, time)
    ground = float(np.linalg.norm(drawn.flight.velocity(time)))
    return ground, None if relative is None else float(np.linalg.norm(relative))


def relative_velocity(drawn: Drawn, time: float) -> Floats | None:
    """The vehicle's velocity minus that of the nearest obstacle (3,) [m/s]; None without an obstacle."""
    assert drawn.flight is not None
    body = nearest(drawn.bodies, drawn.flight.at(time)[0], time)
    return None if body is None else drawn.flight.velocity(time) - body.velocity(time)


class Vectors(Part):
    def __init__(
        self, server: viser.ViserServer, setting: Setting, world: World, palette: Palette, flights: Flights
    ) -> None:
        self._solids, self._setting, self._world, self._flights = Solids(server), setting, world, flights
        self._palette = palette
        self.velocity, self.relative = True, False
        self._nodes: dict[str, Any] = {}
        self._colours: dict[str, list[Rgb]] = {}
        self._time = 0.0
        self.tag: Tag | None = None
        """The label of the relative velocity."""

    @property
    def ahead(self) -> float | None:
        """Time over which an arrow shows the distance travelled [s]; None without a flight."""
        return shapes.even_step(LENGTH * self._world.frame.unit, fastest) if (fastest := self._fastest) > 0 else None

    def show(self, velocity: bool, relative: bool) -> None:
        self.velocity, self.relative = velocity, relative
        self.moved(self._time)

    def moved(self, time: float) -> None:
        self._time = time
        ahead = self.ahead
        self._arrows("velocity", self._velocities(time, ahead) if self.velocity and ahead else [])
        lead = self._flights.lead
        relative = relative_velocity(lead, time) if lead and lead.seen and self.relative and ahead else None
        if lead is None or relative is None or ahead is None:
            self._arrows("relative", [])
            self._label(None, "")
            return
        start = lead.place(time) + self._lift
        end = start + ahead * relative
        self._arrows("relative", [(start, end, rgb(self._palette.relative))])
        self._label(end, f"v rel {np.linalg.norm(relative):.{self.decimals}f} m/s")

    def changed(self) -> None:
        self.moved(self._time)

    def paint(self, palette: Palette) -> None:
        self._palette = palette
        self._remove(*self._nodes)
        self.moved(self._time)

    @property
    def decimals(self) -> int:
        """Decimals of a speed, so that a typical one has three significant digits."""
        fastest = self._fastest
        return 1 if fastest >= 10 else 2 if fastest >= 1 else 3

    @property
    def _fastest(self) -> float:
        """The highest typical speed of the flights [m/s]; 0 without one."""
        flights = [drawn.flight for drawn in self._flights.every if drawn.flight is not None]
        return max((flight.typical_speed for flight in flights), default=0.0)

    @property
    def _lift(self) -> Floats:
        """Above the hull of a planar vehicle."""
        return np.array([0.0, 0.0, 0.6 * self._world.frame.unit * self._setting.planar])

    def _velocities(self, time: float, ahead: float) -> list[tuple[Floats, Floats, Rgb]]:
        found = []
        for drawn in self._flights.every:
            if drawn.seen and drawn.flight is not None:
                start = drawn.place(time) + self._lift
                found.append((start, start + ahead * drawn.flight.velocity(time), rgb(drawn.style.colour)))
        for body, colour in self._flights.obstacles.moving():
            start = body.at(time) + self._lift
            found.append((start, start + ahead * body.velocity(time), shade(colour, 0.9)))
        return found

    def _arrows(self, kind: str, found: list[tuple[Floats, Floats, Rgb]]) -> None:
        """Replace the arrows; redraw only if they have changed."""
        head = HEAD * self._world.frame.unit
        long = [one for one in found if np.linalg.norm(one[1] - one[0]) > head]
        if not long:
            self._remove(kind)
            return
        arrows = [shapes.arrow_lines(start, end, head) for start, end, _ in long]
        points = np.concatenate(arrows).astype(np.float32)
        colours = [colour for lines, (*_, colour) in zip(arrows, long, strict=True) for _ in lines]
        node = self._nodes.get(kind)
        if node is not None and self._colours.get(kind) == colours:
            node.points = points
            return
        self._colours[kind] = colours
        both = np.repeat(np.array([linear(colour) for colour in colours], dtype=np.uint8)[:, None], 2, axis=1)
        self._nodes[kind] = self._solids.line(f"/vectors/{kind}", points, both, WIDTH)

    def _label(self, place: Floats | None, text: str) -> None:
        self.tag = None
        if place is None:
            self._remove("label")
            return
        label = Label("/vectors/label", text, place, "bottom-left", 0.8)
        node = self._nodes.get("label")
        if node is not None:
            node.position, node.text = place, text
        else:
            node = self._nodes["label"] = self._solids.label(label)
        self.tag = Tag(label, node, np.zeros(3))

    def _remove(self, *kinds: str) -> None:
        for kind in kinds:
            if (node := self._nodes.pop(kind, None)) is not None:
                node.remove()
