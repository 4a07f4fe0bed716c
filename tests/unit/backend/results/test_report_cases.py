"""The rows of the report's table of validated cases."""

from __future__ import annotations

import re
from types import SimpleNamespace
from typing import Any

from backend.reports import validation
from backend.reports.figures import Quantity
from campaigns.results.base import Status, ending
from campaigns.results.finding import Calls, HalfStep, Neighbours, ReferenceCost, Repeated, Validation
from campaigns.results.validate import Beyond, Later
from tests.given.verdict_evidence import encountered


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


def test_that_no_obstacle_approaches_is_stated_only_where_distances_are_extrapolated() -> None:
    """Of a criterion without distances to obstacles nothing is."""
    found = Beyond(times=2.0, flights=302, closer=0, lowest=None)
    for measured_to, stated in (("surface", True), ("centre", True), ("", False)):
        record: Any = SimpleNamespace(run=SimpleNamespace(criteria=[SimpleNamespace(measured_to=measured_to)]))
        assert (validation.FAR in validation._beyond(record, found)) == stated


def test_neighbours_that_failed_are_counted() -> None:
    around = Neighbours(flown=300, failed=7, lowest=1.25, lower_by=None)
    assert row(neighbours=around)["neighbours"] == "300, 7 failed"
    assert row(neighbours=around.model_copy(update={"failed": 0}))["neighbours"] == "300"


def encounter(**changes: Any) -> dict[str, str]:
    """The rows on the encounter, as text; of a criterion on distances."""
    validated = SimpleNamespace(encounter=encountered(**changes))
    of, run = Quantity("d_min", "m", None), SimpleNamespace(criteria=[SimpleNamespace(measured_to="surface")])
    record: Any = SimpleNamespace(of=of, run=run, validated=validated, findings=[], symbol_html=lambda path: path)
    return {re.sub("<[^>]*>", "", name): str(text) for name, text in validation.encounter(record)}


def test_flights_that_fail_after_the_horizon_are_counted() -> None:
    later = Later(name="F1", value=0.5, time=2.0, obstacle=0, distance=3.0, closing=1.0, simulated=True, until=71.5)
    some = Beyond(times=2.0, flights=302, cut_short=301, closer=1, lowest=later)

    def numbers(changes: dict[str, Any]) -> list[str]:
        text = encounter(beyond=some.model_copy(update=changes))["Beyond the horizon"]
        return re.findall(r"(?<![F\d.])\d+(?:\.\d+)?", text)

    assert numbers({}) == ["1", "302", "301", "1", "3", "1", "71.5", "0.5", "2"]
    assert numbers({"cut_short": 1, "lowest": None}) == ["1", "302", "1"]
    lower = later.model_copy(update={"value": 0.25, "until": None, "vehicle": True})
    assert numbers({"unknown": lower}) == ["1", "302", "301", "1", "3", "1", "0.25", "2"]
    assert numbers({"cut_short": 0, "lowest": None}) == numbers({"cut_short": None, "lowest": None}) == ["1", "302"]


def test_of_a_criterion_without_distances_nothing_is_known_beyond_what_is_simulated() -> None:
    found = Beyond(times=2.0, flights=302, cut_short=301, closer=0, lowest=None)
    for measured_to, known in (("", False), ("centre", True)):
        record: Any = SimpleNamespace(run=SimpleNamespace(criteria=[SimpleNamespace(measured_to=measured_to)]))
        text = validation._beyond(record, found)
        assert ("nothing is known" in text) is not known
        assert ("extrapolated" in text) is known


def test_a_change_along_a_slice_names_evaluations_without_a_value() -> None:
    no_value = {"a": [Status.FAILED, Status.EXCLUDED], "c": [Status.EXCLUDED]}
    text = list(encounter(influence={"a": 0.0, "b": 1.0}, no_value=no_value).values())[-1]
    a, b, c = text.split("; ")
    assert ending(no_value["a"]) in a
    assert ending(no_value["c"]) in c
    assert (a.split()[:3], b.split(), c.split()[0]) == (["a", "0", "m"], ["b", "1", "m"], "c")
    assert "0" not in c


def test_of_a_simulator_with_a_step_half_of_it_is_shown_and_why_it_has_no_value() -> None:
    again = Repeated(name="a fresh evaluation", cost=1.25, difference=0.0)
    shown = row(half_step=HalfStep(step=0.5, cost=1.125, difference=-0.125), again=again)
    assert (shown["halved"], shown["half"], shown["reason"]) == (True, "1.125000", "")
    refused = HalfStep(step=0.5, cost=None, difference=None, reason="not so short")
    lost = ReferenceCost(name="DOP853", cost=None, difference=None, reason="it diverged")
    without = str(row(half_step=refused, again=again)["reason"])
    assert without.endswith(refused.reason)
    assert row(half_step=refused, integrator=lost)["reason"] == f"{without}; {lost.reason}"
    assert not row(again=again)["halved"]
