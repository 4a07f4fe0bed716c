"""Draws the path of one flight with dots at equal intervals, optionally with the part so far emphasised."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser

from backend.scenes.base.axes import Floats
from backend.scenes.base.palette import rgb, shade
from backend.scenes.drawing import shapes
from backend.scenes.drawing.solids import Solids

PIECES = 24
"""The part so far consists of whole pieces and one that is redrawn, so that little is sent per frame."""
THIN = 1.0
"""Width of the path behind the emphasised part [pixels]."""


class Trail:
    def __init__(self, server: viser.ViserServer, root: str, width: float) -> None:
        self._scene, self._root, self._width = server.scene, root, width
        self._solids = Solids(server)
        self._so_far = False
        self._colour = "#000000"
        self._time = self._points = np.empty(0)
        self._path: Any = None
        self._pieces: list[Any] = []
        self._last: Any = None

    def draw(self, time: Floats, points: Floats, dots: Floats, colour: str, size: float) -> None:
        """Draw a path through points (m, 3) at times (m,) [s], with dots; `size` is a vehicle's length [m]."""
        self._time, self._points, self._colour = time, points, colour
        self._path = self._line("path", points, THIN if self._so_far else self._width)
        places = np.column_stack([np.interp(dots, time, points[:, k]) for k in range(3)])
        self._scene.add_point_cloud(
            f"{self._root}/dots",
            places.astype(np.float32),
            shade(rgb(colour), 0.75),
            point_size=0.04 * size,
            point_shape="circle",
            precision="float32",
        )
        self._redraw_pieces()

    def show(self, so_far: bool, time: float, place: Floats | None) -> None:
        """Draw the whole path uniformly, or emphasise the part up to that time and position."""
        self._so_far = so_far
        if self._path is not None:
            self._path.thickness = THIN if so_far else self._width
            self._redraw_pieces()
        if place is not None:
            self.move(time, place)

    def move(self, time: float, place: Floats) -> None:
        """End the emphasised part at that time [s] and position."""
        if not self._pieces:
            return
        past = int(np.searchsorted(self._time, time, side="right"))
        length = self._length
        whole = max(past - 1, 0) // length
        for number, piece in enumerate(self._pieces):
            if piece.visible != (number < whole):
                piece.visible = number < whole
        rest = np.vstack([self._points[whole * length : max(past, 1)], place])
        self._last.points = shapes.polyline(rest).astype(np.float32)

    @property
    def _length(self) -> int:
        return max(1, -(-len(self._points) // PIECES))

    def _redraw_pieces(self) -> None:
        for node in (*self._pieces, *([self._last] if self._last else [])):
            node.remove()
        self._pieces, self._last = [], None
        if not self._so_far:
            return
        length = self._length
        for number, begin in enumerate(range(0, len(self._points) - 1, length)):
            piece = self._line(f"flown/{number}", self._points[begin : begin + length + 1], self._width)
            piece.visible = False
            self._pieces.append(piece)
        self._last = self._line("flown/last", self._points[[0, 0]], self._width)

    def _line(self, part: str, points: Floats, width: float) -> Any:
        return self._solids.line(f"{self._root}/{part}", shapes.polyline(points), rgb(self._colour), width)
