"""Slices of the criterion: one parameter over its bounds, the others fixed."""

from __future__ import annotations

from campaigns.results.base import Result, Status, Values


class Curve(Result):
    """The criterion against one parameter, the others fixed."""

    path: str
    values: list[float]
    costs: list[float | None]
    status: list[Status]


class Slices(Result):
    """Curves of all parameters through one point."""

    curves: list[Curve]
    at: Values = {}
    """The point."""
