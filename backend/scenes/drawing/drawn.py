"""Draws one flight: its line, the vehicle at a time, the closest approach with its ruler.

A spatial flight has a shadow on the ground and stems at equal intervals, so that heights can be read.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, cast

import numpy as np
import viser

from backend.scenes.base.axes import Floats
from backend.scenes.base.flight import Closest, Flight
from backend.scenes.base.palette import rgb, shade
from backend.scenes.base.setting import Setting
from backend.scenes.drawing import shapes
from backend.scenes.drawing.bodies import Body, bodies_of
from backend.scenes.drawing.labels import Anchor, Label, Tag
from backend.scenes.drawing.solids import Solids
from backend.scenes.drawing.trail import Trail
from backend.scenes.drawing.world import World

MESHES = {
    "robot": shapes.unicycle,
    "two_wheels": shapes.pioneer,
    "aircraft": shapes.aircraft,
    "ball": shapes.ball,
    "body": shapes.body,
}
"""Meshes of vehicles, by the name in their look."""
DOTS = 9
"""Approximate number of dots on a path, and of stems under a spatial one."""


@dataclass(frozen=True)
class Style:
    """The style of a role of flights.

    Coincident flights are separated by `layer`: a higher one is drawn over a lower one, with a thinner line. Its label
    is offset from the closest approach by `label`, or placed beyond the obstacle.
    """

    key: str
    title: str
    colour: str
    layer: int
    label: Literal["top", "bottom", "beyond"]


class Drawn:
    def __init__(self, server: viser.ViserServer, setting: Setting, world: World, style: Style) -> None:
        self._scene, self._setting, self._world, self.style = server.scene, setting, world, style
        self._solids = Solids(server)
        self.flight: Flight | None = None
        self.bodies: list[Body] = []
        """The obstacles of this flight."""
        self.visible = True
        """Whether the flight is visible once it exists."""
        self._root = self._scene.add_frame(f"/flights/{style.key}", show_axes=False, visible=False)
        self._vehicle: Any = None
        self._tag: Tag | None = None
        self.trail = Trail(server, f"/flights/{style.key}", (5.0, 3.0, 2.0)[style.layer])

    def draw(self, flight: Flight, time: float) -> None:
        """Replace the flight, with the vehicle at its position at that time."""
        dots = dots_of(flight, self._setting.horizon)
        self.trail.draw(flight.time, flight.position + self._lift, dots, self.style.colour, self._world.frame.unit)
        if not self._setting.planar:
            self._stand(flight, dots)
        if self._vehicle is None:
            self._vehicle = self._build_vehicle()
        self.flight = flight
        count = len(self._setting.moving)
        self.bodies = bodies_of([self._setting.look(i) for i in range(count)], self._setting.values, flight)
        self._closest(flight.closest)
        if not flight.ok:
            self._failed(flight)
        self._root.visible = self.visible
        self.move(time)

    def clear(self) -> None:
        self.flight, self.bodies = None, []
        self._root.visible = False

    def restyle(self, time: float, title: str | None = None, colour: str | None = None) -> None:
        self.style = replace(self.style, title=title or self.style.title, colour=colour or self.style.colour)
        if colour is not None:
            self._vehicle = None
        if self.flight is not None:
            self.draw(self.flight, time)

    def place(self, time: float, flight: Flight | None = None) -> Any:
        """The drawn position of the vehicle at a time (3,), by default in the flight drawn, which there must be."""
        flight = flight or self.flight
        assert flight is not None
        return flight.at(time)[0] + self._lift

    @property
    def tag(self) -> Tag | None:
        return self._tag if self.seen else None

    @property
    def seen(self) -> bool:
        return self.visible and self.flight is not None

    def move(self, time: float) -> None:
        if self.flight is not None:
            position, turn, _ = self.flight.at(time)
            self._vehicle.position = position + self._lift
            self._vehicle.wxyz = turn
            self.trail.move(time, position + self._lift)

    def show(self, visible: bool) -> None:
        self.visible = visible
        self._root.visible = visible and self.flight is not None

    @property
    def _lift(self) -> Any:
        """Offset above the ground that separates planar flights."""
        return np.array([0.0, 0.0, 0.004 * self._world.frame.span * (1 + self.style.layer) * self._setting.planar])

    def _stand(self, flight: Flight, dots: Any) -> None:
        shadow = flight.position * (1.0, 1.0, 0.0) + (0.0, 0.0, self._world.ground)
        self._line("shadow", shapes.dashed(shadow, self._world.frame.span / 140), 1.5)
        feet = [flight.at(time)[0] for time in dots]
        stems = np.array([(foot, (foot[0], foot[1], self._world.ground)) for foot in feet])
        self._line("stems", stems, 1.0, soft=True)

    def _name(self, part: str) -> str:
        return f"/flights/{self.style.key}/{part}"

    def _line(self, part: str, segments: Any, width: float, soft: bool = False) -> None:
        colour = rgb(self._world.palette.soft if soft else self.style.colour)
        self._solids.line(self._name(part), segments, colour, width)

    def _build_vehicle(self) -> Any:
        frame = self._scene.add_frame(self._name("vehicle"), show_axes=False)
        body, rest = _shape(self._setting)
        dark = shade(rgb(self.style.colour), 0.6)
        for part, mesh, colour in (("body", body, rgb(self.style.colour)), ("rest", rest, dark)):
            scaled = shapes.Mesh(self._world.frame.unit * mesh.vertices, mesh.faces)
            self._solids.mesh(self._name(f"vehicle/{part}"), scaled, colour)
        return frame

    def _closest(self, closest: Closest | None) -> None:
        if closest is None:
            for part in ("closest", "closest-obstacle", "ruler", "label"):
                self._scene.remove_by_name(self._name(part))
            self._tag = None
            return
        near, far = (end + self._lift for end in ruler(closest, self.bodies, self._body))
        self._ball("closest", 0.1, near, self.style.colour)
        self._ball("closest-obstacle", 0.07, far, self.style.colour)
        self._line("ruler", np.stack([near, far])[None], 2.5)
        text = f"{self.style.title} {closest.value:.{self._setting.decimals}f} {self._setting.unit}"
        place, anchor = self._label_place(closest)
        label = Label(self._name("label"), text, place, anchor, 0.9)
        self._tag = Tag(label, self._solids.label(label), np.zeros(3))

    def _failed(self, flight: Flight) -> None:
        text = f"{self.style.title}: {flight.status} at {flight.time[-1]:.2f} s"
        label = Label(self._name("label"), text, flight.position[-1] + self._lift, "bottom-center", 0.9)
        self._tag = Tag(label, self._solids.label(label), np.zeros(3))

    @property
    def _body(self) -> float | None:
        """Radius of the vehicle's body in this flight [m]; None if distances are measured to obstacles' centres."""
        if not self._setting.to_surface or self.flight is None:
            return None
        return {**self._setting.values, **self.flight.parameters}.get("criterion.body_radius", 0.0)

    def _ball(self, part: str, size: float, place: Any, colour: str) -> None:
        radius = size * self._world.frame.unit
        self._scene.add_icosphere(self._name(part), radius, rgb(colour), position=place, cast_shadow=False)

    def _label_place(self, closest: Closest) -> tuple[Any, Anchor]:
        """The position of the label, on the side where it covers neither the obstacle nor another label."""
        across = closest.obstacle - closest.position
        away = "right" if across[0] >= 0 else "left"
        if self.style.label == "beyond":
            return beyond(closest, self._setting.threshold, self._setting.planar)
        # Away from the vehicle, and separate if two flights are closest at the same position.
        side = (1.0 if self.style.label == "bottom" else -1.0) * self._world.frame.unit
        place = (
            closest.position
            + side * np.array([0.0, 0.35, 0.5])
            - 0.7 * self._world.frame.unit * across / max(float(np.linalg.norm(across)), 1e-9)
        )
        return place, cast(Anchor, f"{self.style.label}-{away}")


def dots_of(flight: Flight, horizon: float) -> Floats:
    """The times of the dots on a path: multiples of a round step within the flight; if there is none, its start."""
    start, end = float(flight.time[0]), float(flight.time[-1])
    step = shapes.even_step(max(horizon, end - start), DOTS)
    times: Floats = step * np.arange(np.ceil(start / step), np.floor((end + 1e-9) / step) + 1)
    return times if len(times) else flight.time[:1]


def beyond(closest: Closest, threshold: float, planar: bool) -> tuple[Floats, Anchor]:
    """Position and anchor of a label on the far side of the obstacle, never below it: there it has its own label."""
    across = closest.obstacle - closest.position
    way = across / max(float(np.linalg.norm(across)), 1e-9)
    upwards = 1 if planar else 2
    way[upwards] = abs(way[upwards])
    return closest.obstacle + 1.4 * threshold * way, "center-left" if across[0] >= 0 else "center-right"


def ruler(closest: Closest, bodies: Sequence[Body], radius: float | None) -> tuple[Floats, Floats]:
    """The two ends (3,) of the measured distance of the closest approach, at the vehicle and at the obstacle.

    From the edge of the vehicle's body of that radius to the obstacle's surface; None: between the centres.
    """
    if radius is None or closest.number >= len(bodies):
        return closest.position, closest.obstacle
    body = bodies[closest.number]
    end = body.surface(closest.position, closest.obstacle if body.kind == "round" else body.place)
    apart = closest.position - end
    # The edge that faces the surface; if the vehicle's centre is inside the obstacle, the deepest edge.
    edge = -radius if closest.value + radius >= 0.0 else radius
    return closest.position + edge * apart / max(float(np.linalg.norm(apart)), 1e-9), end


def anchor_of(flights: Sequence[Drawn], edge: Literal["top", "bottom"]) -> Any:
    """The anchor corner of an obstacle's label, so that it points away from the labels of these flights."""
    closest = next((one.flight.closest for one in flights if one.flight and one.flight.closest), None)
    if closest is None:
        return f"{edge}-center"
    return f"{edge}-{'left' if closest.obstacle[0] >= closest.position[0] else 'right'}"


def _shape(setting: Setting) -> tuple[shapes.Mesh, shapes.Mesh]:
    """The vehicle's two meshes: those of its look, or by default an aircraft in space, else a robot; of a simulator the
    one declared, or a neutral one."""
    if setting.scene is not None:
        vehicle = setting.scene.vehicle
        turns = vehicle.quaternion is not None or vehicle.angles is not None
        return MESHES[vehicle.mesh or ("body" if turns else "ball")]()
    look = setting.drawn.vehicle(setting.vehicle)
    mesh = look.mesh if look is not None else "robot" if setting.planar else "aircraft"
    return MESHES[mesh]()
