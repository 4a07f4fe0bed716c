"""The codes of claims: what a check is about, by which rule a search stopped.

They list ours. A method or a check of another package brings its own code, a string that is in no list here.
"""

from __future__ import annotations

from enum import StrEnum


class CheckCode(StrEnum):
    """What must hold before a campaign is cleared."""

    NOMINAL = "nominal"
    SEARCH = "search"
    NO_VIOLATION = "no violation"
    MINIMUM = "minimum"
    AGREEMENT = "agreement"
    VALIDATION = "validation"
    REPETITION = "repetition"
    EVALUATIONS = "evaluations"
    CLOSEST_APPROACH = "closest approach"
    MOTION = "motion"
    AVOIDANCE = "avoidance"
    INFLUENCE = "influence"
    DISTANCES = "distances"
    NOISE = "noise"
    EXCLUSIONS = "exclusions"
    PROBABILITY = "probability"
    TARGET = "target"


class StopCode(StrEnum):
    """Why a search or a stage asked for no more evaluations."""

    BUDGET = "budget"
    """Its evaluations are used up."""
    SHARE = "share"
    """So are those of a part of it, or of one of its members."""
    ITERATIONS = "iterations"
    """It did as many iterations, generations, restarts, or descents as its settings ask for."""
    CONVERGED = "converged"
    """The cost, the step, or the population no longer changes."""
    OPTIMAL = "optimal"
    """The optimality conditions hold, or the cost cannot be lower."""
    RESOLUTION = "resolution"
    """What it divides is as small as it may be."""
    EXHAUSTED = "exhausted"
    """It finds nothing new: no new minimum, no new point."""
    FOUND = "found"
    """It has as many minima as its settings ask for."""
    NO_VALUE = "no value"
    """No evaluation that it needed has a value."""
    ROUNDING = "rounding"
    """Rounding stopped it."""
    LIBRARY = "library"
    """The library stopped it by a rule of its own or with an error."""
    UNSUITED = "unsuited"
    """The method cannot search this campaign."""
    DRAWN = "drawn"
    """All samples are drawn."""
    PRECISE = "precise"
    """The probability is known as precisely as asked for."""
    MEMBERS = "members"
    """Every member of a portfolio, or every part of a method, has ended."""
    OTHER = "other"
    """A sentence without a code, as methods of other packages and earlier versions give it."""
