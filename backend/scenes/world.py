"""Draws what does not move: ground, obstacles with their safety radius, start and goal, the camera's places.

Start reading at `World`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from backend.scenes import shapes
from backend.scenes.address import Camera
from backend.scenes.flight import Closest
from backend.scenes.palette import Palette, rgb
from backend.scenes.setting import Obstacle, Setting

Floats = NDArray[np.float64]

FIELD_OF_VIEW = np.radians(40.0)
LINE = 2.0
"""Width of a drawn line [pixels]."""


@dataclass(frozen=True)
class Frame:
    """The box that holds everything: its middle and its largest side [m]."""

    middle: Floats
    span: float

    @classmethod
    def around(cls, points: list[Floats]) -> Frame:
        """The box of these points; never empty."""
        stacked = np.vstack(points)
        low, high = stacked.min(axis=0), stacked.max(axis=0)
        return cls((low + high) / 2, max(float((high - low).max()), 1e-3))

    @property
    def unit(self) -> float:
        """The length of a vehicle and of other small signs [m]."""
        return self.span / 16


class World:
    """The fixed part of a scene."""

    def __init__(self, server: viser.ViserServer, setting: Setting, palette: Palette) -> None:
        self._scene, self._setting, self._palette = server.scene, setting, palette
        reach = np.ones(3) * setting.threshold
        corners = [o.position + sign * np.maximum(reach, o.radius) for o in setting.obstacles for sign in (-1, 1)]
        self.frame = Frame.around([setting.start, setting.goal, *corners])
        if setting.planar:
            self.frame = Frame(self.frame.middle * (1, 1, 0), self.frame.span)
        server.scene.set_background_image(np.full((1, 1, 3), rgb(palette.background), dtype=np.uint8))
        self._ground()
        for number, obstacle in enumerate(setting.obstacles):
            self._obstacle(number, obstacle)
        self._places()

    def _ground(self) -> None:
        cell = shapes.even_step(self.frame.span, 10)
        self._scene.add_grid(
            "/ground",
            infinite_grid=True,
            cell_size=cell,
            section_size=5 * cell,
            cell_color=rgb(self._palette.grid),
            section_color=rgb(self._palette.section),
            fade_distance=6 * self.frame.span,
            shadow_opacity=0.0,
            position=(0.0, 0.0, -0.002 * self.frame.span),
        )

    def _obstacle(self, number: int, obstacle: Obstacle) -> None:
        name, colour = f"/obstacles/{number}", rgb(self._palette.obstacle)
        threshold, ink = self._setting.threshold, rgb(self._palette.ink)
        if not self._setting.planar:
            self._scene.add_icosphere(
                f"{name}/body", max(obstacle.radius, 0.3 * self.frame.unit), colour, position=obstacle.position
            )
            self._scene.add_icosphere(
                f"{name}/safety", threshold, colour, wireframe=True, opacity=0.3, position=obstacle.position
            )
            return
        height = 1.2 * self.frame.unit
        self._cylinder(f"{name}/core", obstacle.position, 0.12 * self.frame.unit, height, 1.0)
        if obstacle.radius > 0:
            self._cylinder(f"{name}/body", obstacle.position, obstacle.radius, height, 0.45)
        self._cylinder(f"{name}/safety", obstacle.position, threshold, 0.02 * height, 0.25)
        lift = np.array([0.0, 0.0, 0.03 * height])
        ring = shapes.circle(obstacle.position + lift, threshold, dashes=24)
        self._scene.add_line_segments(f"{name}/ring", ring, ink, thickness=LINE, thickness_units="screen")
        self._scene.add_label(
            f"{name}/label",
            f"{self._setting.quantity or 'limit'} ≥ {threshold:g} {self._setting.unit}",
            position=obstacle.position + np.array([0.0, -threshold, 0.0]),
            anchor="top-center",
            font_screen_scale=0.8,
        )

    def _cylinder(self, name: str, position: Floats, radius: float, height: float, opacity: float) -> None:
        self._scene.add_cylinder(
            name,
            radius=radius,
            height=height,
            color=rgb(self._palette.obstacle),
            opacity=opacity if opacity < 1 else None,
            radial_segments=48,
            cast_shadow=False,
            receive_shadow=False,
            position=position + np.array([0.0, 0.0, height / 2]),
        )

    def _places(self) -> None:
        """Start: a ring. Goal: a ring within a ring. Both named."""
        for name, place, colour, rings in (
            ("start", self._setting.start, self._palette.soft, (0.35,)),
            ("goal", self._setting.goal, self._palette.goal, (0.2, 0.4)),
        ):
            for number, radius in enumerate(rings):
                circle = shapes.circle(place, radius * self.frame.unit)
                self._scene.add_line_segments(
                    f"/{name}/{number}", circle, rgb(colour), thickness=LINE, thickness_units="screen"
                )
            self._scene.add_label(
                f"/{name}/label",
                name,
                position=place + np.array([0.0, -0.5 * self.frame.unit, 0.0]),
                anchor="top-center",
                font_screen_scale=0.8,
            )

    def camera(self, kind: Camera, closest: Closest | None) -> tuple[Floats, Floats]:
        """Where the camera stands, and what it looks at."""
        middle, span = self.frame.middle, self.frame.span
        if kind == "encounter" and closest is not None:
            middle = (closest.position + closest.obstacle) / 2
            span = 2.2 * max(closest.value, self._setting.threshold)
        distance = 0.72 * span / np.tan(FIELD_OF_VIEW / 2)
        towards = {
            "overview": (-0.25, -0.75, 0.8),
            "encounter": (-0.35, -0.7, 0.75),
            "top": (0.0, -1e-3, 1.0),
            "side": (0.0, -1.0, 0.12),
        }[kind]
        direction = np.array(towards) / np.linalg.norm(towards)
        return middle + distance * direction, middle


def place_first_camera(server: viser.ViserServer, world: World, kind: Camera, closest: Closest | None) -> None:
    """Where the camera stands when the page opens, and goes back to on "Reset View"."""
    camera: Any = server.initial_camera
    camera.fov = FIELD_OF_VIEW
    camera.position, camera.look_at = world.camera(kind, closest)
    camera.near, camera.far = 0.005 * world.frame.span, 100 * world.frame.span


def move_camera(server: viser.ViserServer, world: World, kind: Camera, closest: Closest | None) -> None:
    """Move the viewer's camera to one of its places."""
    position, look_at = world.camera(kind, closest)
    for client in server.get_clients().values():
        with client.atomic():
            client.camera.position = position
            client.camera.look_at = look_at
