"""Sentences on what is around points: the boundary of a violation, indices of sensitivity, DIRECT's possible gain."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from campaigns.claims.say import Part, amount, count, listed, number, percent, say, symbol
from campaigns.claims.spans import Spans

NOMINAL_BEYOND = say("the nominal case itself violates the criterion or fails")
BETWEEN = " between them is not excluded"
NO_VARIANCE = say("not computed: all evaluations have the same value, so there is no variance to explain")


class Along(NamedTuple):
    """An evaluation along one parameter: fraction of its range from nominal, parameter and value; or, without these, on
    the line from nominal to the finding: fraction of the line."""

    fraction: float
    parameter: Part | None = None
    value: float = 0.0


def boundary(steps: int, violated: Along | None, crossed: float | None, failed: Along | None) -> Spans:
    """violated: the nearest along a parameter; crossed: fraction of the line to the finding; failed: the nearest.

    It is the nearest that was seen, and no bound: a nearer one may be between two evaluations.
    """
    seen = say("; seen in ", count(steps), " steps and the stored evaluations on each line")
    if violated is None:
        statement = say("no violation was seen when one parameter alone is varied")
    else:
        statement = say("varying one parameter alone, the nearest violation seen is at ", _along(violated))
    if crossed is not None:
        line = "; on the line from nominal to this finding the nearest violation seen is at "
        statement = say(statement, line, percent(crossed))
    between = "a violation" if violated is None and crossed is None else "a nearer violation"
    statement = say(statement, seen, "; ", between, BETWEEN)
    if failed is None:
        return statement
    return say(statement, "; the nearest evaluation that failed is at ", _along(failed))


def _along(at: Along) -> Spans:
    if at.parameter is None:
        return say(percent(at.fraction), " of the line from nominal to this finding")
    return say(at.parameter, " = ", number(at.value), ", ", percent(at.fraction), " of its range from nominal")


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


def few_decide(few: int, evaluations: int) -> Spans:
    """The variance is estimated from the base sample, although other evaluations of the design vary."""
    return say(
        *("not computed: fewer than ", count(few), " of the ", count(evaluations)),
        " evaluations that the variance is estimated from decide it; request more samples",
    )


def possible_gain(rectangles: int, lost: int, quantity: str, lowest: float, best: float, unit: str) -> Spans:
    """The estimate of how far below the best of DIRECT's search the criterion may be; lost: rectangles without a
    value."""
    ignored = f" without a value {'is' if lost == 1 else 'are'} ignored"
    without = say("; ", amount(lost, "rectangle"), ignored) if lost else ()
    return say(
        *("estimated minimum of ", symbol(quantity), ": ", number(lowest, unit), ", ", number(best - lowest, unit)),
        " below the lowest value of this search; not a bound, it assumes in ",
        *(amount(rectangles, "rectangle"), " the steepest slope observed", without),
    )


def _leading(values: Sequence[tuple[Part, float]]) -> Spans:
    return listed([say(parameter, ": ", number(value, digits=3)) for parameter, value in values])
