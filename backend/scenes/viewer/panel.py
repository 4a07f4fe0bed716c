"""A viewer's panel: its own controls, and the layers that have a legend.

Time, layers, selection and what-if are controlled by the page. A new tab is a `Part` in its own file, added here.
"""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa
import viser

from backend.http.errors import RefusedError
from backend.scenes.base.part import Driver, Part
from backend.scenes.base.progress import Progress
from backend.scenes.base.schemas import LayersChange
from backend.scenes.base.setting import Setting
from backend.scenes.drawing.flights import Flights
from backend.scenes.drawing.vectors import Vectors
from backend.scenes.drawing.world import World
from backend.scenes.live.live import Live
from backend.scenes.panel.convergence_tab import ConvergenceTab
from backend.scenes.panel.field import FieldSlice
from backend.scenes.panel.sample import Sampled
from backend.scenes.panel.values_tab import ValuesTab


class Panel:
    """Builds the tabs; their titles fit into one row."""

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
        driver: Driver,
    ) -> None:
        gui, palette = server.gui, world.palette
        tabs = gui.add_tab_group()
        with tabs.add_tab("Values"):
            values = ValuesTab(gui, setting, flights, vectors)
            self._sampled = Sampled(server, engine, live, setting, palette, driver)
            scene = (server, setting, world, palette, flights, live, driver)
            self._field = FieldSlice(*scene) if setting.clears else None
            """Only scenarios have an avoider, whose field is a layer."""
        with tabs.add_tab("Search"):
            convergence = ConvergenceTab(gui, setting, palette, progress.curves)
        self.parts: list[Part] = [values, self._sampled, *([self._field] if self._field else []), convergence]

    def have(self, layers: LayersChange) -> None:
        """Change the layers; raises `RefusedError` if they are not available."""
        if self._field is None and layers.field:
            text = "this run evaluates a simulator, whose avoider is not known: the layer field is not available"
            raise RefusedError("unknown-parameter", text)
        self._sampled.have(layers.sampled)
        if self._field is not None:
            self._field.have(layers.field)

    @property
    def layers(self) -> dict[str, Any]:
        return {"sampled": self._sampled.on, "field": self._field is not None and self._field.on}
