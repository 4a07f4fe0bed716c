"""The limits of the rules, written a second time on purpose: an error in `campaigns.rules` must not pass unnoticed.

A test compares the two, name by name.
"""

import math

LEAST = {"global": 25, "local": 3}
"""By the kind of methods that can agree: the fewest evaluations per parameter that count as a search."""
METHODS = 2
AGREEMENT_AT_MOST, AGREEMENT_OF_MARGIN, AGREEMENT_ROUNDING = 0.2, 0.1, 1e-15
TOLERANCE_OF_MARGIN = 0.1
ROUNDING = 1e-6
MOVED, ABOVE_NOISE = 0.01, 10.0
EXCLUDED, CEILING = 0.1, 0.05
SAME_COST = 0.01
SPOT_CHECKS, VIOLATIONS = 200, 200
SAMPLE, SMALLEST, REALISATIONS = 59, 1e-12, 100
SAME_PLACE = 0.05
ORDER = (
    "nominal", "search", "no violation", "minimum", "agreement", "validation", "repetition", "resolution",
    "evaluations", "retries", "noise of calls", "closest approach", "motion", "avoidance", "influence", "sampling",
    "distances", "noise", "exclusions", "sample", "outside the bounds", "probability", "target",
)  # fmt: skip
"""Of the checks of a verdict."""
TURN, CONTINUED, OTHERS = math.pi / 4, 2, 1000
DRAWS = 2
OF_VIOLATIONS = ("nominal", "no violation", "noise of calls", "probability", "target")
"""Checks that violations alone can make fail."""
BASINS, BASELINES, BESIDE, ROUNDED, TAILS, LOWEST, SHARED, CALLED, AFTER = 2, 5, 6, 7, 8, 9, 10, 13, 14
VIOLATING, WHOLE = 14, 14
"""The version of the sentences since which records have what is known of the basins of a baseline; since which they
state all that a comparison with a baseline rests on, judged by the thresholds of both runs, and how many evaluations
failed for each reason; since which a policy accepts known violations only where nothing beside them is wrong; since
which costs agree within rounding only if they differ by that of their own digits; since which an estimate counts what
is beyond the bounds relative to what is not excluded; since which DIRECT's possible gain is measured from the lowest
evaluation of its search, and a search that started at a worst case does not confirm it; since which the members of a
method that share what they know are one in all its searches; since which the worst value of a violation that only
independent calls show is that of a call; since which flights that fail after the horizon are counted, with what they
meet before, a nominal case that fails has no closest approach, a criterion of obstacles states to what it measures, and
obstacles declare their extent where that is their centre; since which failed evaluations alone are no
violations to estimate from; since which a sample of which all were drawn did not end early."""
HALVED = 14
"""The version since which FMUs are confirmed at half the communication step, and what repeats is not cleared by several
calls where single ones would be confirmed so."""
WIDER = 15
"""The version since which more is looked at: flights of all stages after the horizon; for an estimate every violation
of the independent sample; for a change the costs that are compared alone, not the nominal one."""
ALIKE = 17
"""The version since which a search whose members share is no second principle beside one by that of a member; since
which no density as a fraction of the highest one is stated of correlated parameters that are not normal; since which
the band of a distribution function is wider by the probability that a draw was moved inside the bounds; since which
equal values of it are one, with the fraction of all costs at or below."""
MEASURED = 18
"""The version since which a criterion of obstacles must compute the distance that it declares, in m; since which a
margin below the grid on which all values lie does not clear; since which the nearest violation on a line from nominal
is that of all stored evaluations on it."""
GRANTED = 19
"""The version since which the step of the values may be any, such as a tenth of a foot in m; since which a finding that
violates in independent calls alone violates in a comparison; since which a case without a value in either of two
evaluations repeats; since which no fraction below 1 is written as 100 %."""
NEAREST = 20
"""The version since which the lowest values have a grid of their own."""
EACH = 21
"""The version since which what a search excludes counts by itself, a seed of few values bars, a large nominal value
is no scale of how sure a search is, and the lowest values that return often have a step; since which a case of a
baseline is fixed only if it was evaluated at all its values, with no fewer calls, and confirmed by other means."""
PARTS = 22
"""The version since which a case of a baseline is evaluated on the obstacles and faults on which it was found, wherever
they are listed, a seed that every call of a function has bars, and what comes straight to where a vehicle that slows
down will stand is not known."""
CARRIED = 23
"""The version since which what carries a circling vehicle on, rounds that grow and the wide circle of a slight turn are
followed, and an obstacle that each turn moves on by a hair's breadth does not repeat its path."""
BUILT = 24
"""The version since which a fault or the environment must have its whole effect before every flight ends."""
BOTTOM, TOP, MANY = 0.1, 0.9, 100
"""A nominal value is far above so many costs if none is between these fractions of its height."""
CLEARING = max(
    ROUNDED, LOWEST, SHARED, AFTER, HALVED, WIDER, ALIKE, MEASURED, GRANTED, NEAREST, EACH, PARTS, CARRIED, BUILT
)
"""The version since which the rules that can withdraw "cleared" are those of today."""
RULES = max(CLEARING, BASINS, BASELINES, BESIDE, TAILS, CALLED, VIOLATING, WHOLE)
"""The version since which the rules are those of today."""
CHANCE = 0.05
"""Independent calls of two runs differ beyond chance if the probability of it is at most this."""
POINTS, TIMES = 5, 3
"""Of a simulator: how many points are evaluated to measure whether it repeats, and how often each."""


def draws(requested: int, drawn: int) -> int:
    """The most draws of the version that made so many; earlier ones made up to 20 for each requested sample."""
    return (DRAWS if drawn <= DRAWS * requested else 20) * requested
