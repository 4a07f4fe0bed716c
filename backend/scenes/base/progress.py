"""The results of a run so far, as its scene shows them."""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa

from backend.db.tables import Finding, Run, Stage, Trace
from backend.results import service as results
from backend.results.improvements import Improvements
from backend.results.noise import seeds
from backend.scenes.base.flight import Flight, from_stored
from backend.scenes.base.setting import NOMINAL, WORST, Setting
from campaigns.runs import ENDED


class Progress:
    def __init__(self, setting: Setting, run_id: int, shown: str = WORST) -> None:
        """`shown` is the flight shown with the nominal one."""
        self._setting, self._run_id, self.shown = setting, run_id, shown
        self.flights: dict[str, Flight] = {}
        self.findings: dict[str, dict[str, float]] = {}
        """{label: {path: value}}"""
        self.seeds: dict[str, int] = {}
        """Noise seeds of the findings that drew their own realisation."""
        self.curves = {position: Improvements() for position, _, _ in setting.methods}
        self.over = False
        self._seen: dict[str, object] = {}

    @property
    def choices(self) -> list[str]:
        return [*self.findings, NOMINAL]

    def show(self, label: str, reader: sa.Connection) -> None:
        if self.shown != NOMINAL:
            self.flights.pop(self.shown, None)
            self._seen.pop(self.shown, None)
        self.shown = label
        self.look(reader)

    def look(self, reader: sa.Connection) -> bool:
        before = self._state()
        self.over = reader.scalar(sa.select(Run.state).where(Run.id == self._run_id)) in ENDED
        shown = sa.select(Trace.name, Trace.meta).where(
            Trace.run_id == self._run_id, Trace.name.in_((NOMINAL, self.shown))
        )
        for name, meta in reader.execute(shown).all():
            if self._seen.get(name) != meta:  # stored for the first time, or again by a later stage
                self._seen[name] = meta
                flight = from_stored(results.stored(reader, self._run_id, name))
                if flight is not None:
                    self.flights[name] = flight
        found = sa.select(Finding.label, Finding.parameters).where(Finding.run_id == self._run_id)
        rows = sorted(reader.execute(found).all(), key=lambda row: (len(row.label), row.label))
        self.findings = {row.label: row.parameters for row in rows}
        self.seeds = seeds(reader, self._run_id)
        stored = sa.select(Stage.position, Stage.evaluations).where(Stage.run_id == self._run_id)
        for position, evaluations in reader.execute(stored).all():
            if position in self.curves and evaluations > self.curves[position].read:
                self.curves[position].catch_up(reader, self._run_id, position)
        return before != self._state()

    def _state(self) -> tuple[Any, ...]:
        read = [curve.read for curve in self.curves.values()]
        return dict(self.flights), self.findings, read, self.over
