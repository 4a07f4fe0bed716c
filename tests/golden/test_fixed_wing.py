"""Cases 3 to 5, pinned: a change here means that the aircraft, its autopilot, an avoider or the loop changed.

Tolerances leave room for another processor's fused operations, nothing more.
"""

from __future__ import annotations

import numpy as np
import pytest

from campaigns import library, load_file
from clearance.testing.problems import Problem
from worker.engine.systems.closed_loop.trace import trace

SHOWN = ("x", "y", "z", "yaw", "u", "separation")

PINNED = {
    # It climbs to the goal at 20 m/s, the start being 30 m below the sphere's centre (z down), and comes within 35 m of
    # the surface at 16 s. There the field throws the heading round to 2 rad and the pitch up: past the side and above.
    "uav_static": [
        (5, [60.613663585961, 67.585497534369, 5.947258477842, 0.811020916228, 20.311210648623, 263.432249702033]),
        (15, [199.130792885611, 213.250518241988, -18.851067584362, 0.809329045337, 20.030588252897, 63.376194578974]),
        (18, [228.098385639069, 260.313648305557, -32.056425098131, 1.982281680206, 17.558329230602, 32.749625052741]),
        (20, [220.748153699456, 296.627198486636, -42.581187329117, 1.298306627423, 19.338937009098, 63.963270073362]),
        (25, [283.700944552294, 379.978539250729, -49.367012705011, 0.619930030312, 21.10446090111, 139.928324576501]),
    ],
    # It sinks a little towards the goal, meets the intruder's field at 20 m/s, turns left in front of it and dives.
    "uav_moving": [
        (5, [64.491784214297, 77.454529893422, 2.779547935109, 0.86334454228, 20.110622054776, 643.547700740115]),
        (18, [233.565977803069, 275.075857860566, 10.166630865828, 0.862828701094, 20.00074965773, 241.04233059787]),
        (22, [285.73294943522, 335.743610425175, 12.597229730738, 0.750582145521, 19.997459270782, 118.374075054488]),
        (26, [362.123773031532, 367.427572316945, 34.169791752105, 0.520341328993, 22.700867759274, 59.341133087066]),
        (32, [431.137827499543, 458.496719151946, 25.165672834339, 1.216141575716, 19.272083618768, 170.571562314476]),
    ],
    # It follows the plan until the intruder is within 600 m, then left of the line of sight, level, passing in front;
    # back to the planned heading of 0.9 rad once the range opens after 27.5 s.
    "uav_aca": [
        (5, [62.183651902436, 78.361231339424, -0.00722501044, 0.900000132077, 20.0009904863, 642.627673254105]),
        (12, [160.179419959287, 177.873376401057, -0.06144480525, 0.68850231849, 20.018991902065, 432.695967099302]),
        (20, [286.133139487636, 276.728590581034, -0.034640315531, 0.610513677578, 19.996429032773, 211.232076149231]),
        (26, [388.290565037784, 339.359942216946, -0.042074195676, 0.474239891826, 19.98970425088, 85.531594935577]),
        (32, [475.893446576283, 420.083343480457, -0.424496753155, 0.896249946549, 20.088639320561, 151.011789940165]),
    ],
}  # fmt: skip
"""Time [s], then the columns of `SHOWN`."""

CLOSEST = {
    "uav_static": (17.42168426, 29.781982923523),
    "uav_moving": (25.79638979, 59.229016808770),
    "uav_aca": (27.53315270, 77.889829842092),
}
"""Time [s] and distance [m]."""


@pytest.mark.parametrize("name", PINNED)
def test_the_trajectory_is_the_stored_one(name: str) -> None:
    problem = Problem(load_file(library()[name]))
    flown = trace(problem.system, "nominal", {})
    columns = [[c.name for c in flown.columns].index(n) for n in SHOWN]
    rows = [round(t / problem.system.step) for t, _ in PINNED[name]]
    assert flown.data[rows][:, columns] == pytest.approx(np.array([row for _, row in PINNED[name]]), abs=1e-9)
    closest = flown.meta.closest
    assert closest is not None
    assert closest.time == pytest.approx(CLOSEST[name][0], abs=1e-6)
    assert closest.value == pytest.approx(CLOSEST[name][1], abs=1e-10)
    assert flown.meta.frame == "ned"
