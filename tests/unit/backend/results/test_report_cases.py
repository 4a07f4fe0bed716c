"""The rows of the report's table of validated cases."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from backend.reports import validation
from backend.reports.figures import Quantity
from campaigns.results.finding import Calls, Neighbours, Validation


def row(**changes: Any) -> dict[str, object]:
    case = Validation(name="F1", step=None, cost=1.25, allowed=None, ok=True, **changes)
    record: Any = SimpleNamespace(
        of=Quantity("d_min", "m", None), validated=None, findings=[SimpleNamespace(validation=case)]
    )
    (only,) = validation.cases(record)
    return only


def test_of_independent_calls_the_lowest_is_shown() -> None:
    calls = Calls(values=[1.5, None, 1.125], violating=0, failed=1, confidence=0.95, low=0.0, high=0.5, statement=())
    assert (row(repeats=calls)["called"], row(repeats=calls)["other"]) == (True, "1.125000")
    assert (row()["called"], row()["other"]) == (False, "\u2014")


def test_neighbours_that_failed_are_counted() -> None:
    around = Neighbours(flown=300, failed=7, lowest=1.25, lower_by=None)
    assert row(neighbours=around)["neighbours"] == "300, 7 failed"
    assert row(neighbours=around.model_copy(update={"failed": 0}))["neighbours"] == "300"
