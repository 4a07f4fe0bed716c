"""Draws a run's parameter space instead of the flights: box, axes, points, marks."""

from __future__ import annotations

from itertools import combinations, product
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from backend.scenes.base.palette import DARK, Palette, rgb
from backend.scenes.base.setting import NOMINAL, Setting
from backend.scenes.cloud.evaluations import NO_VALUE, Axes, Cloud, Evaluation, Floats, place, places
from backend.scenes.drawing.colours import colours
from backend.scenes.drawing.world import World

SIDE = 0.62
"""Side of the box as a fraction of the scene's."""
POINT = 0.011
"""Sizes of points and marks as fractions of the box's side."""
SIGN = 0.015
"""Half the size of the symbol of an evaluation without a value, as a fraction of the box's side."""
CROSS: Floats = np.array([((-x, -y, -1.0), (x, y, 1.0)) for x in (-1.0, 1.0) for y in (-1.0, 1.0)]) / np.sqrt(3)
"""The diagonals of a cube: a cross from every direction."""
_TIPS = np.array([*np.eye(3), *-np.eye(3)])
DIAMOND: Floats = np.array([(a, b) for a, b in combinations(_TIPS, 2) if a @ b == 0.0])
"""The edges of an octahedron."""
NAME = "/space"


class CloudDrawn:
    """Drawn at the position of the flights, so that the same cameras show it."""

    def __init__(self, server: viser.ViserServer, setting: Setting, world: World, palette: Palette) -> None:
        self._scene, self._setting, self._world, self.palette = server.scene, setting, world, palette
        self._root: Any = self._scene.add_frame(NAME, show_axes=False, visible=False)
        self.points: Floats = np.empty((0, 3))
        """Positions of the evaluations in the scene (n, 3) [m]."""

    @property
    def side(self) -> float:
        """Side of the box [m]."""
        return SIDE * self._world.frame.span

    def _at(self, shares: Any) -> Floats:
        """Convert a position in the unit cube to scene coordinates."""
        found: Floats = self._world.frame.middle + self.side * (np.asarray(shares, dtype=np.float64) - 0.5)
        return found

    def show(self, visible: bool) -> None:
        """Show or hide it."""
        self._root.visible = visible

    def draw(self, cloud: Cloud, picked: Axes) -> None:
        """Redraw everything."""
        visible = self._root.visible
        self._root.remove()
        self._root = self._scene.add_frame(NAME, show_axes=False, visible=visible)
        self._box(picked)
        self.points = self._at(places(cloud, picked))
        self._evaluations(cloud, picked)
        self._marks(cloud, picked)
        self._criterion(picked)

    def _box(self, picked: Axes) -> None:
        """Draw the edges; along three of them the titles and bounds of the axes."""
        corners = np.array(list(product((0.0, 1.0), repeat=3)))
        edges = [(a, b) for a in corners for b in corners if a.sum() < b.sum() and np.abs(b - a).sum() == 1]
        self._lines("box", self._at(edges), self.palette.section, 1.5)
        for axis, name in zip(picked, "xyz", strict=True):
            if axis is None:
                continue
            for share, text in ((0.0, f"{axis.low:.6g}"), (0.5, axis.title), (1.0, f"{axis.high:.6g}")):
                shown = text if share == 0.5 else text.replace("-", "−")
                way, anchor = _beside(name, share)
                size = 0.95 if share == 0.5 else 0.8
                self._scene.add_label(
                    f"{NAME}/axis/{name}/{share:g}",
                    shown,
                    position=self._at(way),
                    anchor=anchor,
                    font_screen_scale=size,
                )

    def _evaluations(self, cloud: Cloud, picked: Axes) -> None:
        """Draw points in the colour of their value, crosses for failed and hollow diamonds for excluded evaluations."""
        costs, status = cloud.costs, np.array([one.status for one in cloud.drawn])
        ok = (status == "ok") & np.isfinite(costs)
        low, high = cloud.range or (0.0, 1.0)
        if ok.any():
            shares = (costs[ok] - low) / (high - low) if high > low else np.zeros(int(ok.sum()))
            self._points("ok", self.points[ok], colours(shares, self.palette is DARK), POINT, "circle")
        excluded = status == "excluded"
        self._signs("excluded", self.points[excluded], DIAMOND)
        self._signs("failed", self.points[~ok & ~excluded], CROSS)
        if not ok.all() and any(axis is not None and not axis.path for axis in picked):
            below = [NO_VALUE if axis is not None and not axis.path else -0.05 for axis in picked]
            self._scene.add_label(
                f"{NAME}/none", "no value", position=self._at(below), anchor="center-right", font_screen_scale=0.8
            )

    def _signs(self, part: str, points: Floats, sign: Floats) -> None:
        """Draw the same symbol of lines (k, 2, 3) at every point."""
        if len(points):
            lines = points[:, None, None] + SIGN * self.side * sign
            self._lines(part, lines.reshape(-1, 2, 3), self.palette.soft, 1.4)

    def _marks(self, cloud: Cloud, picked: Axes) -> None:
        """Draw the nominal case and the findings as labelled balls."""
        taken: list[Floats] = []
        for label, (parameters, cost) in cloud.marks.items():
            at = self._at(place(picked, parameters, cost))
            colour = self.palette.nominal if label == NOMINAL else self.palette.worst
            self._ball(f"mark/{label}", at, 2.0 * POINT, colour)
            text = label if cost is None else f"{label} {cost:.{self._setting.decimals}f} {self._setting.unit}"
            below = any(np.linalg.norm(at - other) < 0.06 * self.side for other in taken)
            shift = (0.0, 0.0, (-0.03 if below else 0.03) * self.side)
            self._scene.add_label(
                f"{NAME}/mark/{label}/label",
                text[0].upper() + text[1:],
                position=shift,
                anchor="top-center" if below else "bottom-center",
                font_screen_scale=0.9,
            )
            taken.append(at)

    def _criterion(self, picked: Axes) -> None:
        """If the criterion's value is an axis, draw the labelled outline of the plane at its threshold."""
        threshold = self._setting.threshold
        for k, axis in enumerate(picked):
            if axis is None or axis.path:
                continue
            share = axis.fraction({}, threshold)
            if not 0.0 <= share <= 1.0:
                continue
            others = [i for i in range(3) if i != k]
            corners = np.full((4, 3), share)
            corners[:, others] = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
            ring = self._at(np.vstack([corners, corners[:1]]))
            self._lines("criterion", np.stack([ring[:-1], ring[1:]], axis=1), self.palette.ink, 2.0)
            text = f"criterion {threshold:g} {self._setting.unit}"
            self._scene.add_label(f"{NAME}/criterion/label", text, position=ring[1], anchor="bottom-left")

    def pick(self, one: Evaluation, picked: Axes) -> None:
        """Mark the picked evaluation."""
        at = self._at(place(picked, one.parameters, one.cost))
        self._ball("picked", at, 1.9 * POINT, self.palette.what_if)
        text = one.status if one.cost is None else f"{one.cost:.{self._setting.decimals}f} {self._setting.unit}"
        what = "Simulated" if self._setting.clears else "Stored"
        self._scene.add_label(
            f"{NAME}/picked/label", f"{what}: {text}", position=(0.0, 0.0, -0.03 * self.side), anchor="top-left"
        )

    def _ball(self, part: str, at: Floats, size: float, colour: str) -> None:
        radius = size * self.side
        self._scene.add_icosphere(
            f"{NAME}/{part}", radius, rgb(colour), position=at, cast_shadow=False, receive_shadow=False
        )

    def _points(self, part: str, points: Floats, lights: NDArray[np.uint8], size: float, shape: Any) -> None:
        self._scene.add_point_cloud(
            f"{NAME}/{part}",
            points.astype(np.float32),
            lights,
            point_size=size * self.side,
            point_shape=shape,
            point_shading="flat",
            precision="float32",
        )

    def _lines(self, part: str, segments: Floats, colour: str, width: float) -> None:
        self._scene.add_line_segments(
            f"{NAME}/{part}", segments.astype(np.float32), rgb(colour), thickness=width, thickness_units="screen"
        )


def _beside(name: str, share: float) -> tuple[tuple[float, float, float], Any]:
    """Position and anchor of an axis label along its edge of the box."""
    away = 0.1 if share == 0.5 else 0.05
    if name == "x":
        return (share, -away, 0.0), "top-center"
    if name == "y":
        return (1 + away, share, 0.0), "center-left"
    return (-away, -away, share), "center-right"
