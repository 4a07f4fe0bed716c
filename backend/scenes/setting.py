"""What a scene shows before anything has flown, and what the run has found so far. Start reading at `load`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import sqlalchemy as sa
from numpy.typing import NDArray

from backend.catalog.service import published
from backend.db.tables import Finding, Run, Stage, Trace
from backend.results import service as results
from backend.results.improvements import Improvements
from backend.runs.service import campaign
from backend.scenes.flight import Flight, from_stored
from campaigns.check import parameters

OVER = ("done", "failed", "cancelled")
NOMINAL, WORST = "nominal", "F1"
SHOWN = (NOMINAL, WORST)
"""The stored flights that are drawn."""


@dataclass(frozen=True)
class Obstacle:
    """A body in the way [m]."""

    position: NDArray[np.float64]
    radius: float


@dataclass(frozen=True)
class Uncertain:
    """One uncertain parameter for a slider, in its unit."""

    path: str
    symbol: str
    unit: str
    text: str
    nominal: float
    low: float
    high: float


@dataclass(frozen=True)
class Setting:
    """The scene's fixed part [m], and what the viewer says of it."""

    run: str
    title: str
    digest: str
    document: dict[str, Any]
    planar: bool
    start: NDArray[np.float64]
    goal: NDArray[np.float64]
    obstacles: list[Obstacle]
    threshold: float
    quantity: str
    unit: str
    horizon: float
    uncertain: list[Uncertain]
    methods: list[tuple[int, str, str]]
    """Position, name and title of each search stage."""


def load(reader: sa.Connection, run_id: int) -> Setting:
    """The setting of a run; 404 for none."""
    asked = campaign(reader, run_id)
    catalogue = published(reader)
    known = {} if catalogue is None else parameters(asked, catalogue)
    values = {path: nominal for path, (_, nominal) in known.items()}
    vehicle = None if catalogue is None else catalogue.component("vehicle", asked.scenario.vehicle.component)
    criterion = None if catalogue is None else catalogue.component("criterion", asked.criterion.component)
    titles = {} if catalogue is None else {m.name: m.title for m in catalogue.methods}
    first = 1 + (asked.stages.sensitivity is not None)
    return Setting(
        run=f"R-{run_id:04d}",
        title=asked.name,
        digest=asked.digest,
        document=asked.document(),
        planar=vehicle is None or vehicle.dimension == 2,
        start=_place(values, "start"),
        goal=_place(values, "goal"),
        obstacles=[
            Obstacle(_place(values, f"obstacles.{i}.position"), values.get(f"obstacles.{i}.radius", 0.0))
            for i in range(len(asked.scenario.obstacles))
        ],
        threshold=asked.criterion.threshold,
        quantity=criterion.quantity if criterion else "",
        unit=criterion.unit if criterion else "",
        horizon=asked.scenario.horizon,
        uncertain=[
            Uncertain(path, entry.symbol, entry.unit, entry.text, nominal, *bounds.interval(nominal))
            for path, bounds in asked.uncertain.items()
            for entry, nominal in [known[path]]
        ]
        if known.keys() >= asked.uncertain.keys()
        else [],
        methods=[(first + i, s.method, titles.get(s.method, s.method)) for i, s in enumerate(asked.stages.search)],
    )


def _place(values: Mapping[str, float], prefix: str) -> NDArray[np.float64]:
    return np.array([values.get(f"{prefix}.{axis}", 0.0) for axis in "xyz"])


class Progress:
    """What a run has found, looked at again and again while it runs."""

    def __init__(self, setting: Setting, run_id: int) -> None:
        self._setting, self._run_id = setting, run_id
        self.flights: dict[str, Flight] = {}
        self.findings: dict[str, dict[str, float]] = {}
        """{label: {path: value}}"""
        self.curves = {position: Improvements() for position, _, _ in setting.methods}
        self.over = False
        self._seen: dict[str, Any] = {}

    def look(self, reader: sa.Connection) -> bool:
        """Read what is new; whether there was anything."""
        before = self._state()
        self.over = reader.scalar(sa.select(Run.state).where(Run.id == self._run_id)) in OVER
        shown = sa.select(Trace.name, Trace.meta).where(Trace.run_id == self._run_id, Trace.name.in_(SHOWN))
        for name, meta in reader.execute(shown).all():
            if self._seen.get(name) != meta:  # stored for the first time, or again by a later stage
                self._seen[name] = meta
                flight = from_stored(results.stored(reader, self._run_id, name))
                if flight is not None:
                    self.flights[name] = flight
        found = sa.select(Finding.label, Finding.parameters).where(Finding.run_id == self._run_id)
        rows = sorted(reader.execute(found).all(), key=lambda row: (len(row.label), row.label))
        self.findings = {row.label: row.parameters for row in rows}
        flown = sa.select(Stage.position, Stage.evaluations).where(Stage.run_id == self._run_id)
        for position, evaluations in reader.execute(flown).all():
            if position in self.curves and evaluations > self.curves[position].read:
                self.curves[position].catch_up(reader, self._run_id, position)
        return before != self._state()

    def _state(self) -> tuple[Any, ...]:
        read = [curve.read for curve in self.curves.values()]
        return dict(self.flights), self.findings, read, self.over
