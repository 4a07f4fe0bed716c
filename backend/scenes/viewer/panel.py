"""A viewer's panel: its tabs, and what they say is to be seen. Start reading at `Panel`.

A new tab is a `Part` in a file of its own, added here.
"""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa
import viser

from backend.scenes.base.flight import Flight
from backend.scenes.base.part import Driver, Part
from backend.scenes.base.schemas import LayersChange, ViewChange
from backend.scenes.base.setting import Progress, Setting
from backend.scenes.cloud.tab import CloudTab, Shown
from backend.scenes.drawing.flights import Flights
from backend.scenes.drawing.following import Following
from backend.scenes.drawing.vectors import Vectors
from backend.scenes.drawing.world import World
from backend.scenes.live.live import Live
from backend.scenes.panel.convergence_tab import ConvergenceTab
from backend.scenes.panel.field import FieldSlice
from backend.scenes.panel.flight_tab import FlightTab
from backend.scenes.panel.sampled import Sampled
from backend.scenes.panel.what_if_tab import WhatIfTab


class Panel:
    """Builds the tabs; the names of all of them fit into one row."""

    def __init__(
        self,
        server: viser.ViserServer,
        engine: sa.Engine,
        live: Live,
        setting: Setting,
        progress: Progress,
        world: World,
        flights: Flights,
        vectors: Vectors,
        following: Following,
        driver: Driver,
    ) -> None:
        gui, palette = server.gui, world.palette

        def fly(flight: Flight) -> None:
            with driver.drawing():
                flights.fly(flight)
                driver.changed()

        tabs = gui.add_tab_group()
        with tabs.add_tab("Flight"):
            self.flight = FlightTab(gui, setting, flights, vectors, driver, progress.shown)
            self._sampled = Sampled(server, engine, live, setting, palette, driver)
            self._field = FieldSlice(server, setting, world, palette, flights, live, driver)
        with tabs.add_tab("What-if"):
            self._what_if = WhatIfTab(gui, setting, live, flights.what_if, fly, progress)
        with tabs.add_tab("Space"):
            shown = Shown(fly, self._what_if.take, self._what_if.flown)
            self._cloud = CloudTab(server, engine, live, setting, world, progress, following, driver, shown)
        with tabs.add_tab("Search"):
            convergence = ConvergenceTab(gui, setting, palette, progress.curves)
        self.parts: list[Part] = [
            self.flight,
            self._sampled,
            self._field,
            self._what_if,
            self._cloud,
            convergence,
        ]

    def have(self, change: ViewChange) -> None:
        """Show what is asked for; raises `UnknownParameterError` for a what-if or an axis."""
        if change.what_if is not None:
            self._what_if.fly(change.what_if, change.what_if_seed)
        layers = change.layers or LayersChange()
        self._cloud.have(layers.space, layers.axes)
        self.flight.have(layers, change.speed)
        self._sampled.have(layers.sampled)
        self._field.have(layers.field)

    def shown(self) -> dict[str, Any]:
        """What is to be seen, as `ViewState` has it."""
        layers = {
            **self.flight.layers,
            "trail": self.flight.trail,
            "sampled": self._sampled.on,
            "field": self._field.on,
            "space": self._cloud.on,
            "axes": self._cloud.along,
        }
        return {
            "speed": self.flight.speed,
            "layers": layers,
            "what_if": self._what_if.parameters,
            "what_if_seed": self._what_if.seed,
        }
