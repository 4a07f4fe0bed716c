"""Draws flights of the run's random sample as thin lines, to show the findings among typical flights.

These are the first of the sample in order, not a selection, each simulated again with its stored parameters; those of a
simulator are evaluated again, and their results compared with the stored ones.
"""

from __future__ import annotations

import itertools
import time
from typing import Any

import numpy as np
import sqlalchemy as sa
import viser

from backend.catalog.service import described
from backend.db.engine import read
from backend.db.tables import Stage
from backend.results import evaluations
from backend.runs.service import number
from backend.scenes.base.axes import Floats
from backend.scenes.base.flight import from_live
from backend.scenes.base.palette import Palette, rgb
from backend.scenes.base.part import Driver, Part
from backend.scenes.base.setting import Setting
from backend.scenes.drawing import shapes
from backend.scenes.drawing.solids import Solids
from backend.scenes.live.latest import Latest
from backend.scenes.live.live import Live, LiveError
from backend.scenes.panel import tables
from backend.scenes.panel.again import of_run
from campaigns.stages.found import declared

MOST = 36
"""Maximum number of flights."""
ROOT = "/flights/sampled"


class Sampled(Part):
    def __init__(
        self,
        server: viser.ViserServer,
        engine: sa.Engine,
        live: Live,
        setting: Setting,
        palette: Palette,
        driver: Driver,
    ) -> None:
        self._solids, self._engine, self._live, self._setting = Solids(server), engine, live, setting
        self._palette, self._driver = palette, driver
        self._lines: list[Floats] = []
        """One node per batch of flights (n, 2, 3)."""
        self._nodes: list[Any] = []
        self._root: Any = server.scene.add_frame(ROOT, show_axes=False, visible=False)
        self.on = False
        """Whether they are visible."""
        self._note: Any = server.gui.add_html("")
        self._whole = self._stopped = False
        self._latest: Latest[None] = Latest(lambda _: self._fly())

    def paint(self, palette: Palette) -> None:
        self._palette = palette
        self._nodes = [self._line(n, lines) for n, lines in enumerate(self._lines)]

    def stop(self) -> None:
        self._stopped = True
        self._latest.stop()

    def have(self, on: bool | None) -> None:
        """Show or hide them; None leaves them unchanged."""
        if on is None or on == self.on:
            return
        with self._driver.drawing():
            self.on = self._root.visible = on
        if on and not self._whole:
            self._latest.ask(None)

    def _fly(self) -> None:
        with read(self._engine) as reader:
            stage, drawn = _sample(reader, number(self._setting.run), self._setting)
            again = of_run(reader, self._live, self._setting)
        if not drawn:
            self._note.content = tables.note("No random sample is stored: it comes from certify or from Monte Carlo.")
            return
        self._forget()
        tally, until = again.tally(stage, len(drawn), self._setting), time.monotonic() + again.patience
        for begin in range(0, len(drawn), again.together):
            simulated = []
            for one in drawn[begin : begin + again.together]:
                if self._stopped or not self.on:
                    return
                try:
                    answer = again.answer(one.parameters, one.seed)
                except LiveError as error:
                    self._note.content = tables.note(str(error), strong=True)
                    return
                flight = from_live(answer)
                tally.count(answer, one.cost, flight is not None)
                simulated += [] if flight is None else [shapes.polyline(flight.position)]
            self._add(simulated)
            if time.monotonic() > until:
                break
        self._whole = True
        with self._driver.drawing():
            self._note.content = tables.note(tally.words())

    def _forget(self) -> None:
        with self._driver.drawing():
            for node in self._nodes:
                node.remove()
            self._lines, self._nodes = [], []

    def _add(self, simulated: list[Floats]) -> None:
        if simulated:
            with self._driver.drawing():
                self._lines.append(np.concatenate(simulated))
                self._nodes.append(self._line(len(self._nodes), self._lines[-1]))

    def _line(self, n: int, segments: Floats) -> Any:
        return self._solids.line(f"{ROOT}/{n}", segments, rgb(self._palette.sampled), 1.0)


def _sample(reader: sa.Connection, run_id: int, setting: Setting) -> tuple[str, list[evaluations.Evaluated]]:
    """The stage with a random sample, certify preferred to a search, and its first flights."""
    whole = (Stage.evaluations > 0, Stage.counted == 0)  # the lowest flights of a sample are no sample
    query = sa.select(Stage.position, Stage.kind, Stage.method).where(Stage.run_id == run_id, *whole)
    stages = reader.execute(query.order_by(Stage.position)).all()
    catalogue = described(reader, run_id)
    titles = {} if catalogue is None else {m.name: m.title for m in catalogue.methods if m.kind == "random"}
    independent = {kind for kind, stage in declared().items() if stage.independent}
    requests = setting.document.get("stages", {})
    sampled = itertools.chain(
        (
            (f"the {stage.kind} stage", stage, min(MOST, (requests.get(stage.kind) or {}).get("samples", MOST)))
            for stage in stages
            if stage.kind in independent
        ),
        ((titles[stage.method], stage, MOST) for stage in stages if stage.method in titles),
    )
    for name, stage, most in sampled:
        return name, evaluations.drawn_first(reader, run_id, stage.position, most)
    return "", []
