"""The trace of a case as a stage stores it, or why there is none."""

from __future__ import annotations

from collections.abc import Mapping

from campaigns.claims.stages.calls import other_trace
from campaigns.stored.records import Trace
from worker.engine.systems.base import NoTrace, System


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
