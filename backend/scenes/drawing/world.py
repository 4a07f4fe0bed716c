"""Draws the fixed part of a scene: ground, start and goal or course, north; and computes the bounding box."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import viser

from backend.scenes.base.axes import Floats
from backend.scenes.base.flight import Flight
from backend.scenes.base.palette import Palette, rgb
from backend.scenes.base.setting import Setting
from backend.scenes.drawing import shapes
from backend.scenes.drawing.bodies import body_of
from backend.scenes.drawing.cameras import Scene
from backend.scenes.drawing.labels import Anchor, Label, Tag
from backend.scenes.drawing.solids import LINE, Solids

LEAST_HEIGHT = 0.04
"""A scene lower than this fraction of its span has no height scale."""


@dataclass(frozen=True)
class Frame:
    """The bounding box: centre, sides and longest side [m]."""

    middle: Floats
    sides: Floats
    span: float
    unit: float
    """The drawn length of a vehicle and of small symbols [m]: visible, and at most what must stay free."""

    @classmethod
    def around(cls, points: Sequence[Floats], threshold: float | None) -> Frame:
        """The bounding box of these points (..., 3); never empty. threshold: what must stay free, if it is known."""
        stacked = np.vstack([np.atleast_2d(p) for p in points])
        low, high = stacked.min(axis=0), stacked.max(axis=0)
        span = max(float((high - low).max()), 1e-3)
        unit = span / 20 if threshold is None else min(span / 16, max(0.9 * threshold, span / 40))
        return cls((low + high) / 2, high - low, span, unit)


class World:
    def __init__(self, server: viser.ViserServer, setting: Setting, palette: Palette) -> None:
        self._scene, self._setting, self.palette = server.scene, setting, palette
        self._solids = Solids(server)
        self._scale: list[Any] = []
        """The nodes of the height scale."""
        self._tags: dict[str, Tag] = {}
        self._scene.configure_default_lights(cast_shadow=False)
        self._background()
        self.fit([])

    def paint(self, palette: Palette) -> None:
        self.palette = palette
        self._background()
        self._draw()

    def tags(self) -> Iterator[Tag]:
        """The labels; of the height scale the highest first."""
        yield from reversed(self._tags.values())

    @property
    def whole(self) -> Scene:
        """The extent that a camera must show."""
        return Scene(self.frame.middle, self._points, self._setting.room, self.frame.unit)

    def fit(self, flights: Sequence[Flight]) -> None:
        """Redraw with a box that contains these flights and their obstacles."""
        points = list(self._reach(flights))
        self.frame = Frame.around(points, self._setting.threshold if self._setting.clears else None)
        self._points = np.vstack([np.atleast_2d(p)[:: max(1, len(np.atleast_2d(p)) // 50)] for p in points])
        low = min(float(p[..., 2].min()) for p in points)
        self.ground = -0.002 * self.frame.span if self._setting.planar else low - 0.04 * self.frame.span
        """The height of the ground [m]."""
        self._draw()

    def _draw(self) -> None:
        self._ground()
        self._places()
        if self._setting.axes.frame == "ned" and self._setting.clears:
            self._north()
        if self._setting.axes.frame == "ned" if self._setting.clears else not self._setting.planar:
            self._heights()

    def _reach(self, flights: Sequence[Flight]) -> Iterator[Floats]:
        setting = self._setting
        yield setting.start
        if setting.goal is not None:
            yield setting.goal
        if setting.course is not None and not flights:
            yield setting.course
        for number, moving in enumerate(setting.moving):
            if not moving:
                body = body_of(number, setting.values, setting.axes, None, setting.look(number))
                far = setting.free(body.extent) if setting.to_surface else max(setting.room, body.extent)
                yield from (body.place - far, body.place + far)
        for flight in flights:
            yield flight.position
            yield from flight.tracks.values()
            if flight.closest is not None:
                yield from (flight.closest.obstacle + sign * setting.threshold for sign in (-1, 1))

    def _background(self) -> None:
        self._scene.set_background_image(np.full((1, 1, 3), rgb(self.palette.background), dtype=np.uint8))

    def _ground(self) -> None:
        cell = shapes.even_step(self.frame.span, 10)
        self._scene.add_grid(
            "/ground",
            infinite_grid=True,
            cell_size=cell,
            section_size=5 * cell,
            cell_color=rgb(self.palette.grid),
            section_color=rgb(self.palette.section),
            fade_distance=6 * self.frame.span,
            shadow_opacity=0.0,
            position=(0.0, 0.0, self.ground),
        )

    def _places(self) -> None:
        """Start: a labelled ring. Goal: two labelled concentric rings. Course: a line to its end."""
        setting, unit = self._setting, self.frame.unit
        for name, place, colour, rings in (
            ("start", setting.start, self.palette.soft, (0.35,)),
            ("goal", setting.goal, self.palette.goal, (0.2, 0.4)),
        ):
            if place is None:
                continue
            for number, radius in enumerate(rings):
                self._line(f"/{name}/{number}", shapes.circle(place, radius * unit), colour)
            self._name(f"/{name}/label", name, place + np.array([0.0, -0.5 * unit, 0.0]))
        if setting.course is not None:
            way = np.stack([setting.start, setting.course])
            self._line("/course", shapes.dashed(way, self.frame.span / 140), self.palette.soft, 1.2)

    def _north(self) -> None:
        """An arrow on the ground in the corner of the box, because aircraft scenes are north up."""
        length = 1.5 * self.frame.unit
        foot = np.array([*(self.frame.middle[:2] - 0.5 * self.frame.sides[:2]), self.ground])
        tip = foot + np.array([0.0, length, 0.0])
        head = shapes.arrow()
        turned = (head.vertices * 0.35 * length)[:, (1, 0, 2)] + tip
        self._line("/north/shaft", np.stack([foot, tip])[None], self.palette.soft)
        self._solids.mesh("/north/head", shapes.Mesh(turned, head.faces), rgb(self.palette.soft))
        self._name("/north/label", "N", foot + 1.45 * (tip - foot), "bottom-center")

    def _heights(self) -> None:
        """A pole in the corner of the box with a height scale relative to the scenario's origin, not to the grid."""
        for node in self._scale:
            node.remove()
        self._scale = []
        self._tags = {name: tag for name, tag in self._tags.items() if not tag.label.fixed}
        top, length = float(self._points[:, 2].max()), 0.3 * self.frame.unit
        if top - self.ground < LEAST_HEIGHT * self.frame.span:
            return
        step = shapes.even_step(top - self.ground, 3)
        marks = step * np.arange(np.ceil(self.ground / step), np.floor(top / step) + 1) + 0.0  # avoid a negative zero
        x, y = self.frame.middle[:2] + 0.5 * self.frame.sides[:2] * (-1.0, 1.0)
        pole = [((x, y, self.ground), (x, y, max(top, float(marks[-1]))))] if len(marks) else []
        ticks = [((x, y, z), (x + length, y, z)) for z in marks]
        if ticks:
            self._scale.append(self._line("/north/heights", np.array(pole + ticks), self.palette.soft, 1.5))
        for k, z in enumerate(marks):
            text = ("height " if z == marks[-1] else "") + f"{z:g} m".replace("-", "−")
            place = np.array([x + 1.2 * length, y, z])
            self._scale.append(self._name(f"/north/height/{k}", text, place, "center-left", fixed=True))

    def _line(self, name: str, segments: Floats, colour: str, width: float = LINE) -> Any:
        return self._solids.line(name, segments, rgb(colour), width)

    def _name(self, name: str, text: str, place: Floats, anchor: Anchor = "top-center", fixed: bool = False) -> Any:
        label = Label(name, text, place, anchor, 0.8, fixed)
        node = self._solids.label(label)
        self._tags[name] = Tag(label, node, np.zeros(3))
        return node
