"""Delay of control: an input acts some time after it was commanded.

    y(t) = u(t - tau)  as the Pade approximation  (1 - tau s/2 + tau^2 s^2/12) / (1 + tau s/2 + tau^2 s^2/12)

u is the command, y what acts on the vehicle, s the Laplace variable. Second order: the gain is exactly 1 at every
frequency, the phase lag short of omega tau by 0.13 % at omega tau = 1, 1.7 % at 2, 6.3 % at 3. After a jump of the
command it responds at once, undershoots and settles within about 2 tau, whereas a true delay would wait: valid for
loops whose bandwidth stays below about 2/tau, stability margins included. It starts settled on the controller's first
command, as before any fault.
Below the delay `shortest` the integrator's step could not follow: there y = (1 - s) u + s d with d delayed by
`shortest` and s = tau / shortest, which delays slow commands by the same tau and is continuous down to tau = 0. Keep
`shortest` above 1.4 steps (3 in a fast loop, whose poles it speeds up) and below 0.5 divided by the loop's bandwidth
[rad/s], beyond which the blend is not a delay. Sampled guidance has its own, exact model, `guidance_delay`.
Source: Golub and Van Loan, Matrix Computations (2013): diagonal Pade approximants of exp; Srikanthakumar, step 3 of
section 1.3 (hardware: computing delays).
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.components.faults.actuator_lag import Constants, derive
from worker.engine.kernels.component import Derived, Fault, Parameter
from worker.engine.kernels.maths import kernel


class ControlDelay(NamedTuple):
    tau: Annotated[float, Parameter("s", "Delay", 0.0, 1e3, symbol="τ")] = 0.0
    shortest: Annotated[float, Parameter("s", "Smallest delay that is integrated", 1e-4, 10.0)] = 0.1


@kernel
def act(t: float, u: float, a: tuple[float, float], p: Constants) -> tuple[float, tuple[float, float]]:
    # With time in units of tau: 1 - 12 s / (s^2 + 6 s + 12), the fraction in controllable form.
    inner, outer = a
    return u - 12.0 * p.share * outer, (p.per_tau * outer, p.per_tau * (u - 12.0 * inner - 6.0 * outer))


@kernel
def rest(u: float, p: Constants) -> tuple[float, float]:
    return u / 12.0, 0.0


component = Fault(
    name="control_delay",
    title="Delay of control",
    path="actuator",
    parameters=ControlDelay,
    kernel=act,
    states=2,
    rest=rest,
    derived=Derived(Constants, derive),
)
