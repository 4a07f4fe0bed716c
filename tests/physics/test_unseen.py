"""An obstacle that is not seen has no effect on any avoider, at any of its parameters' limits and any speed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from campaigns.asked.spec import Part
from campaigns.checked.orders import broken
from tests.physics.bodies import OBSTACLES, _body
from worker.engine.kernels.bind import plain
from worker.engine.kernels.component import Avoider, declared
from worker.engine.kernels.views import CLEAR_SIGHT, shown
from worker.running.catalogue.installed import catalogue, components

AVOIDERS = [c for c in components().values() if isinstance(c, Avoider)]
UNSEEN = CLEAR_SIGHT._replace(visible=0.0)


def demanded(avoider: Avoider, bodies: tuple[Any, ...], q: Any, v: Any, goal: Any, p: Any) -> Any:
    """The demand and the memory after one sample at t = 1 s."""
    memory = plain(avoider.remember)(p)
    if avoider.weigh is not None and avoider.first is not None:
        weighed = plain(avoider.first)(1.0, q, v, goal, memory, p)
        for k, body in enumerate(bodies):
            weighed = plain(avoider.weigh)(weighed, float(k), body, 1.0, q, v, goal, memory, p)
        return plain(avoider.steer)(1.0, q, v, goal, weighed, memory, p)
    return plain(avoider.steer)(1.0, q, v, goal, bodies, memory, p)


@pytest.mark.parametrize("avoider", AVOIDERS, ids=lambda a: a.name)
def test_what_is_not_seen_changes_nothing(avoider: Avoider) -> None:
    random, d = np.random.default_rng(8), avoider.dimension
    obstacle = next(o for o in OBSTACLES if o.name == ("circle" if d == 2 else "sphere"))
    own, goals = declared(avoider.parameters), declared(avoider.goal)
    entry = catalogue().component("avoider", avoider.name)
    for _ in range(100):
        p: Any = avoider.parameters(*(random.choice([s.low, s.high, s.default or s.low]) for s in own))
        bounds = {f"avoider.{s.name}": (p[k], p[k]) for k, s in enumerate(own)}
        if entry is None or list(broken([("avoider", "", entry, Part(component=avoider.name))], bounds)):
            continue
        if avoider.derived is not None:
            p = avoider.derived.constants(*plain(avoider.derived.derive)(p, ()))
        goal = avoider.goal(*(float(random.uniform(max(s.low, -50.0), min(s.high, 50.0))) for s in goals))
        q = tuple(map(float, random.uniform(-30.0, 30.0, d)))
        body = _body(obstacle, {})(1.0, q)
        speed, unseen = 10.0 ** random.uniform(0.0, 3.0), plain(shown)(body, UNSEEN, q)
        v = tuple(float(-speed * (n + random.uniform(-0.3, 0.3))) for n in body[-d:])  # about towards it
        assert demanded(avoider, (unseen,), q, v, goal, p) == demanded(avoider, (), q, v, goal, p)
