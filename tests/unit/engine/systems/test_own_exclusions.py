"""A flight that a criterion excludes by a rule of its own has no other reason, in any sentence."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from campaigns.asked.load import load_document
from campaigns.claims.spans import words
from campaigns.claims.stages.sample import WITHOUT, Counts
from campaigns.results.base import EXCLUDED
from tests.given.case_campaigns import document
from worker.engine.components.criteria import separation, surface_separation
from worker.engine.kernels.component import Criterion
from worker.engine.kernels.maths import kernel
from worker.engine.systems import optional
from worker.engine.systems.closed_loop.flights import Flights
from worker.engine.systems.closed_loop.parts import Installed
from worker.evidence.scopes import closed_loop
from worker.running.catalogue.entries import component_entry
from worker.running.catalogue.installed import catalogue, components

value = surface_separation.component.value


@kernel
def usual(first: Any, p: Any) -> bool:
    """The usual rule, with a docstring and other names."""
    return value(first, p) <= p.threshold


@kernel
def farther(first: Any, p: Any) -> bool:
    return value(first, p) <= 13.5 * p.threshold


@kernel
def strict(first: Any, p: Any) -> bool:
    return value(first, p) < p.threshold


@kernel
def several(first: Any, p: Any) -> bool:
    if first[0] > 1.0:
        return True
    return value(first, p) <= p.threshold


def by(rule: Any) -> Criterion:
    return replace(surface_separation.component, name="own", excluded=rule)


def installed(criterion: Criterion) -> Installed:
    described = catalogue()
    entry = component_entry(criterion, surface_separation)
    described = described.model_copy(update={"components": [*described.components, entry]})
    return Installed(components() | {("criterion", "own"): criterion}, described)


def test_the_usual_rule_is_recognised_and_no_other_one() -> None:
    assert not [entry.name for entry in catalogue().components if entry.own_rule]
    assert not component_entry(by(usual), surface_separation).own_rule
    for rule in (farther, strict, several):
        assert component_entry(by(rule), surface_separation).own_rule
    other_value = replace(by(usual), value=separation.component.value)
    assert component_entry(other_value, surface_separation).own_rule, "it compares another value than its own"


@pytest.mark.parametrize(("rule", "own"), [(usual, False), (several, True)])
def test_a_flight_has_the_reason_by_which_it_was_excluded(rule: Any, own: bool) -> None:
    made = document()
    made["criterion"] = {"component": "own", "threshold": 100.0}
    campaign, known = load_document(made), installed(by(rule))
    flights = Flights(campaign, known, compiled=False, lanes=1)
    batch, reasons = flights.simulate_vectors(flights.vector({})[None, :])
    assert batch.status.tolist() == [EXCLUDED]
    assert np.isnan(batch.costs).all()
    assert ("own rule" in reasons[0], "threshold" in reasons[0]) == (own, not own)
    assert optional.own_rule(flights) == own  # type: ignore[arg-type]
    assert closed_loop.described(campaign, known.catalogue, "DOP853").own_rule == own


@pytest.mark.parametrize("outside", [0.0, 0.01])
@pytest.mark.parametrize("excluded", [1, 40])
def test_a_sample_states_by_what_its_draws_were_excluded(excluded: int, outside: float) -> None:
    counts = Counts(0, 60, 0, excluded, outside, 0.95, WITHOUT, own_rule=True)
    for text in (words(counts.bound(0.05)), words(counts.unclaimed("points", "they are chosen"))):
        assert "own rule" in text
        assert "threshold" not in text
