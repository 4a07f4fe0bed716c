"""The fixed-wing vehicles' own right-hand sides in plain Python, with inputs held, for the physics tests."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from worker.engine.components.vehicles import fixed_wing, fixed_wing_linear
from worker.engine.kernels.bind import plain
from worker.engine.kernels.views import Surroundings
from worker.engine.physics import aerodynamics, trim
from worker.engine.physics.aerodynamics import Airframe, Constants
from worker.engine.systems.base import Floats

CALM = Surroundings(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def constants(**changes: float) -> Any:
    return Constants(*plain(aerodynamics.constants)(Airframe()._replace(**changes)))


def aircraft(**changes: float) -> Any:
    """The vehicle's constants, trimmed at 20 m/s."""
    body = Airframe()._replace(**changes)
    at = trim.trimmed(Airframe(), 20.0)
    return fixed_wing.FixedWing(*plain(fixed_wing.derive)(body, at))


def linear(speed: float) -> Any:
    """Constants of the linear vehicle about a speed."""
    values = {f"vehicle.{k}": v for k, v in Airframe()._asdict().items()}
    at = fixed_wing_linear.solve(values | {"vehicle.reference_speed": speed, "start.speed": speed})
    body = fixed_wing_linear.FixedWingLinear(*Airframe(), speed)
    return fixed_wing_linear.Constants(*plain(fixed_wing_linear.derive)(body, at))


def flown(p: Any, x: Any, u: Any, duration: float, env: Surroundings = CALM, vehicle: Any = fixed_wing) -> Floats:
    """States (12,) after `duration` [s] with inputs held."""
    f = plain(vehicle.derivative)
    done = solve_ivp(
        lambda t, y: f(t, tuple(y.tolist()), u, env, p), (0.0, duration), x, "DOP853", rtol=1e-11, atol=1e-11
    )
    assert done.success
    return np.asarray(done.y[:, -1])
