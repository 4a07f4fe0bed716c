"""Draws bodies, lines and labels, without shadows."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser

from backend.scenes.base.palette import Rgb
from backend.scenes.drawing import shapes
from backend.scenes.drawing.labels import Label

LINE = 2.0
"""Width of a drawn line [pixels]."""


class Solids:
    def __init__(self, server: viser.ViserServer) -> None:
        self._scene = server.scene

    def line(self, name: str, segments: Any, colour: Any, width: float = LINE) -> Any:
        """Segments (n, 2, 3) with a line width in pixels; one colour, or one for each end (n, 2, 3)."""
        return self._scene.add_line_segments(
            name, segments.astype(np.float32), colour, thickness=width, thickness_units="screen"
        )

    def label(self, label: Label) -> Any:
        """The viser node of a label."""
        return self._scene.add_label(
            label.name, label.text, position=label.place, anchor=label.anchor, font_screen_scale=label.size
        )

    def ball(
        self, name: str, radius: float, colour: Rgb, opacity: float | None = None, wireframe: bool = False
    ) -> None:
        """A ball about the origin of its parent node."""
        self._scene.add_icosphere(
            name, radius, colour, opacity=opacity, wireframe=wireframe, cast_shadow=False, receive_shadow=False
        )

    def box(self, name: str, size: tuple[float, ...], lift: float, turn: Any, colour: Rgb) -> None:
        """A translucent box, turned by w, x, y, z."""
        length, width, height = size
        self._scene.add_box(
            name,
            colour,
            (length, width, height),
            opacity=0.45,
            cast_shadow=False,
            receive_shadow=False,
            position=(0.0, 0.0, lift),
            wxyz=turn,
        )

    def mesh(
        self, name: str, mesh: shapes.Mesh, colour: Rgb, opacity: float | None = None, wireframe: bool = False
    ) -> None:
        """Triangles, flatly shaded."""
        self._scene.add_mesh_simple(
            name,
            mesh.vertices.astype(np.float32),
            mesh.faces.astype(np.uint32),
            color=colour,
            opacity=opacity,
            wireframe=wireframe,
            flat_shading=True,
            side="double",
            cast_shadow=False,
            receive_shadow=False,
        )

    def cylinder(
        self, name: str, radius: float, height: float, colour: Rgb, opacity: float, lift: float | None = None
    ) -> None:
        """An upright cylinder; on the ground unless lifted."""
        self._scene.add_cylinder(
            name,
            radius=radius,
            height=height,
            color=colour,
            opacity=opacity if opacity < 1 else None,
            radial_segments=48,
            cast_shadow=False,
            receive_shadow=False,
            position=(0.0, 0.0, height / 2 if lift is None else lift),
        )
