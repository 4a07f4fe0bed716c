"""Draws one flight: its line, the vehicle at a time, the closest approach with its ruler. Start reading at `Drawn`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import viser

from backend.scenes import shapes
from backend.scenes.flight import Closest, Flight
from backend.scenes.palette import rgb, shade
from backend.scenes.setting import Setting
from backend.scenes.world import Frame

Anchor = Literal["bottom-left", "bottom-right", "center-left", "center-right", "top-left", "top-right"]


@dataclass(frozen=True)
class Style:
    """How one role of flight looks.

    Flights that coincide stay apart by `layer`: a higher one is drawn over a lower one, with a thinner line. Its label
    stands off the closest approach by `label`, or beyond the obstacle.
    """

    key: str
    title: str
    colour: str
    layer: int
    label: Literal["top", "bottom", "beyond"]


class Drawn:
    """A flight in the scene; drawn again in place when it changes."""

    def __init__(self, server: viser.ViserServer, setting: Setting, frame: Frame, style: Style) -> None:
        self._scene, self._setting, self._frame, self.style = server.scene, setting, frame, style
        self.flight: Flight | None = None
        self._visible = True
        self._lift = np.array([0.0, 0.0, 0.004 * frame.span * (1 + style.layer)]) if setting.planar else np.zeros(3)
        self._root = self._scene.add_frame(f"/flights/{style.key}", show_axes=False, visible=False)
        self._vehicle: Any = None

    def draw(self, flight: Flight, time: float) -> None:
        """Show this flight instead of the one before, the vehicle where it is at that time."""
        self._line("path", shapes.polyline(flight.position + self._lift), (5.0, 3.0, 2.0)[self.style.layer])
        if self._vehicle is None:
            self._vehicle = self._build_vehicle()
        self.flight = flight
        self._closest(flight.closest)
        self._root.visible = self._visible
        self.move(time)

    def move(self, time: float) -> None:
        """Put the vehicle where it is at that time [s]."""
        if self.flight is not None:
            position, rotation, _ = self.flight.at(time)
            self._vehicle.position = position + self._lift
            self._vehicle.wxyz = shapes.quaternion(rotation)

    def show(self, visible: bool) -> None:
        """Show or hide it."""
        self._visible = visible
        self._root.visible = visible and self.flight is not None

    def _name(self, part: str) -> str:
        return f"/flights/{self.style.key}/{part}"

    def _line(self, part: str, segments: Any, width: float) -> None:
        colour = rgb(self.style.colour)
        self._scene.add_line_segments(
            self._name(part), segments.astype(np.float32), colour, thickness=width, thickness_units="screen"
        )

    def _build_vehicle(self) -> Any:
        frame = self._scene.add_frame(self._name("vehicle"), show_axes=False)
        body, rest = shapes.unicycle() if self._setting.planar else shapes.dart()
        dark = shade(rgb(self.style.colour), 0.45)
        for part, mesh, colour in (("body", body, shade(rgb(self.style.colour), 0.8)), ("rest", rest, dark)):
            self._scene.add_mesh_simple(
                self._name(f"vehicle/{part}"),
                (self._frame.unit * mesh.vertices).astype(np.float32),
                mesh.faces.astype(np.uint32),
                color=colour,
                flat_shading=True,
                side="double",
                cast_shadow=False,
                receive_shadow=False,
            )
        return frame

    def _closest(self, closest: Closest | None) -> None:
        """A ball where the flight came closest, and a ruler to the obstacle that says how close."""
        if closest is None:
            for part in ("closest", "ruler", "label"):
                self._scene.remove_by_name(self._name(part))
            return
        near, far = closest.position + self._lift, closest.obstacle + self._lift
        colour = rgb(self.style.colour)
        self._scene.add_icosphere(
            self._name("closest"), 0.1 * self._frame.unit, colour, position=near, cast_shadow=False
        )
        self._line("ruler", np.stack([near, far])[None], 1.5)
        text = f"{self.style.title} {closest.value:.4f} {self._setting.unit}"
        place, anchor = self._label_place(closest)
        self._scene.add_label(self._name("label"), text, position=place, anchor=anchor, font_screen_scale=0.9)

    def _label_place(self, closest: Closest) -> tuple[Any, Anchor]:
        """Where the label stands, on the side where it covers neither the obstacle nor another flight's label."""
        across = closest.obstacle - closest.position
        away: Literal["left", "right"] = "right" if across[0] >= 0 else "left"
        if self.style.label == "beyond":
            beyond = across / max(float(np.linalg.norm(across)), 1e-9)
            place = closest.obstacle + 1.4 * self._setting.threshold * beyond
            return place, "center-left" if away == "right" else "center-right"
        place = closest.position - 0.05 * across
        sides: dict[str, Anchor] = {
            "bottom-left": "bottom-left",
            "bottom-right": "bottom-right",
            "top-left": "top-left",
            "top-right": "top-right",
        }
        return place, sides[f"{self.style.label}-{away}"]
