"""Of a fault or environment of one's own that reads the time, it is stated where its switches are not known."""

from __future__ import annotations

from typing import Any

import pytest

from campaigns.asked.load import load_document
from campaigns.claims.spans import words
from tests.given.case_campaigns import document
from worker.engine.components.faults import actuator_lag, actuator_loss
from worker.engine.kernels.component import Fault, unswitched
from worker.engine.kernels.maths import kernel
from worker.evidence.scopes import closed_loop
from worker.running.catalogue.installed import catalogue


@kernel
def kicked(t: float, u: float, a: tuple[()], p: Any) -> tuple[float, tuple[()]]:
    return u + (1.0 if t > 2.0 else 0.0), ()


@kernel
def biased(t: float, u: float, a: tuple[()], p: Any) -> tuple[float, tuple[()]]:
    return u + 1.0, ()


def fault(function: Any, switches: Any = None) -> Fault:
    parameters = actuator_lag.component.parameters
    return Fault("own", "Own", path="actuator", parameters=parameters, kernel=function, switches=switches)


def test_what_reads_the_time_and_does_not_state_when_it_changes_is_known() -> None:
    assert unswitched(fault(kicked))
    assert not unswitched(fault(biased))
    assert not unswitched(fault(kicked, lambda p, horizon: [])), "it declares that there are none"
    assert not unswitched(actuator_loss.component)
    assert not [entry.name for entry in catalogue().components if entry.unswitched]


@pytest.mark.parametrize("unknown", [True, False])
def test_the_scope_states_that_a_change_may_be_missed(unknown: bool) -> None:
    made = load_document(document(scenario__faults=[{"component": "blackout", "parameters": {"at": 2.0}}]))
    known = catalogue()
    entries = [c.model_copy(update={"unswitched": unknown}) if c.name == "blackout" else c for c in known.components]
    described = closed_loop.described(made, known.model_copy(update={"components": entries}), "DOP853")
    assert (closed_loop.UNSWITCHED in words(described.scope.settings)) == unknown
    assert not described.bars
