"""Units of two campaigns: a number of one is the same number in the other only where they are equal."""

from __future__ import annotations

import contextlib
from typing import Any

import pytest

from campaigns.asked.load import load_document
from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue
from campaigns.checked.units import differing, fixed
from campaigns.results.baselines import CannotCompare, with_baseline
from tests.given import verdict_evidence as given
from tests.given.case_campaigns import campaign
from tests.simulators import package
from worker.running.catalogue.installed import catalogue


def described(result: str, parameter: str) -> Catalogue:
    """What an installation has whose simulator states these units."""
    wind = {"name": "wind", "symbol": "w", "unit": parameter, "low": 0.0, "high": 20.0, "default": 1.0, "text": "Wind"}
    value = {"name": "separation", "title": "Separation", "unit": result, "quantity": "d", "worse": "low"}
    one = {"name": "drop", "title": "Drop", "text": "", "parameters": [wind], "results": [value]}
    return Catalogue.model_validate({"version": "1", "components": [], "methods": [], "simulators": [one]})


def simulated() -> Campaign:
    document: dict[str, Any] = package.campaign(1.0, simulator={"name": "drop"})
    return load_document(document | {"uncertain": {"simulator.wind": {"low": 0.0, "high": 8.0}}})


@pytest.mark.parametrize(
    ("then", "now", "named"),
    [
        (("m", "m/s"), ("m", "m/s"), []),
        (("kg m2", "m/s"), ("kg·m²", "m/s"), []),
        (("km", "m/s"), ("m", "m/s"), ["its criterion", "km", "m"]),
        (("m", "m/s"), ("m", "km/h"), ["simulator.wind", "m/s", "km/h"]),
        (("m", "m/s"), ("m", ""), ["simulator.wind", "m/s", "no unit"]),
    ],
)
def test_units_differ_where_a_number_means_something_else(
    then: tuple[str, str], now: tuple[str, str], named: list[str]
) -> None:
    one, catalogues = simulated(), (described(*then), described(*now))
    statement = differing(one, catalogues[0], one, catalogues[1])
    assert bool(statement) == bool(named)
    assert all(f"{word} " in f"{statement.replace(',', '')} " for word in named)


def test_what_is_varied_in_either_has_the_same_unit() -> None:
    """A baseline that fixed the wind states its value, which is a number of its own unit."""
    one = simulated()
    calm = load_document(
        one.document() | {"uncertain": {"simulator.gust": {"low": 0, "high": 1}}, "simulator": {"name": "drop"}}
    )
    then, now = described("m", "m/s"), described("m", "km/h")
    assert fixed(calm, then) == {"simulator.wind": 1.0}
    assert fixed(one, then) == {}
    assert differing(calm, then, one, now).startswith("simulator.wind is in m/s")
    assert differing(one, then, calm, now).startswith("simulator.wind is in m/s")


def test_a_scenario_has_the_units_of_its_components() -> None:
    one, here = campaign(), catalogue()
    assert differing(one, here, one, here) == ""
    other = here.model_copy(
        update={
            "components": [c.model_copy(update={"unit": "ft"}) if c.role == "criterion" else c for c in here.components]
        }
    )
    assert differing(one, other, one, here).startswith("its criterion")


@pytest.mark.parametrize(
    ("was", "is_", "refused"), [("a", "b", True), ("a", "a", False), ("", "b", False), ("a", "", False)]
)
def test_a_criterion_whose_code_has_changed_is_another_one(was: str, is_: str, refused: bool) -> None:
    """Of an earlier version the code is not known."""

    def by(digest: str) -> Catalogue:
        entries = [
            entry.model_copy(update={"computed_by": digest}) if entry.name == one.criterion.component else entry
            for entry in catalogue().components
        ]
        return catalogue().model_copy(update={"components": entries})

    one = campaign()
    clause = differing(one, by(was), one, by(is_))
    assert bool(clause) == refused
    assert not refused or one.criterion.component in clause
    with pytest.raises(CannotCompare) if refused else contextlib.nullcontext():
        with_baseline(one, "R-0001", one, [given.finding(0.84)], clause)
