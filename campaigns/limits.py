"""Limits that a run itself applies, and usual values of a campaign: a change of one can change a number.

`campaigns.rules` lists them with those that only a verdict applies.
"""

AGREEMENT, CONFIDENCE, CONFIDENCE_AT_LEAST = 0.05, 0.95, 0.9
"""Usual agreement of methods, a fraction of nominal minus worst; usual confidence of bounds, and the least allowed."""
TOLERANCE, TOLERANCE_OF_MARGIN = 1e-3, 0.1
"""How much the evaluations of a case may differ: usual fraction of its value, and at most that of the margin."""
ROUNDING, ROUNDING_AT_LEAST = 1e-6, 1e-15
"""Fraction of the scale of what is compared below which a difference counts as rounding; whatever the margin, this."""
DISTANCE, BARRIER = 0.03, 0.05
"""Usual limits within which two minima count as one: fraction of every range, of nominal minus worst."""
SAME_COST, SAME_PLACE = 0.01, 0.05
"""A method found a worst case if its evaluations came this close: fraction of nominal minus worst, of every range."""
SPOT_CHECKS, VIOLATIONS = 200, 200
"""Random evaluations, and stored violations at most, that are made again to confirm them; of a simulator in fresh
processes."""
FINDINGS = 20_000
"""Usual limit of the evaluations that distinguish the worst cases, where the searches have as many."""
REPEATS = 10
"""Fewer independent calls of a noisy simulator would say too little about a finding."""
SAMPLE, SAMPLE_CLOSED_LOOP = 59, 300
"""The smallest independent sample that "cleared" rests on: without a violation it bounds P(violation) at 5 %, with a
confidence of 95 %. Drawn where a campaign states none: so many of a simulator, and these of a closed loop (1 %)."""
REALISATIONS = 100
"""Over so many whole numbers at least a parameter that is a seed is to be uniform."""
TURN = 0.7853981633974483
"""pi/4: what turns further within a step can be at the same place at every sample."""
CONTINUED = 2
OTHERS = 1000
"""Flights are simulated on to this multiple of the horizon, to see whether an encounter lies beyond it."""
DRAWS = 2
"""The largest number of draws, including excluded ones, per requested sample: limits scenarios that rarely hold."""

STORED_WHOLE = 100_000
"""A larger sample than this is proposed with its lowest flights stored only. With noise it must be: one that is stored
whole has 2^20 realisations, so that draws of a larger one are too often the same for its bound to hold."""

SEARCH, SEARCHED, SEARCHED_EACH = "auto", 5000, 1000
"""The search of a campaign that states none: the method, its evaluations at least, and those for each parameter."""

BETWEEN = (0.2, 0.4, 0.6, 0.8)
"""Positions on the straight line from a mode of an estimate to a finding that must violate for them to be the same."""
LINE = 32
"""Equal parts of the straight line from a violation of a baseline to a finding; no case between them may be clear for
them to be the same."""

CHANCE = 20
"""Independent calls of two runs differ beyond chance if the probability of it is at most one in so many."""
