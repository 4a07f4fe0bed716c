"""The codes of claims: subjects of checks, and rules by which searches stop.

A method or check of another package has its own code, a string that is not listed here.
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
    RESOLUTION = "resolution"
    EVALUATIONS = "evaluations"
    RETRIES = "retries"
    CALLS = "noise of calls"
    CLOSEST_APPROACH = "closest approach"
    MOTION = "motion"
    AVOIDANCE = "avoidance"
    INFLUENCE = "influence"
    SAMPLING = "sampling"
    DISTANCES = "distances"
    NOISE = "noise"
    EXCLUSIONS = "exclusions"
    SAMPLE = "sample"
    OUTSIDE = "outside the bounds"
    PROBABILITY = "probability"
    TARGET = "target"


class StopCode(StrEnum):
    """Why a search or a stage requested no more evaluations."""

    BUDGET = "budget"
    """Its evaluations are used up."""
    SHARE = "share"
    """The evaluations of a part of it, or of one of its members, are used up."""
    ITERATIONS = "iterations"
    """It completed the iterations, generations, restarts or descents that its settings allow."""
    CONVERGED = "converged"
    """The cost, the step, or the population no longer changes."""
    OPTIMAL = "optimal"
    """The optimality conditions hold, or the cost cannot be lower."""
    RESOLUTION = "resolution"
    """Its boxes have reached the smallest size allowed."""
    EXHAUSTED = "exhausted"
    """It finds nothing new: no new minimum, no new point."""
    FOUND = "found"
    """It has found as many minima as its settings request."""
    NO_VALUE = "no value"
    """None of the evaluations that it needed has a value."""
    ROUNDING = "rounding"
    """Rounding prevents further progress."""
    LIBRARY = "library"
    """The library stopped it by its own rule or with an error."""
    UNSUITED = "unsuited"
    """The method cannot search this campaign."""
    DRAWN = "drawn"
    """All samples are drawn."""
    PRECISE = "precise"
    """The probability is known to the requested precision."""
    MEMBERS = "members"
    """Every member of a portfolio, or every part of a method, has ended."""
    OTHER = "other"
    """A sentence without a code, from a method of another package or an earlier version."""
