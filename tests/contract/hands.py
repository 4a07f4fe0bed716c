"""Every component in few scenes, for tests that compile."""

from __future__ import annotations

from functools import cache

from campaigns import library, load_file
from clearance.testing.scenes import controller_for, entry, of_role
from worker.engine.kernels.component import Component, Controller, Vehicle


@cache
def published() -> frozenset[str]:
    """The avoiders of the library's campaigns: tests of the cases compile them and compare published values; of those
    that avoid nothing, ORCA and the right of way, tests/physics/test_avoiders.py compiles the kernels alone."""
    return frozenset(load_file(path).given_scenario.avoider.component for path in library().values())


def together() -> list[tuple[Component, ...]]:
    """Every component in few scenes, except that of the avoiders in `published` only some are needed.

    A scene has one avoider; all other components are dealt to the scenes in turn.
    """
    found: list[tuple[Component, ...]] = []
    for dimension in (2, 3):
        pairs = _covering([v for v in of_role("vehicle") if v.dimension == dimension])
        avoiders = [a for a in of_role("avoider") if entry(a).dimension == dimension]
        avoiders.sort(key=lambda a: a.name in published())
        needed = max(len(pairs), sum(a.name not in published() for a in avoiders))
        hands: list[list[Component]] = [[a] for a in avoiders[:needed]]
        for k, hand in enumerate(hands):
            hand.extend(pairs[k % len(pairs)])
        # Components with both dimensions are tested in the plane, where loops compile in half the time.
        rest = {role: of_role(role) for role in ("obstacle", "environment", "fault", "criterion")}
        for role, cards in rest.items():
            fit = [c for c in cards if (entry(c).dimension or 2) == dimension]
            first = len(hands) // 2 if role == "criterion" else 0
            for k, card in enumerate(fit):
                hands[(first + k) % len(hands)].append(card)
        found += map(tuple, hands)
    return found


def _covering(vehicles: list[Vehicle]) -> list[tuple[Vehicle, Controller]]:
    """Vehicles with controllers that fit, each of both at least once; all pairs: tests/contract/test_pairs.py."""
    found: list[tuple[Vehicle, Controller]] = []
    left = [c for c in of_role("controller") if any(v.name in c.fits for v in vehicles)]
    for vehicle in vehicles:
        fits = [c for c in left if vehicle.name in c.fits] or [controller_for(vehicle)]
        found.append((vehicle, fits[0]))
        left = [c for c in left if c is not fits[0]]
    return found + [(next(v for v in vehicles if v.name in c.fits), c) for c in left]
