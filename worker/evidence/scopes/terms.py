"""The terms in which claims describe a system, by its kind: `terms`."""

from __future__ import annotations

from worker.engine.systems.base import System
from worker.engine.systems.closed_loop.system import ClosedLoop
from worker.engine.systems.simulators.called import Called
from worker.evidence.scopes import closed_loop, simulators
from worker.evidence.scopes.base import Terms
from worker.evidence.scopes.stored_system import Recorded


def terms(system: System) -> Terms:
    """Its scope, the words for its evaluations, what bars or qualifies a claim on it."""
    if isinstance(system, Recorded):
        return system.terms
    if isinstance(system, ClosedLoop):
        return closed_loop.described(system.campaign, system.installed.catalogue, system.reference)
    return (
        simulators.terms(system.inner, system.request.calls) if isinstance(system, Called) else simulators.terms(system)
    )
