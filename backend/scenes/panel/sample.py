"""Draws flights of the run's random sample as thin lines, to show the findings among typical flights.

These are the first of the sample in order, not a selection, each simulated again with its stored parameters; those of a
simulator are evaluated again, and their results compared with the stored ones.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import sqlalchemy as sa
import viser

from backend.catalog.service import described
from backend.db.engine import read
from backend.db.tables import Run, Stage
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
from campaigns.identity.identity import Identity
from campaigns.stages.found import declared
from campaigns.stored.replies import CaseReply, FlightReply

MOST = 36
"""Maximum number of flights."""
ROWS = 200
"""Maximum number of points of a line."""
TOGETHER = 6
"""Number of flights drawn per batch; cases of a simulator are drawn one by one."""
PATIENCE = 60.0
"""Time after which no further case of a simulator is evaluated [s]: a call may take long."""
ROOT = "/flights/sampled"
ONE = "1 result differs from the stored one."


@dataclass
class Tally:
    """Counts what was drawn of the first `size` evaluations of the sample of a stage, for a sentence."""

    stage: str
    size: int
    setting: Setting
    evaluated: int = 0
    failed: int = 0
    drawn: int = 0
    same: int = 0
    why: str = ""
    """The first reason why one of them could not be drawn."""
    other: str = ""
    """What is other code than that of the run, a sentence."""

    def count(self, answer: FlightReply, stored: float | None, drawn: bool) -> None:
        """One answer, the stored cost, and whether there is a line of it."""
        self.other = self.other or self.setting.other_code(Identity.model_validate(answer["identity"]))
        self.evaluated += 1
        self.failed += answer["status"] != "ok"
        self.drawn += drawn
        self.same += answer["cost"] == stored
        if not drawn:
            untraced = "" if self.setting.clears else cast(CaseReply, answer)["untraced"]
            self.why = self.why or answer["reason"] or untraced or "its trace has no positions"

    def words(self) -> str:
        """The text that describes what is drawn."""
        return " ".join(filter(None, [*(self._flights() if self.setting.clears else self._cases()), self.other]))

    def _flights(self) -> Iterator[str]:
        yield f"Thin: the first {self.size} flights of the sample of {self.stage}, as drawn."
        yield f"{self.failed} failed and end at the failure." if self.failed else ""

    def _cases(self) -> Iterator[str]:
        """A call of a simulator need not repeat: how many results differ is stated."""
        all_of = f"the first {self.evaluated} of the sample of {self.stage}"
        within = "" if self.evaluated == self.size else f", as many as were evaluated within {PATIENCE:g} s"
        yield f"Thin: {all_of}{within}, each evaluated again by one call."
        if self.drawn < self.evaluated:
            yield f"{self.evaluated - self.drawn} of them cannot be drawn: {self.why.rstrip('.')}."
        differ = self.evaluated - self.same
        if not differ:
            yield "All results equal the stored ones."
        else:
            yield f"{differ} results differ from the stored ones." if differ > 1 else ONE


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
            needs = reader.scalar(sa.select(Run.needs).where(Run.id == number(self._setting.run))) or ""
        if not drawn:
            self._note.content = tables.note("No random sample is stored: it comes from certify or from Monte Carlo.")
            return
        self._forget()
        together, patience = (TOGETHER, math.inf) if self._setting.clears else (1, PATIENCE)
        tally, until = Tally(stage, len(drawn), self._setting), time.monotonic() + patience
        for begin in range(0, len(drawn), together):
            simulated = []
            for one in drawn[begin : begin + together]:
                if self._stopped or not self.on:
                    return
                try:
                    answer = self._evaluated(one, needs)
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

    def _evaluated(self, one: evaluations.Evaluated, needs: str) -> FlightReply:
        """The response of the process; needs: the version of the simulator. Raises `LiveError`."""
        document, digest = self._setting.document, self._setting.digest
        if self._setting.clears:
            return self._live.simulate(document, digest, one.parameters, ROWS, one.seed)
        request = {"campaign": document, "simulator": needs, "parameters": one.parameters}
        found: CaseReply = self._live.ask(digest, request | {"rows": ROWS})
        return found

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
