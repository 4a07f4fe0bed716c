"""The closed loops of the library as programs over rows, and their flights as flown."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from campaigns import library, load_file
from tests.bench.proof.flight import Code, Plan
from tests.bench.proof.rows import Shape, shape
from tests.bench.proof.traced import Row, Tape, part, program
from worker.running.opening.opened import closed_loop

ENVELOPES: dict[str, tuple[dict[int, tuple[float, float]], int]] = {
    "unicycle": ({3: (-1e3, 1e3), 4: (-1e3, 1e3)}, -1),
    "fixed_wing": (
        {3: (-2.0, 2.0), 4: (-1.4, 1.4), 6: (3.0, 100.0), 9: (-16.0, 16.0), 10: (-16.0, 16.0), 11: (-16.0, 16.0)},
        6,
    ),
}
"""By the vehicle's first words: the limits of its envelope by state, and the state that two others must stay below."""


class Loop(NamedTuple):
    """One campaign's closed loop."""

    flights: Any
    paths: list[str]
    low: Any
    high: Any
    threshold: float
    plan: Plan
    s: Shape

    def fly(self, points: Any) -> Any:
        """The product's d_min of every point (k, n); -1 without a result."""
        vectors = np.repeat(self.flights.nominal[None, :], len(points), axis=0)
        vectors[:, [self.flights.paths[p] for p in self.paths]] = points
        flown = self.flights.loop.simulate(vectors, self.plan.step, *self.flights.counts(self.plan.step))
        return np.where(flown.status == 0.0, flown.costs[:, 0], -1.0)


def opened(name: str, crossed: bool = True, bear_all: bool = False) -> Loop:
    """A campaign of the library, recorded."""
    flights: Any = closed_loop(load_file(library()[name]))
    campaign, loop, threshold = flights.campaign, flights.loop, flights.threshold
    paths = list(campaign.uncertain)
    low, high = np.array([_range(flights, path) for path in paths]).T
    uncertain = {flights.paths[path]: i for i, path in enumerate(paths)}
    tape = Tape()
    rows = [tape.new() for _ in range(1 + len(paths))]
    flat = tuple(rows[1 + uncertain[k]] if k in uncertain else float(v) for k, v in enumerate(flights.nominal))
    p = part(loop, "extend")(flat)
    held = {x.at: x for x in p if isinstance(x, Row)}
    order = {at: 1 + i for i, at in enumerate(held)}
    extend = program(tape, 1 + len(paths), list(held.values()))
    n_x, n_g = loop.n_state, loop.n_held if loop.parts.sampled else 0
    inputs = 1 + len(held) + n_x + n_g

    def fresh() -> tuple[Any, ...]:
        tape = Tape()
        rows = [tape.new() for _ in range(inputs)]
        params = tuple(rows[order[x.at]] if isinstance(x, Row) else x for x in p)
        x = tuple(rows[1 + len(held) : 1 + len(held) + n_x])
        return tape, rows[0], params, x, tuple(rows[1 + len(held) + n_x :])

    tape, t, q, x, g = fresh()
    initial = program(tape, inputs, list(part(loop, "initial")(q)))
    tape, t, q, x, g = fresh()
    guide = program(tape, inputs, list(part(loop, "guide")(t, x, g, q))[:n_g])
    tape, t, q, x, g = fresh()
    slope, channels = part(loop, "closed_loop")(t, x, g, q)
    seen = program(tape, inputs, [*slope, *channels], True, bear_all)
    tape, t, q, x, g = fresh()
    slopes = program(tape, inputs, list(part(loop, "closed_loop")(t, x, g, q)[0]), True, bear_all)
    parts = (extend, initial, guide, seen, slopes)
    steps, every = flights.counts(flights.step)
    limits = np.tile([-1e9, 1e9], (n_x, 1))
    kind = next(k for k in ENVELOPES if loop.parts.vehicle.name.startswith(k))
    for k, limit in ENVELOPES[kind][0].items():
        limits[k] = limit
    births = max(seen[4], slopes[4])
    plan = Plan(
        *(Code(c[0], c[1], np.array(c[2], dtype=np.int64)) for c in (extend, initial, guide, slopes, seen)),
        len(held), n_x, n_g, len(channels), births, max(c[3] for c in parts), flights.step, steps, every, limits,
        ENVELOPES[kind][1],
    )  # fmt: skip
    return Loop(flights, paths, low, high, threshold, plan, shape(len(paths), n_x + n_g, 4 * births + n_g, crossed))


def _range(flights: Any, path: str) -> tuple[float, float]:
    nominal = float(flights.nominal[flights.paths[path]])
    given = flights.campaign.uncertain[path].model_dump()
    if given.get("low") is not None:
        return given["low"], given["high"]
    share = float(str(given["plus_minus"]).rstrip("%")) / 100.0
    return tuple(sorted((nominal * (1.0 - share), nominal * (1.0 + share))))  # type: ignore[return-value]
