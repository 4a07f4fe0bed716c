"""Delays of guidance whose sum is longer than demands are stored are refused, at their upper bounds."""

from __future__ import annotations

from typing import Any

import pytest

from campaigns import check, library, load_file
from campaigns.asked.load import load_document
from campaigns.checked.check import simulation_problems
from worker.running.catalogue.installed import catalogue


def delayed(*periods: float, upper: float | None = None) -> Any:
    """Case 1 with these delays of guidance, the first one uncertain up to `upper`."""
    document: Any = load_file(library()["unicycle_static"]).document()
    faults = [{"component": "guidance_delay", "parameters": {"periods": p}} for p in periods]
    document["scenario"] |= {"guidance": {"period": 0.1}, "faults": [{"component": "latency"}, *faults]}
    if upper is not None:
        document["uncertain"]["faults.1.periods"] = {"low": 0.0, "high": upper}
    return load_document(document)


@pytest.mark.parametrize(
    ("periods", "upper", "fits"),
    [
        ((4.0,), None, True),
        ((2.0, 2.0), None, True),
        ((1.1, 1.2, 1.7), None, True),
        ((2.0, 2.01), None, False),
        ((3.0, 3.0), None, False),
        ((1.0, 3.0), 1.0, True),
        ((1.0, 3.0), 1.1, False),
    ],
)
def test_delays_add_up(periods: tuple[float, ...], upper: float | None, fits: bool) -> None:
    campaign = delayed(*periods, upper=upper)
    found = [p for p in check(campaign, catalogue()) if p.field == "scenario.faults"]
    assert bool(found) != fits
    assert simulation_problems(campaign, catalogue()) == []


def test_the_upper_bound_of_each_delay_is_stated() -> None:
    (problem,) = check(delayed(1.0, 3.5, upper=2.0), catalogue())
    assert problem.given == "faults.1.periods 2, faults.2.periods 3.5"
