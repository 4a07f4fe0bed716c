"""A campaign whose search is long enough to be killed in the middle."""

from __future__ import annotations

from campaigns import Campaign, library, load_file

SAMPLE = 40_000
"""Long enough to be killed in the middle, twice: on one core a second at least, and results are stored every 0.2 s."""


def case() -> Campaign:
    """Case 1 with a short DIRECT and a long Monte Carlo search; the other stages are short."""
    document = load_file(library()["unicycle_static"]).document()
    document["stages"]["search"] = [
        {"method": "direct", "evaluations": 300},
        {"method": "monte_carlo", "evaluations": SAMPLE},
    ]
    document["stages"] |= {
        "sensitivity": {"points": 5},
        "certify": {"samples": 100},
        "validate": {"neighbours": 20, "evaluations": 20_000},
    }
    return Campaign.model_validate(document)
