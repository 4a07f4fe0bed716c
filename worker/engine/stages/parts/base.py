"""Shared by the stages: the driver between a method and the system that evaluates, random streams, traces."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from campaigns.claims.stages import ends
from campaigns.claims.stages.calls import other_trace
from campaigns.stored.records import Columns, Trace
from worker.engine.search.base import Ended, Parallel, Search
from worker.engine.stages.parts.context import Asking, Cancelled, Context, Driven
from worker.engine.stages.parts.driver import Driver
from worker.engine.stages.parts.ended import stop
from worker.engine.stages.parts.slot_driver import SlotDriver
from worker.engine.systems.base import Floats, NoTrace, System, slots


def drive(
    context: Context, position: int, search: Parallel | Asking[str], budget: int, repeats: bool = False
) -> Driven:
    """Evaluate what a search requests until its own rule or the budget ends it; raises `Cancelled`."""
    kind = SlotDriver if slots(context.problem.system) else Driver
    driver = kind(context, position, budget, repeats)
    try:
        points = next(search)
        while True:
            if context.cancelled():
                raise Cancelled
            batch, spent = driver.answer(points)
            if spent:
                return driver.end(stop("budget", Ended("budget", ends.BUDGET, budget=budget)))
            points = search.send(batch)
    except StopIteration as stopped:
        return driver.end(stop("rule", stopped.value))
    finally:
        search.close()
        driver.flush()


def once(points: Floats, text: str) -> Search:
    """A search that requests these points and ends."""
    yield points
    return text


def all_columns(context: Context, positions: list[int]) -> list[tuple[int, Columns]]:
    """The evaluations of these stages, from memory or from the store."""
    found = []
    for position in positions:
        if position not in context.columns:
            stored = context.store.evaluations(position)
            if stored is None:
                continue
            context.columns[position] = stored
        found.append((position, context.columns[position]))
    return found


def stream(seed: int, index: int) -> np.random.Generator:
    """The random stream of search stage `index`: independent of every other stage and of the worker."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(index,)))


def traced(
    system: System, name: str, values: Mapping[str, float], cost: float | None, exact: bool
) -> tuple[Trace | None, str]:
    """The trace of a simulator's case, and why there is none; both are empty if the simulator gives no traces.

    A trace shows an evaluation of its own. If `exact`, it is only stored if that has the stored cost to the bit:
    otherwise it would show something else than what the finding states.
    """
    if cost is None:
        return None, ""
    try:
        found = system.trace(name, values)
    except NoTrace as error:
        return None, str(error)
    if found is None or not exact or found.meta.cost == cost:
        return found, ""
    return None, other_trace(found.meta.cost, cost)
