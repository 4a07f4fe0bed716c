"""A stored run names its parameters as the run itself did: both have the same parameters with the same symbols."""

from __future__ import annotations

import dataclasses

import pytest

from campaigns import library, load_file
from campaigns.asked.load import load_document
from campaigns.versions import Versions
from clearance.testing.problems import Problem
from tests.audited import audited
from tests.given.case_campaigns import CASE1, searching
from worker.engine.problem.problem import Problem as Stored
from worker.evidence.scopes import stored_system
from worker.running.catalogue.installed import catalogue
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

DIRECT = {"method": "direct", "evaluations": 40}


def renamed(system: object, symbol: str) -> None:
    """Gives every parameter of a system this symbol."""
    system.parameters = tuple(dataclasses.replace(p, symbol=symbol) for p in system.parameters)  # type: ignore[attr-defined]


@pytest.mark.by_day(9)
@pytest.mark.parametrize("name", library())
def test_the_names_of_a_stored_run_are_those_of_the_run(name: str) -> None:
    """Also where all symbols are the same, or none is declared: what one of them lacks counts in neither."""
    campaign = load_file(library()[name])
    run = Problem(campaign)
    (system,) = stored_system.systems(campaign, catalogue(), Versions.of({}), "")
    for symbol in (None, "c", ""):
        if symbol is not None:
            renamed(run.system, symbol)
            renamed(system, symbol)
        assert Stored(campaign, system).symbols == Stored(campaign, run.system).symbols


@pytest.mark.nightly
def test_a_run_whose_parameter_has_the_symbol_of_the_threshold_follows_from_what_it_stored() -> None:
    """The radius of an obstacle, r, and the threshold of `separation`, r, as well."""
    campaign = searching(DIRECT)
    path = "obstacles.0.radius"
    radius = CASE1["scenario"]["obstacles"][0]["parameters"]["radius"]
    document = campaign.document() | {"uncertain": {path: {"low": 0.9 * radius, "high": radius}}}
    store = MemoryStore()
    execute(load_document(document), store, threads=1)
    audited(store, load_document(document))
