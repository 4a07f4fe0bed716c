"""A campaign whose search is long enough to be killed in the middle."""

from __future__ import annotations

from campaigns import Campaign, library, load_file

SAMPLE = 100_000
"""Long enough to be killed in the middle, twice."""


def case() -> Campaign:
    """Case 1 with a short DIRECT and a long Monte Carlo search."""
    document = load_file(library()["unicycle_static"]).document()
    document["stages"]["search"] = [
        {"method": "direct", "evaluations": 300},
        {"method": "monte_carlo", "evaluations": SAMPLE},
    ]
    return Campaign.model_validate(document)
