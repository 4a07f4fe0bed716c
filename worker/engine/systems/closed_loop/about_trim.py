"""The polynomial model of a closed loop about its trim, and the simulation of the same loop by its kernels."""

from __future__ import annotations

from typing import Any

import numpy as np

from campaigns.asked.problem import Problem as Wrong
from worker.engine.kernels.about_trim import simulation
from worker.engine.kernels.bind import plain
from worker.engine.kernels.component import NoTrim
from worker.engine.systems.base import CampaignUnusable, Floats, PolynomialLoop
from worker.engine.systems.closed_loop.flights import Flights


def about_trim(flights: Flights) -> PolynomialLoop | None:
    """The polynomial model that the controller declares, or None; raises `CampaignUnusable` without a trim."""
    vehicle, controller = flights.parts.vehicle, flights.parts.controller
    about = controller.about_trim
    if about is None:
        return None
    values = {path: float(flights.nominal[k]) for path, k in flights.paths.items()}
    trim = () if vehicle.trim is None else vehicle.trim.fields(*flights.nominal[len(values) :].tolist())
    try:
        at = about.trimmed(values, trim)
    except NoTrim as error:
        raise CampaignUnusable([Wrong("stages.attraction", controller.name, str(error))]) from None
    constants = _constants(vehicle, "vehicle", values, trim), _constants(controller, "controller", values, trim)
    made: list[Any] = []

    def compiled() -> Any:
        if not made:
            made.extend(simulation(vehicle.derivative, controller.command["velocity"], about, constants, at))
        return made

    def rates(points: Floats) -> Floats:
        found = np.empty_like(points)
        for point, rate in zip(points, found, strict=True):
            compiled()[0](point, rate)
        return found

    def returns(starts: Floats, norm: Floats, fall: float, seconds: float) -> Any:
        limits = np.array([np.inf if limit is None else limit for limit in at.limits])
        steps = int(np.ceil(seconds / flights.step))
        return compiled()[1](np.ascontiguousarray(starts), limits, norm, fall, flights.step, steps)

    return PolynomialLoop(about.states, at.trim, at.flow, at.limits, at.held, rates, returns)


def _constants(part: Any, role: str, values: dict[str, float], trim: Any) -> Any:
    """The parameters of a component, or the constants derived from them."""
    parameters = part.parameters(*(values[f"{role}.{name}"] for name in part.parameters._fields))
    return parameters if part.derived is None else part.derived.constants(*plain(part.derived.derive)(parameters, trim))
