"""The tab with the numbers at the displayed time, and the legends."""

from __future__ import annotations

from typing import Any

import viser

from backend.scenes.base.part import Part
from backend.scenes.base.setting import Setting
from backend.scenes.drawing.flights import WHAT_IF, Flights
from backend.scenes.drawing.vectors import Vectors
from backend.scenes.panel import tables


class ValuesTab(Part):
    """Separation and speeds of every flight; display only, the page has the controls."""

    def __init__(self, gui: viser.GuiApi, setting: Setting, flights: Flights, vectors: Vectors) -> None:
        self._setting, self._flights, self._vectors = setting, flights, vectors
        self._readout: Any = gui.add_html("")
        self._note: Any = gui.add_html("")
        self._code: Any = gui.add_html("")

    def moved(self, time: float) -> None:
        separations = tables.separations(self._flights.every, self._setting, time)
        self._readout.content = separations + tables.speeds(self._flights.every, time, self._vectors.decimals)

    def changed(self) -> None:
        self.moved(self._flights.time)
        ahead = self._vectors.ahead
        arrows = f"The length of an arrow is the distance travelled in {ahead:g} s. " if ahead else ""
        self._note.content = tables.note(f"{arrows}Dots every {self._flights.dots:g} s.")
        what_if = self._flights.what_if.flight
        other = "" if what_if is None else self._setting.other_code(what_if.identity)
        self._code.content = tables.note(f"{WHAT_IF}: {other}", strong=True) if other else ""
