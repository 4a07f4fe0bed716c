"""The base class of simulators: declared parameters and results, terms in sentences, confirmation by repetition.

A package derives its simulator from `Simulated` and implements `evaluate` and `digest`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from campaigns.catalogue import SimulatorEntry
from campaigns.claims.say import say
from campaigns.results.base import OK
from worker.catalogue.simulator import Opening
from worker.systems.base import Comparison, Confirmed, Floats, Parameter, Reasons, Result, Scope, System, Words

FRESH = "a fresh evaluation"


class Simulated(System):
    """A simulator with its own parameters; it draws no seeds, and has no trace and no evidence of an encounter.

    Costs have one column, the result that the campaign names. Cases are confirmed one by one with the simulator that
    `fresh` returns: this shows whether results repeat, not that the model is correct.
    """

    def __init__(self, entry: SimulatorEntry, opening: Opening) -> None:
        self.entry = entry
        self.opening = opening
        self.parameters = tuple(
            Parameter(
                f"simulator.{p.name}", p.unit, opening.nominal[f"simulator.{p.name}"], p.low, p.high, p.text, p.symbol
            )
            for p in entry.parameters
        )
        self.nominal = np.array([p.nominal for p in self.parameters])
        asked = next(r for r in entry.results if r.name == opening.result)
        self.results = (Result(asked.name, asked.title, asked.quantity, asked.unit, asked.worse),)

    def fresh(self) -> System:
        """The same simulator, without any state of earlier evaluations."""
        return type(self)(self.entry, self.opening)

    @property
    def scope(self) -> Scope:
        return Scope(
            what=say(f"{self.entry.title}, simulator {self.entry.name}"),
            settings=(),
            version=f"simulator digest {self.digest[:12]}",
        )

    @property
    def words(self) -> Words:
        return Words(
            one="case",
            agree=f"{FRESH} agrees",
            disagrees=f"{FRESH} disagrees",
            every="both evaluations",
            again=f"evaluated again, each in {FRESH}",
            reference=FRESH,
            check="repetition",
        )

    @property
    def caveat(self) -> str:
        return (
            "Cases were evaluated again by the same simulator only. Whether an encounter takes place was not checked."
        )

    def confirm(
        self, vectors: Floats, seeds: Sequence[int | None], cancelled: Callable[[], bool] = lambda: False
    ) -> list[Confirmed]:
        batch, _ = self.evaluate(vectors)
        first = [float(c) if s == OK else None for c, s in zip(batch.costs[:, 0], batch.status, strict=True)]
        again = self.compare(vectors, seeds, cancelled)
        return [Confirmed(cost, (other,)) for cost, other in zip(first, again, strict=False)]

    def compare(
        self, vectors: Floats, seeds: Sequence[int | None], cancelled: Callable[[], bool] = lambda: False
    ) -> list[Comparison]:
        found: list[Comparison] = []
        fresh = self.fresh()
        try:
            for vector in vectors:
                if cancelled():
                    break
                found.append(_again(fresh, vector))
        finally:
            fresh.close()
        return found


def _again(fresh: System, vector: Floats) -> Comparison:
    """Evaluate one vector (n,) in its own call."""
    batch, reasons = fresh.evaluate(vector[None, :])
    if batch.status[0] != OK:
        return Comparison("again", FRESH, None, _reason(reasons))
    return Comparison("again", FRESH, float(batch.costs[0, 0]))


def _reason(reasons: Reasons) -> str:
    return reasons.get(0, "the evaluation failed")
