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
        self._run_id, self.shown = run_id, shown
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
        rows = reader.execute(shown).all()
        for name in self.flights.keys() - {row.name for row in rows}:  # the run was reset
            del self.flights[name], self._seen[name]
        for name, meta in rows:
            if self._seen.get(name) != meta:  # stored for the first time, or again by a later stage
                self._seen[name] = meta
                flight = from_stored(results.stored(reader, self._run_id, name))
                if flight is not None:
                    self.flights[name] = flight
        found = sa.select(Finding.label, Finding.parameters).where(Finding.run_id == self._run_id)
        labelled = sorted(reader.execute(found).all(), key=lambda row: (len(row.label), row.label))
        self.findings = {row.label: row.parameters for row in labelled}
        self.seeds = seeds(reader, self._run_id)
        stored = sa.select(Stage.position, Stage.started, Stage.evaluations).where(Stage.run_id == self._run_id)
        stages = {row.position: row for row in reader.execute(stored).all()}
        for position, curve in self.curves.items():
            stage = stages.get(position)
            self.curves[position] = curve.of(stage and stage.started)
            if stage is not None and stage.evaluations > self.curves[position].read:
                self.curves[position].catch_up(reader, self._run_id, position)
        return before != self._state()

    def _state(self) -> tuple[Any, ...]:
        read = [(curve.started, curve.read) for curve in self.curves.values()]
        return dict(self.flights), self.findings, read, self.over
