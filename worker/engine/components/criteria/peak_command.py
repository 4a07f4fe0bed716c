"""Peak command: the largest fraction of its full deflection that any input reaches over the trajectory.

    u_peak = max over t <= T and inputs i of |u_i(t)| / s_i;   s_i = 0: it does not count; more is worse

u_i are the inputs as they arrive at the vehicle, after all actuator faults and before its own stops, in the order in
which the vehicle lists them; s_i is the full deflection of each, such as its stop or its rated value, in its unit.
Inputs differ in unit and size, so neither their maximum nor their norm can be compared across vehicles; the fractions
can: 1 is an input at its stop, more is a command that the stop cuts off. With the defaults it is the magnitude of the
first input in its own unit.
Evaluated at the steps, not between them: a command may jump, at a sample of guidance or a failure, and a parabola would
overshoot there. The value is continuous in the parameters where the commands are, with corners where another step or
input becomes the largest; halving the step changes it by second order in the step at a smooth peak.
Source: Srikanthakumar, chapter 8, asks for several criteria at once; the definition is Clearance's own.
Limits: counts the first four inputs; deflections are measured from 0, not from the trim.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.components.criteria.peak_bank import value
from worker.engine.kernels.component import Criterion, Derived, Parameter
from worker.engine.kernels.maths import kernel


class PeakCommand(NamedTuple):
    """Full deflections, each in the unit of its input."""

    s_1: Annotated[float, Parameter("", "Full deflection of the first input; 0: it does not count", 0.0, 1e9)] = 1.0
    s_2: Annotated[float, Parameter("", "Full deflection of the second input", 0.0, 1e9)] = 0.0
    s_3: Annotated[float, Parameter("", "Full deflection of the third input", 0.0, 1e9)] = 0.0
    s_4: Annotated[float, Parameter("", "Full deflection of the fourth input", 0.0, 1e9)] = 0.0


class Weights(NamedTuple):
    """The fraction for each input."""

    w_1: float
    w_2: float
    w_3: float
    w_4: float


@kernel
def weight(s: float) -> float:
    w = 1.0 / (s if s > 0.0 else 1.0)
    return (w if s > 0.0 else 0.0) + 0.0 * s


@kernel
def derive(p: PeakCommand, trim: Any) -> tuple[float, float, float, float]:
    return weight(p.s_1), weight(p.s_2), weight(p.s_3), weight(p.s_4)


@kernel
def larger(a: float, b: float) -> float:
    """The larger of two; NaN if either is."""
    return (a if a > b else b) + 0.0 * (a + b)


@kernel
def sample(t: float, q: Any, v: Any, x: Any, u: Any, pose: Any, p: Weights) -> tuple[float]:
    four = u + (0.0, 0.0, 0.0)  # noqa: RUF005 - compiled tuples join by +
    first = larger(abs(four[0]) * p.w_1, abs(four[1]) * p.w_2)
    second = larger(abs(four[2]) * p.w_3, abs(four[3]) * p.w_4)
    return (-larger(first, second),)


component = Criterion(
    name="peak_command",
    title="Peak command",
    quantity="u_peak",
    unit="",
    parameters=PeakCommand,
    sample={2: sample, 3: sample},
    value=value,
    worse="high",
    of="flight",
    over="steps",
    derived=Derived(Weights, derive),
)
