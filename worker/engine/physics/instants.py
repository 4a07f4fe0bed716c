"""Instants of discontinuities, as components return them for the reference integrator: plain Python, no kernels."""

from __future__ import annotations

from typing import Any


def ramp(p: Any, horizon: float) -> list[float]:
    """The ends of a ramp that starts `at` and takes `over`."""
    return [p.at, p.at + p.over]


def interval(p: Any, horizon: float) -> list[float]:
    """The ends of an interval of a `duration` that starts `at`."""
    return [p.at, p.at + p.duration]


def samples(p: Any, horizon: float) -> list[float]:
    """The ends of all periods of a sensor or a noise."""
    return [k * p.period for k in range(1, int(horizon / p.period) + 1)]
