"""Dryden gusts whose noise is held for a period: exact covariances of the sampled filters.

Second formulation: the discrete Lyapunov equation of the filters over one period, and its closed form.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy import linalg

from worker.engine.components.environment import dryden_gusts
from worker.engine.kernels.bind import plain

V = 20.0


def deviations(period: float, h: float) -> Any:
    """(phases, 3): the stationary deviation of each gust relative to its own, at phases of a period from its start."""
    parameters = dryden_gusts.DrydenGusts(W=10.0, h=h, V=V, period=period)
    p = dryden_gusts.Constants(*plain(dryden_gusts.derive)(parameters, ()))

    def at(e: Any, n: Any) -> Any:
        return plain(dryden_gusts.blow)(0.0, (0.0,) * 3, (1.0, 0.0, 0.0), tuple(e), tuple(n), p)

    a = np.array([at(e, np.zeros(3))[1] for e in np.eye(5)]).T
    b = np.array([at(np.zeros(5), n)[1] for n in np.eye(3)]).T
    c = np.array([at(e, np.zeros(3))[0][:3] for e in np.eye(5)]).T

    def after(t: float) -> Any:
        grown = linalg.expm(np.block([[a, b], [np.zeros((3, 8))]]) * t)
        return grown[:5, :5], grown[:5, 5:]

    f, g = after(period)
    covariance = linalg.solve_discrete_lyapunov(f, g @ g.T)
    found = []
    for phase in np.linspace(0.0, 1.0, 101):
        f, g = after(phase * period)
        found.append(np.sqrt(np.diag(c @ (f @ covariance @ f.T + g @ g.T) @ c.T)) / (p.s_h, p.s_h, p.s_w))
    return np.array(found)


@pytest.mark.parametrize("x", [0.01, 0.3, 1.0])
def test_at_the_ends_of_a_period_the_deviation_is_the_closed_form(x: float) -> None:
    h = 100.0
    t = 0.3048 / V * (h / 0.3048) / (0.177 + 0.000823 * h / 0.3048) ** 1.2
    assert deviations(2.0 * x * t, h)[0, 0] == pytest.approx(math.sqrt(math.tanh(x) / x), rel=1e-6)


@pytest.mark.parametrize("h", [3.048, 30.0, 304.8])
def test_at_the_longest_period_the_gusts_are_as_strong_as_stated(h: float) -> None:
    """The figures of the component's text; twice that period would weaken them further."""
    found = deviations(dryden_gusts.SHORT * h / V, h)
    assert 0.963 < found.min() < 0.964
    assert found.max() < 1.0
    assert 0.975 < np.sqrt((found**2).mean(axis=0)).min() < 0.976
    assert deviations(2.0 * dryden_gusts.SHORT * h / V, h).min() < 0.93
