"""Case 2, pinned: a change here means that the model or the loop changed, and must be explained.

Up to the first switch of the force, at about 14.5 s, tolerances leave room for another processor's fused operations,
nothing more; behind it rounding may move a switch by a step.
"""

from __future__ import annotations

import numpy as np
import pytest

from campaigns import library, load_file
from clearance.testing.problems import Problem
from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop.trace import trace

PROBLEM = Problem(load_file(library()["pioneer_moving"]))
CORNER = {
    "vehicle.m": 34.0, "vehicle.B_e": 0.48, "vehicle.delta_u": 0.9, "vehicle.delta_w": 0.1, "vehicle.I_e": 3.8,
    "vehicle.u_s": 0.02, "faults.0.dx": 0.5, "faults.0.dy": -0.5,
}  # fmt: skip


def rows(values: dict[str, float]) -> Floats:
    flown = trace(PROBLEM.system, "pinned", values)
    names = [c.name for c in flown.columns]
    return flown.data[[100, 500, 700, 950, 2000]][:, [names.index(n) for n in ("x", "y", "yaw", "u", "separation")]]


@pytest.mark.parametrize(("values", "pinned"), [({}, "NOMINAL"), (CORNER, "WORST")])
def test_the_trajectory_is_the_stored_one(values: dict[str, float], pinned: str) -> None:
    # t = 2, 10, 14, 19, 40 s. Nominal: ahead to the goal, left behind the intruder, to rest at the goal. Worst case:
    # it sees the intruder too far ahead, turns right instead, all round, and follows behind.
    found, expected = rows(values), np.array(globals()[pinned])
    free = 2 if values else 3
    assert found[:free] == pytest.approx(expected[:free], abs=1e-9)
    assert found[free:] == pytest.approx(expected[free:], abs=1e-4)


NOMINAL = [
    [1.395852310452e00, 5.658296637643e-01, 3.091767815992e-01, 9.587070667970e-01, 4.215414790632e01],
    [1.006256586975e01, 3.618555189105e00, 2.814413327547e-01, 1.293480466272e00, 2.370574721357e01],
    [1.518451609075e01, 5.255079725402e00, 2.640320026464e-01, 1.387567943368e00, 1.406988383711e01],
    [1.927856916625e01, 8.406168125456e00, 6.350530344391e-01, 1.141209384788e00, 7.631455180296e00],
    [3.509581474120e01, 9.931437085757e00, -6.209668506988e-01, 2.450936270726e-01, 3.978391012576e01],
]
WORST = [
    [1.915600868153e00, 6.109994377882e-01, 2.858945793276e-01, 1.437547493973e00, 4.172445674332e01],
    [1.378667637844e01, 4.205002526537e00, 2.756141363876e-01, 1.573948140774e00, 2.030724534721e01],
    [1.942642549075e01, 5.223698554575e00, -2.655178624619e-01, 1.042407129166e00, 1.034681729185e01],
    [1.954670882781e01, 4.501887302231e00, -4.494978264749e00, 1.041142060431e00, 6.051058186342e00],
    [3.459624604785e01, 9.900463697132e00, -6.050947633110e00, 2.713825166193e-01, 3.950920004291e01],
]


@pytest.mark.parametrize(("values", "time", "value"), [({}, 19.159068, 7.6283915), (CORNER, 20.724839, 5.8948923)])
def test_the_closest_approach_is_the_stored_one(values: dict[str, float], time: float, value: float) -> None:
    closest = trace(PROBLEM.system, "pinned", values).meta.closest
    assert closest is not None
    assert closest.time == pytest.approx(time, abs=1e-4)
    assert closest.value == pytest.approx(value, abs=1e-6)
