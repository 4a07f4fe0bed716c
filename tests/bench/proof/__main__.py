"""How much of each campaign is proved free of violations, and in what processor time.

`python -m tests.bench.proof [SECONDS [CAMPAIGN ...]]` prints a table and writes build/proof.json; it ends with 1 if a
flight in a proved box comes closer than the box's bound. Proved is the loop as flown until the given time, no longer:
the rest of a flight, near the goal, is left open here.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from tests.bench.proof.flight import flight, linearised
from tests.bench.proof.frame import weights
from tests.bench.proof.loops import Loop, opened
from tests.bench.proof.rows import shape
from tests.bench.proof.search import Proof, proved, widest

UNTIL = {
    "unicycle_static": 9.0,
    "unicycle_two_obstacles": 9.0,
    "uav_static": 36.0,
    "uav_moving": 34.0,
    "uav_static_linear": 36.0,
    "uav_static_bank": 36.0,
    "uav_moving_linear": 34.0,
}
"""How far each is proved [s]: well past the closest approach, before the vehicle is at its goal."""
GATE = 240.0
"""Processor time: two cores for 120 s [s]."""
FLIGHTS = 20_000


def main() -> int:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else GATE
    names = sys.argv[2:] or list(UNTIL)
    print("| campaign | until [s] | share proved | boxes | tried | processor time [s] | flights below their bound |")
    print("|---|---|---|---|---|---|---|")
    path = Path("build/proof.json")
    path.parent.mkdir(exist_ok=True)
    every = json.loads(path.read_text()) if path.exists() else {}
    for name in names:
        every[name] = measured(name, UNTIL[name], seconds)
        path.write_text(json.dumps(every, indent=1))
        r = every[name]
        print(
            f"| {name} | {r['until']:g} | {r['share']:.4%} | {r['boxes']} | {r['tried']} | {r['seconds']:.0f} | "
            f"{r['below']} of {r['flights']} |",
            flush=True,
        )
    return int(any(r["below"] for r in every.values()))


def measured(name: str, until: float, seconds: float) -> dict[str, Any]:
    """The proof of one campaign, and flights in its boxes."""
    loop = opened(name)
    steps = round(until / loop.plan.step)
    began = time.process_time()
    metric, back, apart = swept(loop, steps)
    swept_in = time.process_time() - began
    span = loop.high - loop.low

    def bound(low: Any, high: Any) -> tuple[float, int]:
        a, b = loop.low + low * span, loop.low + high * span
        return flight(loop.plan, a, b, loop.s, loop.threshold, steps, metric, back)  # type: ignore[no-any-return]

    n = len(span)
    began = time.process_time()
    point, _ = bound(np.full(n, 0.5), np.full(n, 0.5))
    one = time.process_time() - began
    widths = np.array([widest(bound, way) for way in np.eye(n)])
    together = widest(bound, np.maximum(widths, 1e-6)) if widths.all() else 0.0
    proof = proved(bound, np.maximum(together * widths, 1e-5), seconds)
    done = proof.curve[-1]
    below, nearest = flown(loop, proof)
    return {
        "paths": loop.paths, "threshold": loop.threshold, "until": until, "share": done[1], "boxes": len(proof.bound),
        "tried": done[2], "seconds": done[0], "curve": proof.curve[:: max(1, len(proof.curve) // 200)],
        "one_flight": one, "sweep": swept_in, "widths": widths.tolist(), "together": (together * widths).tolist(),
        "apart": apart, "bound_at_centre": point,
        "flown_at_centre": float(loop.fly(0.5 * (loop.low + loop.high)[None, :])[0]),
        "flights": FLIGHTS if len(proof.bound) else 0, "below": below, "nearest": nearest,
        "least": float(proof.bound.min()) if len(proof.bound) else None,
    }  # fmt: skip


def swept(loop: Loop, steps: int) -> tuple[Any, Any, float]:
    """The metric of every step and its inverse, from the flight at the centre of the ranges, and how far that flight is
    from the product's, over all states and steps until then."""
    plan, m = loop.plan, loop.plan.n_x + loop.plan.n_g
    jacobians, states = np.zeros((plan.steps, m, m)), np.zeros((plan.steps, m))
    centre = 0.5 * (loop.low + loop.high)
    linearised(plan, centre, shape(m, m, 4 * plan.births + plan.n_g, False), jacobians, states)
    scale = 0.1 / (np.abs(states).max(axis=0) + 1e-3)
    scale[: 3 if plan.n_g else 2] += 1.0  # positions, in metres
    vector = loop.flights.vector(dict(zip(loop.paths, centre, strict=True)))[None, :]
    trace = loop.flights.loop.simulate(vector, plan.step, *loop.flights.counts(plan.step), traced=1).trace[0]
    apart = np.abs(trace[:steps, : plan.n_x] - states[:steps, : plan.n_x]).max()
    return *weights(jacobians, scale, steps, 1e-6), float(apart)


def flown(loop: Loop, proof: Proof) -> tuple[int, float]:
    """How many of the product's flights in proved boxes come closer than their box's bound, and the least gap above."""
    if not len(proof.bound):
        return 0, float("inf")
    rng = np.random.default_rng(11)
    which = rng.integers(len(proof.bound), size=FLIGHTS)
    at = rng.random((FLIGHTS, proof.low.shape[1]))
    at = np.where(rng.random(at.shape) < 0.1, np.round(at), at)  # some on faces
    points = proof.low[which] + at * (proof.high[which] - proof.low[which])
    d = loop.fly(loop.low + points * (loop.high - loop.low))
    return int(np.count_nonzero(d < proof.bound[which])), float((d - proof.bound[which]).min())


if __name__ == "__main__":
    sys.exit(main())
