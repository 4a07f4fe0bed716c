"""The tab with the numbers of the instant that is shown, and the legends of what is drawn. Read `ValuesTab`."""

from __future__ import annotations

from typing import Any

import viser

from backend.scenes.base.part import Part
from backend.scenes.base.setting import Setting
from backend.scenes.drawing.flights import Flights
from backend.scenes.drawing.vectors import Vectors
from backend.scenes.panel import tables


class ValuesTab(Part):
    """Separation and speeds of every flight now; nothing is set here, that is the page's."""

    def __init__(self, gui: viser.GuiApi, setting: Setting, flights: Flights, vectors: Vectors) -> None:
        self._setting, self._flights, self._vectors = setting, flights, vectors
        self._readout: Any = gui.add_html("")
        self._note: Any = gui.add_html("")

    def moved(self, time: float) -> None:
        """The numbers of another time."""
        separations = tables.separations(self._flights.every, self._setting, time)
        self._readout.content = separations + tables.speeds(self._flights.every, time, self._vectors.decimals)

    def changed(self) -> None:
        """The same for other flights."""
        self.moved(self._flights.time)
        ahead = self._vectors.ahead
        arrows = f"An arrow is as long as the way of {ahead:g} s at that velocity. " if ahead else ""
        self._note.content = tables.note(f"{arrows}Dots every {self._flights.dots:g} s.")
