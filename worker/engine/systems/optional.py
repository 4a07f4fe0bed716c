"""What only some systems define, read of any system: the closed loop of components, a simulator, or a package's own.

Of a system that does not define it, the default. `base.ComponentLoop` and `base.Slotted` state what each member is.
"""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from typing import TypeGuard

from campaigns.results.validate import Beyond
from campaigns.stored.records import Trace
from worker.engine.systems.base import (
    Comparison,
    ComponentLoop,
    Floats,
    PolynomialLoop,
    Realised,
    Settings,
    Shown,
    Stopping,
    System,
)


def settings(system: System) -> Settings:
    """What provenance stores of it besides its digest."""
    return system.settings if _defines(system, "settings") else Settings()


def realisations(system: System) -> Realised:
    """The noise realisations of every evaluation."""
    return system.realisations if _defines(system, "realisations") else Realised()


def compare(
    system: System, vectors: Floats, seeds: Sequence[int | None], cancelled: Stopping = lambda: False
) -> list[Comparison]:
    """What `ComponentLoop.compare` returns; all that `confirm` evaluates, if the system has no faster method."""
    if _defines(system, "compare"):
        return system.compare(vectors, seeds, cancelled)
    return [case.comparisons[-1] for case in system.confirm(vectors, seeds, cancelled)]


def encounter(system: System, nominal: Trace | None) -> Shown | None:
    """What `ComponentLoop.encounter` returns; None if the system does not define it."""
    return system.encounter(nominal) if _defines(system, "encounter") else None


def beyond(
    system: System,
    names: Sequence[str],
    vectors: Floats,
    seeds: Sequence[int | None],
    below: float,
    cancelled: Stopping,
) -> Beyond | None:
    """What `ComponentLoop.beyond` returns; None if the system does not define it."""
    return system.beyond(names, vectors, seeds, below, cancelled) if _defines(system, "beyond") else None


def own_rule(system: System) -> bool:
    """What `ComponentLoop.own_rule` states; False if the system does not define it."""
    return system.own_rule if _defines(system, "own_rule") else False


def about_trim(system: System) -> PolynomialLoop | None:
    """What `ComponentLoop.about_trim` returns; None if the system does not define it."""
    return system.about_trim() if _defines(system, "about_trim") else None


def warm(system: System) -> None:
    """Prepare the first evaluation."""
    if _defines(system, "warm"):
        system.warm()


def close(system: System) -> None:
    """Release what it holds; the closed loop holds nothing."""
    if _defines(system, "close"):
        getattr(system, "close")()  # noqa: B009  `ComponentLoop` has none


def _defines(system: System, member: str) -> TypeGuard[ComponentLoop]:
    """Whether it has this member, typed as that of the closed loop."""
    return inspect.getattr_static(system, member, None) is not None  # `hasattr` is false where a property fails
