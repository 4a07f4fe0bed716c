"""The base class of simulators: declared parameters and results, confirmation by repetition.

A package derives its simulator from `Simulated` and implements `evaluate` and `digest`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

import numpy as np

from campaigns.catalogue import SimulatorEntry
from campaigns.results.base import OK
from campaigns.results.scene import Scene
from worker.engine.systems.base import Comparison, Confirmed, Floats, Parameter, Realised, Result, Slotted, with_values
from worker.engine.systems.simulators.declared.columns import Column
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.declared.unchanged import Unchanged

FRESH = "a fresh evaluation"


class Simulated(Slotted):
    """A simulator with its own parameters; it draws no seeds and gives no evidence of an encounter.

    Costs have one column, the result that the campaign names. Cases are confirmed one by one with the simulator that
    `fresh` returns: this shows whether results repeat, not that the model is correct.
    """

    step: float | None = None
    """Its step, if it declares one; of an FMU its communication step."""
    columns: Mapping[str, Column] = MappingProxyType({})
    """Of the trace that it returns on request; empty if it returns none."""
    scene: Scene | None = None
    """What is drawn of a trace, if it declares this."""

    unchanged: Unchanged | None = None
    """Its files as this run opened it; that of the simulator from which a fresh one was made."""

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
        deciding = next(r for r in entry.results if r.name == opening.result)
        self.results = (Result(deciding.name, deciding.title, deciding.quantity, deciding.unit, deciding.worse),)

    def changed(self, now: bool = False, everywhere: bool = False) -> str:
        """Why nothing more is evaluated: its files are no longer those of its digest; empty if they are.

        now: look at them now, not only now and then; everywhere: also on other machines that evaluate.
        """
        return "" if self.unchanged is None else self.unchanged.changed(now)

    @property
    def realisations(self) -> Realised:
        return Realised(undeclared=self.entry.seeds)

    def _vector(self, values: Mapping[str, float]) -> Floats:
        """The nominal vector with these values by path; raises KeyError."""
        return with_values(self.nominal, self.names, values)

    def _by_path(self, vector: Floats) -> dict[str, float]:
        return {p.path: float(v) for p, v in zip(self.parameters, vector[: len(self.parameters)], strict=True)}

    def fresh(self) -> Slotted:
        """This simulator without any state of earlier evaluations."""
        return type(self)(self.entry, self.opening)

    def halved(self) -> Simulated | None:
        """The simulator with its step halved, which the caller closes; None without a step."""
        return None

    def confirm(
        self, vectors: Floats, seeds: Sequence[int | None], cancelled: Callable[[], bool] = lambda: False
    ) -> list[Confirmed]:
        batch, _ = self.evaluate(vectors)
        first = [float(c) if s == OK else None for c, s in zip(batch.costs[:, 0], batch.status, strict=True)]
        again = self.compare(vectors, seeds, cancelled)
        halved = self.halved()
        if halved is None:
            return [Confirmed(cost, (other,)) for cost, other in zip(first, again, strict=False)]
        try:
            halves = [_at_half(halved, vector) for vector in vectors[: len(again)] if not cancelled()]
        finally:
            halved.close()
        found = zip(first, halves, again, strict=False)
        return [Confirmed(cost, (half, other), self.step) for cost, half, other in found]

    def compare(
        self, vectors: Floats, seeds: Sequence[int | None], cancelled: Callable[[], bool] = lambda: False
    ) -> list[Comparison]:
        found: list[Comparison] = []
        fresh = self.fresh()
        # In slots each has a process of its own anyway; without them it gets a call of its own.
        size = 4 * fresh.slots or 1
        try:
            for first in range(0, len(vectors), size):
                if cancelled():
                    break
                found += _again(fresh, vectors[first : first + size])
        finally:
            fresh.close()
        return found


def _again(fresh: Slotted, vectors: Floats) -> list[Comparison]:
    batch, reasons = fresh.evaluate(vectors)
    return [
        Comparison("again", FRESH, float(cost))
        if status == OK
        else Comparison("again", FRESH, None, reasons.get(k, "the evaluation failed"))
        for k, (cost, status) in enumerate(zip(batch.costs[:, 0], batch.status, strict=True))
    ]


def _at_half(halved: Simulated, vector: Floats) -> Comparison:
    (other,) = _again(halved, vector[None, :])
    return Comparison("half_step", "half the step", other.cost, other.reason, halved.step)
