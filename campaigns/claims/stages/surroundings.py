"""Sentences on what is around points: the boundary of a violation, indices of sensitivity, DIRECT's possible gain."""

from __future__ import annotations

from collections.abc import Sequence

from campaigns.claims.say import Part, count, listed, number, percent, say, symbol
from campaigns.claims.spans import Spans

NOMINAL_BEYOND = say("the nominal case itself violates the criterion or fails")
NO_VARIANCE = say("not computed: all evaluations have the same value, so there is no variance to explain")


def boundary(steps: int, nearest: tuple[float, Part, float] | None, crossed: float | None) -> Spans:
    """nearest: fraction of its range from nominal, parameter and value; crossed: fraction of the way to the worst."""
    statement = say("no parameter violates the criterion when varied alone, in ", count(steps), " steps")
    if nearest is not None:
        fraction, parameter, value = nearest
        statement = say(
            *("varying one parameter alone, the criterion is first violated at ", parameter, " = ", number(value)),
            *(", ", percent(fraction), " of its range from nominal"),
        )
    if crossed is None:
        return statement
    line = "; on the line from nominal to this finding the criterion is first violated at "
    return say(statement, line, percent(crossed))


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
    without = say("; ", count(lost), " rectangles without a value are ignored") if lost else ()
    return say(
        *("estimated minimum of ", symbol(quantity), ": ", number(lowest, unit), ", ", number(best - lowest, unit)),
        *(" below the lowest centre; not a bound, it assumes the steepest slope observed between the centres of "),
        *(count(rectangles), " rectangles", without),
    )


def _leading(values: Sequence[tuple[Part, float]]) -> Spans:
    return listed([say(parameter, ": ", number(value, digits=3)) for parameter, value in values])
