"""A campaign whose search is long enough to be killed in the middle."""

from __future__ import annotations

from campaigns import Campaign, library, load_file

TWICE = 40_000
"""Samples that last long enough to be killed in the middle, twice: a second on one core, where results are stored every
0.2 s."""
ONCE = TWICE // 2


def case(samples: int = ONCE) -> Campaign:
    """Case 1 with a short DIRECT and a long Monte Carlo search; the other stages are short."""
    document = load_file(library()["unicycle_static"]).document()
    document["stages"]["search"] = [
        {"method": "direct", "evaluations": 300},
        {"method": "monte_carlo", "evaluations": samples},
    ]
    document["stages"] |= {
        "sensitivity": {"points": 5},
        "certify": {"samples": 100},
        "validate": {"neighbours": 20, "evaluations": 20_000},
    }
    return Campaign.model_validate(document)
