"""Every obstacle as a body at an instant."""

from __future__ import annotations

from typing import Any

import numpy as np

from worker.engine.kernels.bind import plain
from worker.engine.kernels.component import Obstacle, declared
from worker.running.catalogue.installed import components

OBSTACLES = [c for c in components().values() if isinstance(c, Obstacle)]


def _body(obstacle: Obstacle, given: dict[str, float]) -> Any:
    # what has no default is put somewhere, all different
    values = {
        p.field: 1.0 + 0.7 * k if p.default is None else p.default for k, p in enumerate(declared(obstacle.parameters))
    }
    p: Any = obstacle.parameters(**values | given)
    if obstacle.derived is not None:
        p = obstacle.derived.constants(*plain(obstacle.derived.derive)(p, ()))
    state = plain(obstacle.wake)(p) if obstacle.wake is not None else ()
    return lambda t, q: plain(obstacle.body)(t, state, q, p)


def centre(body: Any, dimension: int) -> np.ndarray[Any, Any]:
    return np.array([body.x, body.y] + ([body.z] if dimension == 3 else []))
