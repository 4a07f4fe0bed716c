"""The avoider's field: its demand over the horizontal plane at the vehicle's height, at the displayed time.

A translucent plane coloured by the demand's magnitude, small arrows of its direction, and a legend in the panel. The
simulation process computes the demands with the avoider's own code.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from backend.scenes.base.axes import Floats
from backend.scenes.base.palette import DARK, Palette, Rgb, rgb
from backend.scenes.base.part import Driver, Part
from backend.scenes.base.setting import Setting
from backend.scenes.drawing import shapes
from backend.scenes.drawing.flights import Flights
from backend.scenes.drawing.solids import Solids
from backend.scenes.drawing.world import World
from backend.scenes.live.latest import Latest
from backend.scenes.live.live import Live, LiveError
from backend.scenes.panel import field_slice, tables
from backend.scenes.panel.field_slice import Grid, Slice
from campaigns.identity.identity import Identity

HEAD = 0.9
"""Length of an arrow's head, in cells."""
WIDTH = 1.6
"""Line width of arrows [pixels]."""


@dataclass(frozen=True)
class _FieldRequest:
    title: str
    parameters: Mapping[str, float]
    time: float
    palette: Palette
    seed: int | None


class FieldSlice(Part):
    """The plane and its legend; computes the newest time and drops superseded ones."""

    def __init__(
        self,
        server: viser.ViserServer,
        setting: Setting,
        world: World,
        palette: Palette,
        flights: Flights,
        live: Live,
        driver: Driver,
    ) -> None:
        self._scene, self._setting, self._world, self._flights = server.scene, setting, world, flights
        self._live, self._driver, self._palette, self._solids = live, driver, palette, Solids(server)
        self._time, self._stopped = 0.0, False
        self._root: Any = self._scene.add_frame("/field/slice", show_axes=False, visible=False)
        self.on = False
        """Whether it is visible."""
        self._legend: Any = server.gui.add_html("")
        self._drawn: tuple[Grid, Rgb] | None = None
        self._plane: Any = None
        self._lines: Any = None
        self._latest: Latest[_FieldRequest] = Latest(self._work)

    def moved(self, time: float) -> None:
        self._time = time
        self._ask()

    def changed(self) -> None:
        self._ask()

    def paint(self, palette: Palette) -> None:
        self._palette = palette
        self._ask()

    def stop(self) -> None:
        self._latest.stop()
        with self._driver.drawing():
            self._stopped = True

    def have(self, on: bool | None) -> None:
        """Show or hide it; None leaves it unchanged."""
        if on is None or on == self.on:
            return
        with self._driver.drawing():
            self.on = on
            if not on:
                self._root.visible = False
                self._legend.content = ""
            self._ask()

    def _ask(self) -> None:
        if not self.on:
            return
        lead = self._flights.lead
        if lead is None or lead.flight is None:
            self._legend.content = tables.note("There is no flight yet; its field cannot be shown.")
            return
        flight = lead.flight
        self._latest.ask(_FieldRequest(lead.style.title, flight.parameters, self._time, self._palette, flight.seed))

    def _work(self, request: _FieldRequest) -> None:
        setting, grid = self._setting, Grid.over(self._world.frame)
        drawn = np.concatenate([grid.places.reshape(-1, 2), np.zeros((grid.rows * grid.columns, 1))], axis=1)
        places = [(float(x), float(y)) for x, y, _ in setting.axes.drawn(drawn)]
        try:
            answer = self._live.field(
                setting.document, setting.digest, request.parameters, request.time, places, request.seed
            )
        except LiveError as error:
            with self._driver.drawing():
                if not self._stopped:
                    self._root.visible = False
                    self._legend.content = tables.note(str(error), strong=True)
            return
        found = field_slice.read(answer, grid, setting.axes)
        dark = request.palette is DARK
        picture = field_slice.picture(found, dark)
        arrows = field_slice.arrows(found)
        words = field_slice.legend(found, request.title, setting, dark)
        with self._driver.drawing():
            if self.on and not self._stopped:
                self._draw(found, picture, arrows, rgb(request.palette.ink))
                other = setting.other_code(Identity.model_validate(answer["identity"]))
                self._legend.content = words + (tables.note(other, strong=True) if other else "")

    def _draw(self, found: Slice, picture: NDArray[np.uint8], arrows: Floats, ink: Rgb) -> None:
        """Draw it; a new image of the same plane is updated in place, which avoids flicker."""
        grid, lift = found.grid, 1e-3 * self._world.frame.span * self._setting.planar
        if self._drawn != (grid, ink):
            self._drawn = grid, ink
            self._plane = self._scene.add_image(
                "/field/slice/plane",
                picture,
                grid.columns * grid.cell,
                grid.rows * grid.cell,
                format="png",
                cast_shadow=False,
                receive_shadow=False,
            )
            self._lines = self._solids.line("/field/slice/arrows", np.zeros((1, 2, 3)), ink, WIDTH)
        else:
            self._plane.image = picture
        self._plane.position = (*grid.middle, found.height + lift)
        up = np.array([0.0, 0.0, 3 * lift])
        lines = [shapes.arrow_lines(start + up, end + up, HEAD * grid.cell) for start, end in arrows]
        self._lines.visible = bool(lines)
        if lines:
            self._lines.points = np.concatenate(lines).astype(np.float32)
        self._root.visible = True
