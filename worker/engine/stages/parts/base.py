"""Shared by the stages: the driver between a method and the system that evaluates."""

from __future__ import annotations

from campaigns.claims.stages import ends
from campaigns.stored.records import Columns
from worker.engine.search.base import Ended, Parallel, Search
from worker.engine.stages.parts.context import Asking, Cancelled, Context, Driven
from worker.engine.stages.parts.driver import Driver
from worker.engine.stages.parts.ended import stop
from worker.engine.stages.parts.slot_driver import SlotDriver
from worker.engine.systems.base import Floats, slots


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
