"""One flight as a recording that plays without a server: the scene of the 3D view over time, as one page.

Drawn on a viser server that lets nobody in and is always closed. Time in the recording is time in the flight, so that
the play bar shows seconds of it. Start reading at `record`.
"""

from __future__ import annotations

import secrets
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import viser

from backend.scenes.base.flight import Flight
from backend.scenes.base.palette import DARK, LIGHT, Palette
from backend.scenes.base.setting import NOMINAL, Progress, Setting
from backend.scenes.control.relay import open_server
from backend.scenes.drawing.cameras import FIELD_OF_VIEW, pose
from backend.scenes.drawing.drawn import Drawn
from backend.scenes.drawing.flights import Flights
from backend.scenes.drawing.vectors import Vectors
from backend.scenes.drawing.world import World
from backend.scenes.panel.tables import number

RATE = 20.0
"""Pictures a second of the flight [1/s]."""

MOST = 900
"""Pictures of a long flight: then fewer a second."""


@dataclass(frozen=True)
class Cast:
    """The flights of one recording: the one it is of, and the nominal one beside it."""

    label: str
    shown: Flight
    nominal: Flight | None
    """None where the nominal flight is the one shown, or is not stored."""

    @property
    def flights(self) -> dict[str, Flight]:
        """By name."""
        return ({NOMINAL: self.nominal} if self.nominal else {}) | {self.label: self.shown}


@dataclass(frozen=True)
class Recording:
    """A self-contained HTML page of viser's, and what it takes to read the picture."""

    html: str
    said: str


def record(setting: Setting, cast: Cast, dark: bool) -> Recording:
    """The flights with obstacles, rulers, velocities and separations, played from their beginning to their end."""
    server = open_server(secrets.token_urlsafe(32))
    try:
        stage = _Stage(server, setting, cast, DARK if dark else LIGHT)
        serializer = server.get_scene_serializer()
        end = max(float(one.time[-1]) for one in cast.flights.values())
        times = np.linspace(0.0, end, int(np.clip(round(RATE * end), 2, MOST)) + 1)
        for before, time in pairwise(times):
            serializer.insert_sleep(float(time - before))
            stage.move(float(time))
        return Recording(serializer.as_html(dark_mode=dark), stage.said)
    finally:
        server.stop()


class _Stage:
    """The drawn scene, which is moved from picture to picture."""

    def __init__(self, server: viser.ViserServer, setting: Setting, cast: Cast, palette: Palette) -> None:
        self._server, self._setting = server, setting
        stored = Progress(setting, 0, cast.label)
        stored.flights = cast.flights
        self._world = World(server, setting, palette)
        self._flights = Flights(server, setting, self._world, palette, stored)
        self._flights.chosen.restyle(0.0, title=cast.label)
        self._flights.stored()
        self._vectors = Vectors(server, setting, self._world, palette, self._flights)
        self._told = {drawn: self._teller(drawn) for drawn in self._flights.every if drawn.flight is not None}
        self.move(0.0)
        self._camera()

    @property
    def said(self) -> str:
        """What dots and arrows mean."""
        ahead = self._vectors.ahead
        arrows = f" An arrow is as long as the way of {ahead:g} s at that velocity." if ahead else ""
        return f"The play bar counts seconds of the flight; dots every {self._flights.dots:g} s.{arrows}"

    def _teller(self, drawn: Drawn) -> Any:
        """The label at a vehicle that says how far it is from the nearest obstacle now."""
        anchor: Any = "bottom-center" if drawn.style.layer else "top-center"
        name = f"/flights/{drawn.style.key}/now"
        return self._server.scene.add_label(name, drawn.style.title, anchor=anchor, font_screen_scale=0.75)

    def move(self, time: float) -> None:
        """Show this time [s]."""
        self._flights.moved(time)
        self._vectors.moved(time)
        for drawn, told in self._told.items():
            assert drawn.flight is not None
            position, _, separation = drawn.flight.at(time)
            over = time > drawn.flight.time[-1] + 1e-9
            now = f"{number(separation, self._setting.decimals)} {self._setting.unit} now"
            told.text = f"{drawn.style.title}: {'ended' if over else now}"
            up = self._world.frame.unit * (1.1 if drawn.style.layer else -0.7)
            told.position = position + np.array([0.0, 0.0, up])

    def _camera(self) -> None:
        """Where it stands at the beginning: all of it is seen."""
        initial: Any = self._server.initial_camera
        initial.fov = FIELD_OF_VIEW
        initial.position, initial.look_at = pose("overview", self._world.whole, None)
        span = self._world.frame.span
        initial.near, initial.far = min(0.005 * span, 0.5), 100 * span
