"""Sentences on what is around points: the boundary of a violation, indices of sensitivity, DIRECT's possible gain."""

from __future__ import annotations

from collections.abc import Sequence

from campaigns.claims.say import Part, count, listed, number, percent, say, symbol
from campaigns.claims.spans import Spans

NOMINAL_BEYOND = say("the nominal case itself violates the criterion or fails")
NO_VARIANCE = say("not computed: all evaluations have the same value, so there is no variance to explain")


def boundary(steps: int, nearest: tuple[float, Part, float] | None, crossed: float | None) -> Spans:
    """nearest: fraction of its range from nominal, parameter and value; crossed: fraction of the way to the worst."""
    statement = say("no violation was found along any single parameter, sampled in ", count(steps), " steps")
    if nearest is not None:
        fraction, parameter, value = nearest
        statement = say(
            *("the nearest boundary along a single parameter is at ", parameter, " = ", number(value)),
            *(", ", percent(fraction), " of its range from nominal"),
        )
    if crossed is None:
        return statement
    line = "; on the straight line to the worst case it is crossed at "
    return say(statement, line, percent(crossed), " of the distance")


def effects(leading: Sequence[tuple[Part, float]]) -> Spans:
    """Morris' largest effects."""
    return say("largest effects: ", _leading(leading))


def totals(leading: Sequence[tuple[Part, float]], correlated: bool) -> Spans:
    """Sobol's largest total indices, which split a variance among independent parameters."""
    apart = "; correlations are ignored" if correlated else ""
    return say("largest total indices: ", _leading(leading), apart)


def no_index(missing: int, evaluations: int) -> Spans:
    """The designs need the value of every evaluation, and missing ones are not imputed."""
    return say(
        *("not computed: ", count(missing), " of ", count(evaluations)),
        " evaluations failed or were excluded, and the design needs the value of every one; "
        "narrow the bounds until all evaluations succeed",
    )


def possible_gain(rectangles: int, lost: int, quantity: str, lowest: float, best: float, unit: str) -> Spans:
    """The estimate of how far below DIRECT's best the criterion may be; lost: rectangles without a value."""
    without = say("; ", count(lost), " rectangles whose centre has no value are ignored") if lost else ()
    return say(
        *("estimate, not a bound: if the steepest slopes observed between the centres of ", count(rectangles)),
        *(" rectangles hold everywhere, ", symbol(quantity), " is nowhere below ", number(lowest, unit)),
        *(", ", number(best - lowest, unit), " below the lowest centre", without),
    )


def _leading(values: Sequence[tuple[Part, float]]) -> Spans:
    return listed([say(parameter, " ", number(value, digits=3)) for parameter, value in values])
