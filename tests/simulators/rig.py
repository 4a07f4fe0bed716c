"""A package's simulator that derives from the interface of systems alone, and has slots and terms of its own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Future

import numpy as np

from campaigns.claims.say import say
from campaigns.claims.spans import Spans
from campaigns.results.base import OK
from tests.simulators import two_basins
from worker.engine.search.base import Batch
from worker.engine.systems.base import (
    Comparison,
    Confirmed,
    Evaluated,
    Floats,
    Parameter,
    Reasons,
    Result,
    Scope,
    Seeds,
    System,
    Words,
)
from worker.engine.systems.simulators.declared.simulator import Opening

BAR = ("rig", say("the rig was not calibrated"))


class Rig(System):
    """Derives from the interface alone, and has slots."""

    results = (Result("separation", "Separation", "d_sep", "m", "low"),)
    digest = "d" * 64  # type: ignore[assignment]
    scope = Scope(say("a rig"), (), "rig 7")
    words = Words("drive", "the rig agrees", "the rig disagrees", "all drives", "driven again", "the rig")
    slots = 2

    def __init__(self, opening: Opening) -> None:
        self.opening = opening
        entries = two_basins.ENTRY.parameters
        nominal = [opening.nominal[f"simulator.{p.name}"] for p in entries]
        self.parameters = tuple(
            Parameter(f"simulator.{p.name}", p.unit, at, p.low, p.high, p.text)
            for p, at in zip(entries, nominal, strict=True)
        )
        self.nominal = np.array(nominal)

    def fresh(self) -> System:
        return Rig(self.opening)

    def evaluate(self, vectors: Floats, seeds: Seeds | None = None) -> tuple[Batch, Reasons]:
        return Batch(vectors[:, self.names["simulator.x"], None], np.full(len(vectors), OK, dtype=np.uint8)), {}

    def submit(self, vector: Floats, seed: int | None = None) -> Future[Evaluated]:
        ended: Future[Evaluated] = Future()
        ended.set_result(Evaluated(vector[:1], OK, ""))
        return ended

    def confirm(
        self, vectors: Floats, seeds: Sequence[int | None], cancelled: Callable[[], bool] = lambda: False
    ) -> list[Confirmed]:
        again = [Comparison("again", "another drive", float(v[0])) for v in vectors if not cancelled()]
        return [Confirmed(other.cost, (other,)) for other in again]

    def bars(self) -> list[tuple[str, Spans]]:
        return [BAR]
