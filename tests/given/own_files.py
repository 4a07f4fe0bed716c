"""Files of an operator's own, of which tests edit `SHIFT`: an obstacle that is a post in the plane."""

from __future__ import annotations

POST = '''"""Post: a point in the plane."""

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Obstacle, Parameter
from worker.engine.kernels.maths import kernel, norm2
from worker.engine.kernels.views import Body

SHIFT = 0.0


class Post(NamedTuple):
    x: Annotated[float, Parameter("m", "Position, x", -1e6, 1e6)]
    y: Annotated[float, Parameter("m", "Position, y", -1e6, 1e6)] = 0.0


@kernel
def body(t, o, q, p):
    dx, dy = q[0] - p.x - SHIFT, q[1] - p.y
    d = norm2(dx, dy)
    return Body(p.x + SHIFT, p.y, 0.0, 0.0, 0.0, d, dx / (d + 1e-12), dy / (d + 1e-12))


component = Obstacle(name="post_here", title="Post", dimension=2, parameters=Post, body=body)
'''
